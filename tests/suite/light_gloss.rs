//! Gloss of the sky and of other leaves by rays of each pixel.

use std::fmt::Write as _;

use serde_json::Value;

use crate::place::Place;

/// A floor and, at its edge, a wall: grids of 12 x 12 quads, so that vertices carry light.
fn corner() -> String {
    let mut out = String::new();
    for k in 0..2 {
        for j in 0..=12 {
            for i in 0..=12 {
                let (s, t) = (f64::from(i) / 12.0 - 0.5, f64::from(j) / 12.0);
                let (y, z) = if k == 0 { (0.0, t - 0.5) } else { (t, -0.5) };
                writeln!(out, "v {s} {y} {z}").unwrap();
            }
        }
    }
    for k in 0..2 {
        for j in 0..12 {
            for i in 0..12 {
                let a = 1 + k * 169 + j * 13 + i;
                let (b, c, d) = (a + 1, a + 14, a + 13);
                if k == 0 {
                    writeln!(out, "f {a} {d} {c} {b}").unwrap();
                } else {
                    writeln!(out, "f {a} {b} {c} {d}").unwrap();
                }
            }
        }
    }
    out
}

const LEAF: [&str; 8] = [
    "--reflectance",
    "0.3,0.2,0.1",
    "--transmittance",
    "0.1",
    "--gloss",
    "0.25",
    "--roughness",
    "0.15",
];

fn light(place: &Place, model: &str) {
    let what = ["light", model, "-o", "out.light", "--paths", "256"];
    let how = ["--directions", "none", "--validate"];
    place.json(&[&what[..], &how, &LEAF].concat());
}

fn draw(place: &Place, model: &str, more: &[&str]) -> Value {
    let what = [
        "render",
        model,
        "-o",
        "out.png",
        "--light",
        "out.light",
        "--validate",
    ];
    let how = [
        "--size",
        "64x64",
        "--camera",
        "0.7,0.8,2/0,0.2,-0.2",
        "--fov",
        "35",
        "--supersample",
        "2",
        "--sun-direction",
        "0.5,0.6,0.8",
    ];
    place.json(&[&what[..], &how, &LEAF, more].concat())
}

/// The last runs gave 14 % without and 5 % with rays. In the floor stands the sky with its horizon, and before it the wall in the sun.
#[test]
fn a_glossy_floor_mirrors_the_sky_and_a_wall_as_the_truth_does() {
    let place = Place::new();
    let model = place.write("corner.obj", corner());
    light(&place, &model);
    for form in ["paper", "safe"] {
        let blocks = |rays: &str| {
            let how = ["--lighting", "leaf,truth", "--truth-samples", "32"];
            let what = [
                "--environment",
                "clear:3",
                "--gloss-form",
                form,
                "--gloss-rays",
                rays,
            ];
            let report = draw(&place, &model, &[&how[..], &what].concat());
            let row = &report["errors"][0];
            assert!(
                row["lighting"].as_str().unwrap().starts_with("leaf"),
                "{row:#}"
            );
            row["block_rmse"].as_f64().unwrap()
        };
        let (without, with) = (blocks("0"), blocks("8"));
        assert!(with < 0.07 && without > 0.11, "{form}: {without} {with}");
    }
}

/// No pass, no bytes: with no rays, without gloss, and where nothing else than the sun is drawn.
#[test]
fn what_does_not_shine_needs_no_rays() {
    let place = Place::new();
    let model = place.write("corner.obj", corner());
    light(&place, &model);
    let takes = |more: &[&str]| {
        let report = draw(&place, &model, more);
        let stages = report["times"].as_array().unwrap();
        let passes = ["gloss rays", "gather gloss"];
        let found = passes.map(|p| stages.iter().any(|s| s["stage"] == p));
        assert_eq!(found[0], found[1], "{report:#}");
        let bytes = report["bytes"]["gloss_rays"].as_u64().unwrap();
        assert_eq!(found[0], bytes > 0, "{report:#}");
        found[0]
    };
    assert!(takes(&["--lighting", "leaf"]), "by default");
    assert!(takes(&["--lighting", "shadow-prt"]), "with a shadow map");
    assert!(takes(&["--lighting", "prt", "--gloss-rays", "1"]));
    assert!(!takes(&["--lighting", "leaf", "--gloss-rays", "0"]));
    assert!(!takes(&["--lighting", "lvc"]));
    assert!(!takes(&[
        "--lighting",
        "ambient,truth",
        "--truth-samples",
        "1"
    ]));
    let wrong = [
        "render",
        &model,
        "-o",
        "x.png",
        "--lighting",
        "leaf",
        "--gloss-rays",
    ];
    for number in ["4097", "1.5"] {
        place.assert_refused(&[&wrong[..], &[number]].concat(), &["gloss-rays"]);
    }
}

/// Every sample is a number of its pixel: a picture is the same however often it is drawn, and
/// batches change nothing.
#[test]
fn the_same_gloss_is_drawn_twice() {
    let place = Place::new();
    let model = place.write("corner.obj", corner());
    light(&place, &model);
    let picture = |rays: &str| {
        draw(
            &place,
            &model,
            &["--lighting", "leaf", "--gloss-rays", rays],
        );
        std::fs::read(place.path("out.png")).unwrap()
    };
    assert!(picture("3") == picture("3"), "bit for bit");
}
