//! Transfer matrices and the glossy light of a view.

use glam::{DVec3, Vec3};

use super::light::leaves;
use super::{Case, Outcome};
use crate::Result;
use crate::abi::Receiver;
use crate::gpu::Gpu;
use crate::leaf::gloss_view::GlossPass;
use crate::leaf::glossy::Shadowing;
use crate::leaf::lobe;
use crate::leaf::optics::Optics;
use crate::leaf::prt::{Prt, PrtSettings};
use crate::leaf::rays::RayScene;
use crate::math::sampling::{fibonacci_sphere, uniform};
use crate::reference::matrix::gloss_view;
use crate::reference::prt::Scene;

pub(super) fn cases() -> Vec<Case> {
    let case = |name, run| Case { name, run };
    vec![
        case("light.matrix.order_5", |gpu| matrices(gpu, 5)),
        case("light.matrix.order_2", |gpu| matrices(gpu, 2)),
        case("light.gloss_view.order_5", |gpu| views(gpu, 5)),
        case("light.gloss_view.order_6", |gpu| views(gpu, 6)),
    ]
}

fn matrices(gpu: &Gpu, order: u32) -> Result<Outcome> {
    let (s, receivers) = leaves();
    let settings = PrtSettings {
        order,
        paths: 60,
        batch: 300,
        offset: 1e-4,
        ..PrtSettings::default()
    };
    let device = RayScene::new(gpu, &s.occluders)?;
    let mut prt = Prt::matrices(gpu, &device, &receivers, settings)?;
    prt.run(&mut |_| Ok(()))?;
    let found = prt.take();
    let scene = Scene {
        triangles: &s.triangles,
        faces: &receivers.faces,
        materials: &receivers.transfer,
        seed: settings.seed,
        offset: f64::from(settings.offset),
        survival: f64::from(settings.survival),
        bounces: settings.bounces,
    };
    let n = (order * order) as usize;
    let mut error = if found.len() == 4 * n * n * receivers.points.len() {
        0.0_f64
    } else {
        f64::INFINITY
    };
    for (number, found) in found.chunks_exact(4 * n * n).enumerate() {
        let expected = scene.matrices(&receivers.points[number], number as u32, settings.paths);
        let (direct, indirect) = found.split_at(n * n);
        for (k, value) in direct.iter().enumerate() {
            let wanted = expected[0][k / n][k % n].x;
            error = error.max((wanted - f64::from(*value)).abs());
        }
        for (k, rgb) in indirect.chunks_exact(3).enumerate() {
            let rgb = DVec3::new(rgb[0].into(), rgb[1].into(), rgb[2].into());
            error = error.max((expected[1][k / n][k % n] - rgb).abs().max_element());
        }
    }
    Ok(Outcome {
        error,
        limit: 1e-4,
        measure: "transfer",
    })
}

/// Receivers all round under random light, seen from near.
fn views(gpu: &Gpu, order: u32) -> Result<Outcome> {
    let count = 90;
    let glossy = |rho_s: [f32; 3], roughness: f32| Optics {
        rho_s,
        roughness,
        shadowing: Shadowing::Safe,
        ..Optics::opaque([0.2; 3])
    };
    let optics = [
        glossy([0.1, 0.2, 0.3], 0.15),
        glossy([0.05, 0.04, 0.03], 0.5),
    ];
    let receivers: Vec<Receiver> = (0..count)
        .map(|i| {
            // The last ones are seen exactly from above and in their plane.
            let normal = match i {
                88 => Vec3::X,
                89 => Vec3::Y,
                _ => fibonacci_sphere(i, count).as_vec3(),
            };
            let u = |k: u32| 0.2 * (uniform(31, 3 * i + k) as f32 - 0.5);
            let position = if i < 88 { [u(0), u(1), u(2)] } else { [0.0; 3] };
            Receiver {
                position,
                material: i % 2,
                normal: normal.to_array(),
                facing: normal.to_array(),
            }
        })
        .collect();
    let n = order * order;
    let light: Vec<[f32; 3]> = (0..count * n)
        .map(|i| [0, 1, 2].map(|c| uniform(32, 3 * i + c) as f32 - 0.3))
        .collect();
    let eye = Vec3::new(1.5, 0.0, 0.0);
    let pass = GlossPass::new(gpu, &receivers, (&light, order), &optics)?;
    let (found, _) = pass.view(eye)?;
    let lobes: Vec<f32> = optics
        .iter()
        .flat_map(|o| lobe::table(f64::from(o.roughness), o.shadowing))
        .collect();
    let wide = |v: [f32; 3]| DVec3::from(v.map(f64::from));
    let mut error = 0.0_f64;
    for (i, receiver) in receivers.iter().enumerate() {
        let own: Vec<DVec3> = light[i * n as usize..][..n as usize]
            .iter()
            .map(|&v| wide(v))
            .collect();
        let expected = gloss_view(receiver, &own, &lobes, eye.as_dvec3());
        let rho_s = wide(optics[receiver.material as usize].rho_s);
        for (side, expected) in expected.into_iter().enumerate() {
            let difference = expected * rho_s - wide(found[2 * i + side]);
            error = error.max(difference.abs().max_element());
        }
    }
    Ok(Outcome {
        error,
        limit: 1e-4,
        measure: "light",
    })
}
