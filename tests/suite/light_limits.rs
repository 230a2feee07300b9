//! Light of leaves at its limits: closed forms, furnaces, extreme materials, sizes and places.

use glam::{DAffine3, DVec3, Vec3};
use umbrage::leaf::environment::{Environment, Sun};
use umbrage::leaf::film::{Film, LitScene};
use umbrage::leaf::lvc::{Lvc, LvcSettings};
use umbrage::leaf::optics::Optics;
use umbrage::leaf::prt::{Prt, PrtSettings, Transfer};
use umbrage::leaf::rays::{Occluders, RayScene};
use umbrage::leaf::receivers::Receivers;
use umbrage::leaf::truth::{self, Truth};
use umbrage::math::sampling::{fibonacci_directions, uniform};
use umbrage::math::sh;
use umbrage::math::slab::{Incidence, solve};
use umbrage::scene::{Camera, CameraSpec, Geometry, Lens, Material, Model, Primitive};

use super::fixture;

/// A model of `primitives`, each of its own material, placed by `at`.
fn model(primitives: Vec<Primitive>, at: DAffine3) -> Model {
    let materials = vec![Material::default(); primitives.len()];
    let primitives = (0..)
        .zip(primitives)
        .map(|(material, p)| Primitive { material, ..p });
    let mut out = Model::of_mesh("mesh", primitives.collect(), materials);
    out.instances[0].local_to_world = at;
    out
}

/// Adds a square of half edge `half` about `centre`; its front looks along `n`.
fn add_square(to: &mut Primitive, centre: Vec3, n: Vec3, half: f32) {
    let first = to.positions.len() as u32;
    let (u, v) = n.any_orthonormal_pair();
    for (s, t) in [
        (-1.0, -1.0),
        (1.0, -1.0),
        (1.0, 1.0),
        (-1.0, 1.0),
        (0.0, 0.0),
    ] {
        let p = centre + half * (s * u + t * v);
        to.positions.push(p.to_array());
    }
    for k in 0..4 {
        to.indices
            .extend([first + 4, first + k, first + (k + 1) % 4]);
    }
}

/// Two squares of edge 2 with a narrow gap, fronts up; the middles are vertices 4 and 9.
fn pair(gap: f32) -> Geometry {
    let mut primitive = Primitive::default();
    for y in [0.0, gap] {
        add_square(&mut primitive, y * Vec3::Y, Vec3::Y, 1.0);
    }
    Geometry::flatten(&model(vec![primitive], DAffine3::IDENTITY))
}

/// Leaves at random about the origin, above soil where `soil` is set: two materials.
fn canopy(leaves: u32, soil: bool, at: DAffine3) -> Geometry {
    let mut primitive = Primitive::default();
    for i in 0..leaves {
        let u = |k: u32| uniform(7, 8 * i + k) as f32 - 0.5;
        let n = Vec3::new(u(0), u(1), u(2)).normalize_or(Vec3::Y);
        add_square(
            &mut primitive,
            Vec3::new(u(3), 0.6 * u(4) + 0.4, u(5)),
            n,
            0.15,
        );
    }
    let mut ground = Primitive::default();
    // A little tilted: a normal along an axis turns its frame round with the last digit.
    let up = Vec3::new(0.1, 1.0, 0.2).normalize();
    add_square(&mut ground, Vec3::ZERO, up, if soil { 1.0 } else { 1e-3 });
    Geometry::flatten(&model(vec![primitive, ground], at))
}

fn leaf(reflects: f32, transmits: f32) -> Optics {
    Optics {
        rho_t: [transmits; 3],
        ..Optics::opaque([reflects; 3])
    }
}

/// Transfer of the vertices `which` (all where empty).
fn transfer(
    geometry: &Geometry,
    optics: &[Optics],
    settings: PrtSettings,
    which: &[usize],
) -> Transfer {
    let gpu = fixture::gpu();
    let occluders = Occluders::solid(geometry);
    let mut receivers = Receivers::new(geometry, &occluders, optics);
    if !which.is_empty() {
        receivers.points = which.iter().map(|&v| receivers.points[v]).collect();
    }
    let scene = RayScene::new(&gpu, &occluders).unwrap();
    let mut prt = Prt::new(&gpu, &scene, &receivers, settings).unwrap();
    prt.all(&mut |_| Ok(())).unwrap()
}

/// Coefficient `k` of the red light that leaves a side, direct and indirect.
fn coefficient(t: &Transfer, vertex: usize, side: usize, k: usize) -> f64 {
    let part = |p| f64::from(t.vector(vertex, side, p)[k][0]);
    part(0) + part(1)
}

/// What leaves a side under a sky of radiance 1.
fn under_white(t: &Transfer, vertex: usize, side: usize) -> f64 {
    (4.0 * std::f64::consts::PI).sqrt() * coefficient(t, vertex, side, 0)
}

/// Two wide leaves close together act as one: `R + T^2 R / (1 - R R_b)` and `T^2 / (1 - R R_b)`.
#[test]
fn two_leaves_have_the_closed_form() {
    let (r, back, t) = (0.3_f64, 0.4, 0.25);
    let optics = Optics {
        rho_d_back: [back as f32; 3],
        ..leaf(r as f32, t as f32)
    };
    let settings = PrtSettings {
        paths: 60_000,
        ..PrtSettings::default()
    };
    let found = transfer(&pair(2e-3), &[optics], settings, &[4, 9]);
    let inner = 1.0 - r * back;
    let (r12, t12) = (r + t * t * r / inner, t * t / inner);
    assert!((r12 - 0.321_307).abs() < 1e-6 && (t12 - 0.071_023).abs() < 1e-6);
    // From below the lower sides are the outer ones.
    let below = back + t * t * back / inner;
    let y1 = sh::CLAMPED_COSINE[1] / std::f64::consts::PI;
    for (vertex, side, reflects) in [(1, 0, r12), (0, 1, below)] {
        // A uniform sky gives the sum, a slope towards the zenith the difference.
        let sum = under_white(&found, vertex, side);
        let up = if side == 0 { 1.0 } else { -1.0 };
        let difference = up * coefficient(&found, vertex, side, 1) / y1;
        let (rho, through) = (0.5 * (sum + difference), 0.5 * (sum - difference));
        assert!(
            (rho - reflects).abs() < 1.5e-3,
            "{side}: R {rho} for {reflects}"
        );
        assert!(
            (through - t12).abs() < 1.5e-3,
            "{side}: T {through} for {t12}"
        );
    }
}

/// Leaves that absorb nothing above white soil, under a uniform sky: all looks like the sky, by
/// transfer and by paths from the camera.
#[test]
fn a_white_canopy_over_white_soil_shows_nothing() {
    let geometry = canopy(40, true, DAffine3::IDENTITY);
    let optics = [leaf(0.6, 0.4), leaf(1.0, 0.0)];
    let settings = PrtSettings {
        paths: 32,
        bounces: 2000,
        ..PrtSettings::default()
    };
    let found = transfer(&geometry, &optics, settings, &[]);
    for vertex in 0..geometry.positions.len() {
        for side in 0..2 {
            let value = under_white(&found, vertex, side);
            assert!((value - 1.0).abs() < 2e-3, "{vertex} {side}: {value}");
        }
    }
    let sky = Environment::Constant(DVec3::ONE);
    let sun = sun(DVec3::Y, 0.0);
    let picture = picture(&geometry, &optics, (sky, sun), 4);
    let mut covered = 0;
    for p in picture.sky.pixels.iter().filter(|p| p[3] == 1.0) {
        // Paths end after 64 bounces here: those that are still in the canopy bring nothing.
        assert!(p[0] > 0.7 && p[0] < 1.001, "{p:?}");
        covered += 1;
    }
    let mean: f32 = picture.sky.pixels.iter().map(|p| p[0]).sum::<f32>()
        / picture.sky.pixels.iter().map(|p| p[3]).sum::<f32>();
    assert!(
        covered > 200 && (mean - 1.0).abs() < 0.01,
        "{covered} {mean}"
    );
}

/// Sizes and places: by powers of two not a bit changes, otherwise what rounding changes.
#[test]
fn size_and_place_change_nothing() {
    let gpu = fixture::gpu();
    let optics = [leaf(0.5, 0.3), leaf(0.2, 0.0)];
    let directions: Vec<[f32; 3]> = fibonacci_directions(12)
        .iter()
        .map(|d| d.as_vec3().to_array())
        .collect();
    let light = |at: DAffine3| {
        let geometry = canopy(20, true, at);
        let occluders = Occluders::solid(&geometry);
        let receivers = Receivers::new(&geometry, &occluders, &optics);
        let scene = RayScene::new(&gpu, &occluders).unwrap();
        let settings = LvcSettings {
            radius_degrees: 3.0,
            ..LvcSettings::default()
        };
        let mut lvc = Lvc::new(&gpu, &scene, &receivers, settings).unwrap();
        let settings = PrtSettings {
            paths: 16,
            ..PrtSettings::default()
        };
        let transfer = transfer(&geometry, &optics, settings, &[]);
        (transfer.values, lvc.maps(&directions).unwrap())
    };
    let (values, bytes) = light(DAffine3::IDENTITY);
    for exponent in [-10, 20] {
        let at = DAffine3::from_scale(DVec3::splat(2.0_f64.powi(exponent)));
        assert!(light(at) == (values.clone(), bytes.clone()), "2^{exponent}");
    }
    for at in [
        DAffine3::from_scale(DVec3::splat(1e-3)),
        DAffine3::from_scale(DVec3::splat(1e6)),
        DAffine3::from_translation(DVec3::splat(5e6)),
        DAffine3::from_scale_rotation_translation(
            DVec3::splat(1e6),
            glam::DQuat::IDENTITY,
            DVec3::new(5e6, -5e6, 5e6),
        ),
    ] {
        let (other, seen) = light(at);
        let close = |(a, b): &(&f32, &f32)| (*a - *b).abs() < 1e-4;
        let alike = values.iter().zip(&other).filter(close).count();
        // A path that passes an edge within rounding may go another way.
        assert!(alike as f64 > 0.98 * values.len() as f64, "{at:?}: {alike}");
        let differing = bytes.iter().zip(&seen).filter(|(a, b)| a != b).count();
        assert!(500 * differing < bytes.len(), "{at:?}: {differing} bytes");
    }
}

/// Slabs of every albedo and thickness make leaves whose light is finite and no brighter than the
/// sky.
#[test]
fn extreme_slabs_are_lit_within_limits() {
    let geometry = canopy(6, true, DAffine3::IDENTITY);
    for omega in [0.0, 0.5, 0.999, 1.0] {
        for delta in [1e-4, 0.01, 1.0, 100.0] {
            let slab = solve(omega, delta, Incidence::Beam(1.0)).unwrap();
            let through = slab.t_diff + slab.t_dir;
            let optics = [leaf(slab.rho_d as f32, through as f32), leaf(0.2, 0.0)];
            let settings = PrtSettings {
                paths: 16,
                survival: 0.0,
                bounces: 200,
                ..PrtSettings::default()
            };
            let found = transfer(&geometry, &optics, settings, &[]);
            assert!(
                found.values.iter().all(|v| v.is_finite()),
                "{omega} {delta}"
            );
            for vertex in 0..geometry.positions.len() {
                for side in 0..2 {
                    let value = under_white(&found, vertex, side);
                    let limits = -1e-6..=1.0 + 1e-4;
                    assert!(limits.contains(&value), "{omega} {delta} {vertex}: {value}");
                }
            }
        }
    }
}

fn sun(towards: DVec3, radius_degrees: f64) -> Sun {
    Sun {
        towards,
        radius_degrees,
        irradiance: DVec3::ONE,
    }
}

/// Path traced from above.
fn picture(
    geometry: &Geometry,
    optics: &[Optics],
    (sky, sun): (Environment, Sun),
    samples: u32,
) -> Truth {
    let gpu = fixture::gpu();
    let occluders = Occluders::solid(geometry);
    let receivers = Receivers::new(geometry, &occluders, optics);
    let scene = LitScene {
        model: &Model::default(),
        geometry,
        occluders: &occluders,
        receivers: &receivers,
        optics,
    };
    let lens = Lens {
        fov: 30.0,
        aspect: 1.0,
        margin: 0.0,
    };
    let spec = CameraSpec::Orbit {
        azimuth: 20.0,
        elevation: 40.0,
        distance: 1.0,
    };
    let points = geometry.positions.iter().copied();
    let film = Film {
        sun_shape: umbrage::leaf::shape::Shape::Disc,
        lamps: Vec::new(),
        camera: Camera::new(&spec, lens, geometry.origin, points),
        size: [32, 32],
        sun,
        sky,
    };
    truth::trace(&gpu, &scene, &film, (samples, 3), &mut |_| Ok(())).unwrap()
}

/// The smoothest and roughest gloss, the sun overhead, along the leaves and behind them.
#[test]
fn extreme_gloss_and_grazing_suns_are_finite() {
    let geometry = canopy(6, true, DAffine3::IDENTITY);
    for m in [1e-3, 0.05, 1.0] {
        for (degrees, radius) in [
            (0.0_f64, 44.0),
            (89.99, 0.2665),
            (90.0, 0.0),
            (180.0, 0.2665),
        ] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let light = (
                Environment::Constant(DVec3::splat(0.5)),
                sun(DVec3::new(sin, cos, 0.0), radius),
            );
            let shiny = Optics {
                rho_s: [0.5; 3],
                roughness: m,
                ..leaf(0.2, 0.2)
            };
            let found = picture(&geometry, &[shiny, leaf(0.3, 0.0)], light, 1).full();
            let sound = |p: &[f32; 4]| p.iter().all(|v| v.is_finite() && *v >= 0.0);
            assert!(found.pixels.iter().all(sound), "{m} {degrees} {radius}");
        }
    }
}

/// Any light on more receivers than the device takes at once, and any batches, give the same.
#[test]
fn batches_change_nothing() {
    let gpu = fixture::gpu();
    let geometry = canopy(9, true, DAffine3::IDENTITY);
    let optics = [leaf(0.5, 0.3), leaf(0.2, 0.0)];
    let paths = |batch| {
        let settings = PrtSettings {
            paths: 40,
            batch,
            ..PrtSettings::default()
        };
        transfer(&geometry, &optics, settings, &[])
    };
    let whole = paths(PrtSettings::default().batch);
    assert_eq!(paths(300), whole);
    let occluders = Occluders::solid(&geometry);
    let receivers = Receivers::new(&geometry, &occluders, &optics);
    let scene = RayScene::new(&gpu, &occluders).unwrap();
    let directions = [[0.0, 1.0, 0.0], [0.6, 0.8, 0.0], [0.0, -0.6, 0.8]];
    let maps = |batch, at_once| {
        let settings = LvcSettings {
            radius_degrees: 4.0,
            batch,
            at_once,
            ..LvcSettings::default()
        };
        let mut lvc = Lvc::new(&gpu, &scene, &receivers, settings).unwrap();
        lvc.maps(&directions).unwrap()
    };
    let whole = maps(1 << 18, u32::MAX);
    assert_eq!(whole.len(), 3 * geometry.positions.len());
    assert_eq!(maps(1 << 18, 7), whole, "seven receivers at a time");
    assert_eq!(maps(200, 40), whole);
}
