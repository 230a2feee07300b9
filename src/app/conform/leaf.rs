//! Leaf appearance: the slab table, the shares of texels, the glossy term.

use glam::DVec3;

use super::{Case, Outcome};
use crate::Result;
use crate::abi::{GlossyQueries, LeafTissue};
use crate::gpu::shaders::leaf as shaders;
use crate::gpu::{Binding, BufferInfo, Gpu, QueueKind};
use crate::leaf::{Mode, Side, SlabTable};
use crate::math::sampling::uniform;
use crate::reference::leaf_albedo::leaf_albedo;
use crate::reference::leaf_glossy;

pub(super) fn cases() -> Vec<Case> {
    vec![
        Case {
            name: "leaf.albedo.exact",
            run: |gpu| albedo(gpu, Mode::Exact),
        },
        Case {
            name: "leaf.albedo.paper",
            run: |gpu| albedo(gpu, Mode::Paper),
        },
        Case {
            name: "leaf.albedo.extremes",
            run: extremes,
        },
        Case {
            name: "leaf.glossy.paper",
            run: |gpu| glossy(gpu, false),
        },
        Case {
            name: "leaf.glossy.safe",
            run: |gpu| glossy(gpu, true),
        },
    ]
}

/// Texels of every thickness and gamma.
fn texels(count: u32) -> Vec<[f32; 4]> {
    (0..count)
        .map(|i| {
            let u = |k: u32| uniform(41, 4 * i + k) as f32;
            [2.0 * u(0), 2.0 * u(1), 2.0 * u(2), 6.0 * u(3).powi(3) - 1.0]
        })
        .collect()
}

fn albedo(gpu: &Gpu, mode: Mode) -> Result<Outcome> {
    let texels = texels(4001);
    let mut worst = 0.0;
    // Birch above and below, and one that only scatters.
    for (absorption, scattering) in [
        ([1.9, 1.74, 3.9], [0.87, 1.02, 1.1]),
        ([0.4, 0.05, 2.5], [3.0, 2.9, 1.0]),
        ([0.0, 1e-4, 9.0], [1.8, 40.0, 1e-3]),
    ] {
        let side = Side::of_tissue(absorption, scattering, 1.0);
        let tissue = side.tissue(1.0, mode, texels.len() as u32);
        worst = largest(worst, compare(gpu, &tissue, &texels)?);
    }
    Ok(Outcome {
        error: worst,
        limit: 2e-5,
        measure: "share of the light",
    })
}

/// Albedo 0 and 1, thickness 0 to 1e4, a tissue that is not there.
fn extremes(gpu: &Gpu) -> Result<Outcome> {
    let texels: Vec<[f32; 4]> = [-1.0, -0.9999, -0.99, -0.5, 0.0, 1.0, 99.0]
        .iter()
        .flat_map(|&d| [0.0, 1.0, 50.0].map(|g| [g, g, g, d]))
        .collect();
    let mut worst = 0.0;
    for scale in [1e-4_f32, 1e-2, 1.0, 30.0, 100.0] {
        let tissue = LeafTissue {
            absorption: [0.0, scale, 1e-6 * scale],
            scattering: [scale, 0.0, scale],
            mode: crate::abi::LEAF_EXACT,
            count: texels.len() as u32,
            ..LeafTissue::default()
        };
        worst = largest(worst, compare(gpu, &tissue, &texels)?);
    }
    let nothing = LeafTissue {
        mode: crate::abi::LEAF_EXACT,
        count: texels.len() as u32,
        ..LeafTissue::default()
    };
    worst = largest(worst, compare(gpu, &nothing, &texels)?);
    Ok(Outcome {
        error: worst,
        limit: 5e-5,
        measure: "share of the light",
    })
}

fn compare(gpu: &Gpu, tissue: &LeafTissue, texels: &[[f32; 4]]) -> Result<f64> {
    let table = SlabTable::shared().coefficients();
    let coefficients = gpu.upload("slab table", table)?;
    let maps = gpu.upload("leaf maps", texels)?;
    let bytes = 12 * texels.len() as u64;
    let back = gpu.buffer(BufferInfo::device("rho_d", bytes))?;
    let through = gpu.buffer(BufferInfo::device("rho_t", bytes))?;
    let pipeline = gpu.compute_pipeline(shaders::ALBEDO_COMP)?;
    let mut work = gpu.work(QueueKind::Compute, "leaf albedo")?;
    work.compute(
        "leaf albedo",
        &pipeline,
        &[
            Binding::Read(&coefficients),
            Binding::Read(&maps),
            Binding::Write(&back),
            Binding::Write(&through),
        ],
        tissue,
        [tissue.count, 1, 1],
    )?;
    let back = work.read::<[f32; 3]>("rho_d", &back)?;
    let through = work.read::<[f32; 3]>("rho_t", &through)?;
    let mut done = work.submit()?.wait()?;
    let (back, through) = (done.take(back), done.take(through));
    let mut worst = 0.0;
    for (i, texel) in texels.iter().enumerate() {
        let expected = leaf_albedo(table, tissue, *texel);
        for c in 0..3 {
            for (e, f) in [
                (expected[0][c], back[i][c]),
                (expected[1][c], through[i][c]),
            ] {
                // Reflectances above 1 (the paper's) are compared relative to themselves.
                worst = largest(worst, (e - f64::from(f)).abs() / e.max(1.0));
            }
        }
    }
    Ok(worst)
}

/// Directions over the hemisphere and near grazing, several roughnesses.
fn glossy(gpu: &Gpu, safe: bool) -> Result<Outcome> {
    let mut queries = Vec::new();
    let mut expected = Vec::new();
    for i in 0..3000u32 {
        let u = |k: u32| uniform(43, 8 * i + k);
        let direction = |a: f64, b: f64| {
            let z = if i % 3 == 0 {
                0.02 * a + 1e-4
            } else {
                a.max(1e-4)
            };
            let r = (1.0 - z * z).max(0.0).sqrt();
            let (s, c) = (std::f64::consts::TAU * b).sin_cos();
            DVec3::new(r * c, r * s, z)
        };
        let (to_light, to_viewer) = (direction(u(0), u(1)), direction(u(2), u(3)));
        let m = 0.05 + 0.95 * u(4);
        let half = (to_light + to_viewer).normalize();
        // The twin takes what the device gets, rounded to f32, where it can.
        queries.push([to_light.z, to_viewer.z, half.z, m].map(|v| v as f32));
        expected.push(leaf_glossy::glossy(to_light, to_viewer, m, safe));
    }
    // Below the surface: nothing.
    for q in [
        [-0.1, 0.5, 0.3, 0.3],
        [0.5, 0.0, 0.3, 0.3],
        [0.5, 0.5, -0.1, 0.3],
    ] {
        queries.push(q);
        expected.push(0.0);
    }
    let input = gpu.upload("directions", &queries)?;
    let output = gpu.buffer(BufferInfo::device("glossy", 4 * queries.len() as u64))?;
    let pipeline = gpu.compute_pipeline(shaders::GLOSSY_COMP)?;
    let push = GlossyQueries {
        count: queries.len() as u32,
        safe: u32::from(safe),
    };
    let mut work = gpu.work(QueueKind::Compute, "glossy")?;
    work.compute(
        "glossy",
        &pipeline,
        &[Binding::Read(&input), Binding::Write(&output)],
        &push,
        [push.count, 1, 1],
    )?;
    let output = work.read::<f32>("glossy", &output)?;
    let found = work.submit()?.wait()?.take(output);
    let errors = expected
        .iter()
        .zip(found)
        .map(|(e, f)| (e - f64::from(f)).abs() / (e + 0.01));
    Ok(Outcome {
        error: errors.fold(0.0, largest),
        // The rounding of cos_half to f32 alone is 2 tan / (m^2 cos^2) times 6e-8.
        limit: 1e-4,
        measure: "relative, above 0.01 / sr",
    })
}

/// The larger value; NaN wins.
fn largest(a: f64, b: f64) -> f64 {
    if b.is_nan() || b > a { b } else { a }
}
