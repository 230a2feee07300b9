//! Bounding volume hierarchy over triangles: nearest hit and any hit, with an acceptance test
//! that lets alpha-masked leaves pass rays.
//!
//! Built top-down by the binned surface area heuristic (Wald 2007, On fast Construction of
//! SAH-based Bounding Volume Hierarchies). The triangle test is that of Woop, Benthin and Wald
//! 2013, Watertight Ray/Triangle Intersection: a ray never slips between two triangles that share
//! an edge.

use glam::Vec3;

/// A half-open ray segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Start.
    pub origin: Vec3,
    /// Direction, any length but zero; distances are in its units.
    pub direction: Vec3,
    /// Hits at or before this distance are ignored.
    pub t_min: f32,
    /// Hits beyond this distance are ignored.
    pub t_max: f32,
}

/// Where a ray meets a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Triangle: its three indices start at 3 times this.
    pub triangle: u32,
    /// Distance in units of the ray's direction.
    pub t: f32,
    /// Barycentric weights of the three corners.
    pub weights: [f32; 3],
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    pub(super) min: Vec3,
    pub(super) max: Vec3,
    /// Leaf: first entry of `order`; otherwise the first of two adjacent children.
    pub(super) first: u32,
    /// Triangles of a leaf; 0 for an inner node.
    pub(super) count: u32,
}

/// Hierarchy over indexed triangles.
#[derive(Debug, Clone)]
pub struct Bvh {
    pub(super) nodes: Vec<Node>,
    /// Original triangle number of each stored triangle.
    pub(super) order: Vec<u32>,
    /// Corners in the order of `order`, so that a leaf reads adjacent memory.
    corners: Vec<[Vec3; 3]>,
}

const BINS: usize = 16;
const STACK: usize = 80;

/// Where splitting ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// Triangles of a leaf at most.
    pub(super) leaf_size: usize,
    /// Splits below this depth halve the range, which bounds the traversal stack.
    pub(super) sah_depth: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            leaf_size: 4,
            sah_depth: 40,
        }
    }
}

#[derive(Clone, Copy)]
struct Bounds {
    min: Vec3,
    max: Vec3,
}

impl Bounds {
    const EMPTY: Self = Self {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
    };

    fn join(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    fn centre2(self) -> Vec3 {
        self.min + self.max
    }

    /// Half the surface area; 0 when empty.
    fn half_area(self) -> f32 {
        let e = (self.max - self.min).max(Vec3::ZERO);
        e.x * e.y + e.y * e.z + e.z * e.x
    }
}

impl Bvh {
    /// A hierarchy over the triangles of `indices`.
    #[must_use]
    pub fn new(positions: &[Vec3], indices: &[u32]) -> Self {
        Self::with_limits(positions, indices, Limits::default())
    }

    pub(super) fn with_limits(positions: &[Vec3], indices: &[u32], limits: Limits) -> Self {
        let triangles: Vec<[Vec3; 3]> = indices
            .chunks_exact(3)
            .map(|t| [t[0], t[1], t[2]].map(|i| positions[i as usize]))
            .collect();
        let boxes: Vec<Bounds> = triangles
            .iter()
            .map(|t| Bounds {
                min: t[0].min(t[1]).min(t[2]),
                max: t[0].max(t[1]).max(t[2]),
            })
            .collect();
        let count = u32::try_from(triangles.len()).expect("fewer than 2^32 triangles");
        let mut order: Vec<u32> = (0..count).collect();
        let mut nodes = Vec::new();
        if count > 0 {
            nodes.push(leaf(&boxes, &order, 0));
            let mut open = vec![(0usize, 0usize)];
            while let Some((node, depth)) = open.pop() {
                if let Some(children) = split(&boxes, &mut order, nodes[node], (depth, limits)) {
                    let first = nodes.len();
                    nodes.extend(children);
                    nodes[node].first = u32::try_from(first).expect("fewer than 2^32 nodes");
                    nodes[node].count = 0;
                    open.extend([(first, depth + 1), (first + 1, depth + 1)]);
                }
            }
        }
        let corners = order.iter().map(|&i| triangles[i as usize]).collect();
        Self {
            nodes,
            order,
            corners,
        }
    }

    /// Number of triangles.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.order.len()
    }

    /// The nearest accepted hit. `accept` sees candidates in no particular order.
    pub fn nearest(&self, ray: &Ray, mut accept: impl FnMut(&Hit) -> bool) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        self.traverse(ray, |hit| {
            if accept(&hit) {
                best = Some(hit);
                Step::Shorten(hit.t)
            } else {
                Step::Continue
            }
        });
        best
    }

    /// Whether any hit is accepted.
    pub fn any(&self, ray: &Ray, mut accept: impl FnMut(&Hit) -> bool) -> bool {
        let mut found = false;
        self.traverse(ray, |hit| {
            found = accept(&hit);
            if found { Step::Stop } else { Step::Continue }
        });
        found
    }

    fn traverse(&self, ray: &Ray, mut visit: impl FnMut(Hit) -> Step) {
        if self.nodes.is_empty() {
            return;
        }
        let sheared = Sheared::new(ray.direction);
        // Finite, so that a ray in the plane of a box's side (0 times infinity) still enters it.
        let inverse = ray
            .direction
            .recip()
            .clamp(Vec3::splat(-1e30), Vec3::splat(1e30));
        let mut t_max = ray.t_max;
        let mut stack = [0u32; STACK];
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let node = &self.nodes[stack[top] as usize];
            if entry(node, ray, inverse, t_max).is_none() {
                continue;
            }
            let first = node.first as usize;
            for i in first..first + node.count as usize {
                let Some((t, weights)) = sheared.intersect(ray.origin, &self.corners[i]) else {
                    continue;
                };
                if t <= ray.t_min || t > t_max {
                    continue;
                }
                let triangle = self.order[i];
                match visit(Hit {
                    triangle,
                    t,
                    weights,
                }) {
                    Step::Stop => return,
                    Step::Shorten(t) => t_max = t,
                    Step::Continue => {}
                }
            }
            if node.count == 0 {
                let near = |k: usize| entry(&self.nodes[first + k], ray, inverse, t_max);
                // The nearer child is visited first, so that a nearest hit shortens the ray early.
                let (a, b) = match (near(0), near(1)) {
                    (Some(a), Some(b)) => (Some(u32::from(a > b)), Some(u32::from(a <= b))),
                    (Some(_), None) => (Some(0), None),
                    (None, Some(_)) => (Some(1), None),
                    (None, None) => (None, None),
                };
                for child in [b, a].into_iter().flatten() {
                    stack[top] = node.first + child;
                    top += 1;
                }
            }
        }
    }
}

enum Step {
    Continue,
    Shorten(f32),
    Stop,
}

fn leaf(boxes: &[Bounds], range: &[u32], first: usize) -> Node {
    let all = range
        .iter()
        .fold(Bounds::EMPTY, |b, &i| b.join(boxes[i as usize]));
    Node {
        min: all.min,
        max: all.max,
        first: u32::try_from(first).expect("fewer than 2^32 triangles"),
        count: u32::try_from(range.len()).expect("fewer than 2^32 triangles"),
    }
}

/// Children of a leaf, or `None` where splitting does not pay.
fn split(
    boxes: &[Bounds],
    order: &mut [u32],
    node: Node,
    (depth, limits): (usize, Limits),
) -> Option<[Node; 2]> {
    let first = node.first as usize;
    let range = &mut order[first..first + node.count as usize];
    if range.len() <= 1 {
        return None;
    }
    let centres = range.iter().fold(Bounds::EMPTY, |b, &i| {
        let c = boxes[i as usize].centre2();
        b.join(Bounds { min: c, max: c })
    });
    let axis = (centres.max - centres.min).max_position();
    let plane = (depth < limits.sah_depth)
        .then(|| best_plane(boxes, range, centres, axis))
        .flatten();
    let middle = match plane {
        Some((cost, plane)) => {
            let keep = range.len() as f32 * leaf_area(&node);
            if range.len() <= limits.leaf_size && cost + leaf_area(&node) >= keep {
                return None;
            }
            partition(range, |&i| {
                bin_of(boxes[i as usize], centres, axis) <= plane
            })
        }
        None if range.len() <= limits.leaf_size => return None,
        None => {
            let half = range.len() / 2;
            range.select_nth_unstable_by(half, |&a, &b| {
                let key = |i: u32| boxes[i as usize].centre2()[axis];
                key(a).total_cmp(&key(b)).then(a.cmp(&b))
            });
            half
        }
    };
    let (low, high) = range.split_at(middle);
    Some([leaf(boxes, low, first), leaf(boxes, high, first + middle)])
}

fn leaf_area(node: &Node) -> f32 {
    Bounds {
        min: node.min,
        max: node.max,
    }
    .half_area()
}

fn bin_of(bounds: Bounds, centres: Bounds, axis: usize) -> usize {
    let extent = centres.max[axis] - centres.min[axis];
    let at = (bounds.centre2()[axis] - centres.min[axis]) / extent;
    ((at * BINS as f32) as usize).min(BINS - 1)
}

/// Cheapest split (area times count of both sides) and the last bin of its lower side.
fn best_plane(
    boxes: &[Bounds],
    range: &[u32],
    centres: Bounds,
    axis: usize,
) -> Option<(f32, usize)> {
    if centres.max[axis] <= centres.min[axis] {
        return None;
    }
    let mut bins = [(Bounds::EMPTY, 0u32); BINS];
    for &i in range {
        let b = &mut bins[bin_of(boxes[i as usize], centres, axis)];
        *b = (b.0.join(boxes[i as usize]), b.1 + 1);
    }
    let cost = |side: &[(Bounds, u32)]| {
        let (all, count) = side
            .iter()
            .fold((Bounds::EMPTY, 0), |(b, n), s| (b.join(s.0), n + s.1));
        (count > 0).then(|| all.half_area() * count as f32)
    };
    (0..BINS - 1)
        .filter_map(|last| {
            let (low, high) = bins.split_at(last + 1);
            Some((cost(low)? + cost(high)?, last))
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))
}

/// Moves the elements that satisfy `keep` to the front; returns their number.
fn partition(range: &mut [u32], keep: impl Fn(&u32) -> bool) -> usize {
    let mut count = 0;
    for i in 0..range.len() {
        if keep(&range[i]) {
            range.swap(i, count);
            count += 1;
        }
    }
    count
}

/// Distance at which the ray enters the node's box (slab test), if it does.
fn entry(node: &Node, ray: &Ray, inverse: Vec3, t_max: f32) -> Option<f32> {
    let a = (node.min - ray.origin) * inverse;
    let b = (node.max - ray.origin) * inverse;
    let near = |k: usize| a[k].min(b[k]);
    let far = |k: usize| a[k].max(b[k]);
    let enter = near(0).max(near(1)).max(near(2)).max(ray.t_min);
    // Rounding must not lose a box: Ize 2013, Robust BVH Ray Traversal.
    let leave = (far(0).min(far(1)).min(far(2)) * (1.0 + 4.0 * f32::EPSILON)).min(t_max);
    (enter <= leave).then_some(enter)
}

/// The ray's frame for the watertight test: z along its largest component, sheared onto it.
struct Sheared {
    axes: [usize; 3],
    shear: Vec3,
}

impl Sheared {
    fn new(direction: Vec3) -> Self {
        let z = direction.abs().max_position();
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        if direction[z] < 0.0 {
            std::mem::swap(&mut x, &mut y);
        }
        Self {
            axes: [x, y, z],
            shear: Vec3::new(direction[x], direction[y], 1.0) / direction[z],
        }
    }

    /// Distance and barycentric weights, whichever side is hit.
    fn intersect(&self, origin: Vec3, corners: &[Vec3; 3]) -> Option<(f32, [f32; 3])> {
        let [x, y, z] = self.axes;
        let [a, b, c] = corners.map(|p| {
            let d = p - origin;
            Vec3::new(
                d[x] - self.shear.x * d[z],
                d[y] - self.shear.y * d[z],
                self.shear.z * d[z],
            )
        });
        let mut u = c.x * b.y - c.y * b.x;
        let mut v = a.x * c.y - a.y * c.x;
        let mut w = b.x * a.y - b.y * a.x;
        if u == 0.0 || v == 0.0 || w == 0.0 {
            // On an edge the sign decides between neighbours: products of f32 are exact in f64.
            let cross = |p: Vec3, q: Vec3| {
                (f64::from(p.x) * f64::from(q.y) - f64::from(p.y) * f64::from(q.x)) as f32
            };
            (u, v, w) = (cross(c, b), cross(a, c), cross(b, a));
        }
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let determinant = u + v + w;
        if determinant == 0.0 {
            return None;
        }
        let weights = [u, v, w].map(|k| k / determinant);
        let t = weights[0] * a.z + weights[1] * b.z + weights[2] * c.z;
        Some((t, weights))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sampling::{fibonacci_sphere, uniform};

    fn soup(count: u32) -> (Vec<Vec3>, Vec<u32>) {
        let random = |i: u32| uniform(11, i) as f32;
        let at = |i: u32| Vec3::new(random(3 * i), random(3 * i + 1), random(3 * i + 2));
        let mut positions = Vec::new();
        for t in 0..count {
            let centre = at(4 * t);
            positions.extend((1..4).map(|k| centre + 0.3 * (at(4 * t + k) - 0.5)));
        }
        let indices = (0..3 * count).collect();
        (positions, indices)
    }

    #[test]
    fn nearest_and_any_agree_with_trying_all_triangles() {
        let (positions, indices) = soup(600);
        let bvh = Bvh::new(&positions, &indices);
        assert_eq!(bvh.triangle_count(), 600);
        let mut hits = 0;
        for i in 0..400 {
            let ray = Ray {
                origin: Vec3::splat(0.5) + 0.3 * fibonacci_sphere(i * 7 % 400, 400).as_vec3(),
                direction: fibonacci_sphere(i, 400).as_vec3(),
                t_min: 0.0,
                t_max: f32::INFINITY,
            };
            let sheared = Sheared::new(ray.direction);
            let expected = positions
                .chunks_exact(3)
                .enumerate()
                .filter_map(|(k, p)| {
                    let (t, _) = sheared.intersect(ray.origin, &[p[0], p[1], p[2]])?;
                    (t > 0.0).then_some((t, k as u32))
                })
                .min_by(|a, b| a.0.total_cmp(&b.0));
            let found = bvh.nearest(&ray, |_| true);
            assert_eq!(found.map(|h| (h.t, h.triangle)), expected, "ray {i}");
            assert_eq!(bvh.any(&ray, |_| true), expected.is_some());
            // Refusing the nearest triangle shows the next one.
            if let Some((t, k)) = expected {
                hits += 1;
                let next = bvh.nearest(&ray, |h| h.triangle != k);
                assert!(next.is_none_or(|h| h.t >= t && h.triangle != k));
            }
        }
        assert!(hits > 200, "{hits} of 400 rays hit");
    }

    #[test]
    fn no_ray_slips_through_a_closed_mesh() {
        // A fan of an octahedron: rays through vertices and edges are the hard ones.
        let positions = [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z];
        let indices = [
            0, 1, 2, 1, 3, 2, 3, 4, 2, 4, 0, 2, 1, 0, 5, 3, 1, 5, 4, 3, 5, 0, 4, 5,
        ];
        let bvh = Bvh::new(&positions, &indices);
        for x in -6i8..=6 {
            for y in -6i8..=6 {
                for z in -6i8..=6 {
                    let direction = Vec3::new(f32::from(x), f32::from(y), f32::from(z));
                    if direction == Vec3::ZERO {
                        continue;
                    }
                    let ray = Ray {
                        origin: Vec3::ZERO,
                        direction,
                        t_min: 0.0,
                        t_max: f32::INFINITY,
                    };
                    let hit = bvh.nearest(&ray, |_| true).expect("closed");
                    let sum = direction.abs().element_sum();
                    assert!((hit.t * sum - 1.0).abs() < 1e-5, "{direction}");
                }
            }
        }
    }

    #[test]
    fn degenerate_sets_are_handled() {
        let ray = Ray {
            origin: Vec3::new(0.2, 0.2, 1.0),
            direction: -Vec3::Z,
            t_min: 0.0,
            t_max: 10.0,
        };
        assert!(Bvh::new(&[], &[]).nearest(&ray, |_| true).is_none());
        // A thousand coincident triangles and a point-like one.
        let positions = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let mut indices = [0, 1, 2].repeat(1000);
        indices.extend([0, 0, 0]);
        let bvh = Bvh::new(&positions, &indices);
        let mut seen = 0;
        assert!(!bvh.any(&ray, |_| {
            seen += 1;
            false
        }));
        assert_eq!(seen, 1000);
    }
}
