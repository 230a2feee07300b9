//! A sitting rabbit: a smooth body without leaves, for what draws such bodies.
//!
//! Distances to ellipsoids and cones with round ends, melted into one another by a smooth minimum,
//! and the surface of their zero by marching cubes (Lorensen, Cline 1987).

use std::collections::HashMap;

use glam::DVec3;

use crate::math::marching_cubes_table::{edge_owner, table};
use crate::scene::{Material, Model, Primitive};

/// Its name on the command line.
pub const RABBIT: &str = "rabbit";
/// Edge of the grid's cells, metres.
const CELL: f64 = 0.006;
/// Lowest corner of the grid, metres.
const LOW: DVec3 = DVec3::new(-0.25, -0.03, -0.18);
/// Nodes of the grid.
const NODES: [usize; 3] = [88, 92, 61];
/// Width over which parts melt, metres.
const MELT: f64 = 0.03;

/// Middle and radii, metres.
const ELLIPSOIDS: [([f64; 3], [f64; 3]); 6] = [
    ([-0.01, 0.135, 0.0], [0.155, 0.120, 0.105]),  // body
    ([0.09, 0.13, 0.0], [0.075, 0.105, 0.078]),    // chest
    ([0.145, 0.275, 0.0], [0.075, 0.064, 0.060]),  // head
    ([0.195, 0.258, 0.0], [0.042, 0.036, 0.036]),  // muzzle
    ([-0.175, 0.115, 0.0], [0.040, 0.042, 0.038]), // tail
    ([0.13, 0.20, 0.0], [0.055, 0.07, 0.052]),     // neck
];

/// Ends and their radii, metres, on one side; mirrored to the other.
const CONES: [([f64; 3], f64, [f64; 3], f64); 5] = [
    ([0.125, 0.325, 0.028], 0.021, [0.075, 0.40, 0.050], 0.029), // ear, lower half
    ([0.075, 0.40, 0.050], 0.029, [0.040, 0.465, 0.062], 0.010), // ear, tip
    ([0.105, 0.10, 0.055], 0.034, [0.135, 0.024, 0.058], 0.026), // foreleg
    ([-0.075, 0.105, 0.075], 0.082, [-0.055, 0.085, 0.080], 0.070), // haunch
    ([-0.085, 0.026, 0.090], 0.028, [0.015, 0.020, 0.098], 0.024), // hind foot
];

/// Distance to an ellipsoid, to first order.
fn ellipsoid(p: DVec3, (middle, radii): ([f64; 3], [f64; 3])) -> f64 {
    let (q, r) = (p - DVec3::from(middle), DVec3::from(radii));
    let (scaled, steep) = ((q / r).length(), (q / (r * r)).length());
    if steep > 0.0 {
        scaled * (scaled - 1.0) / steep
    } else {
        -r.min_element()
    }
}

/// Distance to the hull of two balls: the least to any ball between them. The foot of the
/// perpendicular is not the nearest one's middle where radii change; with it normals leap at both ends.
fn cone(p: DVec3, (a, from, b, to): ([f64; 3], f64, [f64; 3], f64)) -> f64 {
    let (a, b) = (DVec3::from(a), DVec3::from(b));
    let length = (b - a).length();
    let way = (b - a) / length;
    let along = (p - a).dot(way);
    let aside = (p - a - along * way).length();
    // How fast it narrows: the sine of the cone's half angle.
    let sine = (from - to) / length;
    let t = (along - aside * sine / (1.0 - sine * sine).sqrt()).clamp(0.0, length);
    (along - t).hypot(aside) - (from - sine * t)
}

/// The lesser of two, rounded where they are near (polynomial).
fn melted(a: f64, b: f64) -> f64 {
    let h = (MELT - (a - b).abs()).max(0.0) / MELT;
    a.min(b) - 0.25 * h * h * MELT
}

/// Below 0 inside.
fn distance(p: DVec3) -> f64 {
    let mirrored = DVec3::new(p.x, p.y, p.z.abs());
    let round = ELLIPSOIDS.iter().map(|&e| ellipsoid(p, e));
    let limbs = CONES.iter().map(|&c| cone(mirrored, c));
    round.chain(limbs).fold(f64::INFINITY, |sum, d| {
        if sum.is_finite() { melted(sum, d) } else { d }
    })
}

fn node(i: usize) -> [usize; 3] {
    [
        i % NODES[0],
        i / NODES[0] % NODES[1],
        i / (NODES[0] * NODES[1]),
    ]
}

fn index(n: [usize; 3]) -> usize {
    n[0] + NODES[0] * (n[1] + NODES[1] * n[2])
}

fn place(n: [usize; 3]) -> DVec3 {
    LOW + CELL * DVec3::new(n[0] as f64, n[1] as f64, n[2] as f64)
}

/// The rabbit: metres, y up, its feet at about 0, looking along x.
#[must_use]
pub fn rabbit() -> Model {
    let count = NODES.iter().product();
    let values: Vec<f64> = (0..count).map(|i| distance(place(node(i)))).collect();
    let mut body = Primitive::default();
    let mut vertex_of: HashMap<(usize, u8), u32> = HashMap::new();
    for i in 0..count {
        for axis in 0..3 {
            let mut end = node(i);
            end[axis] += 1;
            if end[axis] >= NODES[axis] {
                continue;
            }
            let (low, high) = (values[i], values[index(end)]);
            if (low < 0.0) == (high < 0.0) {
                continue;
            }
            let from = place(node(i));
            let at = from + low / (low - high) * (place(end) - from);
            vertex_of.insert((i, axis as u8), body.positions.len() as u32);
            body.positions.push(at.as_vec3().to_array());
            body.normals.push(normal(at).as_vec3().to_array());
        }
    }
    for i in 0..count {
        let low = node(i);
        if (0..3).any(|a| low[a] + 1 >= NODES[a]) {
            continue;
        }
        let corner = |c: u8| [0, 1, 2].map(|a| low[a] + usize::from(c >> a & 1));
        let inside = |c: &u8| values[index(corner(*c))] < 0.0;
        let case = (0..8_u8).filter(inside).fold(0_u8, |case, c| case | 1 << c);
        for &edge in table().case(case) {
            let (c, axis) = edge_owner(edge);
            body.indices.push(vertex_of[&(index(corner(c)), axis)]);
        }
    }
    let fur = Material {
        name: "fur".into(),
        base_color: [0.62, 0.52, 0.42, 1.0],
        ..Material::default()
    };
    Model::of_mesh(RABBIT, vec![body], vec![fur])
}

fn normal(p: DVec3) -> DVec3 {
    let step = 0.25 * CELL;
    let slope = |axis: DVec3| distance(p + step * axis) - distance(p - step * axis);
    DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z)).normalize_or(DVec3::Y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_do_not_leap_where_cones_go_over_into_balls() {
        for one in CONES {
            let (a, b) = (DVec3::from(one.0), DVec3::from(one.2));
            let x = (b - a).normalize();
            let y = x.any_orthonormal_vector();
            let slope = |p: DVec3| {
                let by = |d: DVec3| (cone(p + 1e-6 * d, one) - cone(p - 1e-6 * d, one)) / 2e-6;
                (by(x), by(y))
            };
            let mut last = None;
            for k in -200..=400 {
                let along = 0.0005 * f64::from(k);
                let p = a + along * x + 1.1 * one.1.max(one.3) * y;
                let (u, v) = slope(p);
                assert!((u.hypot(v) - 1.0).abs() < 1e-6, "a distance: {u} {v}");
                let turn = v.atan2(u);
                let before = last.replace(turn).unwrap_or(turn);
                // Balls turn it by a step over their distance.
                assert!((turn - before).abs() < 0.05, "{along}: {before} to {turn}");
            }
        }
    }

    #[test]
    fn the_rabbit_is_closed_and_faces_outwards() {
        let model = rabbit();
        let body = &model.meshes[0].primitives[0];
        assert!(
            body.positions.len() > 5000,
            "{} vertices",
            body.positions.len()
        );
        let mut edges: HashMap<(u32, u32), i32> = HashMap::new();
        let mut volume = 0.0;
        for t in body.indices.chunks_exact(3) {
            let p = [0, 1, 2].map(|k| glam::Vec3::from(body.positions[t[k] as usize]).as_dvec3());
            volume += p[0].cross(p[1]).dot(p[2]) / 6.0;
            for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                *edges.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
            }
        }
        assert!(edges.values().all(|&n| n == 0), "every edge has two sides");
        assert!(
            (0.010..0.020).contains(&volume),
            "litres: {}",
            1000.0 * volume
        );
        let low = body.positions.iter().map(|p| p[1]).fold(1.0, f32::min);
        assert!(low.abs() < 0.02, "stands at {low}");
    }
}
