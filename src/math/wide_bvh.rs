//! The hierarchy that kernels trace: eight children a node, boxes in bytes.
//!
//! After Ylitie, Karras and Laine 2017, Efficient Incoherent Ray Traversal on GPUs Through
//! Compressed Wide BVHs: a binary hierarchy is collapsed by opening the largest child again and
//! again; children stand at places that make the order along a ray a flip of bits; boxes are
//! bytes on a grid of powers of two. `shaders/include/rays.glsl` is the other half.

use glam::{DVec3, Vec3};

use super::sah::{self, Bounds, Limits, Node};

/// Texels of four words, as the kernels fetch them.
pub type Texel = [u32; 4];

/// Children of a node.
const WIDTH: usize = 8;
/// Objects of a leaf: three bits say which there are.
const LEAF: usize = 3;
/// Boxes grow by this share of the unit in which positions are given, against the rounding of
/// the slab test: origins lie within a few units.
const PAD: f64 = 1.0 / (1u64 << 19) as f64;

/// A hierarchy ready for upload.
#[derive(Debug, Clone, Default)]
pub struct WideBvh {
    /// Five texels a node: corner and exponents; first child, first object and what the
    /// children are; bytes of the low x, low y; low z, high x; high y, high z.
    pub nodes: Vec<Texel>,
    /// Number of each object, in the order of the leaves.
    pub order: Vec<u32>,
    /// Levels of nodes: no more groups ever wait for a ray.
    pub depth: usize,
}

impl WideBvh {
    /// A hierarchy of at most `max_depth` levels over the objects in `boxes`, in units of about
    /// the scene's size.
    ///
    /// # Panics
    /// When `max_depth` is less than a balanced hierarchy of this many objects has.
    #[must_use]
    pub fn new(boxes: &[Bounds], max_depth: usize) -> Self {
        if boxes.is_empty() {
            return Self::empty();
        }
        // Where the heuristic gives a hierarchy too deep for the stack, it ends earlier.
        for sah_depth in [40, 20, 10, 0] {
            let limits = Limits {
                leaf_size: LEAF,
                sah_depth,
            };
            let (nodes, order) = sah::build(boxes, limits);
            let wide = Self::collapse(&nodes, &order);
            if wide.depth <= max_depth {
                return wide;
            }
        }
        panic!("{} objects do not fit {max_depth} levels", boxes.len());
    }

    /// One node without children.
    fn empty() -> Self {
        Self {
            nodes: vec![[0; 4]; 5],
            order: Vec::new(),
            depth: 1,
        }
    }

    fn collapse(binary: &[Node], order: &[u32]) -> Self {
        let mut out = Self {
            nodes: vec![[0; 4]; 5],
            order: Vec::with_capacity(order.len()),
            depth: 0,
        };
        // Binary node, wide node and level of what is still to be written.
        let mut open = vec![(0u32, 0usize, 1usize)];
        while let Some((node, wide, level)) = open.pop() {
            out.depth = out.depth.max(level);
            let children = places(binary, node);
            let first_child = out.nodes.len() / 5;
            let inner: Vec<u32> = children
                .iter()
                .flatten()
                .copied()
                .filter(|&c| binary[c as usize].count == 0)
                .collect();
            for (i, &child) in inner.iter().enumerate() {
                open.push((child, first_child + i, level + 1));
                out.nodes.extend([[0; 4]; 5]);
            }
            out.write((binary, order), wide, &children, first_child);
        }
        out
    }

    /// Writes node `wide` and appends the objects of its leaves.
    fn write(
        &mut self,
        (binary, order): (&[Node], &[u32]),
        wide: usize,
        children: &[Option<u32>; WIDTH],
        first_child: usize,
    ) {
        let boxes = children.map(|c| c.map(|c| padded(&binary[c as usize])));
        let all = boxes
            .iter()
            .flatten()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |a, b| {
                (a.0.min(b.0), a.1.max(b.1))
            });
        let (corner, exponents) = grid(all);
        let scale = exponents.map(|e| 2.0_f64.powi(e));
        let first_object = self.order.len();
        let (mut about, mut low, mut high) = ([0u8; WIDTH], [[255u8; WIDTH]; 3], [[0u8; WIDTH]; 3]);
        let mut holds_nodes = 0u32;
        for (place, child) in children.iter().enumerate() {
            let (Some(child), Some(bounds)) = (child, boxes[place]) else {
                continue;
            };
            let node = &binary[*child as usize];
            for k in 0..3 {
                let at = |v: DVec3| (v[k] - f64::from(corner[k])) / scale[k];
                low[k][place] = at(bounds.0).floor().clamp(0.0, 255.0) as u8;
                high[k][place] = at(bounds.1).ceil().clamp(0.0, 255.0) as u8;
            }
            about[place] = if node.count == 0 {
                holds_nodes |= 1 << place;
                1 << 5 | (24 + place) as u8
            } else {
                let offset = (self.order.len() - first_object) as u8;
                let range = node.first as usize..(node.first + node.count) as usize;
                self.order.extend_from_slice(&order[range]);
                ((1 << node.count) - 1) << 5 | offset
            };
        }
        let words = |b: [u8; WIDTH]| {
            let half = |k: usize| u32::from_le_bytes([b[k], b[k + 1], b[k + 2], b[k + 3]]);
            [half(0), half(4)]
        };
        let pair = |a: [u8; WIDTH], b: [u8; WIDTH]| {
            let (a, b) = (words(a), words(b));
            [a[0], a[1], b[0], b[1]]
        };
        let biased = exponents.map(|e| (e + 127) as u32);
        let [x, y, z] = corner.to_array().map(f32::to_bits);
        let e = biased[0] | biased[1] << 8 | biased[2] << 16 | holds_nodes << 24;
        let [m0, m1] = words(about);
        self.nodes[5 * wide..5 * wide + 5].copy_from_slice(&[
            [x, y, z, e],
            [first_child as u32, first_object as u32, m0, m1],
            pair(low[0], low[1]),
            pair(low[2], high[0]),
            pair(high[1], high[2]),
        ]);
    }
}

fn padded(node: &Node) -> (DVec3, DVec3) {
    let (min, max) = (node.bounds.min.as_dvec3(), node.bounds.max.as_dvec3());
    (min - PAD, max + PAD)
}

/// Corner of the node's grid, not above the box, and the power of two of its step on each axis.
fn grid((min, max): (DVec3, DVec3)) -> (Vec3, [i32; 3]) {
    let corner = Vec3::from_array([0, 1, 2].map(|k| {
        let rounded = min[k] as f32;
        if f64::from(rounded) > min[k] {
            rounded.next_down()
        } else {
            rounded
        }
    }));
    let exponents = [0, 1, 2].map(|k| {
        let extent = max[k] - f64::from(corner[k]);
        (extent / 255.0).log2().ceil().clamp(-100.0, 100.0) as i32
    });
    (corner, exponents)
}

/// The (up to eight) descendants of a binary node that become its children, at their places.
fn places(nodes: &[Node], root: u32) -> [Option<u32>; WIDTH] {
    let mut chosen = vec![root];
    if nodes[root as usize].count == 0 {
        while chosen.len() < WIDTH {
            let area = |c: u32| nodes[c as usize].bounds.half_area();
            let inner = (0..chosen.len()).filter(|&i| nodes[chosen[i] as usize].count == 0);
            let Some(largest) = inner.max_by(|&i, &j| area(chosen[i]).total_cmp(&area(chosen[j])))
            else {
                break;
            };
            let first = nodes[chosen.swap_remove(largest) as usize].first;
            chosen.extend([first, first + 1]);
        }
    }
    let centre = |c: u32| nodes[c as usize].bounds.min + nodes[c as usize].bounds.max;
    let middle = chosen.iter().map(|&c| centre(c)).sum::<Vec3>() / chosen.len() as f32;
    // The best pair of a child and a place first: place k is on the high side of axis i where
    // bit i of k is set.
    let mut pairs: Vec<(f32, u32, usize)> = Vec::new();
    for &c in &chosen {
        let d = centre(c) - middle;
        for place in 0..WIDTH {
            let sign = |bit: usize| if place >> bit & 1 == 1 { 1.0 } else { -1.0 };
            pairs.push((d.x * sign(0) + d.y * sign(1) + d.z * sign(2), c, place));
        }
    }
    pairs.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut out = [None; WIDTH];
    for (_, child, place) in pairs {
        if out[place].is_none() && !out.contains(&Some(child)) {
            out[place] = Some(child);
        }
    }
    out
}
