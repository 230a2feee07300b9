//! Surroundings in glossy pixels by rays.

use glam::DVec3;

use super::lit::{FRAME, SIZE, Surfaces, map, wide};
use super::truth::leaves;
use super::{Case, Outcome};
use crate::Result;
use crate::gpu::{Format, Gpu, ImageInfo, QueueKind};
use crate::leaf::environment::Environment;
use crate::leaf::film::LitScene;
use crate::leaf::gloss_rays::{GlossLight, GlossPixels, GlossRays};
use crate::leaf::optics::Optics;
use crate::leaf::rays::Occluders;
use crate::leaf::receivers::Receivers;
use crate::math::sampling::uniform;
use crate::reference::gloss_rays::Scene;
use crate::reference::rays::Triangles;
use crate::scene::Primitive;

/// Rays of a pixel.
const SAMPLES: u32 = 7;
/// Seed of their numbers.
const SEED: u32 = 3;

pub(super) fn cases() -> Vec<Case> {
    vec![Case {
        name: "light.gloss_rays",
        run,
    }]
}

/// Random surfaces of two materials among bent leaves, of which each vertex sends another light.
fn run(gpu: &Gpu) -> Result<Outcome> {
    let geometry = leaves();
    let occluders = Occluders::solid(&geometry);
    let dull = Optics::opaque([0.3, 0.4, 0.2]);
    let glossy = Optics {
        rho_s: [0.06, 0.05, 0.04],
        ..dull
    };
    let optics = [glossy, dull];
    let receivers = Receivers::new(&geometry, &occluders, &optics);
    let model = super::light::model(Primitive::default());
    let scene = LitScene {
        model: &model,
        geometry: &geometry,
        occluders: &occluders,
        receivers: &receivers,
        optics: &optics,
    };
    let sky = Environment::Linear {
        a: DVec3::new(0.5, 0.4, 0.3),
        b: DVec3::new(0.2, 0.1, 0.3),
        up: DVec3::Y,
    };
    let value = |i: u32| [0, 1, 2].map(|k| uniform(41, 3 * i + k) as f32);
    let leaving: Vec<_> = (0..2 * geometry.positions.len() as u32)
        .map(value)
        .collect();
    let surfaces = Surfaces::new(42, false);
    // 0.5 to 2 metres before the camera, some nowhere.
    let near = |i: u32| match i % 11 {
        0 => 0.0,
        _ => 0.05 + 0.15 * uniform(43, i) as f32,
    };
    let depth: Vec<[f32; 4]> = (0..SIZE * SIZE).map(|i| [near(i), 0.0, 0.0, 0.0]).collect();
    let found = draw(gpu, (&scene, &sky), &leaving, (&surfaces, &depth))?;
    let triangles = Triangles::new(&occluders.positions, &occluders.indices);
    let twin = Scene {
        frame: &FRAME,
        scale: occluders.scale.into(),
        triangles: &triangles,
        faces: &receivers.faces,
        indices: &occluders.indices,
        leaving: &leaving,
        materials: &receivers.materials,
        counted: &receivers.gloss_as_diffuse(),
        sky: &|d| sky.radiance(d),
        samples: SAMPLES,
        seed: SEED,
    };
    let other = (0..(SIZE * SIZE) as usize).filter(|&i| {
        let mut expected = DVec3::ZERO;
        if depth[i][0] > 0.0 {
            let at = (i as u32 % SIZE, i as u32 / SIZE);
            let material = i / 2 % 2;
            expected = twin.gloss(at, &surfaces.pixel(i).0, material, depth[i][0].into());
        }
        let apart = (expected - wide(found[i])).abs().max_element();
        apart.is_nan() || apart > 1e-4
    });
    // A ray that passes an edge within rounding sees something else.
    Ok(Outcome::new(
        other.count() as f64 / f64::from(SIZE * SIZE),
        0.01,
        "share of pixels with another light",
    ))
}

fn draw(
    gpu: &Gpu,
    (scene, sky): (&LitScene<'_>, &Environment),
    leaving: &[[f32; 3]],
    (surfaces, depth): (&Surfaces, &[[f32; 4]]),
) -> Result<Vec<[f32; 4]>> {
    let frame = gpu.upload("lit frame", &[FRAME])?;
    let device = surfaces.upload(gpu)?;
    let depths = map(gpu, depth)?;
    let info = ImageInfo::storage("lit picture", Format::Rgba32Float, [SIZE; 2]);
    let picture = gpu.image(info)?;
    let covered = depth.iter().map(|d| [0.0, 0.0, 0.0, f32::from(d[0] > 0.0)]);
    let black: Vec<[f32; 4]> = covered.collect();
    let mut work = gpu.work(QueueKind::Graphics, "lit picture")?;
    work.upload_image("black", &picture, &[bytemuck::cast_slice(&black)])?;
    work.submit()?.wait()?;
    let rays = GlossRays::new(gpu, scene, sky)?;
    let pixels = GlossPixels {
        frame: &frame,
        surface: &device.surface,
        leaf: &device.leaf,
        shine: &device.shine,
        depth: &depths,
        plain: &device.sampler,
        picture: &picture,
    };
    let light = GlossLight {
        rays: &rays,
        leaving,
        samples: SAMPLES,
        seed: SEED,
    };
    rays.add(&pixels, &light)?;
    let mut work = gpu.work(QueueKind::Graphics, "lit picture")?;
    let read = work.read_image("lit picture", &picture)?;
    let mut done = work.submit()?.wait()?;
    Ok(bytemuck::pod_collect_to_vec(&done.take(read)))
}
