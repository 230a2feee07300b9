//! Rays, light and visibility: kernels against twins, and against what must hold.

use glam::{DVec3, Vec3};
use umbrage::abi::SH_MAX_COEFFICIENTS;
use umbrage::app::conform;
use umbrage::leaf::levels::{Level, LevelSums};
use umbrage::leaf::light::{Lighting, Storage, exit_radiance};
use umbrage::leaf::lvc::{Lvc, LvcSettings};
use umbrage::leaf::optics::Optics;
use umbrage::leaf::prt::{Prt, PrtSettings, Transfer, side_floats};
use umbrage::leaf::rays::{Occluders, RayScene};
use umbrage::leaf::receivers::Receivers;
use umbrage::leaf::trace::{Ray, Tracer};
use umbrage::math::sampling::fibonacci_directions;
use umbrage::scene::{Geometry, Material, Model, Primitive};

use super::fixture;

#[test]
fn kernels_agree_with_their_twins() {
    let gpu = fixture::gpu();
    for case in conform::cases()
        .iter()
        .filter(|c| c.name.starts_with("light."))
    {
        let outcome = (case.run)(&gpu).unwrap();
        assert!(outcome.passed(), "{}: {outcome:?}", case.name);
    }
}

/// A model of one mesh.
fn of(primitive: Primitive) -> Model {
    Model::of_mesh("mesh", vec![primitive], vec![Material::default()])
}

/// Horizontal squares of edge 2 at some heights, each of `cells` x `cells` quads, front up.
fn squares(heights: &[f32], cells: u32) -> Geometry {
    let mut primitive = Primitive::default();
    for &y in heights {
        let first = primitive.positions.len() as u32;
        for j in 0..=cells {
            for i in 0..=cells {
                let at = |k: u32| 2.0 * k as f32 / cells as f32 - 1.0;
                primitive.positions.push([at(i), y, at(j)]);
            }
        }
        for j in 0..cells {
            for i in 0..cells {
                let a = first + j * (cells + 1) + i;
                let c = a + cells + 1;
                primitive.indices.extend([a, c, c + 1, a, c + 1, a + 1]);
            }
        }
    }
    Geometry::flatten(&of(primitive))
}

fn leaf(reflects: f32, transmits: f32) -> Optics {
    Optics {
        rho_t: [transmits; 3],
        ..Optics::opaque([reflects; 3])
    }
}

fn transfer(geometry: &Geometry, optics: Optics, settings: PrtSettings) -> Transfer {
    let gpu = fixture::gpu();
    let occluders = Occluders::solid(geometry);
    let receivers = Receivers::new(geometry, &occluders, &[optics]);
    let scene = RayScene::new(&gpu, &occluders).unwrap();
    let mut prt = Prt::new(&gpu, &scene, &receivers, settings).unwrap();
    prt.all(&mut |_| Ok(())).unwrap()
}

/// Exit radiance of a side under a sky of radiance 1.
fn under_white(t: &Transfer, vertex: usize, side: usize) -> f32 {
    let white = (4.0 * std::f32::consts::PI).sqrt();
    white * (t.vector(vertex, side, 0)[0][1] + t.vector(vertex, side, 1)[0][1])
}

/// Leaves that absorb nothing under a uniform sky look exactly like the sky.
#[test]
fn a_white_furnace_shows_nothing() {
    let geometry = squares(&[0.0, 0.3, 0.5], 2);
    let settings = PrtSettings {
        paths: 64,
        bounces: 1000,
        survival: 0.0,
        ..PrtSettings::default()
    };
    let t = transfer(&geometry, leaf(0.7, 0.3), settings);
    for vertex in 0..geometry.positions.len() {
        for side in 0..2 {
            let value = under_white(&t, vertex, side);
            assert!((value - 1.0).abs() < 2e-3, "{vertex} {side}: {value}");
        }
    }
}

/// So they do at every level of detail, whatever the storage.
#[test]
fn a_white_furnace_shows_nothing_at_any_level() {
    let geometry = squares(&[0.0, 0.3, 0.5], 6);
    let settings = PrtSettings {
        paths: 16,
        bounces: 1000,
        survival: 0.0,
        ..PrtSettings::default()
    };
    let t = transfer(&geometry, leaf(0.7, 0.3), settings);
    let mut white = [DVec3::ZERO; SH_MAX_COEFFICIENTS as usize];
    white[0] = DVec3::splat((4.0 * std::f64::consts::PI).sqrt());
    let lighting = Lighting {
        sky: &white,
        sun: &[DVec3::ZERO; SH_MAX_COEFFICIENTS as usize],
        direct_sun: false,
        order: 5,
    };
    let levels = [0.0, 0.5, 1.0, 2.0, 10.0].map(|edge| Level::new(&geometry, edge));
    assert_eq!(levels[4].vertices, 3, "one a leaf");
    for (storage, limit) in [
        (Storage::F32, 1e-3),
        (Storage::F16, 2e-3),
        (Storage::Byte, 1e-2),
    ] {
        let mut sums = LevelSums::new(&levels, t.order);
        for part in t.values.chunks(10 * 2 * side_floats(t.order)) {
            sums.add(part.to_vec(), &lighting);
        }
        for error in sums.errors(&lighting) {
            assert!(error.rmse < 1e-3 && error.bias.abs() < 1e-3, "{error:?}");
        }
        for (level, stored) in levels.iter().zip(sums.stored(storage, 16)) {
            let own = exit_radiance(&stored.transfer(), &lighting);
            let worst = own
                .iter()
                .chain(&level.spread(own.clone()))
                .flatten()
                .map(|v| (v - 1.0).abs())
                .fold(0.0, f32::max);
            assert!(worst < limit, "{storage:?} at {}: {worst}", level.edge);
        }
    }
}

/// A lone leaf: the clamped cosine's closed form, R above and T below.
#[test]
fn a_lone_leaf_has_the_closed_form() {
    let geometry = squares(&[0.0], 1);
    let settings = PrtSettings {
        paths: 20_000,
        ..PrtSettings::default()
    };
    let t = transfer(&geometry, leaf(0.4, 0.2), settings);
    let y1 = umbrage::math::sh::CLAMPED_COSINE[1] as f32 / std::f32::consts::PI;
    for vertex in 0..4 {
        // Band 1 of direction +y is coefficient 1; the sky above counts R, that below T.
        let front = t.vector(vertex, 0, 0)[1][0];
        let back = t.vector(vertex, 1, 0)[1][0];
        assert!((front - (0.4 - 0.2) * y1).abs() < 2e-3, "{front}");
        assert!((back - (0.2 - 0.4) * y1).abs() < 2e-3, "{back}");
        let indirect = t.vector(vertex, 0, 1).iter().flatten();
        assert_eq!(indirect.fold(0.0_f32, |a, v| a.max(v.abs())), 0.0);
    }
}

/// Interrupted and resumed, the result is the same in every bit; so it is on a second run.
#[test]
fn a_resumed_precomputation_is_the_same() {
    let gpu = fixture::gpu();
    let geometry = squares(&[0.0, 0.3], 2);
    let occluders = Occluders::solid(&geometry);
    let receivers = Receivers::new(&geometry, &occluders, &[leaf(0.5, 0.3)]);
    let scene = RayScene::new(&gpu, &occluders).unwrap();
    let settings = PrtSettings {
        paths: 40,
        batch: 200,
        ..PrtSettings::default()
    };
    let new = || Prt::new(&gpu, &scene, &receivers, settings).unwrap();
    let whole = new().all(&mut |_| Ok(())).unwrap();
    let mut kept = None;
    let mut batches = 0;
    let stopped = new().all(&mut |prt| {
        batches += 1;
        if batches == 7 {
            kept = Some(prt.snapshot()?);
            return Err(umbrage::Error::usage("stopped"));
        }
        Ok(())
    });
    assert!(stopped.is_err());
    let mut second = new();
    second.restore(kept.unwrap()).unwrap();
    assert_eq!(second.all(&mut |_| Ok(())).unwrap(), whole);
}

/// A half-plane over part of the disc: V = (acos x - x sqrt(1 - x^2)) / pi.
#[test]
fn a_half_plane_hides_its_share_of_the_sun() {
    let gpu = fixture::gpu();
    let mut geometry = squares(&[0.0, 1.0], 1);
    // The upper square hides x > 0.
    for p in &mut geometry.positions[4..] {
        p.x = if p.x < 0.0 { 0.0 } else { 50.0 };
        p.z *= 50.0;
    }
    let occluders = Occluders::solid(&geometry);
    let mut receivers = Receivers::new(&geometry, &occluders, &[leaf(0.5, 0.3)]);
    receivers.points.truncate(1);
    let scene = RayScene::new(&gpu, &occluders).unwrap();
    let settings = LvcSettings {
        radius_degrees: 5.0,
        samples: 255,
        exhaustive: true,
        ..LvcSettings::default()
    };
    let radius = 5.0_f64.to_radians().sin();
    for x in [-1.3, -0.7, -0.2, 0.0, 0.4, 0.9, 1.2_f64] {
        // The edge stands at x radii of the disc from its middle.
        receivers.points[0].position = [
            (-x * radius * f64::from(occluders.scale)) as f32,
            occluders.positions[0].y,
            0.0,
        ];
        receivers.points[0].position[0] += occluders.positions[4].x;
        let mut lvc = Lvc::new(&gpu, &scene, &receivers, settings).unwrap();
        let found = f64::from(lvc.maps(&[[0.0, 1.0, 0.0]]).unwrap()[0]) / 255.0;
        let x = x.clamp(-1.0, 1.0);
        let hidden = (x.acos() - x * (1.0 - x * x).sqrt()) / std::f64::consts::PI;
        assert!((1.0 - hidden - found).abs() < 0.02, "{x}: {found}");
    }
}

/// The four outermost samples find the penumbra: the rest changes few bytes.
#[test]
fn sparing_samples_changes_few_bytes() {
    let gpu = fixture::gpu();
    let geometry = squares(&[0.0, 0.2, 0.5], 6);
    let occluders = Occluders::solid(&geometry);
    let receivers = Receivers::new(&geometry, &occluders, &[leaf(0.5, 0.3)]);
    let scene = RayScene::new(&gpu, &occluders).unwrap();
    let directions: Vec<[f32; 3]> = fibonacci_directions(30)
        .iter()
        .map(|d| d.as_vec3().to_array())
        .collect();
    let run = |exhaustive| {
        let settings = LvcSettings {
            radius_degrees: 2.0,
            exhaustive,
            ..LvcSettings::default()
        };
        let mut lvc = Lvc::new(&gpu, &scene, &receivers, settings).unwrap();
        (lvc.maps(&directions).unwrap(), lvc.traced)
    };
    let ((all, all_rays), (some, some_rays)) = (run(true), run(false));
    assert!(2 * some_rays < all_rays, "{some_rays} of {all_rays}");
    let squares = all.iter().zip(&some);
    let mean: f64 = squares
        .map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2))
        .sum::<f64>()
        / all.len() as f64;
    assert!(mean.sqrt() / 255.0 < 0.02, "{}", mean.sqrt() / 255.0);
}

/// A lone leaf sees the sun on either side of it.
#[test]
fn a_lone_leaf_is_never_in_its_own_shadow() {
    let gpu = fixture::gpu();
    let geometry = squares(&[0.0], 3);
    let occluders = Occluders::solid(&geometry);
    let receivers = Receivers::new(&geometry, &occluders, &[leaf(0.5, 0.3)]);
    let scene = RayScene::new(&gpu, &occluders).unwrap();
    let mut lvc = Lvc::new(&gpu, &scene, &receivers, LvcSettings::default()).unwrap();
    // Also along the leaf's own plane, within rounding.
    let directions = [
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.8, 0.6, 0.0],
        [1.0, 0.01, 0.0],
    ];
    assert!(lvc.maps(&directions).unwrap().iter().all(|&b| b == 255));
}

/// A ray in the plane of a triangle misses it, one beside it too; neither hangs.
#[test]
fn rays_in_the_plane_of_a_leaf_are_defined() {
    let gpu = fixture::gpu();
    let geometry = squares(&[0.0], 1);
    let scene = RayScene::new(&gpu, &Occluders::solid(&geometry)).unwrap();
    let ray = |origin: Vec3, direction: Vec3| Ray {
        origin: origin.to_array(),
        t_max: f32::INFINITY,
        direction: direction.to_array(),
        tag: 0.0,
    };
    let rays = [
        ray(Vec3::new(-2.0, 0.0, 0.0), Vec3::X),
        ray(Vec3::new(-2.0, 0.0, 0.1), Vec3::new(0.7, 0.0, 0.1)),
        ray(Vec3::new(-2.0, 1e-3, 0.0), Vec3::X),
        ray(Vec3::NAN, Vec3::X),
        ray(Vec3::ZERO, Vec3::ZERO),
        ray(Vec3::new(0.0, 1.0, 0.0), Vec3::NEG_Y),
    ];
    let found = Tracer::new(&gpu).unwrap().any(&scene, &rays).unwrap();
    assert_eq!(found, [false, false, false, false, false, true]);
}

/// Scenes of a thousandth and of a million times the size give the same transfer.
#[test]
fn scale_changes_nothing() {
    let of = |scale: f32| {
        let mut geometry = squares(&[0.0, 0.4], 1);
        for p in &mut geometry.positions {
            *p *= scale;
        }
        (geometry.min, geometry.max) = (scale * geometry.min, scale * geometry.max);
        let settings = PrtSettings {
            paths: 32,
            ..PrtSettings::default()
        };
        transfer(&geometry, leaf(0.5, 0.3), settings)
    };
    let one = of(1.0);
    for scale in [0.001, 1024.0, 1e6] {
        let other = of(scale);
        let errors = one.values.iter().zip(&other.values);
        let worst = errors.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(worst < 1e-4, "{scale}: {worst}");
    }
}

/// One triangle, and one without area.
#[test]
fn the_smallest_scenes_are_lit() {
    for corners in [
        [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
        [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]],
        [[0.5; 3], [0.5; 3], [0.5; 3]],
    ] {
        let geometry = Geometry::flatten(&of(Primitive {
            positions: corners.to_vec(),
            indices: vec![0, 1, 2],
            ..Primitive::default()
        }));
        let t = transfer(
            &geometry,
            leaf(0.5, 0.3),
            PrtSettings {
                paths: 8,
                ..PrtSettings::default()
            },
        );
        assert!(t.values.iter().all(|v| v.is_finite()));
        let white = under_white(&t, 0, 0);
        assert!((white - 0.8).abs() < 1e-3, "{white}");
    }
}

/// Direct transfer of crossed leaves under a linear sky is what integrating by hand gives.
#[test]
fn a_linear_sky_is_exact() {
    let geometry = squares(&[0.0], 2);
    let settings = PrtSettings {
        paths: 4096,
        ..PrtSettings::default()
    };
    let (r, t) = (0.45_f32, 0.25_f32);
    let found = transfer(&geometry, leaf(r, t), settings);
    let up = DVec3::new(0.3, 0.8, 0.5).normalize();
    let sky = umbrage::leaf::environment::Environment::Linear {
        a: DVec3::splat(0.3),
        b: DVec3::splat(0.2),
        up,
    };
    let l = sky.coefficients();
    // A cosine-weighted mean of a + b d.up is a + 2/3 b n.up.
    let above = 0.3 + 0.2 * 2.0 / 3.0 * up.y;
    let below = 0.3 - 0.2 * 2.0 / 3.0 * up.y;
    for (side, expected) in [
        (0, f64::from(r) * above + f64::from(t) * below),
        (1, f64::from(r) * below + f64::from(t) * above),
    ] {
        let value: f64 = found
            .vector(4, side, 0)
            .iter()
            .zip(l)
            .map(|(v, l)| f64::from(v[0]) * l.x)
            .sum();
        assert!((value / expected - 1.0).abs() < 2e-3, "{value} {expected}");
    }
}
