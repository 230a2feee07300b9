//! The foliage bake on the device: twins, determinism, scale, degenerate input, and that only
//! what the settings ask for is run.

use glam::{DAffine3, DVec3, Vec3};
use umbrage::app::conform;
use umbrage::foliage::{AmbientMode, Bake, NormalsMode, Recipe, Settings, Split};
use umbrage::gpu::Gpu;
use umbrage::math::sampling::{uniform, uniform_sphere};
use umbrage::scene::{Geometry, Instance, Material, Mesh, Model, Primitive};

use crate::fixture;

#[test]
fn every_kernel_agrees_with_its_twin() {
    let gpu = fixture::gpu();
    let ours = [
        "generators",
        "density",
        "field",
        "directions",
        "realign",
        "ambient",
        "encode",
    ];
    let mut ran = 0;
    for case in conform::cases() {
        let Some(rest) = case.name.strip_prefix("foliage.") else {
            continue;
        };
        if !ours.iter().any(|prefix| rest.starts_with(prefix)) {
            continue;
        }
        let outcome = (case.run)(&gpu).unwrap();
        assert!(outcome.passed(), "{}: {outcome:?}", case.name);
        ran += 1;
    }
    assert!(ran >= 20, "{ran} cases");
}

/// A crown of `leaves` square leaves in a ball of radius 1 over a trunk, placed and scaled.
fn tree(leaves: u32, to_world: DAffine3) -> Model {
    let mut crown = Primitive {
        material: 0,
        ..Default::default()
    };
    for i in 0..leaves {
        let along = |k: u32| (2.0 * uniform(9, 3 * i + k) - 1.0) as f32;
        // Uniform in the ball: a direction, and the cube root of a uniform number.
        let u = glam::DVec2::new(uniform(9, 3 * i), uniform(9, 3 * i + 1));
        let radius = uniform(9, 3 * i + 2).cbrt();
        let centre = (radius * uniform_sphere(u)).as_vec3();
        let first = crown.positions.len() as u32;
        for corner in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            let at = centre + 0.03 * Vec3::new(corner.0, 0.3 * along(0), corner.1);
            crown.positions.push(at.to_array());
        }
        crown.indices.extend([0, 1, 2, 0, 2, 3].map(|k| first + k));
    }
    let trunk = Primitive {
        material: 1,
        positions: vec![[-0.1, -2.0, 0.0], [0.1, -2.0, 0.0], [0.0, 0.5, 0.0]],
        indices: vec![0, 1, 2],
        ..Default::default()
    };
    let material = |name: &str| Material {
        name: name.into(),
        ..Default::default()
    };
    Model {
        name: "tree".into(),
        materials: vec![material("leaf"), material("bark")],
        meshes: vec![Mesh {
            name: "tree".into(),
            primitives: vec![crown, trunk],
        }],
        instances: vec![Instance {
            name: "tree".into(),
            mesh: 0,
            local_to_world: to_world,
            source: None,
        }],
        ..Default::default()
    }
}

fn small(normals: NormalsMode) -> Settings {
    Settings {
        cells: 24,
        normals,
        ambient: AmbientMode::Eq4,
        ..Settings::default()
    }
}

fn bake(gpu: &Gpu, model: &Model, settings: &Settings) -> Bake {
    let geometry = Geometry::flatten(model);
    let split = Split::new(model, &geometry, None).unwrap();
    let baked = Bake::compute(gpu, model, &geometry, &split, settings, &mut |_, _| {}).unwrap();
    let recipe = Recipe::new(&geometry, &split, settings).unwrap();
    // Fallbacks depend on what is found, so a recipe lists them never.
    if baked.bake.stats.wide_fallbacks + baked.bake.stats.kept_normals == 0 {
        assert_eq!(baked.recipe.passes, recipe.passes, "the recipe is what ran");
    }
    baked.bake
}

#[test]
fn two_bakes_are_bit_equal() {
    let gpu = fixture::gpu();
    let model = tree(300, DAffine3::IDENTITY);
    for mode in [NormalsMode::Gradient, NormalsMode::Vertex] {
        let (a, b) = (
            bake(&gpu, &model, &small(mode)),
            bake(&gpu, &model, &small(mode)),
        );
        assert!(a == b, "two runs of {mode} differ");
    }
}

#[test]
fn normals_point_out_of_a_ball_and_its_core_is_darker() {
    let gpu = fixture::gpu();
    let model = tree(600, DAffine3::IDENTITY);
    // Radii that hold dozens of leaves see the shape of the ball, not its leaves.
    let settings = Settings {
        rho: 0.25,
        rho_ambient: 0.12,
        ..small(NormalsMode::Gradient)
    };
    let baked = bake(&gpu, &model, &settings);
    let geometry = Geometry::flatten(&model);
    let (mut outside, mut core, mut outward) = (Vec::new(), Vec::new(), Vec::new());
    for v in 0..4 * 600 {
        let p = geometry.positions[v] + geometry.origin.as_vec3();
        assert!(
            (baked.normals[v].length() - 1.0).abs() < 1e-4,
            "unit at {v}"
        );
        if p.length() > 0.9 {
            outside.push(baked.ambient[v]);
            outward.push(baked.normals[v].dot(p.normalize()));
        } else if p.length() < 0.5 {
            core.push(baked.ambient[v]);
        }
    }
    let mean = |v: &[f32]| v.iter().sum::<f32>() / v.len() as f32;
    assert!(mean(&outward) > 0.9, "outward: {}", mean(&outward));
    assert!(
        mean(&outside) > mean(&core),
        "{} {}",
        mean(&outside),
        mean(&core)
    );
}

/// Also in the modes that choose (the nearest vertex, the way down to the surface), where one bit
/// decides between two places that are equally near.
#[test]
fn scale_and_distance_change_nothing() {
    let gpu = fixture::gpu();
    let offset = DVec3::new(5e6, 100.0, -5e6);
    let placed = [(1e-3, DVec3::ZERO), (1e6, offset), (1.0, offset)].map(|(scale, offset)| {
        let placement = DAffine3::from_scale_rotation_translation(
            DVec3::splat(scale),
            glam::DQuat::IDENTITY,
            offset,
        );
        (scale, tree(200, placement))
    });
    for mode in [
        NormalsMode::Vertex,
        NormalsMode::Face,
        NormalsMode::Exact,
        NormalsMode::Gradient,
        NormalsMode::Multiscale,
        NormalsMode::Open,
    ] {
        let settings = small(mode);
        let expected = bake(&gpu, &tree(200, DAffine3::IDENTITY), &settings);
        for (scale, model) in &placed {
            let got = bake(&gpu, model, &settings);
            for (v, (a, b)) in expected.normals.iter().zip(&got.normals).enumerate() {
                let angle = a.angle_between(*b).to_degrees();
                assert!(
                    angle < 0.1,
                    "{mode:?}: {angle} degrees at {v}, scale {scale}"
                );
            }
            // What reaches the device is rounded once, from f64: hardly a bit may differ.
            let pairs = expected.normals.iter().zip(&got.normals);
            let moved = pairs.filter(|(a, b)| a != b).count();
            assert!(
                moved * 50 <= expected.normals.len(),
                "{mode:?}: {moved} of {} normals differ, scale {scale}",
                expected.normals.len()
            );
            for (a, b) in expected.ambient.iter().zip(&got.ambient) {
                assert!(
                    (a - b).abs() < 1e-3,
                    "{mode:?}: ambient {a} {b}, scale {scale}"
                );
            }
        }
    }
}

#[test]
fn one_leaf_and_coincident_leaves_give_finite_results() {
    let gpu = fixture::gpu();
    let mut coincident = tree(40, DAffine3::IDENTITY);
    for p in &mut coincident.meshes[0].primitives[0].positions {
        *p = [0.25; 3];
    }
    for model in [tree(1, DAffine3::IDENTITY), coincident] {
        let baked = bake(&gpu, &model, &small(NormalsMode::Gradient));
        assert!(
            baked
                .normals
                .iter()
                .all(|n| n.is_finite() && n.length() > 0.9),
            "normals"
        );
        assert!(
            baked.ambient.iter().all(|k| (0.0..=1.0).contains(k)),
            "ambient"
        );
    }
}

#[test]
fn only_what_the_settings_ask_for_is_run() {
    let model = tree(50, DAffine3::IDENTITY);
    let geometry = Geometry::flatten(&model);
    let split = Split::new(&model, &geometry, None).unwrap();
    let recipe = |settings: &Settings| Recipe::new(&geometry, &split, settings).unwrap();
    let gradient = recipe(&small(NormalsMode::Gradient));
    let vertex = recipe(&small(NormalsMode::Vertex));
    let grid = |r: &Recipe| r.passes.iter().any(|p| p.contains("grid"));
    assert!(!grid(&gradient), "gradient and equation 4 need no grid");
    assert!(grid(&vertex), "vertex needs one");
    assert!(gradient.bytes() < vertex.bytes(), "and its bytes");
    let nothing = recipe(&Settings {
        ambient: AmbientMode::None,
        encoding: umbrage::foliage::Encoding::None,
        ..small(NormalsMode::Original)
    });
    assert_eq!(nothing, Recipe::default(), "nothing asked for, nothing run");
}

#[test]
fn a_grid_over_the_bound_is_refused_with_its_size() {
    let model = tree(20, DAffine3::IDENTITY);
    let geometry = Geometry::flatten(&model);
    let split = Split::new(&model, &geometry, None).unwrap();
    let settings = Settings {
        cells: 1024,
        memory: 1,
        ..small(NormalsMode::Vertex)
    };
    let message = Recipe::new(&geometry, &split, &settings)
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("bytes") && message.contains("1048576"),
        "{message}"
    );
}
