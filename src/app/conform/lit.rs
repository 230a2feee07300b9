//! The second pass of lit pictures.

use glam::DVec3;

use super::{Case, Outcome};
use crate::Result;
use crate::abi::{LEAF_TURN_NODES, LeafSides, LeafTurn, LitFrame};
use crate::gpu::shaders::leaf as shaders;
use crate::gpu::{Binding, Format, Gpu, Image, ImageInfo, QueueKind, Sampler, SamplerInfo};
use crate::math::packing::{f16_to_f32, f32_to_f16, pack_normal8, unpack_normal8};
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

/// Random surfaces of two materials, dull and glossy, seen from either side.
pub(super) struct Surfaces {
    pub(super) light: Vec<[f32; 4]>,
    pub(super) surface: Vec<[f32; 4]>,
    leaf: Vec<[u32; 4]>,
    shine: Vec<[f32; 4]>,
    pub(super) turns: Vec<LeafTurn>,
    directional: bool,
}

/// Surfaces on the device.
pub(super) struct DeviceSurfaces {
    pub(super) surface: Image,
    pub(super) leaf: Image,
    pub(super) shine: Image,
    pub(super) turns: crate::gpu::Buffer,
    pub(super) constants: [(u32, u32); 1],
    pub(super) sampler: Sampler,
}

impl Surfaces {
    pub(super) fn new(seed: u32, directional: bool) -> Self {
        let count = SIZE * SIZE;
        let nodes = LEAF_TURN_NODES;
        let turn = |i: u32| {
            let u = |k: u32| 0.5 + uniform(seed + 7, 12 * i + k) as f32;
            LeafTurn {
                front: [u(0), u(1), u(2)],
                back: [u(3), u(4), u(5)],
                down: [u(6), u(7), u(8)],
                up: [u(9), u(10), u(11)],
            }
        };
        let mut out = Self {
            light: Vec::new(),
            surface: Vec::new(),
            leaf: Vec::new(),
            shine: Vec::new(),
            turns: (0..2 * nodes).map(turn).collect(),
            directional,
        };
        for i in 0..count {
            let u = |k: u32| uniform(seed, 16 * i + k) as f32;
            let n = fibonacci_sphere(i * 7 % count, count).as_vec3();
            let side = if n.z > 0.0 { 1.0 } else { -1.0 };
            // Every ninth says another side than its normal does: a rim.
            let side = if i % 9 == 0 { -side } else { side };
            out.light
                .push([u(0), u(1), u(2), if i % 11 == 0 { 0.0 } else { 1.0 }]);
            out.surface.push([n.x, n.y, n.z, side * (1.0 + u(3))]);
            let half = |a: f32, b: f32| u32::from(f32_to_f16(a)) | u32::from(f32_to_f16(b)) << 16;
            // Every fifth keeps its energy.
            let m = (0.15 + 0.3 * u(10)) * if i % 5 == 0 { -1.0 } else { 1.0 };
            out.leaf.push([
                half(0.5 * u(4), 0.5 * u(5)),
                half(0.5 * u(6), m),
                half(0.5 * u(7), 0.5 * u(8)),
                half(0.5 * u(9), 0.0) | pack_normal8(side * n) << 16,
            ]);
            let gloss = if i % 2 == 0 { 0.0 } else { 0.06 };
            out.shine
                .push([gloss, 0.8 * gloss, gloss, (i / 2 % 2) as f32]);
        }
        out
    }

    /// What the first pass would leave at pixel `i`, and the factors of its material.
    pub(super) fn pixel(&self, i: usize) -> (Pixel, &[LeafTurn]) {
        let half = |word: u32, high: bool| f16_to_f32((word >> if high { 16 } else { 0 }) as u16);
        let [a, b, c, d] = self.leaf[i];
        let rho_d = [half(a, false), half(a, true), half(b, false)];
        let [r, g, blue, material] = self.shine[i];
        let nodes = LEAF_TURN_NODES as usize;
        let turns = &self.turns[material as usize * nodes..][..nodes];
        let pixel = Pixel {
            light: wide(self.light[i]),
            normal: wide(self.surface[i]).normalize(),
            surface: self.surface[i][3].into(),
            leaf: LeafSides {
                rho_d_front: rho_d,
                rho_d_back: rho_d,
                rho_t: [half(c, false), half(c, true), half(d, false)],
            },
            shine: [r, g, blue, half(b, true)],
            face: unpack_normal8(d >> 16).as_dvec3(),
        };
        (pixel, if self.directional { turns } else { &[] })
    }

    pub(super) fn upload(&self, gpu: &Gpu) -> Result<DeviceSurfaces> {
        Ok(DeviceSurfaces {
            surface: map(gpu, &self.surface)?,
            leaf: image(gpu, Format::Rgba32Uint, bytemuck::cast_slice(&self.leaf))?,
            shine: map(gpu, &self.shine)?,
            turns: gpu.upload("oblique light", &self.turns)?,
            constants: [(7, u32::from(self.directional))],
            sampler: gpu.sampler(&SamplerInfo::default())?,
        })
    }
}

pub(super) fn wide(v: [f32; 4]) -> DVec3 {
    DVec3::new(v[0].into(), v[1].into(), v[2].into())
}

pub(super) fn cases() -> Vec<Case> {
    let case = |name, run| Case { name, run };
    vec![
        case("light.lit_sun", |gpu| run(gpu, false)),
        case("light.lit_sun.directional", |gpu| run(gpu, true)),
    ]
}

/// Random surfaces under one sun.
fn run(gpu: &Gpu, directional: bool) -> Result<Outcome> {
    let surfaces = Surfaces::new(21, directional);
    let found = draw(gpu, &surfaces)?;
    let mut error = 0.0_f64;
    for (i, &found) in found.iter().enumerate() {
        let (pixel, turns) = surfaces.pixel(i);
        let expected = if surfaces.light[i][3] > 0.0 {
            lit_sun(&FRAME, (i as u32 % SIZE, i as u32 / SIZE), &pixel, turns)
        } else {
            pixel.light
        };
        error = error.max((expected - wide(found)).abs().max_element());
    }
    Ok(Outcome {
        error,
        limit: 1e-4,
        measure: "light",
    })
}

fn draw(gpu: &Gpu, surfaces: &Surfaces) -> Result<Vec<[f32; 4]>> {
    let frame = gpu.upload("lit frame", &[FRAME])?;
    let device = surfaces.upload(gpu)?;
    let light = map(gpu, &surfaces.light)?;
    let info = ImageInfo::storage("lit picture", Format::Rgba32Float, [SIZE; 2]);
    let picture = gpu.image(info)?;
    let kernel = gpu.compute_pipeline_with(shaders::LIT_SUN_COMP, &device.constants)?;
    let mut work = gpu.work(QueueKind::Graphics, "lit picture")?;
    work.compute(
        "sun",
        &kernel,
        &[
            Binding::Read(&frame),
            Binding::Read(&device.turns),
            Binding::Sampled(&light, &device.sampler),
            Binding::Sampled(&device.surface, &device.sampler),
            Binding::Sampled(&device.leaf, &device.sampler),
            Binding::Sampled(&device.shine, &device.sampler),
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
    image(gpu, Format::Rgba32Float, bytemuck::cast_slice(texels))
}

fn image(gpu: &Gpu, format: Format, texels: &[u8]) -> Result<Image> {
    let image = gpu.image(ImageInfo::texture("lit map", format, [SIZE; 2], 1))?;
    let mut work = gpu.work(QueueKind::Transfer, "lit map")?;
    work.upload_image("lit map", &image, &[texels])?;
    work.submit()?.wait()?;
    Ok(image)
}
