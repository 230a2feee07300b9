//! Path-traced pictures.

use glam::{DVec3, Vec3};

use super::light::model;
use super::{Case, Outcome};
use crate::Result;
use crate::gpu::Gpu;
use crate::leaf::directional;
use crate::leaf::environment::{Environment, Sun};
use crate::leaf::film::{Film, LitScene};
use crate::leaf::glossy::Shadowing;
use crate::leaf::lamp::Lamp;
use crate::leaf::optics::Optics;
use crate::leaf::rays::Occluders;
use crate::leaf::receivers::Receivers;
use crate::leaf::shape::Shape;
use crate::leaf::truth;
use crate::reference::rays::Triangles;
use crate::reference::truth::{Light, Scene};
use crate::scene::{Camera, CameraSpec, Geometry, Lens, Primitive};

/// Pixels along an edge.
const SIZE: u32 = 40;
/// Largest difference of paths that count as the same, in shares of 1 plus what they bring: a
/// bounce off glossy leaves enlarges what rounding leaves.
const SAME: f64 = 1e-3;

pub(super) fn cases() -> Vec<Case> {
    let case = |name, run| Case { name, run };
    vec![
        case("light.truth.diffuse", |gpu| run(gpu, 0.0, &[])),
        case("light.truth.glossy", |gpu| run(gpu, 0.06, &[])),
        // And with the factors of oblique light.
        case("light.truth.lamps", |gpu| run(gpu, 0.06, &lamps())),
    ]
}

/// Bent leaves over each other, some of whose shading normals lean.
pub(super) fn leaves() -> Geometry {
    let mut primitive = Primitive::default();
    for i in 0..5 {
        let first = primitive.positions.len() as u32;
        let (x, y) = (0.35 * i as f32, 0.25 * i as f32);
        for (s, t) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            let at = [s + 0.3 * x, y + 0.25 * s * t, t - x];
            primitive.positions.push(at);
            let normal = Vec3::new(0.3 * s, 1.0, -0.2 * t).normalize();
            primitive.normals.push(normal.to_array());
        }
        let quad = [0, 2, 1, 0, 3, 2].map(|k| first + k);
        primitive.indices.extend(quad);
    }
    Geometry::flatten(&model(primitive))
}

/// One path through every pixel, each against its own twin.
fn run(gpu: &Gpu, shine: f32, lamps: &[Lamp]) -> Result<Outcome> {
    let geometry = leaves();
    let occluders = Occluders::solid(&geometry);
    let optics = [Optics {
        rho_d_front: [0.3, 0.5, 0.1],
        rho_d_back: [0.4, 0.45, 0.2],
        rho_t: [0.35, 0.3, 0.05],
        rho_s: [shine; 3],
        roughness: 0.3,
        shadowing: Shadowing::Paper,
    }];
    let mut receivers = Receivers::new(&geometry, &occluders, &optics);
    if !lamps.is_empty() {
        receivers.turns = directional::table(&optics)?;
    }
    let scene = LitScene {
        model: &model(Primitive::default()),
        geometry: &geometry,
        occluders: &occluders,
        receivers: &receivers,
        optics: &optics,
    };
    let mut film = film(&geometry);
    film.lamps = lamps.to_vec();
    if let Some(lamp) = lamps.first() {
        // With lamps the sun has a shape too.
        film.sun_shape = lamp.shape.clone();
    }
    let lights = truth::lights(&scene, &film);
    let found = truth::trace(gpu, &scene, &film, (1, 7), &mut |_| Ok(()))?;
    let triangles = Triangles::new(&occluders.positions, &occluders.indices);
    let twin = Scene {
        frame: &truth::frame(&scene, &film, 7),
        triangles: &triangles,
        faces: &receivers.faces,
        indices: &occluders.indices,
        normals: &geometry.normals,
        materials: &receivers.materials,
        gloss: &[[shine, shine, shine, 0.3]],
        turns: &receivers.turns,
        lamps: &lights.records,
        points: &lights.points,
        sky: &|d| film.sky.radiance(d),
        bounces: truth::BOUNCES,
    };
    let other = (0..SIZE * SIZE).filter(|&pixel| {
        let Light {
            direct,
            indirect,
            sky,
            covered,
        } = twin.path(pixel, 0);
        let pairs = [
            (direct, found.direct.pixels[pixel as usize]),
            (indirect, found.indirect.pixels[pixel as usize]),
            (sky, found.sky.pixels[pixel as usize]),
        ];
        let same = |(expected, found): (DVec3, [f32; 4])| {
            let [r, g, b, seen] = found.map(f64::from);
            let apart = (DVec3::new(r, g, b) - expected).abs() / (1.0 + expected);
            apart.max_element() < SAME && seen == covered
        };
        !pairs.into_iter().all(same)
    });
    // A path that passes an edge within rounding may go another way for the rest of its life.
    Ok(Outcome::new(
        other.count() as f64 / f64::from(SIZE * SIZE),
        0.005,
        "share of paths that end differently",
    ))
}

/// A quad and a disc, above and among the leaves.
fn lamps() -> Vec<Lamp> {
    let lamp = |shape, position: [f64; 3], normal: DVec3| Lamp {
        position: position.into(),
        normal,
        half: [0.3, 0.2],
        shape,
        intensity: DVec3::new(2.0, 1.5, 1.0),
    };
    vec![
        lamp(Shape::Square, [0.5, 2.0, 0.4], DVec3::NEG_Y),
        lamp(Shape::Disc, [0.6, 0.1, 0.3], DVec3::Y),
    ]
}

fn film(geometry: &Geometry) -> Film {
    let lens = Lens {
        fov: 40.0,
        aspect: 1.0,
        margin: 0.0,
    };
    let spec = CameraSpec::Orbit {
        azimuth: 30.0,
        elevation: 35.0,
        distance: 0.8,
    };
    Film {
        camera: Camera::new(
            &spec,
            lens,
            geometry.origin,
            geometry.positions.iter().copied(),
        ),
        size: [SIZE; 2],
        sun: Sun {
            towards: DVec3::new(0.4, 0.8, 0.3).normalize(),
            radius_degrees: 3.0,
            irradiance: DVec3::new(3.0, 2.8, 2.5),
        },
        sun_shape: Shape::Disc,
        lamps: Vec::new(),
        sky: Environment::Linear {
            a: DVec3::new(0.24, 0.27, 0.3),
            b: DVec3::new(0.12, 0.13, 0.15),
            up: DVec3::Y,
        },
    }
}
