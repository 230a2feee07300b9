//! Rays, transfer vectors and visibility maps.

use glam::{DVec3, Vec3};

use super::{Case, Outcome};
use crate::Result;
use crate::abi::RAY_NOTHING;
use crate::gpu::Gpu;
use crate::leaf::lvc::{Lvc, LvcSettings};
use crate::leaf::optics::Optics;
use crate::leaf::prt::{Prt, PrtSettings};
use crate::leaf::rays::{Occluders, RayScene};
use crate::leaf::receivers::Receivers;
use crate::leaf::trace::{NearestHit, Ray, Tracer};
use crate::math::sampling::{fibonacci_directions, uniform};
use crate::reference::lvc::visibility;
use crate::reference::prt::Scene;
use crate::reference::rays::Triangles;
use crate::scene::{
    AlphaMode, Geometry, ImageSource, Material, Model, Primitive, Texture, TextureRef,
};

pub(super) fn cases() -> Vec<Case> {
    let case = |name, run| Case { name, run };
    vec![
        case("light.nearest_hit.soup", |gpu| nearest(gpu, &soup(600))),
        case("light.any_hit.soup", |gpu| any(gpu, &soup(600))),
        case("light.any_hit.masked", |gpu| any(gpu, &cards())),
        case("light.nearest_hit.resumed", resumed),
        case("light.nearest_hit.coincident", coincident),
        case("light.nearest_hit.watertight", watertight),
        case("light.prt.transfer", |gpu| transfer(gpu, 5)),
        case("light.prt.order_6", |gpu| transfer(gpu, 6)),
        case("light.prt.order_1", |gpu| transfer(gpu, 1)),
        case("light.lvc.bytes", bytes),
    ]
}

/// A model of one mesh with white, opaque material.
pub(super) fn model(primitive: Primitive) -> Model {
    Model::of_mesh("conformance", vec![primitive], vec![Material::default()])
}

fn random_point(seed: u32, i: u32) -> Vec3 {
    let u = |k: u32| uniform(seed, 3 * i + k) as f32;
    Vec3::new(u(0), u(1), u(2))
}

/// Triangles at random, and among them flat, coincident and sliver ones.
fn soup(count: u32) -> Model {
    let mut positions = Vec::new();
    for t in 0..count {
        let centre = random_point(3, t);
        let [a, b, c] = [0, 1, 2].map(|k| centre + 0.2 * (random_point(4, 3 * t + k) - 0.5));
        positions.extend(match t % 50 {
            7 => [a, b, a],
            8 => [a, a, a],
            9 => [a, b, a.lerp(b, 0.5)],
            10 => [a, b, b + 1e-4 * (c - b)],
            _ => [a, b, c],
        });
    }
    model(Primitive {
        indices: (0..positions.len() as u32).collect(),
        positions: positions.iter().map(|p| p.to_array()).collect(),
        ..Primitive::default()
    })
}

/// Crossed cards with a checkered alpha, the texture coordinates beyond the texture.
fn cards() -> Model {
    let mut primitive = Primitive::default();
    for i in 0..40 {
        let first = primitive.positions.len() as u32;
        let centre = random_point(5, i);
        let (u, v) = (random_point(6, i) - 0.5, random_point(7, i) - 0.5);
        for (s, t) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            primitive
                .positions
                .push((centre + 0.4 * (s * u + t * v)).to_array());
            primitive.texcoords.push([1.3 * s, 0.2 + 0.9 * t]);
        }
        let quad = [0, 1, 2, 0, 2, 3].map(|k| first + k);
        primitive.indices.extend(quad);
    }
    let mut out = model(primitive);
    let pixels: Vec<u8> = (0..5 * 7)
        .flat_map(|i| [255, 255, 255, if i * 7 % 3 == 0 { 0 } else { 255 }])
        .collect();
    out.images = vec![ImageSource::Rgba8 {
        name: "checks".into(),
        width: 5,
        height: 7,
        pixels: pixels.into(),
    }];
    out.textures = vec![Texture::default()];
    out.materials[0].alpha_mode = AlphaMode::Mask { cutoff: 0.5 };
    out.materials[0].base_color_texture = Some(TextureRef::new(0));
    out
}

/// What a case traces, on both sides.
pub(super) struct Setting {
    pub(super) geometry: Geometry,
    pub(super) occluders: Occluders,
    pub(super) triangles: Triangles,
    rays: Vec<Ray>,
}

impl Setting {
    fn new(model: &Model) -> Result<Self> {
        let geometry = Geometry::flatten(model);
        let occluders = Occluders::new(model, &geometry)?;
        let triangles = Triangles::new(&occluders.positions, &occluders.indices);
        let directions = fibonacci_directions(3000);
        let rays = (0u32..)
            .zip(&directions)
            .map(|(i, d)| Ray {
                origin: (0.5 * (random_point(9, i) - 0.5)).to_array(),
                t_max: if i % 5 == 0 { 0.2 } else { 1e30 },
                // Along the axes some components are 0.
                direction: match i % 40 {
                    0 => [1.0, 0.0, 0.0],
                    1 => [0.0, -1.0, 0.0],
                    2 => [0.0, 0.6, -0.8],
                    _ => d.as_vec3().to_array(),
                },
                tag: 0.0,
            })
            .collect();
        Ok(Self {
            geometry,
            occluders,
            triangles,
            rays,
        })
    }

    /// The twin's answer.
    fn expected(&self, ray: &Ray) -> Option<crate::reference::rays::Hit> {
        let vector = |v: [f32; 3]| DVec3::from(v.map(f64::from));
        let stops = |hit: &crate::reference::rays::Hit| {
            if !self.occluders.masked() {
                return true;
            }
            let corners = &self.geometry.indices[3 * hit.triangle as usize..];
            let mut uv = [0.0; 2];
            for (w, &i) in hit.weights.iter().zip(corners) {
                let at = self.geometry.texcoords[i as usize];
                uv = [0, 1].map(|k| uv[k] + w * f64::from(at[k]));
            }
            self.occluders.cutouts.stops(0, uv.map(|v| v as f32))
        };
        let (origin, direction) = (vector(ray.origin), vector(ray.direction));
        self.triangles
            .nearest(origin, direction, f64::from(ray.t_max), stops)
    }
}

fn nearest(gpu: &Gpu, model: &Model) -> Result<Outcome> {
    let s = Setting::new(model)?;
    let scene = RayScene::new(gpu, &s.occluders)?;
    let found = Tracer::new(gpu)?.nearest(&scene, &s.rays)?;
    let error = |(ray, found): (&Ray, &Option<NearestHit>)| match (s.expected(ray), found) {
        (None, None) => 0.0,
        (Some(a), Some(b)) => (a.t - f64::from(b.t)).abs(),
        _ => f64::INFINITY,
    };
    Ok(Outcome {
        error: s.rays.iter().zip(&found).map(error).fold(0.0, f64::max),
        limit: 1e-5,
        measure: "distance in diagonals",
    })
}

fn any(gpu: &Gpu, model: &Model) -> Result<Outcome> {
    let s = Setting::new(model)?;
    let scene = RayScene::new(gpu, &s.occluders)?;
    let found = Tracer::new(gpu)?.any(&scene, &s.rays)?;
    let differs = |(ray, found): &(&Ray, &bool)| s.expected(ray).is_some() != **found;
    Ok(Outcome {
        error: s.rays.iter().zip(&found).filter(differs).count() as f64,
        limit: 0.0,
        measure: "differing rays",
    })
}

/// Rays that are cut off every few rounds arrive where they would have at once.
fn resumed(gpu: &Gpu) -> Result<Outcome> {
    let s = Setting::new(&soup(600))?;
    let scene = RayScene::new(gpu, &s.occluders)?;
    let mut tracer = Tracer::new(gpu)?;
    let (whole, open) = (
        tracer.nearest(&scene, &s.rays)?,
        tracer.any(&scene, &s.rays)?,
    );
    tracer.rounds = 7;
    let (parts, open_parts) = (
        tracer.nearest(&scene, &s.rays)?,
        tracer.any(&scene, &s.rays)?,
    );
    let differing = whole.iter().zip(&parts).filter(|(a, b)| a != b).count()
        + open.iter().zip(&open_parts).filter(|(a, b)| a != b).count();
    Ok(Outcome {
        error: differing as f64,
        limit: 0.0,
        measure: "differing rays",
    })
}

/// Of a thousand triangles in one place the first is hit, and the rest are all tried.
fn coincident(gpu: &Gpu) -> Result<Outcome> {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.1], [0.0, 1.0, 0.2]];
    let positions: Vec<[f32; 3]> = (0..3000).map(|i| corners[i % 3]).collect();
    let mut s = Setting::new(&model(Primitive {
        indices: (0..3000).collect(),
        positions,
        ..Primitive::default()
    }))?;
    s.rays.truncate(400);
    let scene = RayScene::new(gpu, &s.occluders)?;
    let mut tracer = Tracer::new(gpu)?;
    tracer.rounds = 300;
    let found = tracer.nearest(&scene, &s.rays)?;
    let wrong =
        s.rays.iter().zip(&found).filter(|(ray, found)| {
            found.map(|h| h.triangle) != s.expected(ray).map(|h| h.triangle)
        });
    Ok(Outcome {
        error: wrong.count() as f64,
        limit: 0.0,
        measure: "rays that meet another triangle",
    })
}

/// A closed ball: no ray from inside leaves it, not through its vertices, edges or poles either.
fn watertight(gpu: &Gpu) -> Result<Outcome> {
    let (rings, sectors) = (12u32, 20u32);
    let mut positions = vec![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    for ring in 1..rings {
        for sector in 0..sectors {
            let theta = std::f32::consts::PI * ring as f32 / rings as f32;
            let phi = std::f32::consts::TAU * sector as f32 / sectors as f32;
            positions.push([
                theta.sin() * phi.cos(),
                theta.sin() * phi.sin(),
                theta.cos(),
            ]);
        }
    }
    let at = |ring: u32, sector: u32| 2 + (ring - 1) * sectors + sector % sectors;
    let mut indices = Vec::new();
    for sector in 0..sectors {
        indices.extend([0, at(1, sector), at(1, sector + 1)]);
        indices.extend([1, at(rings - 1, sector + 1), at(rings - 1, sector)]);
        for ring in 1..rings - 1 {
            let [a, b] = [at(ring, sector), at(ring, sector + 1)];
            let [c, d] = [at(ring + 1, sector), at(ring + 1, sector + 1)];
            indices.extend([a, c, d, a, d, b]);
        }
    }
    let s = Setting::new(&model(Primitive {
        positions,
        indices,
        ..Primitive::default()
    }))?;
    let mut rays = Vec::new();
    for start in [Vec3::ZERO, Vec3::new(0.05, -0.02, 0.1)] {
        for t in s.occluders.indices.chunks_exact(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| s.occluders.positions[i as usize]);
            for target in [
                a,
                0.5 * (a + b),
                0.5 * (b + c),
                a.lerp(b, 0.3),
                (a + b + c) / 3.0,
            ] {
                rays.push(Ray {
                    origin: start.to_array(),
                    t_max: 1e30,
                    direction: (target - start).to_array(),
                    tag: 0.0,
                });
            }
        }
    }
    let scene = RayScene::new(gpu, &s.occluders)?;
    let found = Tracer::new(gpu)?.nearest(&scene, &rays)?;
    let lost = found
        .iter()
        .filter(|h| h.is_none_or(|h| (h.t - 1.0).abs() > 1e-4 || h.triangle == RAY_NOTHING));
    Ok(Outcome {
        error: lost.count() as f64,
        limit: 0.0,
        measure: "rays that escape",
    })
}

/// Three leaves over each other, of two materials in turn.
pub(super) fn leaves() -> (Setting, Receivers) {
    let mut primitive = Primitive::default();
    for i in 0..3 {
        let first = primitive.positions.len() as u32;
        let z = 0.4 * i as f32;
        for (s, t) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            primitive.positions.push([s, t + 0.3 * z, z + 0.2 * s * t]);
        }
        primitive
            .indices
            .extend([0, 1, 2, 0, 2, 3].map(|k| first + k));
    }
    let s = Setting::new(&model(primitive)).expect("has no textures");
    let optics = Optics {
        rho_d_front: [0.3, 0.5, 0.1],
        rho_d_back: [0.4, 0.45, 0.2],
        rho_t: [0.35, 0.3, 0.05],
        ..Optics::opaque([0.0; 3])
    };
    let receivers = Receivers::new(&s.geometry, &s.occluders, &[optics]);
    (s, receivers)
}

/// Transfer vectors of `order` bands.
fn transfer(gpu: &Gpu, order: u32) -> Result<Outcome> {
    let (s, receivers) = leaves();
    let settings = PrtSettings {
        order,
        paths: 50,
        batch: 600,
        offset: 1e-4,
        ..PrtSettings::default()
    };
    let device = RayScene::new(gpu, &s.occluders)?;
    let found = Prt::new(gpu, &device, &receivers, settings)?.all(&mut |_| Ok(()))?;
    let scene = Scene {
        triangles: &s.triangles,
        faces: &receivers.faces,
        materials: &receivers.materials,
        seed: settings.seed,
        offset: f64::from(settings.offset),
        survival: f64::from(settings.survival),
        bounces: settings.bounces,
    };
    let mut error = 0.0_f64;
    for (number, receiver) in receivers.points.iter().enumerate() {
        for side in 0..2 {
            let expected = scene.transfer(receiver, number as u32, side as u32, settings.paths);
            for (part, expected) in expected.iter().enumerate() {
                let found = found.vector(number, side, part);
                for (expected, found) in expected.iter().zip(found) {
                    let d = expected - DVec3::from(found.map(f64::from));
                    error = error.max(d.abs().max_element());
                }
            }
        }
    }
    Ok(Outcome {
        error,
        limit: 1e-4,
        measure: "transfer",
    })
}

fn bytes(gpu: &Gpu) -> Result<Outcome> {
    let (s, receivers) = leaves();
    let settings = LvcSettings {
        radius_degrees: 12.0,
        samples: 30,
        exhaustive: true,
        offset: 1e-4,
        ..LvcSettings::default()
    };
    let device = RayScene::new(gpu, &s.occluders)?;
    let directions: Vec<[f32; 3]> = fibonacci_directions(20)
        .iter()
        .map(|d| d.as_vec3().to_array())
        .collect();
    let found = Lvc::new(gpu, &device, &receivers, settings)?.maps(&directions)?;
    let sin = settings.radius_degrees.to_radians().sin();
    let disc = (sin, settings.samples, f64::from(settings.offset));
    let mut error = 0.0_f64;
    for (d, centre) in directions.iter().enumerate() {
        for (v, receiver) in receivers.points.iter().enumerate() {
            let centre = DVec3::from(centre.map(f64::from));
            let expected = 255.0 * visibility(&s.triangles, receiver, centre, disc);
            let found = f64::from(found[d * receivers.points.len() + v]);
            error = error.max((expected.round() - found).abs());
        }
    }
    Ok(Outcome {
        error,
        limit: 1.0,
        measure: "bytes",
    })
}
