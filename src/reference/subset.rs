//! A fraction of the generators (Luft, Balzer, Deussen 2007, section 3.1).
//!
//! Twin of `shaders/foliage/subset_*.comp`. Positions are normalised: between -1/2 and 1/2.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;

use super::generators::Generator;
use crate::math::sampling::uniform;

/// How a fraction of the generators is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subset {
    /// Those of one voxel become one at their mean, weights and areas added up.
    Stratified,
    /// Every generator is kept with equal probability; weight and area are divided by it.
    Plain,
}

/// Lattice steps of the frame's diagonal.
const STEPS: f64 = 1_048_576.0;

/// Numbers of voxel sizes: each is 2^(1/128) times the one before, from 1/4096 of the diagonal to
/// four diagonals.
const SIZES: i32 = 14 * 128;

/// A subset of about `fraction` of the generators (0 < fraction <= 1), never empty unless `all` is.
#[must_use]
pub fn subset(all: &[Generator], fraction: f64, method: Subset, seed: u32) -> Vec<Generator> {
    if fraction >= 1.0 || all.len() < 2 {
        return all.to_vec();
    }
    match method {
        Subset::Plain => plain(all, fraction, seed),
        Subset::Stratified => {
            let target = (fraction * all.len() as f64).round().max(1.0) as usize;
            Voxels::few_enough(all, target, seed).merge(all)
        }
    }
}

fn plain(all: &[Generator], fraction: f64, seed: u32) -> Vec<Generator> {
    let drawn: Vec<f64> = (0..all.len() as u32).map(|i| uniform(seed, i)).collect();
    // Where nobody draws a number below the fraction, the least number is kept.
    let least = drawn.iter().copied().fold(1.0, f64::min);
    let mut kept = Vec::new();
    for (g, number) in all.iter().zip(drawn) {
        if number < fraction || number == least {
            kept.push(Generator {
                position: g.position,
                weight: g.weight / fraction,
                area: g.area / fraction,
            });
        }
    }
    kept
}

/// Cubes of one size over the lattice.
#[derive(Debug, Clone, Copy)]
struct Voxels {
    /// Edge in lattice steps, a whole number.
    edge: f64,
    /// Where they begin, in lattice steps: less than half an edge before the frame.
    shift: DVec3,
}

impl Voxels {
    fn new(size: i32, seed: u32) -> Self {
        let edge = (256.0 * (f64::from(size) / 128.0).exp2()).round();
        let shift = [0, 1, 2].map(|axis| {
            let share = (1024.0 * uniform(seed, axis)).floor() / 2048.0;
            (share * edge).floor()
        });
        Self {
            edge,
            shift: shift.into(),
        }
    }

    /// The size found by halving the sizes between those too small and those large enough.
    fn few_enough(all: &[Generator], target: usize, seed: u32) -> Self {
        let (mut too_small, mut enough) = (-1, SIZES);
        while enough - too_small > 1 {
            // The device halves what is left of its interval, whose lower end is still open.
            let middle = (too_small + 1 + enough).div_euclid(2);
            let occupied: BTreeSet<[i64; 3]> = {
                let voxels = Self::new(middle, seed);
                all.iter().map(|g| voxels.of(g.position)).collect()
            };
            if occupied.len() > target {
                too_small = middle;
            } else {
                enough = middle;
            }
        }
        Self::new(enough, seed)
    }

    fn of(&self, position: DVec3) -> [i64; 3] {
        let lattice = (STEPS * position).floor() + 0.5 * STEPS;
        let inside = lattice.clamp(DVec3::ZERO, DVec3::splat(STEPS));
        ((inside + self.shift) / self.edge)
            .floor()
            .to_array()
            .map(|c| c as i64)
    }

    /// Every voxel's generators as one, in the order of the first of each.
    fn merge(&self, all: &[Generator]) -> Vec<Generator> {
        let mut members: BTreeMap<[i64; 3], Vec<usize>> = BTreeMap::new();
        for (i, g) in all.iter().enumerate() {
            members.entry(self.of(g.position)).or_default().push(i);
        }
        let mut groups: Vec<Vec<usize>> = members.into_values().collect();
        groups.sort_by_key(|group| group[0]);
        let one = |group: &Vec<usize>| {
            let sum = |of: fn(&Generator) -> f64| group.iter().map(|&i| of(&all[i])).sum::<f64>();
            let weight = sum(|g| g.weight);
            let moment: DVec3 = group.iter().map(|&i| all[i].weight * all[i].position).sum();
            Generator {
                position: moment / weight,
                weight,
                area: sum(|g| g.area),
            }
        };
        groups.iter().map(one).collect()
    }
}
