//! One leaf as a small mesh, in the leaf's own frame.
//!
//! x runs from the petiole's base (origin) to the tip (1, 0, 0), z is the upper side, y the left
//! hand seen from above with the tip ahead. Unit length, so a leaf is a frame and a scale.

use glam::DVec3;

use super::parameters::{LeafParameters, LeafShape};
use super::portable::sin_cos;

/// A leaf mesh in its own frame.
pub(super) struct Template {
    pub(super) positions: Vec<DVec3>,
    pub(super) normals: Vec<DVec3>,
    pub(super) texcoords: Vec<[f32; 2]>,
    pub(super) triangles: Vec<[u16; 3]>,
}

/// Number of variants of a template, which differ in fold, curl and sweep.
pub(super) const VARIANTS: usize = 8;

/// A row of the blade: the midrib's place and the edge's place and half width, over the blade.
struct Row {
    mid: f64,
    edge: f64,
    half_width: f64,
}

const fn row(mid: f64, edge: f64, half_width: f64) -> Row {
    Row {
        mid,
        edge,
        half_width,
    }
}

/// Outlines; the coarse ones are for plants of many leaves, which are small in any picture.
const OVATE: [Row; 3] = [
    row(0.14, 0.10, 0.20),
    row(0.44, 0.42, 0.31),
    row(0.77, 0.74, 0.20),
];
const OVATE_COARSE: [Row; 2] = [row(0.24, 0.20, 0.27), row(0.66, 0.62, 0.27)];
const CORDATE: [Row; 4] = [
    row(0.07, -0.10, 0.21),
    row(0.22, 0.07, 0.41),
    row(0.47, 0.38, 0.40),
    row(0.76, 0.70, 0.21),
];
const CORDATE_COARSE: [Row; 2] = [row(0.18, -0.06, 0.33), row(0.54, 0.46, 0.40)];
const ELLIPTIC: [Row; 3] = [
    row(0.18, 0.16, 0.13),
    row(0.50, 0.50, 0.21),
    row(0.82, 0.80, 0.13),
];
const ELLIPTIC_COARSE: [Row; 2] = [row(0.32, 0.30, 0.19), row(0.68, 0.66, 0.19)];

/// The template variants of a leaf.
pub(super) fn templates(leaf: &LeafParameters, coarse: bool) -> Vec<Template> {
    (0..VARIANTS)
        .map(|i| {
            // a fixed sequence, so that textures and counts do not depend on the seed
            let t = i as f64 / (VARIANTS - 1) as f64;
            let u = ((i * 5) % VARIANTS) as f64 / (VARIANTS - 1) as f64;
            match leaf.shape {
                LeafShape::NeedleSpray => spray(leaf, coarse, t, u),
                shape => blade(shape, leaf.scale_x, coarse, t, u),
            }
        })
        .collect()
}

/// A flat leaf folded along its midrib and curled along its length.
fn blade(shape: LeafShape, scale_x: f64, coarse: bool, t: f64, u: f64) -> Template {
    let (rows, petiole): (&[Row], f64) = match (shape, coarse) {
        (LeafShape::Cordate, false) => (&CORDATE, 0.26),
        (LeafShape::Cordate, true) => (&CORDATE_COARSE, 0.26),
        (LeafShape::Elliptic, false) => (&ELLIPTIC, 0.08),
        (LeafShape::Elliptic, true) => (&ELLIPTIC_COARSE, 0.08),
        (_, false) => (&OVATE, 0.14),
        (_, true) => (&OVATE_COARSE, 0.14),
    };
    let fold = 0.12 + 0.30 * u;
    let curl = 0.10 + 0.35 * t;
    let sweep = 0.10 * (u - 0.5);
    let bent = |s: f64, w: f64| {
        let x = petiole + (1.0 - petiole) * s;
        // the blade arches: it leaves the petiole rising and its tip hangs
        let arch = curl * (x - x * x * 1.6);
        DVec3::new(x, w + sweep * s * s, arch * 0.6 + fold * w.abs())
    };
    let mut m = Template::empty();
    let flat = |s: f64, w: f64| [(0.5 + w) as f32, (1.0 - s) as f32];
    let thickness = 0.009;
    let left = m.vertex(DVec3::new(0.0, thickness, 0.0), flat(0.02, 0.006));
    let right = m.vertex(DVec3::new(0.0, -thickness, 0.0), flat(0.02, -0.006));
    let base = m.vertex(bent(0.0, 0.0), flat(0.02, 0.0));
    m.triangles.push([left, right, base]);
    let mut before = [base; 3];
    for r in rows {
        let w = r.half_width * scale_x;
        let here = [
            m.vertex(bent(r.edge, w), flat(r.edge.max(0.0), r.half_width)),
            m.vertex(bent(r.mid, 0.0), flat(r.mid, 0.0)),
            m.vertex(bent(r.edge, -w), flat(r.edge.max(0.0), -r.half_width)),
        ];
        if before[0] == before[1] {
            m.triangles
                .extend([[base, here[1], here[0]], [base, here[2], here[1]]]);
        } else {
            m.triangles.extend([
                [before[0], before[1], here[0]],
                [before[1], here[1], here[0]],
                [before[1], before[2], here[1]],
                [before[2], here[2], here[1]],
            ]);
        }
        before = here;
    }
    let tip = m.vertex(bent(1.0, 0.0), flat(1.0, 0.0));
    m.triangles
        .extend([[before[0], before[1], tip], [before[1], before[2], tip]]);
    m.settle()
}

/// Needles along a piece of shoot: left, right and above it, swept towards its tip, all hanging
/// together along the shoot so that the spray is one connected leaf.
fn spray(leaf: &LeafParameters, coarse: bool, t: f64, u: f64) -> Template {
    let pairs = if coarse { 5 } else { 7 };
    let mut m = Template::empty();
    let n = 2 * pairs;
    let axis: Vec<u16> = (0..=n)
        .map(|i| {
            let x = 0.86 * f64::from(i) / f64::from(n);
            let sag = 0.05 * (t - 0.5) * x;
            m.vertex(DVec3::new(x, 0.0, sag), [0.02, (0.3 + 0.4 * x) as f32])
        })
        .collect();
    for i in 0..n {
        let x = 0.86 * (f64::from(i) + 0.5) / f64::from(n);
        // needles turn about the shoot: sides, upper left, upper right
        let side = if i % 2 == 0 { 1.0 } else { -1.0 };
        let raise = [0.12, 0.75, 0.30, 1.05][((i / 2) % 4) as usize] + 0.2 * (u - 0.5);
        let (sine, cosine) = sin_cos(raise);
        let length = 0.34 * leaf.scale_x * (1.0 - 0.35 * x);
        let forward = 0.62 * length;
        let outward = 0.78 * length;
        let tip = DVec3::new(x + forward, side * outward * cosine, outward * sine);
        let tip = m.vertex(tip, [1.0, ((f64::from(i) + 0.5) / f64::from(n)) as f32]);
        let (a, b) = (axis[i as usize], axis[i as usize + 1]);
        m.triangles
            .push(if side > 0.0 { [a, b, tip] } else { [b, a, tip] });
    }
    let end = axis[n as usize];
    let (l, r) = (axis[n as usize - 1], DVec3::new(0.90, -0.02, 0.0));
    let r = m.vertex(r, [0.5, 0.5]);
    let tip = m.vertex(DVec3::new(1.0, 0.0, 0.02 * t), [1.0, 0.5]);
    m.triangles.extend([[l, r, end], [end, r, tip]]);
    m.settle()
}

impl Template {
    fn empty() -> Self {
        Self {
            positions: Vec::new(),
            normals: Vec::new(),
            texcoords: Vec::new(),
            triangles: Vec::new(),
        }
    }

    fn vertex(&mut self, position: DVec3, texcoord: [f32; 2]) -> u16 {
        self.positions.push(position);
        self.texcoords.push(texcoord);
        (self.positions.len() - 1) as u16
    }

    /// Turns and scales the mesh so that its last vertex, the tip, is at (1, 0, 0), and makes the
    /// normals from the faces (area-weighted), towards the upper side.
    fn settle(mut self) -> Self {
        let tip = *self.positions.last().expect("a template has vertices");
        let x = tip.normalize();
        let y = DVec3::Z.cross(x).normalize();
        let z = x.cross(y);
        let scale = 1.0 / tip.length();
        for q in &mut self.positions {
            *q = DVec3::new(q.dot(x), q.dot(y), q.dot(z)) * scale;
        }
        let mut sums = vec![DVec3::ZERO; self.positions.len()];
        for t in &mut self.triangles {
            let [a, b, c] = t.map(|i| self.positions[usize::from(i)]);
            let mut n = (b - a).cross(c - a);
            if n.z < 0.0 {
                t.swap(1, 2);
                n = -n;
            }
            for &i in t.iter() {
                sums[usize::from(i)] += n;
            }
        }
        self.normals = sums.into_iter().map(DVec3::normalize).collect();
        self
    }

    /// Area of the mesh of unit length, m2.
    #[cfg(test)]
    fn area(&self) -> f64 {
        let half = |t: &[u16; 3]| {
            let [a, b, c] = t.map(|i| self.positions[usize::from(i)]);
            0.5 * (b - a).cross(c - a).length()
        };
        self.triangles.iter().map(half).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::super::Species;
    use super::*;

    #[test]
    fn templates_are_sound() {
        for species in Species::ALL {
            for coarse in [false, true] {
                for m in templates(&species.parameters().leaf, coarse) {
                    assert!(
                        (8..=17).contains(&m.triangles.len()),
                        "{}",
                        m.triangles.len()
                    );
                    assert!((m.positions[m.positions.len() - 1] - DVec3::X).length() < 1e-12);
                    assert!(m.area() > 0.02 && m.area() < 1.0, "{species}: {}", m.area());
                    for t in &m.triangles {
                        let [a, b, c] = t.map(|i| m.positions[usize::from(i)]);
                        assert!((b - a).cross(c - a).length() > 1e-4, "{species}: {t:?}");
                        assert!((b - a).cross(c - a).z >= 0.0);
                    }
                    for n in &m.normals {
                        assert!((n.length() - 1.0).abs() < 1e-9);
                    }
                }
            }
        }
    }
}
