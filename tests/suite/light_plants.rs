//! Plants that stand in several places share one light file; leaves take levels of detail.

use std::path::PathBuf;

use glam::DVec3;
use umbrage::app::cli::light::OpticsArgs;
use umbrage::app::lit::LitModel;
use umbrage::app::relight::{Relight, Relighting};
use umbrage::leaf::environment::{Environment, Sun};
use umbrage::leaf::film::Film;
use umbrage::leaf::lamp::Lamp;
use umbrage::leaf::shape::Shape;
use umbrage::scene::{Camera, CameraSpec, Lens};

use crate::place::Place;
use crate::small_model::small_tree;

/// The leaves of the plants.
const LEAF: [&str; 4] = [
    "--reflectance",
    "0.3,0.35,0.2",
    "--transmittance",
    "0.2,0.25,0.1",
];

const HOW: Relighting = Relighting {
    window: 0.002,
    direct_sun: true,
    order: 5,
    lod_pixels: 0.0,
};

fn lit(path: &str) -> LitModel {
    let source = path.parse().unwrap();
    let optics = OpticsArgs {
        reflectance: LEAF[1].parse().ok(),
        transmittance: LEAF[3].parse().ok(),
        ..OpticsArgs::default()
    };
    LitModel::new(&source, &[], None, &optics).unwrap()
}

/// A sun and a sky that are nowhere alike.
fn film(eye: DVec3) -> Film {
    let target = DVec3::new(0.0, 1.5, 0.0);
    let spec = CameraSpec::LookAt { eye, target };
    let lens = Lens {
        fov: 40.0,
        aspect: 1.0,
        margin: 0.0,
    };
    Film {
        camera: Camera::new(&spec, lens, DVec3::ZERO, std::iter::empty()),
        size: [256, 256],
        sun: Sun {
            towards: DVec3::new(0.5, 0.6, 0.4).normalize(),
            radius_degrees: 0.2665,
            irradiance: DVec3::new(3.0, 2.5, 2.0),
        },
        sun_shape: Shape::Disc,
        lamps: Vec::new(),
        sky: Environment::Linear {
            a: DVec3::new(0.3, 0.4, 0.5),
            b: DVec3::new(0.2, 0.1, 0.3),
            up: DVec3::new(0.3, 0.8, -0.5).normalize(),
        },
    }
}

fn radiance(lit: &LitModel, light: PathBuf, how: &Relighting, film: &Film) -> Vec<[f32; 3]> {
    let mut relight = Relight::read(lit, &[light]).unwrap();
    relight.radiance(film, how, lit.vertices()).unwrap()
}

fn scene(place: &Place, name: &str, places: &[&str]) -> String {
    let text: String = places
        .iter()
        .map(|at| format!("[[plants]]\nmodel = \"tree.glb\"\n{at}\n"))
        .collect();
    place.write(name, text)
}

fn light(place: &Place, what: &str, to: &str, more: &[&str]) -> PathBuf {
    let all = ["light", what, "-o", to, "--directions", "none"];
    place.json(&[&all[..], &LEAF, more].concat());
    place.path(to)
}

#[test]
fn a_plant_in_two_places_is_lit_like_the_plant_alone() {
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    let file = light(&place, &tree, "tree.light", &["--paths", "16"]);
    let alone = lit(&tree);
    let alone = radiance(&alone, file.clone(), &HOW, &film(DVec3::Z));
    let two = scene(
        &place,
        "two.toml",
        &["", "at = [9.0, 1.0, 0.0]\nscale = 2.0"],
    );
    let two = lit(&two);
    assert_eq!(two.model.meshes.len(), 1, "the triangles are kept once");
    let both = radiance(&two, file.clone(), &HOW, &film(DVec3::Z));
    assert!(both[..alone.len()] == alone, "the first, in every bit");
    assert!(both[alone.len()..] == alone, "the second, in every bit");
    let bytes = Relight::read(&two, &[file]).unwrap().bytes()[0];
    assert_eq!(bytes, [600 * 11, 2 * 600 * 11], "vectors once");
}

/// Sky, sun and lamps are turned into the plant's frame: what comes out is the light of the turned
/// plant, computed for itself, but for the noise of its own paths.
#[test]
fn a_turned_plant_is_lit_like_the_turned_model() {
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    let paths = ["--paths", "32768", "--storage", "f32"];
    let file = light(&place, &tree, "tree.light", &paths);
    let turned = scene(&place, "turned.toml", &["yaw = 130.0\nscale = 0.7"]);
    let own = light(&place, &turned, "turned.light", &paths);
    let turned = lit(&turned);
    let mut film = film(DVec3::Z);
    film.lamps = vec![Lamp::parse("disc:3,6,2/-0.4,-1,-0.2/0.3/30").unwrap()];
    let [shared, own] = [file, own].map(|f| radiance(&turned, f, &HOW, &film));
    let mean = |v: &[[f32; 3]]| {
        let sum: f64 = v.as_flattened().iter().map(|&v| f64::from(v)).sum();
        sum / (3 * v.len()) as f64
    };
    let (a, b) = (mean(&shared), mean(&own));
    assert!((a / b - 1.0).abs() < 2e-3, "{a} and {b}");
    let squares: f64 = shared
        .as_flattened()
        .iter()
        .zip(own.as_flattened())
        .map(|(a, b)| f64::from(a - b).powi(2))
        .sum();
    let rmse = (squares / (3 * own.len()) as f64).sqrt() / b;
    assert!(rmse < 0.02, "{rmse}");
}

#[test]
fn near_leaves_take_the_finest_level_and_far_ones_the_coarsest() {
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    let paths = ["--paths", "16", "--lod"];
    let levels = |lod: &str, to: &str| light(&place, &tree, to, &[&paths[..], &[lod]].concat());
    let all = levels("0,0.5", "all.light");
    let coarse = levels("0.5", "coarse.light");
    let fine = levels("0", "fine.light");
    let lit = lit(&tree);
    let at = |file: &PathBuf, lod_pixels: f64, distance: f64| {
        let how = Relighting { lod_pixels, ..HOW };
        radiance(&lit, file.clone(), &how, &film(DVec3::Z * distance))
    };
    let [finest, coarsest] = [&fine, &coarse].map(|f| at(f, 0.0, 5.0));
    assert!(finest != coarsest);
    assert!(at(&all, 0.0, 1e4) == finest, "0 pixels: the exact end");
    assert!(at(&all, 4.0, 1e4) == coarsest, "far away");
    let between = at(&all, 4.0, 60.0);
    assert!(between != finest && between != coarsest, "blended");
}

#[test]
fn wrong_files_for_plants_are_refused() {
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    let tall = small_tree().with(|m| m.set_position(0, 1, 5.0));
    let tall = place.write("tall.glb", tall.glb());
    light(&place, &tree, "tree.light", &["--paths", "4"]);
    light(&place, &tall, "tall.light", &["--paths", "4"]);
    let one = scene(&place, "one.toml", &[""]);
    let draw = |lights: &[&'static str]| {
        let draw = ["render", &one, "-o", "out.png", "--lighting", "leaf"];
        [&draw[..], &LEAF, lights].concat()
    };
    place.assert_refused(
        &draw(&["--light", "tall.light"]),
        &["none of the files", "tree"],
    );
    let both = ["--light", "tree.light", "--light", "tall.light"];
    place.assert_refused(&draw(&both), &["tall.light", "another model"]);
    let small = ["--size", "32x32", "--light", "tree.light"];
    place.json(&draw(&small));
}
