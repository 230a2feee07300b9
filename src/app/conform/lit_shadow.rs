//! The sun by a shadow map.

use glam::{DVec3, Vec3};

use super::lit::{FRAME, SIZE, Surfaces, map, wide};
use super::{Case, Outcome};
use crate::Result;
use crate::abi::ShadowView;
use crate::gpu::shaders::leaf as shaders;
use crate::gpu::{Binding, Format, Gpu, ImageInfo, QueueKind};
use crate::leaf::shadow_map::{ShadowSettings, view};
use crate::math::sampling::uniform;
use crate::reference::lit::{leaf_for_light, leaf_scatters, position_of_pixel, to_eye_of_pixel};
use crate::reference::lit_shadow::shadow_visibility;

/// Where f32 and f64 may differ: texels, and shares of the map's depth.
const SLACK: f64 = 2e-4;

pub(super) fn cases() -> Vec<Case> {
    vec![Case {
        name: "light.lit_shadow",
        run,
    }]
}

/// Random surfaces over a map of random depths; pixels whose answer hangs on rounding may differ by
/// the points that do.
fn run(gpu: &Gpu) -> Result<Outcome> {
    let count = SIZE * SIZE;
    let u = |seed: u32, i: u32| uniform(seed, i) as f32;
    let corners: Vec<Vec3> = (0..8u32)
        .map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.4 - 1.2)
        .collect();
    let settings = ShadowSettings {
        size: SIZE,
        radius: 1.5,
    };
    let sun = DVec3::from(FRAME.sun.map(f64::from)).normalize();
    let view = view(sun, &corners, settings);
    let texels: Vec<f32> = (0..count).map(|i| u(31, i)).collect();
    let surfaces = Surfaces::new(32, true);
    let near = |i: u32| {
        if i.is_multiple_of(11) {
            0.0
        } else {
            0.05 + 0.15 * u(33, i)
        }
    };
    let depth: Vec<[f32; 4]> = (0..count).map(|i| [near(i), 0.0, 0.0, 0.0]).collect();
    let stored: Vec<[f32; 4]> = texels.iter().map(|&d| [d, 0.0, 0.0, 0.0]).collect();
    let found = draw(gpu, view, &surfaces, [&depth, &stored])?;
    let mut error = 0.0_f64;
    for i in 0..count as usize {
        let (mut expected, mut unsure) = (DVec3::ZERO, DVec3::ZERO);
        if depth[i][0] > 0.0 {
            let (pixel, turns) = surfaces.pixel(i);
            let at = (i as u32 % SIZE, i as u32 / SIZE);
            let to_eye = to_eye_of_pixel(&FRAME, at, pixel.normal, pixel.surface);
            let place = position_of_pixel(&FRAME, at, depth[i][0].into());
            let cosine = pixel.normal.dot(sun);
            let (seen, hangs) = shadow_visibility((&view, &texels), place, cosine, SLACK);
            let leaf = leaf_for_light(&pixel.leaf, turns, cosine);
            let light = leaf_scatters(&leaf, pixel.shine, pixel.normal, (sun, to_eye))
                * DVec3::from(FRAME.irradiance.map(f64::from));
            expected = light * seen;
            unsure = light * f64::from(hangs) / f64::from(crate::abi::LIT_SHADOW_TAPS);
        }
        let off = (expected - wide(found[i])).abs() - unsure;
        error = error.max(off.max_element());
    }
    Ok(Outcome {
        error,
        limit: 1e-4,
        measure: "light",
    })
}

fn draw(
    gpu: &Gpu,
    view: ShadowView,
    surfaces: &Surfaces,
    maps: [&[[f32; 4]]; 2],
) -> Result<Vec<[f32; 4]>> {
    let frame = gpu.upload("lit frame", &[FRAME])?;
    let view = gpu.upload("shadow view", &[view])?;
    let device = surfaces.upload(gpu)?;
    let (depth, stored) = (map(gpu, maps[0])?, map(gpu, maps[1])?);
    let info = ImageInfo::storage("lit picture", Format::Rgba32Float, [SIZE; 2]);
    let picture = gpu.image(info)?;
    let kernel = gpu.compute_pipeline_with(shaders::LIT_SHADOW_COMP, &device.constants)?;
    let black = vec![[0.0_f32; 4]; (SIZE * SIZE) as usize];
    let mut work = gpu.work(QueueKind::Graphics, "lit picture")?;
    work.upload_image("black", &picture, &[bytemuck::cast_slice(&black)])?;
    work.compute(
        "sun by shadow map",
        &kernel,
        &[
            Binding::Read(&frame),
            Binding::Read(&device.turns),
            Binding::Read(&view),
            Binding::Sampled(&device.surface, &device.sampler),
            Binding::Sampled(&device.leaf, &device.sampler),
            Binding::Sampled(&device.shine, &device.sampler),
            Binding::Sampled(&depth, &device.sampler),
            Binding::Sampled(&stored, &device.sampler),
            Binding::StorageReadWrite(&picture),
        ],
        &(),
        [SIZE, SIZE, 1],
    )?;
    let read = work.read_image("lit picture", &picture)?;
    let mut done = work.submit()?.wait()?;
    Ok(bytemuck::pod_collect_to_vec(&done.take(read)))
}
