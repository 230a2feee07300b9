//! The sun by a shadow map.

use glam::{DVec3, Vec3};

use super::lit::{FRAME, LEAVES, SIZE, map};
use super::{Case, Outcome};
use crate::Result;
use crate::abi::ShadowView;
use crate::gpu::shaders::leaf as shaders;
use crate::gpu::{Binding, Format, Gpu, ImageInfo, QueueKind, SamplerInfo};
use crate::leaf::shadow_map::{ShadowSettings, view};
use crate::math::sampling::{fibonacci_sphere, uniform};
use crate::reference::lit::{leaf_scatters, position_of_pixel, to_eye_of_pixel};
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
    let (mut surface, mut material, mut depth) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..count {
        let n = fibonacci_sphere(i * 7 % count, count).as_vec3();
        surface.push([n.x, n.y, n.z, n.z.signum() * 1.5]);
        let tint = [0, 1, 2].map(|k| 0.5 + u(32, 3 * i + k));
        material.push([tint[0], tint[1], tint[2], (i % 2) as f32]);
        depth.push([
            if i % 11 == 0 {
                0.0
            } else {
                0.05 + 0.15 * u(33, i)
            },
            0.0,
            0.0,
            0.0,
        ]);
    }
    let wide: Vec<[f32; 4]> = texels.iter().map(|&d| [d, 0.0, 0.0, 0.0]).collect();
    let found = draw(gpu, view, [&surface, &material, &depth, &wide])?;
    let mut error = 0.0_f64;
    for i in 0..count as usize {
        let vector = |v: [f32; 4]| DVec3::new(v[0].into(), v[1].into(), v[2].into());
        let (mut expected, mut unsure) = (DVec3::ZERO, DVec3::ZERO);
        if depth[i][0] > 0.0 {
            let at = (i as u32 % SIZE, i as u32 / SIZE);
            let normal = vector(surface[i]).normalize();
            let to_eye = to_eye_of_pixel(&FRAME, at, normal, surface[i][3].into());
            let place = position_of_pixel(&FRAME, at, depth[i][0].into());
            let cosine = normal.dot(sun);
            let (seen, hangs) = shadow_visibility((&view, &texels), place, cosine, SLACK);
            let own = material[i][3] as usize;
            let leaf = (&LEAVES.0[own], LEAVES.1[own]);
            let light = leaf_scatters(leaf.0, leaf.1, normal, (sun, to_eye))
                * DVec3::from(FRAME.irradiance.map(f64::from))
                * vector(material[i]);
            expected = light * seen;
            unsure = light * f64::from(hangs) / f64::from(crate::abi::LIT_SHADOW_TAPS);
        }
        let off = (expected - vector(found[i])).abs() - unsure;
        error = error.max(off.max_element());
    }
    Ok(Outcome {
        error,
        limit: 1e-4,
        measure: "light",
    })
}

fn draw(gpu: &Gpu, view: ShadowView, maps: [&[[f32; 4]]; 4]) -> Result<Vec<[f32; 4]>> {
    let frame = gpu.upload("lit frame", &[FRAME])?;
    let leaves = gpu.upload("leaf sides", &LEAVES.0)?;
    let gloss = gpu.upload("gloss", &LEAVES.1)?;
    let view = gpu.upload("shadow view", &[view])?;
    let sampler = gpu.sampler(&SamplerInfo::default())?;
    let images = [
        map(gpu, maps[0])?,
        map(gpu, maps[1])?,
        map(gpu, maps[2])?,
        map(gpu, maps[3])?,
    ];
    let info = ImageInfo::storage("lit picture", Format::Rgba32Float, [SIZE; 2]);
    let picture = gpu.image(info)?;
    let mut bound = vec![
        Binding::Read(&frame),
        Binding::Read(&leaves),
        Binding::Read(&gloss),
        Binding::Read(&view),
    ];
    bound.extend(images.iter().map(|i| Binding::Sampled(i, &sampler)));
    bound.push(Binding::StorageReadWrite(&picture));
    let kernel = gpu.compute_pipeline(shaders::LIT_SHADOW_COMP)?;
    let black = vec![[0.0_f32; 4]; (SIZE * SIZE) as usize];
    let mut work = gpu.work(QueueKind::Graphics, "lit picture")?;
    work.upload_image("black", &picture, &[bytemuck::cast_slice(&black)])?;
    work.compute("sun by shadow map", &kernel, &bound, &(), [SIZE, SIZE, 1])?;
    let read = work.read_image("lit picture", &picture)?;
    let mut done = work.submit()?.wait()?;
    Ok(bytemuck::pod_collect_to_vec(&done.take(read)))
}
