//! Generators of the density field (Luft, Balzer, Deussen 2007, section 3.1).

use std::collections::HashMap;

use glam::DVec3;

use crate::math::sampling;

/// One generator `p_i` of the field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Generator {
    /// Centre of mass.
    pub position: DVec3,
    /// Weight `w_i`: how many primitives it stands for (1 without a subset).
    pub weight: f64,
    /// One-sided area of those primitives, in squared units of `position`.
    pub area: f64,
}

/// What makes one generator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// A connected component of the mesh; triangles are joined by equal positions.
    Leaf,
    /// Each triangle.
    Triangle,
}

/// How a fraction of the generators is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subset {
    /// Those of one voxel are merged to their mean, weights added up. Its expected number of
    /// generators is the fraction.
    Stratified,
    /// Every generator is kept with equal probability, and its weight divided by the fraction.
    Plain,
}

/// Generators of an indexed triangle mesh, in the order of their first triangle.
///
/// # Errors
/// The index of the first vertex whose position is not finite.
pub fn generators(
    positions: &[[f32; 3]],
    indices: &[u32],
    source: Source,
) -> Result<Vec<Generator>, usize> {
    if let Some(bad) = positions
        .iter()
        .position(|p| p.iter().any(|c| !c.is_finite()))
    {
        return Err(bad);
    }
    let labels = match source {
        Source::Leaf => leaf_labels(positions, indices),
        Source::Triangle => (0..indices.len() / 3).collect(),
    };
    Ok(centres_of_mass(positions, indices, &labels))
}

/// Component number of every triangle, components numbered by their first triangle.
#[must_use]
pub fn leaf_labels(positions: &[[f32; 3]], indices: &[u32]) -> Vec<usize> {
    let mut parent: Vec<usize> = (0..indices.len() / 3).collect();
    let mut owner: HashMap<[u32; 3], usize> = HashMap::new();
    for (triangle, corners) in indices.chunks_exact(3).enumerate() {
        for &corner in corners {
            // Adding zero turns -0 into +0, so that both have the same bits.
            let key = positions[corner as usize].map(|c| (c + 0.0).to_bits());
            let other = *owner.entry(key).or_insert(triangle);
            let (a, b) = (root(&mut parent, triangle), root(&mut parent, other));
            parent[a.max(b)] = a.min(b);
        }
    }
    let mut number = HashMap::new();
    (0..parent.len())
        .map(|triangle| {
            let root = root(&mut parent, triangle);
            let next = number.len();
            *number.entry(root).or_insert(next)
        })
        .collect()
}

fn root(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
}

/// Area-weighted mean of each component; the mean of its corners where the area is zero.
fn centres_of_mass(positions: &[[f32; 3]], indices: &[u32], labels: &[usize]) -> Vec<Generator> {
    #[derive(Clone, Copy, Default)]
    struct Sum {
        moment: DVec3,
        area: f64,
        corners: DVec3,
        corner_count: f64,
    }
    let count = labels.iter().max().map_or(0, |&m| m + 1);
    let mut sums = vec![Sum::default(); count];
    for (corners, &label) in indices.chunks_exact(3).zip(labels) {
        let [a, b, c] = [corners[0], corners[1], corners[2]].map(|i| widen(positions[i as usize]));
        let area = 0.5 * (b - a).cross(c - a).length();
        let sum = &mut sums[label];
        sum.moment += area * (a + b + c) / 3.0;
        sum.area += area;
        sum.corners += a + b + c;
        sum.corner_count += 3.0;
    }
    sums.iter()
        .map(|s| Generator {
            position: if s.area > 0.0 {
                s.moment / s.area
            } else {
                s.corners / s.corner_count
            },
            weight: 1.0,
            area: s.area,
        })
        .collect()
}

/// A subset of about `fraction` of the generators (0 < fraction <= 1), never empty.
#[must_use]
pub fn subset(all: &[Generator], fraction: f64, method: Subset, seed: u32) -> Vec<Generator> {
    if fraction >= 1.0 || all.len() < 2 {
        return all.to_vec();
    }
    match method {
        Subset::Stratified => stratified_subset(all, fraction, seed),
        Subset::Plain => plain_subset(all, fraction, seed),
    }
}

fn plain_subset(all: &[Generator], fraction: f64, seed: u32) -> Vec<Generator> {
    let number = |i: usize| sampling::uniform(seed, i as u32);
    let mut kept: Vec<usize> = (0..all.len()).filter(|&i| number(i) < fraction).collect();
    if kept.is_empty() {
        kept.extend((0..all.len()).min_by(|&a, &b| number(a).total_cmp(&number(b))));
    }
    kept.iter()
        .map(|&i| Generator {
            weight: all[i].weight / fraction,
            area: all[i].area / fraction,
            ..all[i]
        })
        .collect()
}

/// Voxels of the size that leaves at most `fraction` of the generators, by bisection.
fn stratified_subset(all: &[Generator], fraction: f64, seed: u32) -> Vec<Generator> {
    let target = ((fraction * all.len() as f64).round() as usize).max(1);
    let (min, max) = bounds(all);
    let extent = (max - min).max_element();
    if extent == 0.0 {
        return merge_voxels(all, |_| [0; 3]);
    }
    let shift = 0.5 * DVec3::from([0, 1, 2].map(|axis| sampling::uniform(seed, axis)));
    let voxel = |cell: f64| {
        move |g: &Generator| {
            ((g.position - min) / cell + shift)
                .to_array()
                .map(|c| c as i64)
        }
    };
    // `coarse` begins as one voxel around everything and always satisfies the target.
    let (mut fine, mut coarse) = (extent / 4096.0, 2.0 * extent);
    for _ in 0..32 {
        let middle = (fine * coarse).sqrt();
        if merge_voxels(all, voxel(middle)).len() > target {
            fine = middle;
        } else {
            coarse = middle;
        }
    }
    merge_voxels(all, voxel(coarse))
}

/// Weighted means per voxel, in the order of each voxel's first generator.
fn merge_voxels(all: &[Generator], voxel: impl Fn(&Generator) -> [i64; 3]) -> Vec<Generator> {
    let mut slot = HashMap::new();
    let mut merged: Vec<Generator> = Vec::new();
    for g in all {
        let k = *slot.entry(voxel(g)).or_insert(merged.len());
        if k == merged.len() {
            merged.push(Generator {
                position: DVec3::ZERO,
                weight: 0.0,
                area: 0.0,
            });
        }
        merged[k].position += g.weight * g.position;
        merged[k].weight += g.weight;
        merged[k].area += g.area;
    }
    for g in &mut merged {
        g.position /= g.weight;
    }
    merged
}

/// Smallest and largest corner.
#[must_use]
pub fn bounds(all: &[Generator]) -> (DVec3, DVec3) {
    all.iter()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), g| {
            (lo.min(g.position), hi.max(g.position))
        })
}

/// f32 triple to f64.
#[must_use]
pub fn widen(p: [f32; 3]) -> DVec3 {
    DVec3::from(p.map(f64::from))
}
