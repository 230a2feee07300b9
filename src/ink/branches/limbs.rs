//! Branches as axes with radii, from the tubes of their surface.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::order::{Tube, tubes};
use super::surface::{NONE, Surface};

/// Radius of what is no tube, metres: no branch is so thick.
pub const UNKNOWN: f32 = 1e9;

/// Sections and vertices of a branch at least, and its length in radii; of shorter ones the axis is not
/// known.
const LEAST: (usize, usize, f64) = (3, 12, 8.0);
/// Halves of one ring are nearer than so many radii.
const HALVES: f64 = 2.2;
/// Share of the radius by which an axis is moved at most when it is smoothed.
const WITHIN: f64 = 0.4;
/// Rounds in which it is.
const SMOOTH: usize = 4;

/// One branch, from its foot to its tip.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Limb {
    /// Places on its axis, metres.
    pub middles: Vec<DVec3>,
    /// Radius at each of them, metres.
    pub radii: Vec<f64>,
}

/// The branches of a surface.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Limbs {
    /// Those that are tubes.
    pub limbs: Vec<Limb>,
    /// Radius of the branch at each vertex that came in, metres; [`UNKNOWN`] where it is no tube's.
    pub radius: Vec<f32>,
}

/// Where an axis is nearest to a place.
struct Near {
    /// Between this of its points and the next.
    section: usize,
    /// How far on the way there, 0 to 1.
    share: f64,
    /// Square of the distance.
    away: f64,
}

impl Near {
    /// Of an axis of two points or more.
    fn new(middles: &[DVec3], p: DVec3) -> Self {
        let mut best = Self {
            section: 0,
            share: 0.0,
            away: f64::INFINITY,
        };
        for (section, m) in middles.windows(2).enumerate() {
            let way = m[1] - m[0];
            let share = (p - m[0]).dot(way) / way.length_squared().max(f64::MIN_POSITIVE);
            let share = share.clamp(0.0, 1.0);
            let away = p.distance_squared(m[0] + share * way);
            if away < best.away {
                best = Self {
                    section,
                    share,
                    away,
                };
            }
        }
        best
    }
}

/// Whether a tube is so long that its sections tell its axis.
fn is_long(tube: &Tube) -> bool {
    let all: Vec<(DVec3, f64, f64)> = tube.axis().collect();
    let length: f64 = all.windows(2).map(|s| s[0].0.distance(s[1].0)).sum();
    let thickest = all.iter().map(|s| s.1).fold(0.0, f64::max);
    all.len() >= LEAST.0 && tube.nodes.len() >= LEAST.1 && length >= LEAST.2 * thickest
}

/// Middles and radii of a tube's sections. Those nearer to each other than rings can be are two halves
/// of one.
fn rings(tube: &Tube) -> (Vec<DVec3>, Vec<f64>) {
    let mut out: Vec<(DVec3, f64, f64)> = Vec::new();
    for (middle, radius, count) in tube.axis() {
        match out.last_mut() {
            Some(last) if last.0.distance(middle) < HALVES * last.1.max(radius) => {
                let whole = last.2 + count;
                let both = (last.2 * last.0 + count * middle) / whole;
                *last = (both, last.1.max(radius), whole);
            }
            _ => out.push((middle, radius, count)),
        }
    }
    out.into_iter().map(|r| (r.0, r.1)).unzip()
}

/// Radii as the mean distance of the `nodes` about each point of an axis; branches grow thinner all the
/// way.
fn measure(middles: &[DVec3], radii: &mut [f64], nodes: &[DVec3]) {
    let count = middles.len();
    if count < 2 {
        return;
    }
    let mut sums = vec![(0.0, 0.0); count];
    for &p in nodes {
        let near = Near::new(middles, p);
        let sum = &mut sums[near.section + usize::from(near.share > 0.5)];
        *sum = (sum.0 + near.away.sqrt(), sum.1 + 1.0);
    }
    // Ends have caps.
    for k in 1..count - 1 {
        if sums[k].1 > 2.0 {
            radii[k] = sums[k].0 / sums[k].1;
        }
    }
    for k in 1..count {
        radii[k] = radii[k].min(radii[k - 1]);
    }
}

/// Ends hold half a ring: the axis goes on straight to them.
fn straighten_ends(middles: &mut [DVec3], radii: &[f64]) {
    let count = middles.len();
    if count < 3 {
        return;
    }
    for (end, next, after) in [(0, 1, 2), (count - 1, count - 2, count - 3)] {
        let way = (middles[next] - middles[after]).normalize_or_zero();
        let on = middles[next] + (middles[end] - middles[next]).dot(way) * way;
        middles[end] += (on - middles[end]).clamp_length_max(radii[end]);
    }
}

/// The branches of the triangles of `indices`: every connected tube is one.
#[must_use]
pub fn limbs(positions: &[Vec3], indices: &[u32]) -> Limbs {
    let surface = Surface::new(positions, indices);
    let tubes = tubes(&surface);
    let found: Vec<(Limb, Vec<(u32, f32)>)> = tubes
        .par_iter()
        .filter(|t| t.is_narrow() && is_long(t))
        .map(|t| limb(t, &surface))
        .collect();
    let mut of_node = vec![UNKNOWN; surface.places.len()];
    for &(node, radius) in found.iter().flat_map(|f| &f.1) {
        of_node[node as usize] = radius;
    }
    let of_vertex = |&node: &u32| match node {
        NONE => UNKNOWN,
        _ => of_node[node as usize],
    };
    Limbs {
        radius: surface.of_vertex.iter().map(of_vertex).collect(),
        limbs: found.into_iter().map(|f| f.0).collect(),
    }
}

/// A tube's axis, and the radius at its nodes.
fn limb(tube: &Tube, surface: &Surface) -> (Limb, Vec<(u32, f32)>) {
    let place = |&n: &u32| surface.places[n as usize];
    let (mut middles, mut radii) = rings(tube);
    // Sections that hold no whole rings have their middles beside the axis, but within the branch.
    let found = middles.clone();
    for _ in 0..SMOOTH {
        for i in 1..middles.len().max(2) - 1 {
            let mean = 0.25 * (middles[i - 1] + 2.0 * middles[i] + middles[i + 1]);
            middles[i] = found[i] + (mean - found[i]).clamp_length_max(WITHIN * radii[i]);
        }
    }
    straighten_ends(&mut middles, &radii);
    let nodes: Vec<DVec3> = tube.nodes.iter().map(place).collect();
    measure(&middles, &mut radii, &nodes);
    let of_node = |n: &u32| {
        let near = Near::new(&middles, place(n));
        let [a, b] = [radii[near.section], radii[near.section + 1]];
        (*n, (a + near.share * (b - a)) as f32)
    };
    let of_nodes = if middles.len() > 1 {
        tube.nodes.iter().map(of_node).collect()
    } else {
        tube.nodes.iter().map(|n| (*n, radii[0] as f32)).collect()
    };
    // The last section's middle lies before the tip.
    if let [.., before, last] = middles[..] {
        let way = (last - before).normalize_or_zero();
        let beyond = |n: &u32| (place(n) - last).dot(way);
        let near = 4.0 * last.distance(before);
        let ends = tube.nodes.iter().filter(|n| place(n).distance(last) < near);
        let most = ends.map(beyond).fold(0.0, f64::max);
        if most > 1e-3 * last.distance(before) {
            middles.push(last + most * way);
            radii.push(radii[radii.len() - 1]);
        }
    }
    (Limb { middles, radii }, of_nodes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tube_is_one_limb_with_its_axis_and_its_radius() {
        let (mut positions, mut indices) = (Vec::new(), Vec::new());
        for ring in 0..40_u32 {
            let radius = 0.1 - 0.002 * ring as f32;
            for side in 0..8_u32 {
                let (sin, cos) = (std::f32::consts::FRAC_PI_4 * side as f32).sin_cos();
                positions.push(Vec3::new(
                    3.0 + radius * cos,
                    0.05 * ring as f32,
                    radius * sin,
                ));
                if ring > 0 {
                    let (a, b) = ((ring - 1) * 8 + side, (ring - 1) * 8 + (side + 1) % 8);
                    indices.extend([a, b, b + 8, a, b + 8, a + 8]);
                }
            }
        }
        let found = limbs(&positions, &indices);
        assert_eq!(found.limbs.len(), 1);
        let limb = &found.limbs[0];
        for (p, r) in limb.middles.iter().zip(&limb.radii) {
            assert!((p.x - 3.0).hypot(p.z) < 0.03, "{p}");
            assert!((r - (0.1 - 0.04 * p.y)).abs() < 0.02, "{r} at {p}");
        }
        let tip = limb.middles[limb.middles.len() - 1];
        assert!((tip.y - 1.95).abs() < 0.02, "{tip}");
        for (p, r) in positions.iter().zip(&found.radius) {
            assert!((r - (0.1 - 0.04 * p.y)).abs() < 0.02, "{r} at {p}");
        }
        assert_eq!(limbs(&[], &[]), Limbs::default());
    }
}
