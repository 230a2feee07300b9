//! Generators of the density field (Luft, Balzer, Deussen 2007, section 3.1).

use std::collections::HashMap;

use glam::DVec3;

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
