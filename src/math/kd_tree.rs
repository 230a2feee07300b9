//! Nearest points by a balanced k-d tree stored in one permutation (Bentley 1975).

use std::ops::Range;

use glam::Vec3;

/// Points sorted so that every range's middle splits it along the longest side.
#[derive(Debug, Clone)]
pub struct KdTree {
    points: Vec<Vec3>,
    order: Vec<u32>,
    axes: Vec<u8>,
}

impl KdTree {
    /// A tree over `points`.
    #[must_use]
    pub fn new(points: &[Vec3]) -> Self {
        let count = u32::try_from(points.len()).expect("fewer than 2^32 points");
        let mut tree = Self {
            points: points.to_vec(),
            order: (0..count).collect(),
            axes: vec![0; points.len()],
        };
        let mut ranges = vec![(0, points.len())];
        while let Some((start, end)) = ranges.pop() {
            if end - start < 2 {
                continue;
            }
            let (min, max) = tree.order[start..end]
                .iter()
                .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), &i| {
                    (lo.min(points[i as usize]), hi.max(points[i as usize]))
                });
            let axis = (max - min).max_position();
            let middle = start + (end - start) / 2;
            tree.order[start..end].select_nth_unstable_by(middle - start, |&a, &b| {
                points[a as usize][axis]
                    .total_cmp(&points[b as usize][axis])
                    .then(a.cmp(&b))
            });
            tree.axes[middle] = u8::try_from(axis).expect("three axes");
            ranges.extend([(start, middle), (middle + 1, end)]);
        }
        tree
    }

    /// Indices of the `count` points nearest to `q`, nearest first, lower indices first at equal
    /// distance.
    #[must_use]
    pub fn nearest(&self, q: Vec3, count: usize) -> Vec<usize> {
        let mut best: Vec<(f32, u32)> = Vec::with_capacity(count + 1);
        self.visit(q, count, 0..self.order.len(), &mut best);
        best.into_iter().map(|(_, i)| i as usize).collect()
    }

    fn visit(&self, q: Vec3, count: usize, range: Range<usize>, best: &mut Vec<(f32, u32)>) {
        let Range { start, end } = range;
        if start >= end || count == 0 {
            return;
        }
        let middle = start + (end - start) / 2;
        let index = self.order[middle];
        let point = self.points[index as usize];
        let entry = (q.distance_squared(point), index);
        let at = best.partition_point(|b| (b.0, b.1) < entry);
        if at < count {
            best.insert(at, entry);
            best.truncate(count);
        }
        let axis = usize::from(self.axes[middle]);
        let offset = q[axis] - point[axis];
        let (near, far) = if offset < 0.0 {
            (start..middle, middle + 1..end)
        } else {
            (middle + 1..end, start..middle)
        };
        self.visit(q, count, near, best);
        if best.len() < count || offset * offset <= best[best.len() - 1].0 {
            self.visit(q, count, far, best);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sampling::uniform;

    #[test]
    fn agrees_with_trying_all_points() {
        // A coarse lattice makes equal distances and coincident points.
        let coordinate = |i: u32| (uniform(3, i) * 8.0).floor() as f32;
        let points: Vec<Vec3> = (0..500)
            .map(|i| {
                Vec3::new(
                    coordinate(3 * i),
                    coordinate(3 * i + 1),
                    coordinate(3 * i + 2),
                )
            })
            .collect();
        let tree = KdTree::new(&points);
        for k in 0..50 {
            let q = points[k] + Vec3::splat(0.25 * (k % 3) as f32);
            let mut all: Vec<(f32, usize)> = points
                .iter()
                .enumerate()
                .map(|(i, p)| (q.distance_squared(*p), i))
                .collect();
            all.sort_by(|a, b| a.partial_cmp(b).expect("finite"));
            let expected: Vec<usize> = all[..13].iter().map(|a| a.1).collect();
            assert_eq!(tree.nearest(q, 13), expected);
        }
        assert!(KdTree::new(&[]).nearest(Vec3::ZERO, 3).is_empty());
    }
}
