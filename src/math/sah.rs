//! A binary hierarchy over boxes by the binned surface area heuristic (Wald 2007, On fast
//! Construction of SAH-based Bounding Volume Hierarchies), on all three axes.

use glam::Vec3;

/// An axis-aligned box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Lowest corner.
    pub min: Vec3,
    /// Highest corner.
    pub max: Vec3,
}

impl Bounds {
    /// Holds nothing.
    pub const EMPTY: Self = Self {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
    };

    /// The box of some points.
    #[must_use]
    pub fn of(points: &[Vec3]) -> Self {
        points.iter().fold(Self::EMPTY, |b, &p| Self {
            min: b.min.min(p),
            max: b.max.max(p),
        })
    }

    /// The box of two boxes.
    #[must_use]
    pub fn join(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// Half the surface area; 0 when empty.
    #[must_use]
    pub fn half_area(self) -> f32 {
        let e = (self.max - self.min).max(Vec3::ZERO);
        e.x * e.y + e.y * e.z + e.z * e.x
    }

    fn centre2(self) -> Vec3 {
        self.min + self.max
    }
}

/// A node: a leaf, or two children that stand side by side.
#[derive(Debug, Clone, Copy)]
pub struct Node {
    /// Its box.
    pub bounds: Bounds,
    /// Leaf: first entry of the order; otherwise the first of two adjacent children.
    pub first: u32,
    /// Objects of a leaf; 0 for an inner node.
    pub count: u32,
}

/// What splitting costs and where it ends.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Objects of a leaf at most.
    pub leaf_size: usize,
    /// Splits below this depth halve the range.
    pub sah_depth: usize,
}

/// Cost of a node in tests of an object.
const NODE_COST: f32 = 0.5;
const BINS: usize = 32;

/// Nodes (the first is the root; none for no boxes) and the numbers of the boxes in the order
/// of the leaves.
#[must_use]
pub fn build(boxes: &[Bounds], limits: Limits) -> (Vec<Node>, Vec<u32>) {
    let count = u32::try_from(boxes.len()).expect("fewer than 2^32 boxes");
    let mut order: Vec<u32> = (0..count).collect();
    if boxes.is_empty() {
        return (Vec::new(), order);
    }
    let mut nodes = vec![leaf(boxes, &order, 0)];
    let mut open = vec![(0usize, 0usize)];
    while let Some((node, depth)) = open.pop() {
        let Node { first, count, .. } = nodes[node];
        let range = &mut order[first as usize..(first + count) as usize];
        let Some(middle) = split(boxes, range, nodes[node].bounds, depth, limits) else {
            continue;
        };
        let (low, high) = range.split_at(middle);
        let children = nodes.len();
        nodes.extend([
            leaf(boxes, low, first),
            leaf(boxes, high, first + middle as u32),
        ]);
        nodes[node].first = u32::try_from(children).expect("fewer than 2^32 nodes");
        nodes[node].count = 0;
        open.extend([(children, depth + 1), (children + 1, depth + 1)]);
    }
    (nodes, order)
}

fn leaf(boxes: &[Bounds], range: &[u32], first: u32) -> Node {
    let join = |b: Bounds, &i: &u32| b.join(boxes[i as usize]);
    Node {
        bounds: range.iter().fold(Bounds::EMPTY, join),
        first,
        count: range.len() as u32,
    }
}

/// Orders the range and says where it is cut, or `None` where splitting does not pay.
fn split(
    boxes: &[Bounds],
    range: &mut [u32],
    all: Bounds,
    depth: usize,
    limits: Limits,
) -> Option<usize> {
    if range.len() <= 1 {
        return None;
    }
    let centre = |i: u32| boxes[i as usize].centre2();
    let centres = range.iter().fold(Bounds::EMPTY, |b, &i| Bounds {
        min: b.min.min(centre(i)),
        max: b.max.max(centre(i)),
    });
    let grid = Grid::new(centres);
    let plane = (depth < limits.sah_depth)
        .then(|| grid.best_plane(boxes, range))
        .flatten();
    if let Some((cost, axis, bin)) = plane {
        let area = all.half_area();
        let keep = range.len() as f32 * area;
        if range.len() <= limits.leaf_size && cost + NODE_COST * area >= keep {
            return None;
        }
        return Some(partition(range, |i| {
            grid.bins(boxes[i as usize])[axis] <= bin
        }));
    }
    if range.len() <= limits.leaf_size {
        return None;
    }
    let (half, axis) = (range.len() / 2, (centres.max - centres.min).max_position());
    range.select_nth_unstable_by(half, |&a, &b| {
        centre(a)[axis].total_cmp(&centre(b)[axis]).then(a.cmp(&b))
    });
    Some(half)
}

fn partition(range: &mut [u32], low: impl Fn(u32) -> bool) -> usize {
    let mut middle = 0;
    for i in 0..range.len() {
        if low(range[i]) {
            range.swap(i, middle);
            middle += 1;
        }
    }
    middle
}

/// Bins of equal width over the centres of a range.
struct Grid {
    start: Vec3,
    per_unit: Vec3,
}

impl Grid {
    fn new(centres: Bounds) -> Self {
        let extent = centres.max - centres.min;
        let per_unit = |e: f32| if e > 0.0 { BINS as f32 / e } else { 0.0 };
        Self {
            start: centres.min,
            per_unit: Vec3::new(per_unit(extent.x), per_unit(extent.y), per_unit(extent.z)),
        }
    }

    fn bins(&self, b: Bounds) -> [usize; 3] {
        let at = (b.centre2() - self.start) * self.per_unit;
        at.to_array().map(|v| (v as usize).min(BINS - 1))
    }

    /// Cost, axis and last bin below of the cheapest plane.
    fn best_plane(&self, boxes: &[Bounds], range: &[u32]) -> Option<(f32, usize, usize)> {
        let mut bins = [[(Bounds::EMPTY, 0usize); BINS]; 3];
        for &i in range {
            let b = boxes[i as usize];
            for (row, bin) in bins.iter_mut().zip(self.bins(b)) {
                row[bin] = (row[bin].0.join(b), row[bin].1 + 1);
            }
        }
        let mut best: Option<(f32, usize, usize)> = None;
        for (axis, row) in bins.iter().enumerate() {
            let mut above = [f32::INFINITY; BINS];
            let (mut sum, mut count) = (Bounds::EMPTY, 0);
            for (bin, &(b, n)) in row.iter().enumerate().skip(1).rev() {
                (sum, count) = (sum.join(b), count + n);
                if count > 0 {
                    above[bin] = sum.half_area() * count as f32;
                }
            }
            (sum, count) = (Bounds::EMPTY, 0);
            for (bin, &(b, n)) in row.iter().enumerate().take(BINS - 1) {
                (sum, count) = (sum.join(b), count + n);
                let cost = sum.half_area() * count as f32 + above[bin + 1];
                if count > 0 && cost < best.map_or(f32::INFINITY, |b| b.0) {
                    best = Some((cost, axis, bin));
                }
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sampling::uniform;

    fn check(boxes: &[Bounds], limits: Limits) {
        let (nodes, order) = build(boxes, limits);
        let mut seen = vec![false; boxes.len()];
        let mut open = vec![0u32];
        while let Some(node) = open.pop() {
            let node = nodes[node as usize];
            if node.count == 0 {
                let children = [node.first, node.first + 1];
                let both = children.map(|c| nodes[c as usize].bounds);
                assert_eq!(both[0].join(both[1]), node.bounds);
                open.extend(children);
                continue;
            }
            assert!(node.count as usize <= limits.leaf_size);
            for &i in &order[node.first as usize..(node.first + node.count) as usize] {
                assert_eq!(node.bounds.join(boxes[i as usize]), node.bounds);
                assert!(!std::mem::replace(&mut seen[i as usize], true), "{i} twice");
            }
        }
        assert!(seen.iter().all(|&s| s));
    }

    #[test]
    fn every_box_is_in_one_leaf() {
        let random = |i: u32| Vec3::from([0, 1, 2].map(|k| uniform(7, 3 * i + k) as f32));
        let boxes: Vec<Bounds> = (0..500)
            .map(|i| Bounds::of(&[random(2 * i), random(2 * i).lerp(random(2 * i + 1), 0.1)]))
            .collect();
        for (leaf_size, sah_depth) in [(3, 40), (1, 40), (4, 0), (3, 2)] {
            let limits = Limits {
                leaf_size,
                sah_depth,
            };
            check(&boxes, limits);
            // Boxes in one place cannot be told apart.
            check(&[boxes[0]; 100], limits);
            check(&boxes[..1], limits);
        }
    }
}
