//! Object-space coordinates along and round branches, from nothing but their surface (Coconu,
//! Deussen, Hege 2006, section 7, hatch trunks in object space and do not say by what).
//!
//! Axes come from the normals of pieces of the surface as large as needed (`axes`); signs,
//! frames and lengths go along the surface so that nothing leaps on a branch (`along`).

mod along;
mod axes;
pub mod limbs;
pub mod order;
mod surface;

use glam::{DVec3, Vec3};

use surface::{NONE, Surface};

/// Branches, for each vertex that came in; zero where no triangle names it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Branches {
    /// Unit direction of the axis.
    pub axis: Vec<Vec3>,
    /// Radius, metres.
    pub radius: Vec<f32>,
    /// Coordinates of hatching: across the axis in its frame (x, y: the way round is their
    /// angle), metres along it, and the binary logarithm of its girth in metres.
    pub hatch: Vec<[f32; 4]>,
}

impl Branches {
    /// Of the triangles of `indices`.
    #[must_use]
    pub fn new(positions: &[Vec3], indices: &[u32]) -> Self {
        let surface = Surface::new(positions, indices);
        let axes = axes::axes(&surface);
        let ways = along::ways(&surface, &axes);
        let node = |i: usize| {
            let (axis, zero) = (ways.direction[i], ways.zero[i]);
            let radius = axes[i].radius.max(1e-12);
            // On a flat piece the normals are all one: the place across it opens them.
            let open = axes[i].flatness() * (surface.places[i] - axes[i].middle) / radius;
            let out = surface.normals[i] + open;
            let out = if out.is_finite() { out } else { DVec3::ZERO };
            let girth = (std::f64::consts::TAU * radius).log2();
            [
                out.dot(zero) as f32,
                out.dot(axis.cross(zero)) as f32,
                ways.along[i] as f32,
                girth as f32,
            ]
        };
        let nodes: Vec<[f32; 4]> = (0..axes.len()).map(node).collect();
        let mut out = Self {
            axis: vec![Vec3::ZERO; positions.len()],
            radius: vec![0.0; positions.len()],
            hatch: vec![[0.0; 4]; positions.len()],
        };
        for (v, &i) in surface
            .of_vertex
            .iter()
            .enumerate()
            .filter(|v| *v.1 != NONE)
        {
            let i = i as usize;
            out.axis[v] = ways.direction[i].as_vec3();
            out.radius[v] = axes[i].radius as f32;
            out.hatch[v] = nodes[i];
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use glam::{DMat3, EulerRot};

    use super::*;

    /// A tapered tube whose axis is an arc of `bend` radians over its length, turned anyhow; with
    /// the direction of the axis, its arc length and the angle about it at each vertex.
    struct Tube {
        positions: Vec<Vec3>,
        indices: Vec<u32>,
        truth: Vec<(DVec3, f64, f64)>,
    }

    fn tube(sides: u32, rings: u32, [low, high]: [f64; 2], bend: f64) -> Tube {
        let turn = DMat3::from_euler(EulerRot::XYZ, 0.7, -0.4, 1.9);
        let mut tube = Tube {
            positions: Vec::new(),
            indices: Vec::new(),
            truth: Vec::new(),
        };
        for ring in 0..=rings {
            let t = f64::from(ring) / f64::from(rings);
            let angle = (bend * t).max(1e-9 * t);
            let big = 1.0 / bend.max(1e-9);
            let middle = DVec3::new(big * (1.0 - angle.cos()), big * angle.sin(), 0.0);
            let (along, out) = (
                DVec3::new(angle.sin(), angle.cos(), 0.0),
                DVec3::new(angle.cos(), -angle.sin(), 0.0),
            );
            for side in 0..sides {
                let phi = TAU * f64::from(side) / f64::from(sides);
                let radial = phi.cos() * out + phi.sin() * out.cross(along);
                let place = middle + (low + (high - low) * t) * radial;
                tube.positions.push((turn * place).as_vec3());
                tube.truth.push((turn * along, t, phi));
                if ring > 0 {
                    let (a, b) = (
                        (ring - 1) * sides + side,
                        (ring - 1) * sides + (side + 1) % sides,
                    );
                    let quad = [a, b, b + sides, a, b + sides, a + sides];
                    tube.indices.extend(quad);
                }
            }
        }
        tube
    }

    #[test]
    fn axes_of_tubes_and_cones_are_within_five_degrees() {
        for (sides, rings, radii, bend) in [
            (24, 20, [0.1, 0.1], 0.0),
            (8, 40, [0.08, 0.01], 0.0),
            (3, 12, [0.03, 0.02], 0.3),
            (96, 200, [0.1, 0.06], 0.6),
            (6, 4, [0.05, 0.04], 0.0),
        ] {
            let tube = tube(sides, rings, radii, bend);
            let found = Branches::new(&tube.positions, &tube.indices);
            let worst = found.axis.iter().zip(&tube.truth).map(|(axis, truth)| {
                axis.as_dvec3()
                    .dot(truth.0)
                    .abs()
                    .min(1.0)
                    .acos()
                    .to_degrees()
            });
            let worst = worst.fold(0.0, f64::max);
            assert!(
                worst < 5.0,
                "{sides} sides, {rings} rings, bend {bend}: {worst} degrees"
            );
            for (t, r) in tube.truth.iter().zip(&found.radius) {
                let want = radii[0] + (radii[1] - radii[0]) * t.1;
                let ratio = f64::from(*r) / want;
                assert!((0.45..1.6).contains(&ratio), "radius {r} for {want}");
            }
        }
    }

    #[test]
    fn ways_along_and_round_are_those_of_the_tube() {
        let tube = tube(16, 60, [0.05, 0.04], 0.8);
        let found = Branches::new(&tube.positions, &tube.indices);
        let sign = f64::from(found.hatch[16 * 60][2] - found.hatch[0][2]).signum();
        let turn_of = |v: usize| f64::from(found.hatch[v][1]).atan2(f64::from(found.hatch[v][0]));
        let zero = turn_of(16 * 30);
        let off = |a: f64| (a - (a / TAU).round() * TAU).abs();
        let mut worst = [0.0_f64; 2];
        for (v, truth) in tube.truth.iter().enumerate() {
            let along = sign * f64::from(found.hatch[v][2] - found.hatch[0][2]);
            assert!((along - truth.1).abs() < 0.02, "{along} for {}", truth.1);
            // Open ends are seen from one side only.
            if (0.05..0.95).contains(&truth.1) {
                let turn = turn_of(v) - zero;
                worst[0] = worst[0].max(off(turn - truth.2));
                worst[1] = worst[1].max(off(turn + truth.2));
            }
        }
        assert!(worst[0].min(worst[1]) < 0.1, "{worst:?} radians");
    }

    #[test]
    fn degenerate_surfaces_are_finite() {
        let flat: Vec<Vec3> = [(0.0, 0.0), (0.1, 0.0), (0.1, 2.0), (0.0, 2.0)]
            .map(|(x, y)| Vec3::new(x, y, 0.0))
            .to_vec();
        let card = Branches::new(&flat, &[0, 1, 2, 0, 2, 3]);
        assert!(
            card.axis.iter().all(|a| a.dot(Vec3::Y).abs() > 0.99),
            "{:?}",
            card.axis
        );
        let point = Branches::new(&[Vec3::ONE; 3], &[0, 1, 2]);
        let nothing = Branches::new(&[], &[]);
        assert!(nothing.hatch.is_empty(), "nothing");
        for found in [card, point] {
            let all = found.hatch.iter().flatten();
            assert!(all.chain(&found.radius).all(|v| v.is_finite()), "{found:?}");
        }
    }
}
