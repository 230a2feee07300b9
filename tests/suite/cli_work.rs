//! The program's real work, as a user runs it: what is written, cached, reported.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use umbrage::scene::Model;
use umbrage::scene::import::{self, LoadOptions};

use crate::place::{Place, stderr};
use crate::small_model::small_tree;

/// A grown shrub small enough for a second.
const SHRUB: &str = "grow:shrub:1:400";

/// Coarse grids: these tests are about files, not about accuracy.
const QUICK: [&str; 3] = ["--validate", "--cells", "16"];

fn with<'a>(arguments: &[&'a str], more: &[&'a str]) -> Vec<&'a str> {
    [arguments, more].concat()
}

fn load(path: &Path) -> Model {
    import::load(path, &LoadOptions::default()).unwrap()
}

/// Every ambient coefficient of a model.
fn ambient(model: &Model) -> Vec<f32> {
    let primitives = model.meshes.iter().flat_map(|m| &m.primitives);
    primitives.flat_map(|p| p.ambient.iter().copied()).collect()
}

fn mean(values: &[f32]) -> f32 {
    values.iter().sum::<f32>() / values.len() as f32
}

/// Stages of a report that ran on the device.
fn device_stages(report: &Value) -> usize {
    let times = report["times"].as_array().unwrap();
    times.iter().filter(|t| t["on"] != "cpu").count()
}

fn cached_bakes(place: &Place) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(place.path("cache/umbrage")) else {
        return Vec::new();
    };
    entries
        .map(|e| e.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == "bake"))
        .collect()
}

#[test]
fn a_baked_model_keeps_its_shape_and_gains_ambient() {
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    let report = place.json(&with(&["bake", &tree, "-o", "out.glb"], &QUICK));
    assert_eq!(report["foliage_vertices"], 8, "{report:#}");
    assert_eq!(report["covered_vertices"], 3, "{report:#}");
    let (before, after) = (load(Path::new(&tree)), load(&place.path("out.glb")));
    let positions = |m: &Model| -> Vec<[f32; 3]> {
        let primitives = m.meshes.iter().flat_map(|m| &m.primitives);
        primitives.flat_map(|p| p.positions.clone()).collect()
    };
    assert_eq!(positions(&before), positions(&after), "same positions");
    assert_eq!(
        before.materials.len(),
        after.materials.len(),
        "same materials"
    );
    let ambient = ambient(&after);
    assert_eq!(ambient.len(), 11, "one coefficient a vertex");
    assert!(
        ambient.iter().all(|k| (0.0..=1.0).contains(k)),
        "{ambient:?}"
    );
}

#[test]
fn a_second_bake_is_found_and_a_damaged_one_is_not_trusted() {
    let place = Place::new();
    let bake = |output: &str, more: &[&str]| {
        let arguments = with(&["bake", SHRUB, "-o", output], &QUICK);
        let report = place.json(&with(&arguments, more));
        (
            device_stages(&report),
            fs::read(place.path(output)).unwrap(),
        )
    };
    let (passes, first) = bake("1.glb", &[]);
    assert!(passes > 0, "the first run computes");
    assert_eq!(cached_bakes(&place).len(), 1, "and keeps its bake");
    let (passes, second) = bake("2.glb", &[]);
    assert_eq!(passes, 0, "the second run computes nothing");
    assert!(first == second, "and writes the same file");
    let (passes, _) = bake("3.glb", &["--k-min", "0.3"]);
    assert!(passes > 0, "another setting is another bake");
    for path in cached_bakes(&place) {
        let mut bytes = fs::read(&path).unwrap();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        fs::write(&path, bytes).unwrap();
    }
    let output = place.umbrage(&with(&["bake", SHRUB, "-o", "4.glb"], &QUICK));
    assert!(
        stderr(&output).contains("damaged"),
        "told: {}",
        stderr(&output)
    );
    let anew = fs::read(place.path("4.glb")).unwrap();
    assert!(anew == first, "computed anew");
    let (passes, again) = bake("5.glb", &[]);
    assert_eq!((passes, again == first), (0, true), "and kept again");
    let (passes, anew) = bake("6.glb", &["--no-cache"]);
    assert!(passes > 0, "without the cache it computes");
    assert!(anew == first, "the same bytes");
}

#[test]
fn no_cache_leaves_no_trace() {
    let place = Place::new();
    place.json(&with(&["bake", SHRUB, "-o", "1.glb", "--no-cache"], &QUICK));
    assert!(!place.path("cache/umbrage").exists(), "no cache folder");
}

#[test]
fn plants_of_a_scene_darken_each_other() {
    let place = Place::new();
    let bake = |folder: &str, distance: f32| {
        let scene = format!(
            "[foliage]\ncells = 16\n[[plants]]\ngrow = 'shrub'\nleaves = 400\n\
             [[plants]]\nname = 'second'\ngrow = 'shrub'\nleaves = 400\nyaw = 90\nat = [{distance}, 0, 0]"
        );
        let file = place.write(&format!("{folder}.toml"), scene);
        place.json(&[
            "bake",
            &file,
            "-o",
            folder,
            "--validate",
            "--ambient",
            "transmittance",
        ]);
        let names = ["shrub.glb", "second.glb"];
        names.map(|name| load(&place.path(&format!("{folder}/{name}"))))
    };
    let near = bake("near", 0.3);
    let far = bake("far", 30.0);
    for (near, far) in near.iter().zip(&far) {
        let (close, apart) = (mean(&ambient(near)), mean(&ambient(far)));
        assert!(
            close < apart - 0.02,
            "{close} beside a neighbour, {apart} alone"
        );
        let corner = |m: &Model| m.meshes[0].primitives[0].positions[0];
        assert_eq!(
            corner(near),
            corner(far),
            "files keep their own coordinates"
        );
    }
}

#[test]
fn a_picture_shows_a_green_plant_before_a_plain_ground() {
    let place = Place::new();
    let report = place.json(&with(
        &["render", SHRUB, "-o", "shrub.png", "--size", "160x120"],
        &QUICK,
    ));
    assert_eq!(report["width"], 160, "{report:#}");
    let picture = image::open(place.path("shrub.png")).unwrap().to_rgb8();
    assert_eq!(picture.dimensions(), (160, 120), "size");
    let colours: BTreeSet<[u8; 3]> = picture.pixels().map(|p| p.0).collect();
    assert!(colours.len() > 500, "{} colours", colours.len());
    let share = |test: fn([u8; 3]) -> bool| {
        picture.pixels().filter(|p| test(p.0)).count() as f64 / f64::from(160 * 120)
    };
    let green = share(|[r, g, b]| g > r && u16::from(g) > u16::from(b) + 10);
    assert!((0.05..0.9).contains(&green), "green share {green}");
    let dark = share(|c| c.iter().all(|&v| v < 90));
    assert!(dark > 0.005, "dark core and shadow: share {dark}");
    let lost = share(|c| c == [0; 3] || c == [255; 3]);
    assert!(lost < 0.02, "share without detail {lost}");
}

#[test]
fn sheets_stand_side_by_side_and_below_each_other() {
    let place = Place::new();
    let sheet = ["--compare", "standard,textured,normals", "--size", "64x48"];
    let one = with(&["render", SHRUB, "-o", "1.png"], &sheet);
    let one = place.json(&with(&one, &QUICK));
    let two = with(&["render", SHRUB, "grow:lime:1:300", "-o", "2.jpg"], &sheet);
    let two = place.json(&with(&two, &QUICK));
    assert!(one["width"].as_u64().unwrap() >= 3 * 64, "{one:#}");
    assert_eq!(one["width"], two["width"], "as many columns");
    assert!(two["height"].as_u64().unwrap() >= 2 * 48, "two rows");
    let jpeg = fs::read(place.path("2.jpg")).unwrap();
    assert_eq!(&jpeg[..3], [0xff, 0xd8, 0xff], "JPEG by extension");
}

#[test]
fn every_view_can_be_drawn() {
    let place = Place::new();
    let views = "ambient,direct,combined,shadowed,textured,standard,normals,depth,slice,surface";
    let arguments = [
        "render",
        SHRUB,
        "-o",
        "v.png",
        "--size",
        "48x48",
        "--compare",
        views,
    ];
    place.json(&with(&arguments, &QUICK));
    let sheet = image::open(place.path("v.png")).unwrap().to_rgb8();
    let count = u32::try_from(views.split(',').count()).unwrap();
    let gap = (sheet.width() - count * 48) / (count + 1);
    let cells: BTreeSet<Vec<u8>> = (0..count)
        .map(|i| {
            let x = gap + i * (48 + gap);
            image::imageops::crop_imm(&sheet, x, gap, 48, 48)
                .to_image()
                .into_raw()
        })
        .collect();
    assert_eq!(
        cells.len(),
        count as usize,
        "no two views are the same picture"
    );
}

#[test]
fn the_surface_is_a_closed_mesh() {
    let place = Place::new();
    let report = place.json(&with(&["surface", SHRUB, "-o", "shell.glb"], &QUICK));
    let model = load(&place.path("shell.glb"));
    let mesh = &model.meshes[0].primitives[0];
    assert_eq!(report["triangles"], mesh.indices.len() / 3, "{report:#}");
    let mut edges: Vec<(u32, u32)> = mesh
        .indices
        .chunks_exact(3)
        .flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])])
        .collect();
    let mut reversed: Vec<(u32, u32)> = edges.iter().map(|&(a, b)| (b, a)).collect();
    edges.sort_unstable();
    reversed.sort_unstable();
    assert!(!edges.is_empty(), "there are triangles");
    assert_eq!(edges, reversed, "each edge is met once from each side");
}

#[test]
fn the_same_seed_grows_the_same_file() {
    let place = Place::new();
    let grow = |seed: &str, output: &str| {
        let arguments = [
            "grow", "shrub", "--leaves", "200", "--seed", seed, "-o", output,
        ];
        let report = place.json(&arguments);
        assert_eq!(report["leaves"], 200, "{report:#}");
        fs::read(place.path(output)).unwrap()
    };
    let first = grow("7", "a.glb");
    assert!(first == grow("7", "b.glb"), "same seed");
    assert!(first != grow("8", "c.glb"), "another seed");
}

#[test]
fn benchmarks_report_passes_device_and_bytes() {
    let place = Place::new();
    for (what, queue) in [("bake", "compute"), ("render", "graphics")] {
        let arguments = ["bench", what, SHRUB, "--runs", "2", "--warm-up", "1"];
        let report = place.json(&with(&arguments, &QUICK));
        let passes = report["passes"].as_array().unwrap();
        assert!(!passes.is_empty(), "{report:#}");
        for pass in passes {
            assert_eq!(pass["on"], queue, "{pass:#}");
            assert_eq!(pass["samples"], 2, "warm-up does not count: {pass:#}");
        }
        assert!(report["device_bytes"].as_u64().unwrap() > 0, "{report:#}");
        assert!(
            report["device"]["vector_width"].as_u64().unwrap() > 0,
            "{report:#}"
        );
    }
}

#[test]
fn benchmarks_of_slice_and_surface_draw_them() {
    let place = Place::new();
    for view in ["slice", "surface"] {
        let arguments = ["bench", "render", SHRUB, "--runs", "1", "--warm-up", "0"];
        let report = place.json(&with(&with(&arguments, &["--view", view]), &QUICK));
        let passes = report["passes"].as_array().unwrap();
        assert!(
            passes.iter().any(|p| p["stage"] == "overlay"),
            "{view}: {report:#}"
        );
    }
}

#[test]
fn conformance_reports_each_case() {
    let place = Place::new();
    let report = place.json(&["--validate", "conform", "gpu."]);
    assert_eq!(report["failed"], 0, "{report:#}");
    assert_eq!(
        report["passed"].as_u64().unwrap() as usize,
        report["cases"].as_array().unwrap().len(),
        "{report:#}"
    );
    let output = place.umbrage(&["conform", "gpu.fill_sequence.one"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.starts_with("Pass gpu.fill_sequence.one error 0 limit 0 "),
        "{text}"
    );
}
