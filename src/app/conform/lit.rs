//! The second pass of lit pictures.

use glam::DVec3;

use super::{Case, Outcome};
use crate::Result;
use crate::abi::{LeafSides, LitFrame};
use crate::gpu::shaders::leaf as shaders;
use crate::gpu::{Binding, Format, Gpu, Image, ImageInfo, QueueKind, SamplerInfo};
use crate::math::sampling::{fibonacci_sphere, uniform};
use crate::reference::lit::{Pixel, lit_sun};

/// Pixels along an edge.
pub(super) const SIZE: u32 = 12;

/// A camera and a sun.
pub(super) const FRAME: LitFrame = LitFrame {
    relative_to_clip: [[0.0; 4]; 4],
    forward: [0.0, 0.0, -1.0],
    width: SIZE,
    right: [0.4, 0.0, 0.0],
    height: SIZE,
    up: [0.0, 0.3, 0.0],
    near: 0.1,
    eye: [0.1, 0.2, 1.5],
    // A unit vector: (0.3, 0.8, 0.5) over its length.
    sun: [0.303_045_76, 0.808_122_04, 0.505_076_3],
    irradiance: [3.0, 2.8, 2.5],
};

/// Two materials and their gloss.
pub(super) const LEAVES: ([LeafSides; 2], [[f32; 4]; 2]) = (
    [
        LeafSides {
            rho_d_front: [0.1, 0.2, 0.05],
            rho_d_back: [0.2, 0.3, 0.1],
            rho_t: [0.15, 0.25, 0.02],
        },
        LeafSides {
            rho_d_front: [0.5, 0.4, 0.3],
            rho_d_back: [0.3, 0.4, 0.5],
            rho_t: [0.2, 0.1, 0.3],
        },
    ],
    [[0.0, 0.0, 0.0, 0.3], [0.05, 0.04, 0.06, 0.15]],
);

pub(super) fn cases() -> Vec<Case> {
    vec![Case {
        name: "light.lit_sun",
        run,
    }]
}

/// Random surfaces under one sun, dull and glossy, seen from either side.
fn run(gpu: &Gpu) -> Result<Outcome> {
    let (frame, (leaves, gloss)) = (FRAME, LEAVES);
    let count = SIZE * SIZE;
    let (mut light, mut surface, mut material) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..count {
        let u = |k: u32| uniform(21, 8 * i + k) as f32;
        let n = fibonacci_sphere(i * 7 % count, count).as_vec3();
        let side = if n.z > 0.0 { 1.0 } else { -1.0 };
        // Every ninth says another side than its normal does: a rim.
        let side = if i % 9 == 0 { -side } else { side };
        light.push([u(0), u(1), u(2), if i % 11 == 0 { 0.0 } else { 1.0 }]);
        surface.push([n.x, n.y, n.z, side * (1.0 + u(3))]);
        material.push([0.5 + u(4), 0.5 + u(5), 0.5 + u(6), (i % 2) as f32]);
    }
    let found = draw(
        gpu,
        &frame,
        (&leaves, &gloss),
        [&light, &surface, &material],
    )?;
    let mut error = 0.0_f64;
    for i in 0..count as usize {
        let [l, s, m] = [light[i], surface[i], material[i]];
        let wide = |v: [f32; 4]| DVec3::new(v[0].into(), v[1].into(), v[2].into());
        let expected = if l[3] > 0.0 {
            let pixel = Pixel {
                light: wide(l),
                normal: wide(s).normalize(),
                surface: s[3].into(),
                tint: wide(m),
            };
            let at = (i as u32 % SIZE, i as u32 / SIZE);
            let own = m[3] as usize;
            lit_sun(&frame, at, &pixel, (&leaves[own], gloss[own]))
        } else {
            wide(l)
        };
        error = error.max((expected - wide(found[i])).abs().max_element());
    }
    Ok(Outcome {
        error,
        limit: 1e-4,
        measure: "light",
    })
}

fn draw(
    gpu: &Gpu,
    frame: &LitFrame,
    (leaves, gloss): (&[LeafSides], &[[f32; 4]]),
    maps: [&[[f32; 4]]; 3],
) -> Result<Vec<[f32; 4]>> {
    let frame = gpu.upload("lit frame", &[*frame])?;
    let leaves = gpu.upload("leaf sides", leaves)?;
    let gloss = gpu.upload("gloss", gloss)?;
    let sampler = gpu.sampler(&SamplerInfo::default())?;
    let [light, surface, material] = [map(gpu, maps[0])?, map(gpu, maps[1])?, map(gpu, maps[2])?];
    let info = ImageInfo::storage("lit picture", Format::Rgba32Float, [SIZE; 2]);
    let picture = gpu.image(info)?;
    let kernel = gpu.compute_pipeline(shaders::LIT_SUN_COMP)?;
    let mut work = gpu.work(QueueKind::Graphics, "lit picture")?;
    work.compute(
        "sun",
        &kernel,
        &[
            Binding::Read(&frame),
            Binding::Read(&leaves),
            Binding::Read(&gloss),
            Binding::Sampled(&light, &sampler),
            Binding::Sampled(&surface, &sampler),
            Binding::Sampled(&material, &sampler),
            Binding::StorageWrite(&picture),
        ],
        &(),
        [SIZE, SIZE, 1],
    )?;
    let read = work.read_image("lit picture", &picture)?;
    let mut done = work.submit()?.wait()?;
    Ok(bytemuck::pod_collect_to_vec(&done.take(read)))
}

/// An image of one value a pixel.
pub(super) fn map(gpu: &Gpu, texels: &[[f32; 4]]) -> Result<Image> {
    let info = ImageInfo::texture("lit map", Format::Rgba32Float, [SIZE; 2], 1);
    let image = gpu.image(info)?;
    let mut work = gpu.work(QueueKind::Transfer, "lit map")?;
    work.upload_image("lit map", &image, &[bytemuck::cast_slice(texels)])?;
    work.submit()?.wait()?;
    Ok(image)
}
