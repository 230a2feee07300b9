//! Lamps: what vertices see of them and what pixels make of their light.

use glam::DVec3;

use super::light::leaves;
use super::lit::{FRAME, SIZE, Surfaces, map, wide};
use super::{Case, Outcome};
use crate::Result;
use crate::abi::LampPass;
use crate::gpu::shaders::leaf as shaders;
use crate::gpu::{Binding, Format, Gpu, ImageInfo, QueueKind};
use crate::leaf::lamp::{Lamp, PlacedLamps};
use crate::leaf::lamp_maps::{LampMaps, LampSettings};
use crate::leaf::rays::RayScene;
use crate::leaf::shape::Shape;
use crate::math::sampling::uniform;
use crate::reference::lamps::{scattered, visibility};
use crate::reference::lit::{position_of_pixel, to_eye_of_pixel};

pub(super) fn cases() -> Vec<Case> {
    let case = |name, run| Case { name, run };
    vec![
        case("light.lamps.visibility", seen),
        case("light.lamps.pixels", pixels),
    ]
}

fn lamps() -> Vec<Lamp> {
    let lamp = |shape, position: [f64; 3], half, intensity: [f64; 3]| Lamp {
        position: position.into(),
        normal: -DVec3::from(position).normalize(),
        half,
        shape,
        intensity: intensity.into(),
    };
    vec![
        lamp(Shape::Disc, [0.4, 0.3, 2.0], [0.4; 2], [3.0, 2.0, 1.0]),
        lamp(Shape::Square, [-1.0, 0.5, 0.55], [0.2, 0.5], [1.0; 3]),
        // Among the leaves, behind some of them.
        lamp(Shape::Square, [0.1, -0.2, 0.6], [0.3, 0.1], [0.5; 3]),
    ]
}

/// All points, on leaves above, below and about the lamps.
fn seen(gpu: &Gpu) -> Result<Outcome> {
    let (s, receivers) = leaves();
    let settings = LampSettings {
        points: 40,
        exhaustive: true,
        offset: 1e-4,
        batch: 256,
    };
    let scene = RayScene::new(gpu, &s.occluders)?;
    let from = (&s.occluders, s.geometry.origin);
    let mut maps = LampMaps::new(gpu, &scene, from, &receivers, settings)?;
    let frame = (s.geometry.origin, f64::from(s.occluders.scale));
    let mut error = 0.0_f64;
    for lamp in lamps() {
        let found = maps.map(&lamp)?;
        let placed = PlacedLamps::new(&[lamp], frame, settings.points);
        for (receiver, &found) in receivers.points.iter().zip(&found) {
            let expected = visibility(
                &s.triangles,
                receiver,
                (&placed.records[0], &placed.points),
                f64::from(settings.offset),
            );
            error = error.max((expected - f64::from(found)).abs());
        }
    }
    Ok(Outcome {
        error,
        limit: 1e-4,
        measure: "share of the lamp",
    })
}

/// Random surfaces under all lamps.
fn pixels(gpu: &Gpu) -> Result<Outcome> {
    let count = SIZE * SIZE;
    let placed = PlacedLamps::new(&lamps(), (DVec3::ZERO, 1.0), 5);
    let surfaces = Surfaces::new(22, true);
    let (mut depth, mut visible) = (Vec::new(), Vec::new());
    for i in 0..count {
        let u = |k: u32| uniform(23, 4 * i + k) as f32;
        // 0.5 to 2 metres before the camera.
        let near = if i % 11 == 0 { 0.0 } else { 0.05 + 0.15 * u(3) };
        depth.push([near, 0.0, 0.0, 0.0]);
        visible.push([u(0), u(1), u(2), 0.0]);
    }
    let found = draw(gpu, &placed, &surfaces, [&depth, &visible])?;
    let mut error = 0.0_f64;
    for i in 0..count as usize {
        let mut expected = DVec3::ZERO;
        if depth[i][0] > 0.0 {
            let (pixel, turns) = surfaces.pixel(i);
            let at = (i as u32 % SIZE, i as u32 / SIZE);
            let to_eye = to_eye_of_pixel(&FRAME, at, pixel.normal, pixel.surface);
            let place = position_of_pixel(&FRAME, at, depth[i][0].into());
            for (lamp, share) in placed.records.iter().zip(visible[i]) {
                let light = scattered(
                    (lamp, &placed.points),
                    (&pixel.leaf, pixel.shine, turns),
                    (place, pixel.normal, to_eye),
                );
                expected += f64::from(share) * light;
            }
        }
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
    placed: &PlacedLamps,
    surfaces: &Surfaces,
    maps: [&[[f32; 4]]; 2],
) -> Result<Vec<[f32; 4]>> {
    let frame = gpu.upload("lit frame", &[FRAME])?;
    let records = gpu.upload("lamps", &placed.records)?;
    let points = gpu.upload("lamp points", &placed.points)?;
    let device = surfaces.upload(gpu)?;
    let (depth, visible) = (map(gpu, maps[0])?, map(gpu, maps[1])?);
    let info = ImageInfo::storage("lit picture", Format::Rgba32Float, [SIZE; 2]);
    let picture = gpu.image(info)?;
    let kernel = gpu.compute_pipeline_with(shaders::LIT_LAMPS_COMP, &device.constants)?;
    let black = vec![[0.0_f32; 4]; (SIZE * SIZE) as usize];
    let mut work = gpu.work(QueueKind::Graphics, "lit picture")?;
    work.upload_image("black", &picture, &[bytemuck::cast_slice(&black)])?;
    work.compute(
        "lamps",
        &kernel,
        &[
            Binding::Read(&frame),
            Binding::Read(&device.turns),
            Binding::Read(&records),
            Binding::Read(&points),
            Binding::Sampled(&device.surface, &device.sampler),
            Binding::Sampled(&device.leaf, &device.sampler),
            Binding::Sampled(&device.shine, &device.sampler),
            Binding::Sampled(&depth, &device.sampler),
            Binding::Sampled(&visible, &device.sampler),
            Binding::StorageReadWrite(&picture),
        ],
        &LampPass { first: 0, count: 3 },
        [SIZE, SIZE, 1],
    )?;
    let read = work.read_image("lit picture", &picture)?;
    let mut done = work.submit()?.wait()?;
    Ok(bytemuck::pod_collect_to_vec(&done.take(read)))
}
