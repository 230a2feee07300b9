//! Subsets of the generators against their twin: the same voxels and the same draws, so that
//! every generator that is left is compared.

use glam::DVec3;

use super::{Case, Outcome};
use crate::Result;
use crate::foliage::probe_field as probe;
use crate::foliage::{Sampling, Settings};
use crate::gpu::Gpu;
use crate::math::sampling::uniform;
use crate::reference::generators::Generator;
use crate::reference::subset::{Subset, subset};

/// Rounding of a position to f32, and a few steps of its sums, in diagonals.
const LIMIT: f64 = 2e-7;

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let mut add = |name, run| cases.push(Case { name, run });
    add("foliage.subset.stratified", |gpu| {
        both(gpu, &cloud(3000), &[0.5, 0.25, 0.1], Sampling::Stratified)
    });
    add("foliage.subset.plain", |gpu| {
        both(gpu, &cloud(3000), &[0.5, 0.25, 0.1], Sampling::Plain)
    });
    add("foliage.subset.merged", |gpu| {
        both(gpu, &tufts(700, 8), &[0.125], Sampling::Stratified)
    });
    add("foliage.subset.least", |gpu| {
        let cloud = cloud(500);
        let stratified = both(gpu, &cloud, &[1e-9], Sampling::Stratified)?;
        Ok(worse(
            stratified,
            both(gpu, &cloud, &[1e-9], Sampling::Plain)?,
        ))
    });
    add("foliage.subset.all", |gpu| {
        let cloud = cloud(500);
        let stratified = both(gpu, &cloud, &[0.999, 1.0], Sampling::Stratified)?;
        Ok(worse(
            stratified,
            both(gpu, &cloud, &[0.999, 1.0], Sampling::Plain)?,
        ))
    });
    add("foliage.subset.one", |gpu| {
        let stratified = both(gpu, &cloud(1), &[0.5], Sampling::Stratified)?;
        Ok(worse(
            stratified,
            both(gpu, &cloud(1), &[0.5], Sampling::Plain)?,
        ))
    });
    add("foliage.subset.coincident", |gpu| {
        let point = ([0.1, -0.2, 0.3, 1.0], 1e-4);
        both(gpu, &vec![point; 70_000], &[0.5], Sampling::Stratified)
    });
    add("foliage.subset.corners", |gpu| {
        let corner = |i: u32| {
            let side = |axis: u32| if i >> axis & 1 == 0 { -0.5 } else { 0.5 };
            ([side(0), side(1), side(2), 1.0], 0.5)
        };
        let corners: Vec<_> = (0..8).map(corner).collect();
        both(gpu, &corners, &[0.9, 0.3, 0.1], Sampling::Stratified)
    });
    cases
}

type Point = ([f32; 4], f32);

/// Seeded generators of very different areas.
fn cloud(count: u32) -> Vec<Point> {
    let point = |i: u32| {
        let along = |k: u32| (uniform(13, 4 * i + k) - 0.5) as f32;
        let area = 10f32.powf(-9.0 + 7.0 * uniform(13, 4 * i + 3) as f32);
        ([0.9 * along(0), along(1), 0.4 * along(2), 1.0], area)
    };
    (0..count).map(point).collect()
}

/// Tufts of generators that are far closer to each other than to the next tuft.
fn tufts(count: u32, each: u32) -> Vec<Point> {
    let centres = cloud(count);
    let point = |i: u32| {
        let ([x, y, z, w], area) = centres[(i % count) as usize];
        let near = |k: u32| 1e-5 * uniform(17, 3 * i + k) as f32;
        ([x + near(0), y + near(1), z + near(2), w], area)
    };
    (0..count * each).map(point).collect()
}

fn worse(a: Outcome, b: Outcome) -> Outcome {
    if a.passed() { b } else { a }
}

/// The largest difference; that of the last of `fractions`, or of the first that fails.
fn both(gpu: &Gpu, all: &[Point], fractions: &[f32], sampling: Sampling) -> Result<Outcome> {
    let (centres, areas): (Vec<[f32; 4]>, Vec<f32>) = all.iter().copied().unzip();
    let widened: Vec<Generator> = all.iter().map(widen).collect();
    let method = match sampling {
        Sampling::Stratified => Subset::Stratified,
        Sampling::Plain => Subset::Plain,
    };
    let mut outcome = None;
    for (&fraction, seed) in fractions.iter().zip(1..) {
        let settings = Settings {
            fraction,
            most_generators: u32::MAX,
            sampling,
            seed,
            ..Settings::default()
        };
        let got = probe::subset(gpu, (&centres, &areas), &settings)?;
        let expected = subset(&widened, f64::from(fraction), method, seed);
        let measure = (LIMIT, "diagonals, share of weight and area");
        let one = Outcome::worst((&got, &expected), difference, measure);
        outcome = Some(match outcome {
            Some(before) => worse(before, one),
            None => one,
        });
    }
    Ok(outcome.expect("a fraction at least"))
}

fn widen(point: &Point) -> Generator {
    let [x, y, z, w] = point.0.map(f64::from);
    Generator {
        position: DVec3::new(x, y, z),
        weight: w,
        area: f64::from(point.1),
    }
}

fn difference(got: &Point, expected: &Generator) -> f64 {
    let got = widen(got);
    let far = got.position.distance(expected.position);
    let weight = (got.weight / expected.weight - 1.0).abs();
    // Areas are sums of multiples of 2^-44.
    let area = (got.area - expected.area).abs() / (expected.area + 1e-4);
    far.max(weight).max(area)
}
