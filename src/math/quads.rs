//! Triangles in pairs: two that share an edge are four corners to fetch instead of six, and one
//! object of a hierarchy instead of two.

use glam::Vec3;

use super::sah::Bounds;

/// One or two triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Quad {
    /// Vertices a, b, c, d of the triangles abc and dbc, in no winding order; of a triangle
    /// alone c and d are the same, so that the second has no area.
    pub corners: [u32; 4],
    /// Numbers of the triangles.
    pub triangles: [u32; 2],
}

impl Quad {
    /// Its box.
    #[must_use]
    pub fn bounds(&self, positions: &[Vec3]) -> Bounds {
        Bounds::of(&self.corners.map(|i| positions[i as usize]))
    }
}

/// Pairs the triangles of `indices` where the box of two is cheaper than two boxes. Vertices of
/// equal `key` count as one; triangles of different `group` are never paired. Triangles with two
/// equal corners are left out, as are copies of a triangle of the same group: of copies the one
/// of the lowest number remains.
pub fn pair<K: Ord + Copy>(
    positions: &[Vec3],
    indices: &[u32],
    key: impl Fn(u32) -> K,
    group: impl Fn(u32) -> u32,
) -> Vec<Quad> {
    let corners = |t: u32| [0, 1, 2].map(|k| indices[3 * t as usize + k]);
    let kept = distinct(indices.len() / 3, |t| {
        let mut keys = corners(t).map(&key);
        keys.sort_unstable();
        (keys, group(t))
    });
    let mut edges: Vec<_> = kept
        .iter()
        .flat_map(|&t| [0, 1, 2].map(|k| (t, k)))
        .map(|(t, k)| {
            let (a, b) = (key(corners(t)[k]), key(corners(t)[(k + 1) % 3]));
            ((a.min(b), a.max(b), group(t)), t, k)
        })
        .collect();
    edges.sort_unstable();
    let bounds = |t: u32| Bounds::of(&corners(t).map(|i| positions[i as usize]));
    let mut pairs = Vec::new();
    for shared in edges.chunk_by(|a, b| a.0 == b.0) {
        for neighbours in shared.windows(2) {
            let [(_, t, k), (_, s, l)] = [neighbours[0], neighbours[1]];
            let (x, y) = (bounds(t), bounds(s));
            let worth = x.join(y).half_area() / (x.half_area() + y.half_area());
            if t != s && worth <= 1.0 {
                pairs.push((worth, t, k, s, l));
            }
        }
    }
    pairs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.3).cmp(&(b.1, b.3))));
    let mut alone = vec![false; indices.len() / 3];
    for &t in &kept {
        alone[t as usize] = true;
    }
    let mut out = Vec::with_capacity(kept.len());
    for (_, t, k, s, l) in pairs {
        if alone[t as usize] && alone[s as usize] {
            (alone[t as usize], alone[s as usize]) = (false, false);
            let c = corners(t);
            out.push(Quad {
                corners: [
                    c[(k + 2) % 3],
                    c[k],
                    c[(k + 1) % 3],
                    corners(s)[(l + 2) % 3],
                ],
                triangles: [t, s],
            });
        }
    }
    out.extend(kept.iter().filter(|&&t| alone[t as usize]).map(|&t| {
        let [a, b, c] = corners(t);
        Quad {
            corners: [a, b, c, c],
            triangles: [t, t],
        }
    }));
    out
}

/// Numbers below `count` of the triangles with three different corners, the first of equal ones.
fn distinct<K: Ord + Copy>(count: usize, key: impl Fn(u32) -> ([K; 3], u32)) -> Vec<u32> {
    let mut all: Vec<_> = (0..count as u32).map(|t| (key(t), t)).collect();
    all.retain(|(([a, b, c], _), _)| a != b && b != c);
    all.sort_unstable();
    all.dedup_by_key(|(key, _)| *key);
    let mut kept: Vec<u32> = all.into_iter().map(|(_, t)| t).collect();
    kept.sort_unstable();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sampling::uniform;

    fn pairs(positions: &[Vec3], indices: &[u32]) -> Vec<Quad> {
        let key = |i: u32| positions[i as usize].to_array().map(f32::to_bits);
        pair(positions, indices, key, |_| 0)
    }

    /// A pair holds the corners of its triangles, and every triangle is in one pair.
    fn check(positions: &[Vec3], indices: &[u32], quads: &[Quad], expected: &[u32]) {
        let sorted = |corners: [u32; 3]| {
            let mut at = corners.map(|i| positions[i as usize].to_array().map(f32::to_bits));
            at.sort_unstable();
            at
        };
        let mut found = Vec::new();
        for quad in quads {
            let [a, b, c, d] = quad.corners;
            let [first, second] = quad.triangles;
            let corners = |t: u32| [0, 1, 2].map(|k| indices[3 * t as usize + k]);
            assert_eq!(sorted([a, b, c]), sorted(corners(first)));
            found.push(first);
            if second == first {
                assert_eq!(c, d);
            } else {
                assert_eq!(sorted([d, b, c]), sorted(corners(second)));
                found.push(second);
            }
        }
        found.sort_unstable();
        assert_eq!(found, expected);
    }

    #[test]
    fn cards_become_one_pair_each() {
        let random = |i: u32| Vec3::from([0, 1, 2].map(|k| uniform(5, 3 * i + k) as f32));
        let mut positions = Vec::new();
        let mut indices = Vec::new();
        for card in 0..50 {
            let (at, u, v) = (random(3 * card), random(3 * card + 1), random(3 * card + 2));
            let first = positions.len() as u32;
            positions.extend([at, at + 0.1 * u, at + 0.1 * (u + v), at + 0.1 * v]);
            indices.extend([0, 1, 2, 0, 2, 3].map(|k| first + k));
        }
        let quads = pairs(&positions, &indices);
        assert_eq!(quads.len(), 50);
        check(&positions, &indices, &quads, &(0..100).collect::<Vec<_>>());
    }

    #[test]
    fn copies_and_triangles_without_area_are_left_out() {
        let positions = [
            Vec3::ZERO,
            Vec3::X,
            Vec3::Y,
            Vec3::X,
            Vec3::new(1.0, 1.0, 0.1),
        ];
        // The third is the first turned over, with another vertex in the same place.
        let indices = [1, 1, 2, 0, 1, 2, 2, 3, 0, 2, 3, 4];
        let quads = pairs(&positions, &indices);
        assert_eq!(quads.len(), 1);
        check(&positions, &indices, &quads, &[1, 3]);
        assert!(pairs(&positions, &[]).is_empty());
    }
}
