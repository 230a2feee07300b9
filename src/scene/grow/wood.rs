//! Stems as generalised cylinders (Weber and Penn 1995, section 5).

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::DVec3;

use super::parameters::Parameters;
use super::portable::sin_cos;
use super::random::Random;
use super::stem::{Skeleton, Stem};
use crate::scene::{Botany, Primitive};

/// Sides of a stem's section by branching order at detail 1.
const SIDES: [f64; 4] = [24.0, 12.0, 6.0, 3.0];

/// Meshes all stems; `keep` tells which ones.
pub(super) fn mesh(
    skeleton: &Skeleton,
    keep: &[bool],
    parameters: &Parameters,
    detail: f64,
    material: usize,
) -> Primitive {
    let mut wood = Wood {
        p: parameters,
        out: Primitive::default(),
        order: Vec::new(),
    };
    wood.out.material = material;
    for (i, stem) in skeleton.stems.iter().enumerate().filter(|&(i, _)| keep[i]) {
        let leafy_twig = stem.order + 1 == parameters.levels;
        let base = SIDES[usize::from(stem.order)];
        let base = if leafy_twig { base.min(4.0) } else { base };
        let sides = (base * detail + 0.5).floor().clamp(3.0, 96.0) as u32;
        wood.stem(stem, sides, i as u64);
    }
    let botany = Botany {
        branch_order: wood.order,
        leaves: Vec::new(),
    };
    wood.out.botany = Some(Arc::new(botany));
    wood.out
}

struct Wood<'a> {
    p: &'a Parameters,
    out: Primitive,
    order: Vec<u8>,
}

impl Wood<'_> {
    fn stem(&mut self, stem: &Stem, sides: u32, index: u64) {
        let tint = self.tint(stem, index);
        let last = stem.points.len() - 1;
        let lobes = if stem.order == 0 && !stem.is_fork {
            self.p.lobes
        } else {
            0
        };
        let mut along = stem.bark_offset;
        let mut before = None;
        for i in 0..last {
            let step = (stem.points[i + 1] - stem.points[i]).length();
            let slope = (stem.radii[i] - stem.radii[i + 1]) / step;
            let depth = if lobes > 0 {
                self.lobe_depth(stem.fractions[i])
            } else {
                0.0
            };
            let ring = self.ring(
                stem,
                i,
                &Section {
                    sides,
                    along,
                    slope,
                    lobes,
                    depth,
                    tint,
                },
            );
            if let Some(before) = before {
                self.join(before, ring, sides);
            } else if stem.parent.is_none() {
                self.floor_cap(stem, ring, sides, tint);
            }
            before = Some(ring);
            // one texture height per texture width keeps the bark's grain square as stems thin
            let around = TAU * (0.5 * (stem.radii[i] + stem.radii[i + 1])).max(0.004);
            along += step * stem.bark_repeats / (2.0 * around);
        }
        self.tip(
            stem,
            before.expect("a stem has two sections"),
            sides,
            along,
            tint,
        );
    }

    /// Depth of the buttresses; they end with the flare.
    fn lobe_depth(&self, fraction: f64) -> f64 {
        let low = (1.0 - 9.0 * fraction).max(0.0);
        self.p.lobe_depth * low * low
    }

    /// Young wood is lighter than old.
    fn tint(&self, stem: &Stem, index: u64) -> [f32; 4] {
        let mut random = Random::new(index).fork(77);
        let age = 1.0 - f64::from(stem.order) / f64::from(self.p.levels);
        let light = 0.70 + 0.16 * age + 0.08 * random.signed();
        let warm = 0.05 * (1.0 - age) + 0.03 * random.signed();
        [
            (light + warm) as f32,
            light as f32,
            (light - warm) as f32,
            1.0,
        ]
    }

    fn ring(&mut self, stem: &Stem, i: usize, section: &Section) -> u32 {
        let first = self.out.positions.len() as u32;
        let frame = &stem.frames[i];
        let lobes = f64::from(section.lobes);
        for k in 0..=section.sides {
            // the seam repeats the first vertex with another texture coordinate
            let angle = TAU * f64::from(k % section.sides) / f64::from(section.sides);
            let radial = frame.radial(angle);
            let (sine, cosine) = sin_cos(lobes * angle);
            let radius = stem.radii[i] * (1.0 + section.depth * sine);
            let mut q = stem.points[i] + radial * radius;
            if stem.parent.is_none() && i == 0 {
                // leaning shrub stems stand on the ground with a level foot
                q.y = 0.0;
            }
            let swing = stem.radii[i] * section.depth * lobes * cosine / radius;
            let round = frame.z.cross(radial);
            let n = radial + frame.z * section.slope - round * swing;
            let u = f64::from(k) / f64::from(section.sides) * stem.bark_repeats;
            self.vertex(q, n, [u, section.along], section.tint, stem.order);
        }
        first
    }

    fn join(&mut self, below: u32, above: u32, sides: u32) {
        for k in 0..sides {
            let (a, b) = (below + k, below + k + 1);
            let (c, d) = (above + k, above + k + 1);
            self.out.indices.extend([a, b, d, a, d, c]);
        }
    }

    /// The last section closes in a point.
    fn tip(&mut self, stem: &Stem, ring: u32, sides: u32, along: f64, tint: [f32; 4]) {
        let last = stem.points.len() - 1;
        let end = stem.points[last] + stem.frames[last].z * stem.radii[last];
        let first = self.out.positions.len() as u32;
        for k in 0..sides {
            let angle = TAU * (f64::from(k) + 0.5) / f64::from(sides);
            let n = stem.frames[last].radial(angle) + stem.frames[last].z * 0.5;
            let u = (f64::from(k) + 0.5) / f64::from(sides) * stem.bark_repeats;
            self.vertex(end, n, [u, along], tint, stem.order);
            self.out.indices.extend([ring + k, ring + k + 1, first + k]);
        }
    }

    /// Closes a trunk at the ground.
    fn floor_cap(&mut self, stem: &Stem, ring: u32, sides: u32, tint: [f32; 4]) {
        let first = self.out.positions.len() as u32;
        let centre = DVec3::new(stem.points[0].x, 0.0, stem.points[0].z);
        for k in 0..sides {
            let q = DVec3::from(self.out.positions[(ring + k) as usize].map(f64::from));
            let u = f64::from(k) / f64::from(sides) * stem.bark_repeats;
            self.vertex(q, -DVec3::Y, [u, stem.bark_offset], tint, stem.order);
        }
        self.vertex(
            centre,
            -DVec3::Y,
            [0.5, stem.bark_offset - 0.2],
            tint,
            stem.order,
        );
        for k in 0..sides {
            let next = first + (k + 1) % sides;
            self.out.indices.extend([first + sides, next, first + k]);
        }
    }

    fn vertex(&mut self, q: DVec3, n: DVec3, uv: [f64; 2], tint: [f32; 4], order: u8) {
        self.out.positions.push(q.as_vec3().to_array());
        self.out.normals.push(n.normalize().as_vec3().to_array());
        self.out.texcoords.push(uv.map(|c| c as f32));
        self.out.colors.push(tint);
        self.order.push(order);
    }
}

/// What all vertices of one ring share.
struct Section {
    sides: u32,
    along: f64,
    slope: f64,
    lobes: u32,
    depth: f64,
    tint: [f32; 4],
}
