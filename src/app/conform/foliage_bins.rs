//! Sorting into bins against its twin: every kernel that adds generators relies on its order.

use glam::{DVec3, Vec3};

use super::{Case, Outcome};
use crate::Result;
use crate::foliage::Norm;
use crate::foliage::probe_field::FieldInput;
use crate::gpu::Gpu;
use crate::math::sampling::uniform;
use crate::reference::bins::{Bins, order};

/// Edges by which a point may lie outside its bin: coordinates are f32.
const LIMIT: f64 = 1e-4;

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let mut add = |name, run| cases.push(Case { name, run });
    add("foliage.bins.none", |gpu| sorted(gpu, &[]));
    add("foliage.bins.one", |gpu| {
        sorted(gpu, &[[0.1, 0.0, -0.2, 1.0]])
    });
    add("foliage.bins.cloud", |gpu| {
        let at = |i, axis| uniform(axis, i) as f32 - 0.5;
        let cloud: Vec<_> = (0..5000)
            .map(|i| [at(i, 3), at(i, 4), at(i, 5), 1.0])
            .collect();
        sorted(gpu, &cloud)
    });
    // More in one bin than an invocation may run rounds on a software driver.
    add("foliage.bins.coincident", |gpu| {
        sorted(gpu, &vec![[0.2, 0.1, -0.3, 1.0]; 100_000])
    });
    // Points outside the box, and what is no number, still have a bin and a place.
    add("foliage.bins.outside", |gpu| {
        let far = [
            [9.0, -9.0, 9.0, 1.0],
            [f32::NAN, 0.0, f32::INFINITY, 1.0],
            [-1e30, 1e30, 0.0, 1.0],
        ];
        let binned = input(&far).binned(gpu)?;
        let differing = differing(&binned.bin_of_point, &binned.order);
        let count = binned.bins.iter().product::<u32>();
        let lost = binned.bin_of_point.iter().filter(|&&b| b >= count).count();
        Ok(Outcome::new(
            (differing + lost) as f64,
            0.0,
            "differing places",
        ))
    });
    cases
}

fn input(points: &[[f32; 4]]) -> FieldInput<'_> {
    FieldInput {
        generators: points,
        radius: 0.1,
        norm: Norm::Euclidean,
        half: DVec3::splat(0.5),
    }
}

/// Places where `got` is not the stable order.
fn differing(bin_of_point: &[u32], got: &[u32]) -> usize {
    let expected = order(bin_of_point);
    let unequal = expected.iter().zip(got).filter(|(a, b)| a != b).count();
    unequal + expected.len().abs_diff(got.len())
}

fn sorted(gpu: &Gpu, points: &[[f32; 4]]) -> Result<Outcome> {
    let binned = input(points).binned(gpu)?;
    let wrong =
        differing(&binned.bin_of_point, &binned.order) + points.len() - binned.bin_of_point.len();
    if wrong > 0 {
        return Ok(Outcome::new(wrong as f64, 0.0, "differing places"));
    }
    let bins = Bins {
        origin: Vec3::from(binned.origin).as_dvec3(),
        edge: f64::from(binned.edge),
        bins: binned.bins,
    };
    Ok(Outcome::worst(
        (points, &binned.bin_of_point),
        |p, &bin| bins.outside(Vec3::new(p[0], p[1], p[2]).as_dvec3(), bin),
        (LIMIT, "edges outside the bin"),
    ))
}
