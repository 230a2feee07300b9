//! Drawn maps of a leaf: outline, veins of four orders, mottling.
//!
//! v runs from the tip (0) to the base (1) and u across with the midrib at one half, as the leaf
//! templates of the plant generator lay out their texture coordinates; lengths are shares of the
//! leaf's length.

use super::maps::SideMaps;
use crate::scene::grow::noise::fractal;

/// How a leaf is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// Outline and course of the veins.
    pub form: Form,
    /// Half the width over the length.
    pub half_width: f32,
    /// Where the leaf is widest, from the base, (0, 1).
    pub widest: f32,
    /// Side veins on each side.
    pub veins: f32,
    /// How far a side vein runs towards the tip per distance from the midrib.
    pub slant: f32,
    /// Depth of the teeth of the margin over the half width.
    pub teeth: f32,
    /// Strength of the mottling, 0 to 1.
    pub mottle: f32,
    /// Senescence: 0 green, 1 spotted and with green left along the veins.
    pub autumn: f32,
}

/// Kinds of leaf blades.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// A midrib with side veins.
    Pinnate,
    /// Veins along the blade: grasses.
    Parallel,
    /// A needle: the whole texture is leaf.
    Needle,
}

impl Look {
    /// Egg-shaped.
    pub const OVATE: Self = Self {
        form: Form::Pinnate,
        half_width: 0.31,
        widest: 0.40,
        veins: 9.0,
        slant: 0.85,
        teeth: 0.0,
        mottle: 0.5,
        autumn: 0.0,
    };
    /// Birch: egg-shaped with a toothed margin.
    pub const SERRATE: Self = Self {
        half_width: 0.33,
        widest: 0.34,
        slant: 0.80,
        teeth: 0.06,
        ..Self::OVATE
    };
    /// The same in autumn.
    pub const SENESCED: Self = Self {
        mottle: 0.9,
        autumn: 1.0,
        ..Self::SERRATE
    };
    /// Narrow, widest below the middle.
    pub const LANCE: Self = Self {
        half_width: 0.20,
        widest: 0.42,
        veins: 11.0,
        slant: 1.2,
        ..Self::OVATE
    };
    /// Broad at the base.
    pub const CORDATE: Self = Self {
        half_width: 0.41,
        widest: 0.30,
        veins: 6.0,
        slant: 1.05,
        teeth: 0.03,
        ..Self::OVATE
    };
    /// A narrow ellipse.
    pub const ELLIPTIC: Self = Self {
        half_width: 0.21,
        widest: 0.50,
        veins: 8.0,
        slant: 0.7,
        mottle: 0.3,
        ..Self::OVATE
    };
    /// A piece of a grass blade.
    pub const PARALLEL: Self = Self {
        form: Form::Parallel,
        half_width: 0.16,
        widest: 0.35,
        ..Self::OVATE
    };
    /// A needle.
    pub const NEEDLE: Self = Self {
        form: Form::Needle,
        half_width: 0.5,
        ..Self::OVATE
    };
}

/// Mask and maps of both sides.
#[derive(Debug, Clone)]
pub struct Drawn {
    /// Where the leaf is.
    pub mask: Vec<f32>,
    /// Upper and lower side.
    pub sides: [SideMaps; 2],
}

/// Draws a leaf.
#[must_use]
pub fn draw(look: &Look, size: [u32; 2], roughness: [f32; 2], gloss: f32) -> Drawn {
    let mut sides = [0, 1].map(|i| SideMaps::plain(size, gloss, roughness[i]));
    let mut mask = Vec::with_capacity(sides[0].len());
    let texel = 1.0 / size[1].max(1) as f32;
    for y in 0..size[1] {
        for x in 0..size[0] {
            let u = (x as f32 + 0.5) / size[0] as f32;
            let v = (y as f32 + 0.5) / size[1] as f32;
            let index = mask.len();
            mask.push(look.coverage(u, v, texel));
            let at = look.place(u, v);
            for (face, side) in sides.iter_mut().enumerate() {
                side.gamma_delta[index] = at.gamma_delta(look, face);
                side.specular[index] = at.specular(gloss, roughness[face], face);
            }
        }
    }
    Drawn { mask, sides }
}

/// What is found at a place of the blade, each 0 to 1.
struct Place {
    midrib: f32,
    side_vein: f32,
    cross_vein: f32,
    net: f32,
    /// Between two side veins: 0 at a vein, 1 half way.
    islet: f32,
    blotch: f32,
    grain: f32,
    spot: f32,
}

impl Look {
    /// Half the width of the blade at a distance from the base.
    fn edge(&self, s: f32) -> f32 {
        if !(0.0..=1.0).contains(&s) {
            return 0.0;
        }
        // s^p (1 - s)^q is widest at p / (p + q).
        let q = 0.85;
        let p = q * self.widest / (1.0 - self.widest);
        let peak = self.widest.powf(p) * (1.0 - self.widest).powf(q);
        let smooth = self.half_width * s.powf(p) * (1.0 - s).powf(q) / peak;
        let tooth = (s * 34.0).fract();
        smooth * (1.0 - self.teeth * tooth)
    }

    fn coverage(&self, u: f32, v: f32, texel: f32) -> f32 {
        if self.form == Form::Needle {
            return 1.0;
        }
        let (s, w) = (1.0 - v, (u - 0.5).abs());
        // The margin is half a texel soft.
        ((self.edge(s) - w) / texel + 0.5).clamp(0.0, 1.0)
    }

    fn place(&self, u: f32, v: f32) -> Place {
        let (s, w) = (1.0 - v, (u - 0.5).abs());
        let blotch = fractal(u, v, [5, 5], 11);
        let grain = fractal(u, v, [40, 40], 23);
        let spot = fractal(u, v, [14, 14], 37);
        let mut out = Place {
            midrib: 0.0,
            side_vein: 0.0,
            cross_vein: 0.0,
            net: 0.0,
            islet: 0.5,
            blotch,
            grain,
            spot,
        };
        match self.form {
            Form::Pinnate => self.pinnate(s, w, u > 0.5, &mut out),
            Form::Parallel => {
                out.midrib = vein(w, 0.014 * (1.2 - s));
                let lines = (w * 46.0 + 0.3 * (blotch - 0.5)).fract();
                out.side_vein = 0.6 * vein((lines - 0.5).abs() / 46.0, 0.0028);
                let fine = (w * 190.0).fract();
                out.net = 0.5 * vein((fine - 0.5).abs() / 190.0, 0.0012);
            }
            Form::Needle => out.midrib = 0.3 * vein(w, 0.12),
        }
        out
    }

    fn pinnate(&self, s: f32, w: f32, right: bool, out: &mut Place) {
        let edge = self.edge(s).max(0.02);
        let across = (w / edge).min(1.2);
        out.midrib = vein(w, 0.004 + 0.010 * (1.0 - s).powf(1.5));
        // Side veins leave the midrib in turn, rise towards the tip and bend along the margin.
        let wander = 0.03 * (out.blotch - 0.5);
        let rise = self.slant * w * (1.0 + 0.35 * across * across);
        let phase = (s - rise + wander) * self.veins + if right { 0.5 } else { 0.0 };
        let off = (phase - phase.round()).abs();
        let number = phase.round();
        // A vein of its own width for each, and thinner towards the margin.
        let own = 0.8 + 0.4 * hash(number, f32::from(u8::from(right)));
        let thin = 0.0065 * own * (1.0 - 0.75 * across).max(0.12);
        out.side_vein = vein(off / self.veins, thin) * (1.25 - 0.9 * across).clamp(0.0, 1.0);
        out.islet = (2.0 * off).min(1.0);
        // Cross veins: ladders between neighbouring side veins, each rung broken by noise.
        let ladder = (phase.floor(), phase - phase.floor());
        let along =
            w * 30.0 + 5.0 * hash(ladder.0, 7.0) + 1.1 * (ladder.1 - 0.5) + 1.5 * (out.spot - 0.5);
        let rung = (along - along.round()).abs() / 30.0;
        let present = f32::from(u8::from(hash(ladder.0, along.round()) > 0.15));
        out.cross_vein = present * vein(rung, 0.0024);
        // The net: cells of one to two hundredths of the length.
        let (first, second) = cells(58.0 * w + 3.0 * out.spot, 58.0 * s, right);
        out.net = vein((second - first) / 58.0, 0.0022);
    }
}

/// Profile of a vein: 1 on it, falling to 0 over twice its half width.
fn vein(distance: f32, half_width: f32) -> f32 {
    let t = (1.5 - 0.75 * distance / half_width).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Number in \[0, 1\] of a pair.
fn hash(a: f32, b: f32) -> f32 {
    let mut h = (a as i32 as u32).wrapping_mul(0x9e37_79b1)
        ^ (b as i32 as u32).wrapping_mul(0x85eb_ca77)
        ^ 0x27d4_eb2f;
    h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
    h = (h ^ (h >> 12)).wrapping_mul(0x297a_2d39);
    h ^= h >> 15;
    (h >> 8) as f32 / 16_777_216.0
}

/// Distances to the nearest and second nearest of jittered points (Worley 1996), in cells.
fn cells(x: f32, y: f32, right: bool) -> (f32, f32) {
    let (cx, cy) = (x.floor(), y.floor());
    let (mut first, mut second) = (9.0_f32, 9.0_f32);
    let seed = if right { 977.0 } else { 0.0 };
    for dy in -1..=1 {
        for dx in -1..=1 {
            let (px, py) = (cx + dx as f32, cy + dy as f32);
            let jx = px + hash(px + seed, py);
            let jy = py + hash(py + 131.0, px + seed);
            let d = ((jx - x).powi(2) + (jy - y).powi(2)).sqrt();
            if d < first {
                (first, second) = (d, first);
            } else {
                second = second.min(d);
            }
        }
    }
    (first, second)
}

impl Place {
    /// gamma and thickness; face 0 is the upper side.
    fn gamma_delta(&self, look: &Look, face: usize) -> [f32; 4] {
        let below = face == 1;
        // Veins stand out below the blade more than above it.
        let prominence = if below { 1.0 } else { 0.55 };
        let veins = (1.0 * self.midrib)
            .max(0.62 * self.side_vein)
            .max(0.34 * self.cross_vein)
            .max(0.20 * self.net);
        let mottle = look.mottle * (self.blotch - 0.5) + 0.35 * look.mottle * (self.grain - 0.5);
        let mut delta = 0.95 * veins + 0.28 * mottle;
        // Pale, yellowish veins; a darker blade in the hollows between them.
        let pale = prominence * veins;
        let bulge = 0.10 * (self.islet - 0.5);
        let shade = 1.0 + 0.55 * mottle + bulge;
        let mut gamma = [
            shade * (1.0 + 1.15 * pale),
            shade * (1.0 + 0.75 * pale),
            shade * (1.0 + 0.95 * pale),
        ];
        if look.autumn > 0.0 {
            // Brown, dry spots; green that is left along the veins.
            let dry = look.autumn * smooth((self.spot * 0.6 + self.blotch * 0.6 - 0.72) * 7.0);
            let green = look.autumn * 0.6 * smooth(1.0 - 2.2 * self.islet) * (1.0 - dry);
            let tint = |c: f32, dry_to: f32, green_to: f32| {
                c * (1.0 + dry * (dry_to - 1.0)) * (1.0 + green * (green_to - 1.0))
            };
            gamma = [
                tint(gamma[0], 0.45, 0.62),
                tint(gamma[1], 0.28, 0.97),
                tint(gamma[2], 0.30, 0.80),
            ];
            delta += 0.5 * dry + 0.18 * green;
        }
        [gamma[0], gamma[1], gamma[2], delta.max(-0.9)]
    }

    /// Gloss and roughness; face 0 is the upper side.
    fn specular(&self, gloss: f32, roughness: f32, face: usize) -> [f32; 4] {
        let veins = self.midrib.max(0.6 * self.side_vein);
        let wax =
            1.0 + 0.35 * (self.grain - 0.5) - 0.35 * veins * if face == 0 { 1.0 } else { 0.5 };
        let s = (gloss * wax).clamp(0.0, 1.0);
        let m = roughness * (1.0 + 0.25 * (self.blotch - 0.5) + 0.30 * veins);
        [s, s, s, m.clamp(0.05, 1.0)]
    }
}

fn smooth(t: f32) -> f32 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
