//! High-level primitives: leaves gathered into spheres (Coconu, Deussen, Hege 2006, section 5).
//!
//! Greedy: a leaf joins, of all spheres that stay within the largest radius when they grow to hold
//! it, the one that ends smallest; otherwise it starts its own. The paper does not say how a sphere
//! moves; here it grows by the step of Ritter (1990), so that it holds all of its members at any
//! time.

use std::collections::HashMap;

use glam::{IVec3, Vec3};

use crate::math::hashing::WordHash;
use crate::{Error, Result};

/// Which of the spheres that would do a leaf joins.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Choice {
    /// The one that ends smallest.
    #[default]
    Smallest,
    /// The oldest (the paper, read literally).
    First,
}

/// A cluster of leaves, the paper's HLP.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cluster {
    /// Centre, in the frame of the leaves.
    pub centre: Vec3,
    /// Largest distance of a member from the centre; 0 for one leaf.
    pub radius: f32,
    /// Members.
    pub leaves: u32,
}

/// Leaves and the clusters they are in.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Clusters {
    /// Clusters, in the order in which their first leaves came.
    pub clusters: Vec<Cluster>,
    /// Cluster of each leaf.
    pub of_leaf: Vec<u32>,
}

type Grid = HashMap<IVec3, Vec<u32>, WordHash>;

/// A sphere while it grows; f64, since thousands of steps add up.
#[derive(Debug, Clone, Copy)]
struct Ball {
    centre: glam::DVec3,
    radius: f64,
}

impl Ball {
    /// The sphere that holds `point` too (Ritter's step).
    fn grown(self, point: glam::DVec3) -> Self {
        let away = point - self.centre;
        let distance = away.length();
        if distance <= self.radius {
            return self;
        }
        let radius = 0.5 * (self.radius + distance);
        Self {
            centre: self.centre + away * ((distance - radius) / distance),
            radius,
        }
    }
}

impl Clusters {
    /// Gathers `points` into spheres of at most `largest_radius`, in time linear in the points for
    /// leaves of bounded density (a hash grid of cells two radii wide).
    ///
    /// # Errors
    /// A radius that is not a positive number, or a point that is none.
    pub fn new(points: &[Vec3], largest_radius: f32, choice: Choice) -> Result<Self> {
        if !(largest_radius > 0.0 && largest_radius.is_finite()) {
            return Err(Error::usage(format!(
                "cluster radius {largest_radius}: expected a positive number"
            )));
        }
        if let Some(leaf) = points.iter().position(|p| !p.is_finite()) {
            return Err(Error::usage(format!("leaf {leaf}: its place is no number")));
        }
        let mut greedy = Greedy::new(points, largest_radius, choice);
        let of_leaf: Vec<u32> = points.iter().map(|&p| greedy.place(p)).collect();
        Ok(Self {
            clusters: settled(points, &of_leaf, &greedy.balls),
            of_leaf,
        })
    }

    /// Number of clusters.
    #[must_use]
    pub fn len(&self) -> usize {
        self.clusters.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.clusters.is_empty()
    }
}

struct Greedy {
    /// Corner of the grid, so that cells fit integers wherever the plant stands.
    low: glam::DVec3,
    cell: f64,
    largest: f64,
    choice: Choice,
    balls: Vec<Ball>,
    grid: Grid,
}

impl Greedy {
    fn new(points: &[Vec3], largest_radius: f32, choice: Choice) -> Self {
        let far = Vec3::splat(f32::INFINITY);
        let low = points.iter().copied().fold(far, Vec3::min).as_dvec3();
        let high = points.iter().copied().fold(-far, Vec3::max).as_dvec3();
        // Cells finer than a millionth of the extent would not fit integers and help nobody.
        let extent = (high - low).max_element().max(0.0);
        Self {
            low,
            cell: (2.0 * f64::from(largest_radius)).max(1e-6 * extent),
            largest: f64::from(largest_radius),
            choice,
            balls: Vec::new(),
            grid: Grid::default(),
        }
    }

    fn cell(&self, point: glam::DVec3) -> IVec3 {
        ((point - self.low) / self.cell).floor().as_ivec3()
    }

    /// Puts a leaf into a sphere and says which.
    fn place(&mut self, point: Vec3) -> u32 {
        let point = point.as_dvec3();
        if let Some((number, ball)) = self.find(point) {
            let (from, to) = (
                self.cell(self.balls[number as usize].centre),
                self.cell(ball.centre),
            );
            self.balls[number as usize] = ball;
            if from != to {
                if let Some(cell) = self.grid.get_mut(&from) {
                    cell.retain(|&n| n != number);
                }
                self.grid.entry(to).or_default().push(number);
            }
            return number;
        }
        let number = self.balls.len() as u32;
        self.balls.push(Ball {
            centre: point,
            radius: 0.0,
        });
        self.grid.entry(self.cell(point)).or_default().push(number);
        number
    }

    /// The sphere that `point` joins, grown. One that can hold it has its centre within two of the
    /// largest radii, and so lies in one of the 27 cells around.
    fn find(&self, point: glam::DVec3) -> Option<(u32, Ball)> {
        let home = self.cell(point);
        let mut best: Option<(u32, Ball)> = None;
        for offset in 0..27 {
            let step = IVec3::new(offset % 3 - 1, offset / 3 % 3 - 1, offset / 9 - 1);
            let Some(cell) = self.grid.get(&(home + step)) else {
                continue;
            };
            for &number in cell {
                let ball = self.balls[number as usize].grown(point);
                if ball.radius > self.largest {
                    continue;
                }
                // Ties go to the older one, whatever order the cells hold them in.
                let better = best.is_none_or(|(b, known)| match self.choice {
                    Choice::Smallest => (ball.radius, number) < (known.radius, b),
                    Choice::First => number < b,
                });
                if better {
                    best = Some((number, ball));
                }
            }
        }
        best
    }
}

/// Centres and radii from the members: the middle of their box, or the sphere that grew where that
/// is smaller.
fn settled(points: &[Vec3], of_leaf: &[u32], balls: &[Ball]) -> Vec<Cluster> {
    let far = Vec3::splat(f32::INFINITY);
    let mut boxes = vec![(far, -far, 0_u32); balls.len()];
    for (&p, &c) in points.iter().zip(of_leaf) {
        let b = &mut boxes[c as usize];
        *b = (b.0.min(p), b.1.max(p), b.2 + 1);
    }
    let centres = boxes.iter().map(|b| 0.5 * (b.0 + b.1));
    let candidates: Vec<[Vec3; 2]> = centres
        .zip(balls)
        .map(|(c, ball)| [c, ball.centre.as_vec3()])
        .collect();
    let mut reach = vec![[0.0_f32; 2]; balls.len()];
    for (&p, &c) in points.iter().zip(of_leaf) {
        for (r, centre) in reach[c as usize].iter_mut().zip(candidates[c as usize]) {
            *r = r.max(p.distance(centre));
        }
    }
    let settle = |cluster: usize| {
        let reach = reach[cluster];
        let which = usize::from(reach[1] < reach[0]);
        Cluster {
            centre: candidates[cluster][which],
            radius: reach[which],
            leaves: boxes[cluster].2,
        }
    };
    (0..balls.len()).map(settle).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cloud(count: usize, seed: u32) -> Vec<Vec3> {
        let mut state = seed.wrapping_mul(747_796_405).wrapping_add(1);
        let mut next = || {
            state ^= state << 13;
            state ^= state >> 17;
            state ^= state << 5;
            state as f32 / u32::MAX as f32
        };
        (0..count)
            .map(|_| Vec3::new(next(), next(), next()))
            .collect()
    }

    fn check(points: &[Vec3], largest: f32, found: &Clusters) {
        assert_eq!(
            found.of_leaf.len(),
            points.len(),
            "each leaf in one cluster"
        );
        let mut members = vec![0; found.len()];
        for (&p, &c) in points.iter().zip(&found.of_leaf) {
            let cluster = found.clusters[c as usize];
            assert!(p.distance(cluster.centre) <= cluster.radius, "held");
            members[c as usize] += 1;
        }
        for (cluster, members) in found.clusters.iter().zip(members) {
            assert_eq!(cluster.leaves, members, "counted");
            // The sphere grew in f64 within the largest radius; its rounding to f32 is all there is.
            let rounding = 1e-6 * (largest + cluster.centre.length());
            assert!(cluster.radius <= largest + rounding, "within the radius");
        }
    }

    #[test]
    fn clusters_hold_their_leaves_within_the_radius() {
        for (count, largest) in [(1, 0.1), (2, 0.6), (3000, 0.05), (3000, 0.2), (500, 10.0)] {
            let points = cloud(count, 3);
            for choice in [Choice::Smallest, Choice::First] {
                let found = Clusters::new(&points, largest, choice).unwrap();
                check(&points, largest, &found);
                assert_eq!(
                    found,
                    Clusters::new(&points, largest, choice).unwrap(),
                    "again the same"
                );
            }
        }
    }

    #[test]
    fn all_leaves_of_a_small_plant_are_one_cluster_and_far_ones_their_own() {
        let points = cloud(100, 7);
        assert_eq!(
            Clusters::new(&points, 2.0, Choice::Smallest).unwrap().len(),
            1
        );
        let apart: Vec<_> = (0..50).map(|i| Vec3::X * i as f32).collect();
        assert_eq!(
            Clusters::new(&apart, 0.4, Choice::Smallest).unwrap().len(),
            50
        );
    }

    #[test]
    fn a_leaf_joins_the_cluster_that_ends_smallest_or_the_oldest() {
        // Two clusters at 0 and 1; the third leaf is nearer to the younger one.
        let points = [Vec3::ZERO, Vec3::X, Vec3::X * 0.6];
        let smallest = Clusters::new(&points, 0.45, Choice::Smallest).unwrap();
        assert_eq!(smallest.of_leaf, [0, 1, 1]);
        let first = Clusters::new(&points, 0.45, Choice::First).unwrap();
        assert_eq!(first.of_leaf, [0, 1, 0]);
    }

    #[test]
    fn coincident_leaves_and_wrong_numbers_are_seen_to() {
        let same = vec![Vec3::splat(5e6); 1000];
        let found = Clusters::new(&same, 0.1, Choice::Smallest).unwrap();
        assert_eq!((found.len(), found.clusters[0].radius), (1, 0.0));
        assert!(Clusters::new(&[], 1.0, Choice::First).unwrap().is_empty());
        assert!(Clusters::new(&same, 0.0, Choice::First).is_err());
        assert!(Clusters::new(&same, f32::NAN, Choice::First).is_err());
        assert!(Clusters::new(&[Vec3::NAN], 1.0, Choice::First).is_err());
        // A radius that is nothing against the extent makes cells that still fit integers.
        let wide = [Vec3::ZERO, Vec3::splat(1e6)];
        assert_eq!(Clusters::new(&wide, 1e-9, Choice::First).unwrap().len(), 2);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]
        #[test]
        fn clusters_keep_their_promises(seed in any::<u32>(), scale in -3.0..6.0_f32, part in 0.01..1.0_f32) {
            let scale = 10.0_f32.powf(scale);
            let points: Vec<_> = cloud(200, seed).iter().map(|p| *p * scale).collect();
            let found = Clusters::new(&points, part * scale, Choice::Smallest).unwrap();
            check(&points, part * scale, &found);
        }
    }
}
