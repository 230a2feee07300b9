//! Orders, storage and matrices of transfer.

use glam::{DVec3, Vec3};
use umbrage::leaf::environment::{Environment, Sun};
use umbrage::leaf::light::{Lighting, Storage, StoredTransfer, exit_radiance};
use umbrage::leaf::lvc::SUN_RADIUS_DEGREES;
use umbrage::leaf::matrix::{Colours, StoredMatrices, diffuse, matrix_floats, pack};
use umbrage::leaf::optics::Optics;
use umbrage::leaf::prt::{Prt, PrtSettings, Transfer};
use umbrage::leaf::rays::{Occluders, RayScene};
use umbrage::leaf::receivers::Receivers;
use umbrage::leaf::storage_error::storage_errors;
use umbrage::scene::{Geometry, Part};

use super::fixture;
use crate::model_fixture::shared;
use crate::place::Place;
use crate::small_model::small_tree;

/// Two squares of edge 2, one 0.5 above the other and shifted; fronts up.
fn squares() -> Geometry {
    let mut g = Geometry::default();
    for (x, y) in [(0.0, 0.0), (0.7, 0.5)] {
        let first = g.positions.len() as u32;
        for (s, t) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            g.positions.push(Vec3::new(x + s, y, t));
            g.normals.push(Vec3::Y);
            g.texcoords.push([0.0; 2]);
        }
        g.indices.extend([0, 2, 1, 0, 3, 2].map(|k| first + k));
    }
    (g.min, g.max) = (Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.7, 0.5, 1.0));
    g.parts.push(Part {
        instance: 0,
        mesh: 0,
        primitive: 0,
        material: 0,
        first_vertex: 0,
        vertex_count: 8,
        first_index: 0,
        index_count: 12,
    });
    g
}

fn leaf() -> Optics {
    Optics {
        rho_d_back: [0.2, 0.3, 0.1],
        rho_t: [0.25, 0.3, 0.05],
        ..Optics::opaque([0.3, 0.4, 0.1])
    }
}

/// Matrices of the squares, and the receivers they belong to.
fn matrices(settings: PrtSettings, colours: Colours) -> (StoredMatrices, Receivers) {
    let gpu = fixture::gpu();
    let geometry = squares();
    let occluders = Occluders::solid(&geometry);
    let receivers = Receivers::new(&geometry, &occluders, &[leaf()]);
    let scene = RayScene::new(&gpu, &occluders).unwrap();
    let mut prt = Prt::matrices(&gpu, &scene, &receivers, settings).unwrap();
    let mut packed = Vec::new();
    prt.run(&mut |prt| {
        packed.extend(pack(&prt.take(), settings.order, colours));
        Ok(())
    })
    .unwrap();
    let form = (settings.order, colours);
    let stored = StoredMatrices::new(&packed, form, Storage::F32, (settings.paths, 0.0));
    (stored, receivers)
}

fn sky() -> Environment {
    Environment::Linear {
        a: DVec3::new(0.24, 0.27, 0.30),
        b: DVec3::new(0.12, 0.135, 0.15),
        up: DVec3::Y,
    }
}

fn sun() -> Sun {
    Sun {
        towards: DVec3::new(0.5, 0.8, -0.3).normalize(),
        radius_degrees: SUN_RADIUS_DEGREES,
        irradiance: DVec3::new(3.0, 2.85, 2.55),
    }
}

fn transfer(settings: PrtSettings) -> Transfer {
    let gpu = fixture::gpu();
    let geometry = squares();
    let occluders = Occluders::solid(&geometry);
    let receivers = Receivers::new(&geometry, &occluders, &[leaf()]);
    let scene = RayScene::new(&gpu, &occluders).unwrap();
    let mut prt = Prt::new(&gpu, &scene, &receivers, settings).unwrap();
    prt.all(&mut |_| Ok(())).unwrap()
}

/// A lower order is the beginning of a higher one (kernels of other orders round otherwise), and
/// takes its share of the memory.
#[test]
fn orders_are_nested() {
    let of = |order: u32| {
        transfer(PrtSettings {
            order,
            paths: 24,
            ..PrtSettings::default()
        })
    };
    let all = of(6);
    for order in 1..=5 {
        let few = of(order);
        let count = (order * order) as usize;
        assert_eq!(few.values.len(), 8 * 2 * 2 * count * 3);
        for (vertex, side, part) in (0..32).map(|i| (i / 4, i / 2 % 2, i % 2)) {
            let [few, all] = [&few, &all].map(|t| t.vector(vertex, side, part));
            for (a, b) in few.iter().flatten().zip(all[..count].iter().flatten()) {
                assert!(
                    (a - b).abs() < 1e-6,
                    "{order}: {vertex} {side} {part}: {a} {b}"
                );
            }
        }
        let stored = StoredTransfer::new(&few, Storage::F32, 24, 0.0);
        assert_eq!(stored.receivers(), 8);
        assert_eq!(stored.transfer(), few);
    }
}

/// Rounding to f16 is seen nowhere, to bytes hardly.
#[test]
fn storage_costs_what_is_told() {
    let t = transfer(PrtSettings {
        paths: 256,
        ..PrtSettings::default()
    });
    let (sky, sun) = (sky().coefficients(), sun().coefficients(0.002));
    let errors = storage_errors(&t, &sky, &sun);
    let limits = [(0.0, 0.0), (5e-4, 1e-3), (5e-3, 0.04)];
    for (e, (all, indirect)) in errors.iter().zip(limits) {
        assert!(e.all <= all && e.indirect <= indirect, "{e:?}");
    }
    assert_eq!([0, 1, 2].map(|k| errors[k].bytes), [9600, 4800, 2400]);
}

/// Diffuse leaves by matrices look like the same leaves by vectors: what is left is the cosine's
/// share above the bands, and noise.
#[test]
fn matrices_light_diffuse_leaves_as_vectors_do() {
    let settings = PrtSettings {
        order: 6,
        paths: 4096,
        ..PrtSettings::default()
    };
    let vectors = transfer(settings);
    let (sky, sun) = (sky().coefficients(), sun().coefficients(0.002));
    let lighting = Lighting {
        sky: &sky,
        sun: &sun,
        direct_sun: false,
        order: 6,
    };
    let wanted = exit_radiance(&vectors, &lighting);
    for (colours, limit) in [(Colours::Rgb, 0.02), (Colours::Mono, 0.12)] {
        let (stored, receivers) = matrices(settings, colours);
        assert_eq!(stored.bytes.len(), 8 * 4 * matrix_floats(6, colours));
        let light = stored.incident(&lighting, &receivers.points);
        let found = diffuse(&light, 6, &receivers.points, &receivers.materials);
        let (mut mean, mut square) = (0.0, 0.0);
        for (a, b) in found.as_flattened().iter().zip(wanted.as_flattened()) {
            mean += f64::from(*b);
            square += f64::from(a - b).powi(2);
        }
        let error = (square * 48.0).sqrt() / mean;
        assert!(error < limit, "{colours:?}: {error}");
    }
}

/// The sky in glossy leaves, by the lobe and as if it were diffuse, against a path-traced picture
/// of another program. The last runs gave 4.6 % and 6.1 %.
#[test]
fn the_sky_in_glossy_leaves_is_nearer_by_matrices() {
    let place = Place::new();
    let path = |name: &str| {
        let path = shared(&format!("../leaf/truth/{name}"));
        path.to_str().unwrap().to_owned()
    };
    let (model, sky) = (path("leaf50.obj"), path("leaf50_gloss_sky_full.exr"));
    let sky = sky.strip_suffix("_full.exr").unwrap();
    let leaf = [
        &["--up", "z", "--reflectance", "0.1207,0.1581,0.0469"][..],
        &["--reflectance-below", "0.1689,0.2031,0.0828"],
        &["--transmittance", "0.1723,0.2025,0.0402"],
        &["--gloss", "0.04", "--roughness", "0.3", "--validate"],
    ]
    .concat();
    let light = ["light", &model, "-o", "a.light", "--transfer", "both"];
    let few = ["--paths", "24", "--directions", "none"];
    let report = place.json(&[&light[..], &few, &leaf].concat());
    // Half precision: 325 and 625 elements.
    assert_eq!(
        report["transfer"]["matrix_bytes"],
        4550 * 1900,
        "{report:#}"
    );
    let draw = [
        &["render", &model, "-o", "out.png", "--light", "a.light"][..],
        &[
            "--lighting",
            "leaf",
            "--sun-irradiance",
            "0",
            "--reference",
            sky,
        ],
        &[
            "--size",
            "256x256",
            "--camera",
            "0.42,0.22,0.34/0,0,0",
            "--fov",
            "42",
        ],
        // Without rays for the gloss: matrices against vectors.
        &["--supersample", "2", "--splits", "1", "--gloss-rays", "0"],
        &leaf,
    ]
    .concat();
    let error = |gloss: &str| {
        let report = place.json(&[&draw[..], &["--sky-gloss", gloss]].concat());
        report["errors"][0]["block_rmse"].as_f64().unwrap()
    };
    let (lobe, diffuse) = (error("lobe"), error("diffuse"));
    assert!(lobe < 0.9 * diffuse && lobe < 0.055, "{lobe} {diffuse}");
}

#[test]
fn a_tree_is_lit_by_matrices() {
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    let light = |more: &[&str]| {
        let what = ["light", &tree, "--paths", "8", "--directions", "none"];
        place.json(&[&what[..], more].concat())
    };
    light(&[
        "-o",
        "m.light",
        "--transfer",
        "matrix",
        "--matrix-colours",
        "rgb",
        "--order",
        "3",
    ]);
    light(&[
        "-o",
        "b.light",
        "--transfer",
        "both",
        "--lod",
        "0.2",
        "--storage",
        "8bit",
    ]);
    light(&["-o", "v.light"]);
    let draw = [
        "render",
        &tree,
        "-o",
        "out.png",
        "--size",
        "48x48",
        "--lighting",
        "leaf,prt",
        "--splits",
        "0",
        "--validate",
        "--light",
    ];
    for gloss in ["lobe", "diffuse", "none"] {
        place.json(&[&draw[..], &["b.light", "--sky-gloss", gloss]].concat());
    }
    place.json(&[&draw[..], &["m.light", "--gloss-form", "safe"]].concat());
    place.json(
        &[
            &draw[..],
            &["b.light", "--transfer", "matrix", "--order", "2"],
        ]
        .concat(),
    );
    place.json(&[&draw[..], &["b.light", "--transfer", "vector"]].concat());
    let refused = |light: &str, transfer: &str, words: &[&str]| {
        place.assert_refused(
            &[&draw[..], &[light, "--transfer", transfer]].concat(),
            words,
        );
    };
    refused("v.light", "matrix", &["transfer matrices"]);
    refused("m.light", "vector", &["transfer vectors"]);
    let lamp = ["m.light", "--lamp", "disc:0,9,0/0,-1,0/0.1/6,5,4"];
    place.assert_refused(&[&draw[..], &lamp].concat(), &["--lamp", "--transfer both"]);
    let wrong = |more: &[&str], words: &[&str]| {
        let what = ["light", &tree, "-o", "x.light", "--transfer", "matrix"];
        place.assert_refused(&[&what[..], more].concat(), words);
    };
    wrong(&["--matrix-colours", "grey"], &["grey"]);
    wrong(
        &["--max-bytes", "100000", "--directions", "none"],
        &["--max-bytes"],
    );
}
