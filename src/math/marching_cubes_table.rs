//! The case table of marching cubes, derived from the cube's edges and one face rule.
//!
//! Lorensen and Cline 1987, Marching Cubes. The original table leaves cracks where neighbouring
//! cubes resolve an ambiguous face (inside corners on a diagonal) differently. Here the polygons
//! of a cube follow from its six faces alone: on every face the inside corners of a diagonal are
//! cut off separately. The rule looks at the face's four signs only, so the two cubes that share
//! a face always draw the same segments on it, and the surface is closed.
//!
//! Numbering, shared with the shaders:
//! * corner `i` of a cube has the offsets `(i & 1, i >> 1 & 1, i >> 2 & 1)`;
//! * a case is the bit set of inside corners (value above the threshold);
//! * edge `e = 4 * axis + k` runs along `axis` from its lower corner, `k` counts the four lower
//!   corners in ascending order ([`edge_owner`]). A surface vertex thus belongs to a grid node
//!   (the lower one of its edge) and an axis, and is never stored twice.

use std::sync::LazyLock;

/// Edges of a cube.
pub const EDGES: usize = 12;

/// Cases: one per set of inside corners.
pub const CASES: usize = 256;

/// Most triangles that one cube can hold (a test checks that it is reached and not exceeded).
pub const MAX_TRIANGLES: usize = 5;

/// Corners of each face, counter-clockwise as seen from outside the cube.
const FACES: [[u8; 4]; 6] = [
    [0, 4, 6, 2], // x = 0
    [1, 3, 7, 5], // x = 1
    [0, 1, 5, 4], // y = 0
    [2, 6, 7, 3], // y = 1
    [0, 2, 3, 1], // z = 0
    [4, 5, 7, 6], // z = 1
];

/// Triangles of every case.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CaseTable {
    /// First index into `edges` per case; entry 256 closes the last case. Multiples of 3.
    pub offsets: [u32; CASES + 1],
    /// Three edge numbers per triangle, counter-clockwise as seen from the outside (the side of
    /// lower values).
    pub edges: Vec<u8>,
}

impl CaseTable {
    /// Edge numbers of a case, three per triangle.
    #[must_use]
    pub fn case(&self, case: u8) -> &[u8] {
        let case = usize::from(case);
        &self.edges[self.offsets[case] as usize..self.offsets[case + 1] as usize]
    }

    /// Triangles of a case.
    #[must_use]
    pub fn triangle_count(&self, case: u8) -> u32 {
        let case = usize::from(case);
        (self.offsets[case + 1] - self.offsets[case]) / 3
    }

    /// The form for storage buffers: the 257 offsets, then one edge number per word, so that
    /// case `c` reads words `257 + offsets[c] .. 257 + offsets[c + 1]`.
    #[must_use]
    pub fn words(&self) -> Vec<u32> {
        self.offsets
            .iter()
            .copied()
            .chain(self.edges.iter().map(|&e| u32::from(e)))
            .collect()
    }
}

/// Lower corner and axis of an edge: the vertex on it belongs to that corner's grid node.
#[must_use]
pub const fn edge_owner(edge: u8) -> (u8, u8) {
    let axis = edge / 4;
    let k = edge % 4;
    // Spread k's two bits over the two other axes.
    let corner = match axis {
        0 => k << 1,
        1 => (k & 1) | (k & 2) << 1,
        _ => k,
    };
    (corner, axis)
}

/// The edge between two neighbouring corners.
fn edge_between(a: u8, b: u8) -> u8 {
    let axis = match a ^ b {
        1 => 0u8,
        2 => 1,
        4 => 2,
        _ => panic!("corners {a} and {b} share no edge"),
    };
    let lower = a & b;
    let k = match axis {
        0 => lower >> 1,
        1 => (lower & 1) | (lower >> 1 & 2),
        _ => lower,
    };
    4 * axis + k
}

/// The table, derived once.
#[must_use]
pub fn table() -> &'static CaseTable {
    static TABLE: LazyLock<CaseTable> = LazyLock::new(derive);
    &TABLE
}

fn derive() -> CaseTable {
    let mut offsets = [0; CASES + 1];
    let mut edges = Vec::new();
    for case in 0..CASES {
        let inside = u8::try_from(case).expect("256 cases");
        for polygon in polygons(inside) {
            for triangle in triangulate(&polygon, inside) {
                edges.extend(triangle);
            }
        }
        offsets[case + 1] = u32::try_from(edges.len()).expect("a few thousand");
    }
    CaseTable { offsets, edges }
}

/// Closed polygons of a case: every face adds one directed segment per run of inside corners.
fn polygons(inside: u8) -> Vec<Vec<u8>> {
    let is_inside = |corner: u8| inside >> corner & 1 == 1;
    let mut next = [None; EDGES];
    for face in FACES {
        for start in 0..4 {
            let corner = |step: usize| face[(start + step) % 4];
            // A run starts behind an outside corner; with the diagonal inside, each run has one
            // corner, which is the face rule.
            if is_inside(corner(3)) || !is_inside(corner(0)) {
                continue;
            }
            let length = (1..4)
                .find(|&step| !is_inside(corner(step)))
                .expect("corner 3 is outside");
            let enter = edge_between(corner(3), corner(0));
            let leave = edge_between(corner(length - 1), corner(length));
            next[usize::from(enter)] = Some(leave);
        }
    }
    let mut out = Vec::new();
    for start in 0..EDGES {
        let mut polygon = Vec::new();
        let mut edge = start;
        while let Some(following) = next[edge].take() {
            polygon.push(u8::try_from(edge).expect("12 edges"));
            edge = usize::from(following);
        }
        if !polygon.is_empty() {
            out.push(polygon);
        }
    }
    out
}

/// Cuts a polygon into triangles with no diagonal inside a face of the cube: there the neighbour
/// could draw the same diagonal, and four triangles would meet in it.
fn triangulate(polygon: &[u8], inside: u8) -> Vec<[u8; 3]> {
    let n = polygon.len();
    let fan = |apex: usize| -> Vec<[u8; 3]> {
        (1..n - 1)
            .map(|i| [apex, apex + i, apex + i + 1].map(|k| polygon[k % n]))
            .collect()
    };
    (0..n)
        .find(|&apex| (2..n - 1).all(|i| !on_one_face(polygon[apex], polygon[(apex + i) % n])))
        .map(fan)
        .unwrap_or_else(|| panic!("case {inside}: no fan of {polygon:?} avoids the faces"))
}

fn on_one_face(a: u8, b: u8) -> bool {
    let on =
        |edge: u8, face: &[u8; 4]| (0..4).any(|i| edge_between(face[i], face[(i + 1) % 4]) == edge);
    FACES.iter().any(|face| on(a, face) && on(b, face))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    fn midpoint(edge: u8) -> [f64; 3] {
        let (corner, axis) = edge_owner(edge);
        let mut q = [0, 1, 2].map(|a| f64::from(corner >> a & 1));
        q[usize::from(axis)] = 0.5;
        q
    }

    #[test]
    fn edges_and_owners_agree() {
        for edge in 0..12 {
            let (corner, axis) = edge_owner(edge);
            assert_eq!(corner >> axis & 1, 0, "edge {edge} starts at its lower end");
            assert_eq!(edge_between(corner, corner | 1 << axis), edge);
        }
    }

    #[test]
    fn every_case_uses_exactly_the_crossed_edges() {
        let mut most = 0;
        for case in 0..=255u8 {
            let used: std::collections::BTreeSet<u8> = table().case(case).iter().copied().collect();
            let crossed = (0..12u8)
                .filter(|&e| {
                    let (corner, axis) = edge_owner(e);
                    (case >> corner ^ case >> (corner | 1 << axis)) & 1 == 1
                })
                .collect();
            assert_eq!(used, crossed, "case {case}");
            most = most.max(table().triangle_count(case) as usize);
        }
        assert_eq!(most, MAX_TRIANGLES);
        assert_eq!(table().words().len(), 257 + table().edges.len());
    }

    #[test]
    fn a_single_corner_faces_outwards() {
        for corner in 0..8u8 {
            let t = table().case(1 << corner);
            let [a, b, c] = [t[0], t[1], t[2]].map(|e| glam::DVec3::from(midpoint(e)));
            let centre = glam::DVec3::from([0, 1, 2].map(|i| f64::from(corner >> i & 1)));
            let n = (b - a).cross(c - a);
            assert!(n.dot(a - centre) > 0.0, "corner {corner} looks inwards");
        }
    }

    /// Any two cubes that share a face draw opposite directed segments on it: no crack, no fold.
    #[test]
    fn neighbours_agree_on_every_shared_face() {
        let directed = |case: u8, axis: u8, side: u8| -> HashMap<([u8; 2], [u8; 2]), i32> {
            let mut out = HashMap::new();
            for t in table().case(case).chunks_exact(3) {
                for i in 0..3 {
                    let ends = [t[i], t[(i + 1) % 3]].map(|e| {
                        let (corner, a) = edge_owner(e);
                        (a != axis && corner >> axis & 1 == side)
                            .then_some([corner & !(1 << axis), a])
                    });
                    if let [Some(a), Some(b)] = ends {
                        *out.entry((a, b)).or_default() += 1;
                    }
                }
            }
            out
        };
        for axis in 0..3u8 {
            for low in 0..=255u8 {
                for high in 0..=255u8 {
                    let matches = (0..8u8)
                        .filter(|c| c >> axis & 1 == 1)
                        .all(|c| low >> c & 1 == high >> (c & !(1 << axis)) & 1);
                    if !matches {
                        continue;
                    }
                    let a = directed(low, axis, 1);
                    let b = directed(high, axis, 0);
                    assert!(a.values().all(|&n| n == 1), "cases {low} {high}");
                    assert_eq!(a.len(), b.len(), "cases {low} {high}");
                    for (from, to) in a.keys() {
                        assert_eq!(b.get(&(*to, *from)), Some(&1), "cases {low} {high}");
                    }
                }
            }
        }
    }
}
