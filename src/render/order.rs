//! Triangles sorted front to back, leaf by leaf.
//!
//! Alpha-tested leaves hide each other: drawn from the nearest on, most fragments of a dense crown
//! fail the depth test before their texture is read.

use std::ops::Range;

use glam::Vec3;

/// Triangles of one cluster at most.
const CLUSTER_TRIANGLES: usize = 32;

/// A run of triangles that stay together when drawn: neighbours in the index list that share
/// vertices (a leaf, a piece of a branch).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cluster {
    /// Range of the index list.
    pub indices: Range<u32>,
}

/// Cuts ranges of an index list into clusters.
#[must_use]
pub fn clusters(indices: &[u32], ranges: &[Range<usize>]) -> Vec<Cluster> {
    let as_u32 = |i: usize| u32::try_from(i).expect("fewer than 2^32 indices");
    let mut out = Vec::new();
    for range in ranges {
        let mut start = range.start;
        for at in (range.start..range.end).step_by(3) {
            let triangle = &indices[at..at + 3];
            let previous = &indices[at.saturating_sub(3)..at];
            let joined = at > start
                && at - start < 3 * CLUSTER_TRIANGLES
                && triangle.iter().any(|i| previous.contains(i));
            if !joined && at > start {
                out.push(Cluster {
                    indices: as_u32(start)..as_u32(at),
                });
                start = at;
            }
        }
        if range.end > start {
            out.push(Cluster {
                indices: as_u32(start)..as_u32(range.end),
            });
        }
    }
    out
}

/// Every triangle of an index range as a cluster of its own.
#[must_use]
pub fn triangles(range: Range<usize>) -> Vec<Cluster> {
    let as_u32 = |i: usize| u32::try_from(i).expect("fewer than 2^32 indices");
    range
        .step_by(3)
        .map(|i| Cluster {
            indices: as_u32(i)..as_u32(i + 3),
        })
        .collect()
}

/// Appends the indices of `clusters` to `out`, ordered by the distance of their first triangle's
/// middle along `direction`; equal distances keep their order.
pub fn append_sorted(
    out: &mut Vec<u32>,
    clusters: &[Cluster],
    indices: &[u32],
    positions: &[Vec3],
    direction: Vec3,
) {
    let mut keys: Vec<(u32, u32)> = (0u32..)
        .zip(clusters)
        .map(|(i, c)| {
            let first = c.indices.start as usize;
            let sum: Vec3 = indices[first..first + 3]
                .iter()
                .map(|&v| positions[v as usize])
                .sum();
            (ordered(direction.dot(sum)), i)
        })
        .collect();
    keys.sort_unstable();
    for (_, i) in keys {
        let range = &clusters[i as usize].indices;
        out.extend_from_slice(&indices[range.start as usize..range.end as usize]);
    }
}

/// Bits whose unsigned order is the order of the numbers.
fn ordered(v: f32) -> u32 {
    let bits = v.to_bits();
    if bits >> 31 == 0 {
        bits | (1 << 31)
    } else {
        !bits
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_of_bits_is_order_of_numbers() {
        let v = [
            f32::NEG_INFINITY,
            -2.5,
            -1e-30,
            0.0,
            1e-30,
            3.0,
            f32::INFINITY,
        ];
        for w in v.windows(2) {
            assert!(ordered(w[0]) < ordered(w[1]), "{w:?}");
        }
    }

    #[test]
    #[expect(clippy::single_range_in_vec_init, reason = "one range is meant")]
    fn leaves_stay_whole_and_come_nearest_first() {
        // Three cards of two triangles at depths 2, 0, 1.
        let mut positions = Vec::new();
        let mut indices = Vec::new();
        for (i, z) in [2.0, 0.0, 1.0].into_iter().enumerate() {
            let corners = [(0., 0.), (1., 0.), (0., 1.), (1., 1.)];
            positions.extend(corners.map(|(x, y)| Vec3::new(x, y, z)));
            indices.extend([0, 1, 2, 2, 1, 3].map(|k| k + 4 * i as u32));
        }
        let c = clusters(&indices, &[0..18]);
        assert_eq!(c.len(), 3);
        let mut out = Vec::new();
        append_sorted(&mut out, &c, &indices, &positions, Vec3::Z);
        let firsts: Vec<u32> = out.chunks(6).map(|c| c[0]).collect();
        assert_eq!(firsts, [4, 8, 0]);
        let mut sorted = out.clone();
        sorted.sort_unstable();
        let mut all = indices.clone();
        all.sort_unstable();
        assert_eq!(sorted, all, "no index is lost");
    }

    #[test]
    #[expect(clippy::single_range_in_vec_init, reason = "one range is meant")]
    fn long_strips_are_cut() {
        let indices: Vec<u32> = (0..300).flat_map(|i| [i, i + 1, i + 2]).collect();
        let c = clusters(&indices, &[0..indices.len()]);
        assert!(c.len() >= 300 / CLUSTER_TRIANGLES);
        assert!(c.iter().all(|c| c.indices.len() <= 3 * CLUSTER_TRIANGLES));
        assert!(clusters(&[], &[]).is_empty());
    }
}
