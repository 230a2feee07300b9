//! Sheets of lit pictures: shadow maps beside visibility maps, and rows of differences.

use crate::model_fixture::shared;
use crate::place::Place;
use crate::small_model::small_tree;

/// With the sun alone a shadow map and stored visibility show the same, but for its texels.
#[test]
fn a_shadow_map_casts_the_shadows_of_visibility() {
    let place = Place::new();
    let model = shared("../leaf/truth/crossed.obj");
    let report = place.json(&[
        "render",
        model.to_str().unwrap(),
        "-o",
        "out.png",
        "--validate",
        "--up",
        "z",
        "--size",
        "128x128",
        "--camera",
        "0.16,0.12,0.22/0,0,0",
        "--fov",
        "34",
        "--sun-direction",
        "0.439385,0.819152,-0.368688",
        "--environment",
        "constant:0",
        "--splits",
        "4",
        "--transmittance",
        "0.17,0.2,0.04",
        "--shadow-radius",
        "1",
        "--lighting",
        "shadow,ambient,lvc",
        "--difference",
    ]);
    for row in report["errors"].as_array().unwrap() {
        let bias = row["bias"].as_f64().unwrap();
        let blocks = row["block_rmse"].as_f64().unwrap();
        assert!(bias.abs() < 0.03 && blocks < 0.08, "{row:#}");
    }
    assert_eq!(report["errors"].as_array().unwrap().len(), 2, "to the last");
    let sheet = image::open(place.path("out.png")).unwrap();
    assert_eq!(
        (sheet.width(), sheet.height()),
        (8 + 3 * 136, 8 + 2 * (128 + 28)),
        "a row of differences"
    );
}

#[test]
fn a_shadow_map_needs_no_light_file_and_with_transfer_it_does() {
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    let draw = [
        "render",
        &tree,
        "-o",
        "out.png",
        "--size",
        "48x48",
        "--reflectance",
        "0.2",
    ];
    let with = |more: &[&'static str]| [&draw[..], more].concat();
    place.json(&with(&["--lighting", "shadow", "--shadow-size", "64"]));
    place.assert_refused(&with(&["--lighting", "shadow-prt"]), &["--light"]);
    place.json(&[
        "light",
        &tree,
        "-o",
        "a.light",
        "--paths",
        "8",
        "--directions",
        "none",
        "--reflectance",
        "0.2",
    ]);
    place.json(&with(&[
        "--lighting",
        "shadow-prt,leaf",
        "--light",
        "a.light",
        "--difference=0.2",
        "--validate",
    ]));
}

/// A leaf file's veins are drawn pixel by pixel, its outline is cut out, and its mean stays.
#[test]
fn leaves_with_maps_are_drawn_by_them() {
    let place = Place::new();
    let edit = [
        "leaf",
        "edit",
        "maple",
        "-o",
        "maple.toml",
        "--size",
        "64x64",
    ];
    place.json(&edit);
    let card = "v -1 0 0\nv 1 0 0\nv 1 2 0\nv -1 2 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
                f 1/1 2/2 3/3 4/4\n";
    let card = place.write("card.obj", card);
    let draw = |leaf: &str, out: &str| {
        let sun = ["--sun-direction", "0,0.2,1", "--environment", "constant:0"];
        let what = [
            "render",
            &card,
            "-o",
            out,
            "--size",
            "96x96",
            "--lighting",
            "lvc,truth",
        ];
        let how = [
            "--leaf",
            leaf,
            "--camera",
            "0,0",
            "--truth-samples",
            "8",
            "--validate",
        ];
        let report = place.json(&[&what[..], &how, &sun].concat());
        report["errors"][0].clone()
    };
    let mapped = draw("maple.toml", "maps.png");
    let directional = {
        let what = [
            "render",
            &card,
            "-o",
            "d.png",
            "--size",
            "96x96",
            "--lighting",
            "lvc,truth",
            "--leaf",
            "maple.toml",
            "--camera",
            "0,0",
            "--truth-samples",
            "8",
            "--directional",
            "--sun-direction",
            "0,1,0.4",
            "--environment",
            "constant:0",
            "--validate",
        ];
        place.json(&what)["errors"][0].clone()
    };
    for row in [&mapped, &directional] {
        let bias = row["bias"].as_f64().unwrap();
        assert!(bias.abs() < 0.05, "the mean stays: {row:#}");
        assert!(
            row["rmse"].as_f64().unwrap() > 0.05,
            "veins differ: {row:#}"
        );
        assert!(
            row["coverage"].as_f64().unwrap() < 0.03,
            "one outline: {row:#}"
        );
    }
    let sheet = image::open(place.path("maps.png")).unwrap().to_rgb8();
    // The corner of the card is no leaf.
    let seen = sheet
        .pixels()
        .filter(|p| p[1] > p[2].saturating_add(10))
        .count();
    assert!(seen > 500 && seen < 2 * 96 * 96 * 4 / 5, "{seen}");
}
