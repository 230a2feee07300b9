//! Drawings that are drawn again: with other options, again and again, from other folders, without
//! the files that they were drawn from.

use std::fs;

use umbrage::scene::textures::encode_png;

use crate::place::{Place, stderr};
use crate::small_model::small_tree;

/// A folder with a model and a drawing of it in a folder of its own.
fn prepared(more: &[&str]) -> Place {
    let place = Place::new();
    place.write("models/tree.glb", small_tree().glb());
    fs::create_dir_all(place.path("out")).unwrap();
    let first = ["render", "models/tree.glb", "-o", "out/d.svg"];
    succeeds(&place, &[&first, more].concat());
    place
}

fn succeeds(place: &Place, arguments: &[&str]) {
    let output = place.umbrage(arguments);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {said}");
}

/// Metadata, and everything else.
fn read(place: &Place, name: &str) -> (serde_json::Value, Vec<String>) {
    let text = fs::read_to_string(place.path(name)).unwrap();
    let document = roxmltree::Document::parse(&text).unwrap();
    let metadata = document
        .descendants()
        .find(|n| n.tag_name().name() == "metadata")
        .and_then(|n| n.text())
        .unwrap();
    let lines = text.lines().filter(|l| !l.contains("<metadata>"));
    (
        serde_json::from_str(metadata).unwrap(),
        lines.map(str::to_owned).collect(),
    )
}

fn arguments(place: &Place, name: &str) -> String {
    let list = read(place, name).0["arguments"].clone();
    let list: Vec<String> = serde_json::from_value(list).unwrap();
    list.join(" ")
}

#[test]
fn options_beside_a_drawing_take_the_place_of_its_own() {
    let place = prepared(&[
        "--style",
        "ds00-fig3a",
        "--paper",
        "40x60",
        "--camera",
        "40,10",
    ]);
    let again = |more: &[&str]| {
        succeeds(
            &place,
            &[&["render", "out/d.svg", "-o", "out/e.svg"], more].concat(),
        );
        (read(&place, "out/e.svg").1, arguments(&place, "out/e.svg"))
    };
    let straight = |more: &[&str]| {
        let first = ["render", "models/tree.glb", "-o", "out/f.svg"];
        succeeds(&place, &[&first, more].concat());
        read(&place, "out/f.svg").1
    };
    let (lines, held) = again(&["--profile", "plotter", "--paper", "30x40"]);
    let mut all = vec!["--style", "ds00-fig3a", "--camera", "40,10"];
    all.extend(["--profile", "plotter", "--paper", "30x40"]);
    assert!(lines == straight(&all), "profile and paper");
    assert!(
        held.contains("--profile plotter --paper 30x40") && !held.contains("40x60"),
        "{held}"
    );
    let (lines, _) = again(&["--camera", "90,3"]);
    let all = [
        "--style",
        "ds00-fig3a",
        "--paper",
        "40x60",
        "--camera",
        "90,3",
    ];
    assert!(lines == straight(&all), "camera");
    let (lines, held) = again(&["--style", "plotter-a4"]);
    let all = [
        "--style",
        "plotter-a4",
        "--paper",
        "40x60",
        "--camera",
        "40,10",
    ];
    assert!(lines == straight(&all), "style");
    assert!(!held.contains("fig3a"), "{held}");
    succeeds(
        &place,
        &["render", "out/d.svg", "-o", "d.png", "--size", "60x90"],
    );
    let picture = fs::read(place.path("d.png")).unwrap();
    assert_eq!(picture[16..24], [0, 0, 0, 60, 0, 0, 0, 90], "size");
    for (more, words) in [
        (["--style", "toon"], ["toon", "ds00-fig3a"]),
        (["--compare", "normals"], ["d.svg", "--compare"]),
        (["--toward", "toon"], ["--toward", "paper"]),
    ] {
        let line = [&["render", "out/d.svg", "-o", "x.svg"], &more[..]].concat();
        place.assert_refused(&line, &words);
    }
    place.assert_refused(
        &[
            "render",
            "models/tree.glb",
            "-o",
            "x.svg",
            "--paper",
            "30x40",
        ],
        &["--paper", "--style", ".svg"],
    );
}

#[test]
fn a_drawing_that_was_drawn_again_is_drawn_again() {
    let place = prepared(&["--style", "ds00-fig3a", "--paper", "40x60", "--sun=-60,30"]);
    let first = read(&place, "out/d.svg");
    succeeds(&place, &["render", "out/d.svg", "-o", "out/d.svg"]);
    succeeds(&place, &["render", "out/d.svg", "-o", "e.svg"]);
    succeeds(&place, &["render", "e.svg", "-o", "out/f.svg"]);
    for name in ["out/d.svg", "e.svg", "out/f.svg"] {
        assert!(read(&place, name).1 == first.1, "{name}");
    }
    let held = "render ../models/tree.glb --style ds00-fig3a --paper 40x60 --sun=-60,30";
    assert_eq!(arguments(&place, "out/d.svg"), held);
    assert_eq!(arguments(&place, "out/f.svg"), held);
    assert_eq!(
        arguments(&place, "e.svg"),
        held.replace("../models", "models")
    );
}

#[test]
fn a_model_is_found_from_where_the_drawing_lies_and_beside_it() {
    let place = prepared(&["--style", "ds00-fig3a", "--paper", "40x60"]);
    let first = read(&place, "out/d.svg").1;
    let drawing = place.path("out/d.svg");
    let from = |folder: &str| {
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_umbrage"))
            .args(["render", drawing.to_str().unwrap(), "-o", "again.svg"])
            .current_dir(place.path(folder))
            .env("XDG_CACHE_HOME", place.path("cache"))
            .output()
            .unwrap();
        (output.status.code(), stderr(&output))
    };
    let (code, said) = from("models");
    assert_eq!(code, Some(0), "{said}");
    assert!(read(&place, "models/again.svg").1 == first);
    assert_eq!(
        arguments(&place, "models/again.svg").split(' ').nth(1),
        Some("tree.glb"),
        "named from where the new drawing lies"
    );
    fs::rename(place.path("models/tree.glb"), place.path("out/tree.glb")).unwrap();
    let (code, said) = from("models");
    assert_eq!(code, Some(0), "beside the drawing: {said}");
    fs::remove_file(place.path("out/tree.glb")).unwrap();
    let words = ["d.svg", "models/tree.glb", "out/tree.glb", "beside"];
    place.assert_refused(&["render", "out/d.svg", "-o", "x.svg"], &words);
}

/// A mask of as many pixels, half of it white.
fn mask(side: u32, noise: bool) -> Vec<u8> {
    let mut state = 1_u32;
    let pixel = |i: u32| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let v = if i % side < side / 2 { 255 } else { 0 };
        let v = if noise { (state >> 24) as u8 } else { v };
        [v, v, v, 255]
    };
    let pixels: Vec<u8> = (0..side * side).flat_map(pixel).collect();
    encode_png(side, side, &pixels).unwrap()
}

#[test]
fn small_masks_are_in_the_drawing_and_large_ones_are_named() {
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    let style = "format_version = 1\nkind = \"paper\"\ndescription = \"x\"\n\
        [foliage]\nthreshold = 1.0\nwidth_by = { mask = \"painted.png\" }\n";
    place.write("styles/own.toml", style);
    let draw = |size: u32, noise: bool| {
        place.write("styles/painted.png", mask(size, noise));
        let line = ["render", &tree, "-o", "d.svg", "--style", "styles/own.toml"];
        succeeds(&place, &[&line[..], &["--paper", "40x60"]].concat());
        let first = read(&place, "d.svg");
        fs::remove_file(place.path("styles/painted.png")).unwrap();
        first
    };
    let (_, lines) = draw(16, false);
    succeeds(&place, &["render", "d.svg", "-o", "e.svg"]);
    succeeds(&place, &["render", "e.svg", "-o", "f.svg"]);
    assert!(read(&place, "f.svg").1 == lines, "the mask is in it");
    let (held, _) = draw(400, true);
    let text = held["style"].as_str().unwrap();
    assert!(text.contains("styles/painted.png"), "{text:.600}");
    let words = ["d.svg", "styles/painted.png", "not found"];
    place.assert_refused(&["render", "d.svg", "-o", "x.svg"], &words);
}
