//! Styles on paper as files: written with every key, listed, told in the documentation.

use std::fs;

use crate::place::{Place, stderr, stdout};
use crate::small_model::small_tree;

fn said(place: &Place, arguments: &[&str]) -> String {
    let output = place.umbrage(arguments);
    let error = stderr(&output);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {error}");
    stdout(&output)
}

#[test]
fn a_written_style_draws_what_the_built_in_one_does() {
    let place = Place::new();
    place.write("tree.glb", small_tree().glb());
    let drawn = |style: &str| {
        let line = ["render", "tree.glb", "-o", "a.svg", "--paper", "40x60"];
        said(&place, &[&line[..], &["--style", style]].concat());
        let text = fs::read_to_string(place.path("a.svg")).unwrap();
        let lines = text.lines().filter(|l| !l.contains("<metadata>"));
        lines.map(str::to_owned).collect::<Vec<_>>()
    };
    fs::create_dir(place.path("own")).unwrap();
    said(&place, &["style", "ds00-fig4c", "-o", "own/a.toml"]);
    assert!(drawn("own/a.toml") == drawn("ds00-fig4c"));
    let printed = said(&place, &["style", "ds00-fig4c"]);
    assert_eq!(
        printed,
        fs::read_to_string(place.path("own/a.toml")).unwrap()
    );
    assert!(printed.contains("taper = "), "{printed}");
    // Files are named from where the written style lies.
    place.write("mask.png", b"looked at when it is drawn");
    let masked = "format_version = 1\nkind = \"paper\"\ndescription = \"x\"\n\
        [foliage]\nwidth_by = { mask = \"mask.png\" }\n";
    place.write("masked.toml", masked);
    let moved = said(&place, &["style", "masked.toml", "-o", "own/b.toml"]);
    assert!(moved.contains("own/b.toml"), "{moved}");
    let text = fs::read_to_string(place.path("own/b.toml")).unwrap();
    assert!(text.contains("\"../mask.png\""), "{text}");
}

#[test]
fn every_style_is_listed_and_written() {
    let place = Place::new();
    let report = place.json(&["style"]);
    let names: Vec<_> = report["styles"].as_array().unwrap().iter().collect();
    assert!(names.len() > 30, "{report}");
    for row in names {
        let text = said(&place, &["style", row["style"].as_str().unwrap()]);
        assert!(text.contains("format_version = 1"), "{text}");
    }
    place.assert_refused(&["style", "nothing"], &["nothing", "ds00-fig3a", "toon"]);
    place.assert_refused(&["style", "toon", "-o", "x.txt"], &["x.txt", ".toml"]);
    let strokes = ["ink", "strokes", "ds00-fig3a", "-o", "x.toml"];
    place.assert_refused(&strokes, &["paper", "umbrage style ds00-fig3a"]);
    let way = [
        "render",
        "-o",
        "x.png",
        "--style",
        "toon",
        "--toward",
        "ds00-fig3a",
    ];
    place.assert_refused(&way, &["--toward", "paper"]);
}

#[test]
fn the_documentation_has_the_table_of_keys() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/paper-style.md");
    let page = fs::read_to_string(page).unwrap();
    let table = umbrage::ink::paper::style_table::markdown();
    assert!(
        page.contains(&table),
        "docs/paper-style.md: put in what `umbrage style --keys` prints"
    );
}
