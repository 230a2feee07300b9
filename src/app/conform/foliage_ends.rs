//! The ends of what the kernels are asked: nothing at all, and a threshold of zero.

use glam::DVec3;

use super::{Case, Outcome};
use crate::Result;
use crate::abi;
use crate::foliage::probe::{SurfaceAnswer, SurfaceQuestion, surface};
use crate::foliage::probe_field::{self as probe, FieldInput};
use crate::foliage::{Encoding, NodeGrid, Norm, Primitive, Sampling, Settings, SurfaceNormals};
use crate::gpu::Gpu;
use crate::math::sampling::uniform;

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let mut add = |name, run| cases.push(Case { name, run });
    add("foliage.generators.empty", |gpu| {
        let mut left = 0;
        for &primitive in Primitive::ALL {
            left += probe::generators(gpu, &[], &[], primitive)?.len();
            left += probe::areas(gpu, &[], &[], primitive)?.len();
        }
        nothing(left)
    });
    add("foliage.subset.empty", |gpu| {
        let mut left = 0;
        for &sampling in Sampling::ALL {
            let settings = Settings {
                fraction: 0.5,
                sampling,
                ..Settings::default()
            };
            left += probe::subset(gpu, (&[], &[]), &settings)?.len();
        }
        nothing(left)
    });
    add("foliage.density.empty", |gpu| {
        let grid = NodeGrid::around(HALF, 0.1, 12, 64)?;
        let density = field(&[]).on_grid(gpu, &grid)?;
        let there = density.iter().filter(|&&d| d != 0.0).count();
        nothing(there + density.len().abs_diff(grid.node_count()))
    });
    add("foliage.field.empty", |gpu| {
        let points = points(100);
        let values = field(&[]).at(gpu, &points)?;
        let there = values.iter().filter(|v| **v != [0.0; 4]).count();
        let no_points = field(&points).at(gpu, &[])?.len();
        nothing(there + no_points + values.len().abs_diff(points.len()))
    });
    add("foliage.directions.empty", |gpu| {
        let (single, a) = probe::directions(gpu, abi::DIRECTIONS_SINGLE, (&[], &[]), 0.1)?;
        let (filled, b) = probe::filled_directions(gpu, (&[], &[]), 0.1)?;
        nothing(single.len() + filled.len() + a + b)
    });
    add("foliage.realign.blend.empty", |gpu| {
        nothing(probe::blend(gpu, &[], &[], 0.5)?.len())
    });
    add("foliage.ambient.empty", |gpu| {
        let push = abi::AmbientTransfer::default();
        nothing(probe::transfer(gpu, &[], push)?.len())
    });
    add("foliage.encode.empty", |gpu| {
        let mut left = 0;
        for &encoding in Encoding::ALL {
            left += probe::encode(gpu, encoding, &[], &[])?.len();
        }
        nothing(left)
    });
    add("foliage.surface.empty", |gpu| {
        let answer = ask(gpu, &[], &points(10), 0.3)?;
        nothing(answer.surface.positions.len() + answer.surface.indices.len() + found(&answer))
    });
    add("foliage.nearest.empty", |gpu| {
        let answer = ask(gpu, &points(50), &[], 0.3)?;
        let no_surface = usize::from(answer.surface.indices.is_empty());
        nothing(no_surface + found(&answer))
    });
    add("foliage.realign.tau_zero", tau_zero);
    cases
}

const HALF: DVec3 = DVec3::new(0.3, 0.28, 0.29);

/// Seeded points in the box, of weight 1.
fn points(count: u32) -> Vec<[f32; 4]> {
    let along = |i: u32, k: u32| (HALF[k as usize] * (2.0 * uniform(4, 3 * i + k) - 1.0)) as f32;
    (0..count)
        .map(|i| [along(i, 0), along(i, 1), along(i, 2), 1.0])
        .collect()
}

fn field(generators: &[[f32; 4]]) -> FieldInput<'_> {
    FieldInput {
        generators,
        radius: 0.1,
        norm: Norm::Euclidean,
        half: HALF,
    }
}

fn ask(
    gpu: &Gpu,
    generators: &[[f32; 4]],
    queries: &[[f32; 4]],
    tau: f32,
) -> Result<SurfaceAnswer> {
    surface(
        gpu,
        &SurfaceQuestion {
            generators,
            half: HALF,
            radius: 0.15,
            norm: Norm::Euclidean,
            cells: 24,
            tau,
            normals: SurfaceNormals::Gradient,
            queries,
        },
    )
}

/// Answers to queries.
fn found(answer: &SurfaceAnswer) -> usize {
    let directions = [&answer.vertex, &answer.face, &answer.exact];
    answer.nearest_vertex.len() + directions.iter().map(|d| d.len()).sum::<usize>()
}

/// Of nothing comes nothing.
fn nothing(left: usize) -> Result<Outcome> {
    Ok(Outcome::new(left as f64, 0.0, "results of nothing"))
}

/// With a threshold of zero the surface is the border of the support, where the gradient vanishes
/// and F = 0 has no normal: every mode still gives unit vectors, and `exact` those of `face` where
/// it finds nothing better.
fn tau_zero(gpu: &Gpu) -> Result<Outcome> {
    let queries = points(300);
    let answer = ask(gpu, &points(50), &queries, 0.0)?;
    let modes = [&answer.vertex, &answer.face, &answer.exact];
    let missing = modes.iter().any(|m| m.len() != queries.len());
    let mut error = if missing { f64::NAN } else { 0.0f64 };
    for direction in modes.into_iter().flatten() {
        let [x, y, z, w] = direction.map(f64::from);
        let off = (DVec3::new(x, y, z).length() - 1.0).abs() + (w - 1.0).abs();
        error = if off.is_nan() { off } else { error.max(off) };
        if error.is_nan() {
            break;
        }
    }
    Ok(Outcome::new(error, 1e-5, "length"))
}
