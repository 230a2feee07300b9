//! Twin of factors on thresholds and widths: programs of a stack over the buffers of a pixel
//! (Deussen and Strothotte 2000, figure 4 c).

use glam::DVec3;

use crate::abi::{
    InkFrame, PAPER_ABS, PAPER_ADD, PAPER_CLAMP, PAPER_COS, PAPER_DIV, PAPER_EXP, PAPER_FACTOR,
    PAPER_FLOOR, PAPER_FRACT, PAPER_GREATER, PAPER_LARGEST, PAPER_LESS, PAPER_LOG, PAPER_MAX,
    PAPER_MIN, PAPER_MIX, PAPER_MOD, PAPER_MUL, PAPER_NEG, PAPER_NOT, PAPER_NUMBER, PAPER_POW,
    PAPER_SIN, PAPER_SMOOTH, PAPER_SQRT, PAPER_SUB, PAPER_VARIABLE, PAPER_VARIABLES, PAPER_WIDER,
    PaperModulate, PaperOp, PaperTrait,
};

/// Values of a program's variables.
pub type Inputs = [f64; PAPER_VARIABLES as usize];

fn one_of(code: u32, a: f64) -> f64 {
    match code {
        PAPER_NEG => -a,
        PAPER_NOT => f64::from(a == 0.0),
        PAPER_ABS => a.abs(),
        PAPER_SQRT => a.max(0.0).sqrt(),
        PAPER_SIN => a.sin(),
        PAPER_COS => a.cos(),
        PAPER_EXP => a.min(50.0).exp(),
        PAPER_LOG if a > 0.0 => a.ln(),
        PAPER_LOG => 0.0,
        PAPER_FLOOR => a.floor(),
        _ => a - a.floor(),
    }
}

fn power(a: f64, b: f64) -> f64 {
    if b == 0.0 {
        return 1.0;
    }
    if a == 0.0 {
        return 0.0;
    }
    let size = (b * a.abs().ln()).min(50.0).exp();
    let whole = b == b.floor();
    let odd = b - 2.0 * (0.5 * b).floor() == 1.0;
    if a > 0.0 {
        size
    } else if !whole {
        0.0
    } else if odd {
        -size
    } else {
        size
    }
}

fn two_of(code: u32, a: f64, b: f64) -> f64 {
    match code {
        PAPER_ADD => a + b,
        PAPER_SUB => a - b,
        PAPER_MUL => a * b,
        PAPER_DIV | PAPER_MOD if b == 0.0 => 0.0,
        PAPER_DIV => a / b,
        PAPER_MOD => a - b * (a / b).floor(),
        PAPER_POW => power(a, b),
        PAPER_MIN => a.min(b),
        PAPER_MAX => a.max(b),
        PAPER_LESS => f64::from(a < b),
        _ => f64::from(a > b),
    }
}

fn three_of(code: u32, a: f64, b: f64, c: f64) -> f64 {
    match code {
        PAPER_CLAMP => a.max(b).min(c),
        PAPER_MIX => a + (b - a) * c,
        PAPER_SMOOTH => {
            let t = if b == a {
                f64::from(c >= a)
            } else {
                ((c - a) / (b - a)).clamp(0.0, 1.0)
            };
            t * t * (3.0 - 2.0 * t)
        }
        _ if a != 0.0 => b,
        _ => c,
    }
}

/// The value of a program; without steps 1.
#[must_use]
pub fn value_of(steps: &[PaperOp], inputs: &Inputs) -> f64 {
    let mut stack: Vec<f64> = Vec::new();
    for op in steps {
        let mut take = || stack.pop().unwrap_or(0.0);
        let value = if op.code == PAPER_NUMBER {
            f64::from(op.value)
        } else if op.code == PAPER_VARIABLE {
            inputs[op.value as usize]
        } else if op.code <= PAPER_FRACT {
            one_of(op.code, take())
        } else if op.code <= PAPER_GREATER {
            let (b, a) = (take(), take());
            two_of(op.code, a, b)
        } else {
            let (c, b, a) = (take(), take(), take());
            three_of(op.code, a, b, c)
        };
        let largest = f64::from(PAPER_LARGEST);
        stack.push(value.clamp(-largest, largest));
    }
    stack.first().copied().unwrap_or(1.0)
}

/// Maps that programs read.
#[derive(Debug, Clone, Copy)]
pub struct Buffers<'a> {
    /// Camera.
    pub frame: &'a InkFrame,
    /// Steps of all programs.
    pub steps: &'a [PaperOp],
    /// Particles.
    pub traits: &'a [PaperTrait],
    /// Depth of foliage.
    pub foliage_depth: &'a [f32],
    /// Number of the particle plus 1.
    pub foliage_number: &'a [f32],
    /// Depth of stems.
    pub stem_depth: &'a [f32],
    /// Normal of stems and light.
    pub stem_normal: &'a [[f32; 4]],
    /// Shadow.
    pub shadow: &'a [f32],
    /// Masks, 0 to 255.
    pub masks: &'a [[u8; 4]],
}

/// Factors on threshold and width of what is seen in a pixel.
#[must_use]
pub fn factors(maps: &Buffers<'_>, push: &PaperModulate, x: i64, y: i64) -> [f64; 2] {
    let here = (y * i64::from(push.width) + x) as usize;
    let foliage = f64::from(maps.foliage_depth[here]);
    let stem = f64::from(maps.stem_depth[here]);
    if foliage <= 0.0 && stem <= 0.0 {
        return [1.0; 2];
    }
    let leaf = foliage > 0.0 && (stem <= 0.0 || foliage <= stem);
    let vector = |v: [f32; 3]| DVec3::from(v.map(f64::from));
    let frame = maps.frame;
    let mut normal = maps.stem_normal[here].map(f64::from);
    let (mut number, mut object) = (0.0, 0.0);
    if leaf {
        number = f64::from(maps.foliage_number[here]);
        let of = &maps.traits[number as usize - 1];
        object = f64::from(of.object);
        let n = vector(of.normal);
        let seen = DVec3::new(
            n.dot(vector(frame.right)),
            n.dot(vector(frame.up)),
            -n.dot(vector(frame.forward)),
        );
        let seen = if seen.z < 0.0 { -seen } else { seen };
        let ambient = f64::from(push.ambient);
        let light = ambient + (1.0 - ambient) * n.dot(vector(frame.to_sun)).abs();
        normal = [seen.x, seen.y, seen.z, light];
    }
    let (nearest, farthest) = (f64::from(push.nearest), f64::from(push.farthest));
    let share = (if leaf { foliage } else { stem } - nearest) / (farthest - nearest);
    let masks = maps.masks[here].map(|m| f64::from(m) / 255.0);
    let inputs = [
        (x as f64 + 0.5) / f64::from(push.width),
        1.0 - (y as f64 + 0.5) / f64::from(push.height),
        f64::from(push.near) + share * (f64::from(push.far) - f64::from(push.near)),
        number,
        object,
        f64::from(maps.shadow[here]),
        normal[3],
        normal[0],
        normal[1],
        normal[2],
        masks[0],
        masks[1],
        masks[2],
        masks[3],
    ];
    let [a, b, c, d] = push.ends.map(|e| e as usize);
    let [first, middle, last] = if leaf { [0, a, b] } else { [b, c, d] };
    let value = |from: usize, to: usize| value_of(&maps.steps[from..to], &inputs);
    [
        value(first, middle).clamp(0.0, f64::from(PAPER_FACTOR)),
        value(middle, last).clamp(0.0, f64::from(PAPER_WIDER)),
    ]
}
