//! Drawings on paper as users get them: what is in the file, what draws it again, what is refused.

use std::collections::BTreeSet;
use std::fs;

use roxmltree::{Document, Node};

use crate::model_fixture::shared;
use crate::place::{Place, stderr};
use crate::small_model::small_tree;

const INKSCAPE: &str = "http://www.inkscape.org/namespaces/inkscape";

/// A shrub that is drawn in a second.
const SHRUB: &str = "grow:shrub:1:400";

fn drawn(place: &Place, more: &[&str]) -> String {
    let arguments = [
        &[
            "render",
            SHRUB,
            "-o",
            "out.svg",
            "--validate",
            "--paper",
            "a6",
        ],
        more,
    ]
    .concat();
    let output = place.umbrage(&arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    fs::read_to_string(place.path("out.svg")).unwrap()
}

fn layers<'a>(document: &'a Document<'a>) -> Vec<Node<'a, 'a>> {
    let root = document.root_element();
    root.children()
        .filter(|n| n.is_element() && n.tag_name().name() == "g")
        .collect()
}

#[test]
fn layers_are_what_inkscape_and_plotters_take_for_layers() {
    let place = Place::new();
    for style in ["lenient-sketch", "ds00-fig4b", "plotter-a4"] {
        let text = drawn(&place, &["--style", style]);
        let document = Document::parse(&text).unwrap();
        let root = document.root_element();
        assert_eq!(root.attribute("width"), Some("105mm"));
        assert_eq!(
            root.attribute("viewBox"),
            Some("0 0 105 148"),
            "one unit is a millimetre"
        );
        let mut numbers = BTreeSet::new();
        for layer in layers(&document) {
            assert_eq!(layer.attribute((INKSCAPE, "groupmode")), Some("layer"));
            assert_eq!(layer.attribute("transform"), None);
            let label = layer.attribute((INKSCAPE, "label")).unwrap();
            let (number, name) = label.split_once(' ').unwrap();
            assert!(
                numbers.insert(number.parse::<u32>().unwrap()),
                "{label} twice"
            );
            assert!(!name.contains(|c: char| c.is_ascii_digit()), "{label}");
            assert!(
                layer
                    .descendants()
                    .any(|n| n.has_tag_name("path") || n.tag_name().name() == "path"),
                "{label}"
            );
        }
        assert!(numbers.len() >= 2, "{style}: {numbers:?}");
        for wrong in ["<use", "clipPath", "mask", "class=", "NaN", "inf"] {
            assert!(!text.contains(wrong), "{style}: {wrong}");
        }
        for path in document
            .descendants()
            .filter(|n| n.tag_name().name() == "path")
        {
            let d = path.attribute("d").unwrap();
            let mut numbers = d
                .split(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-'))
                .filter(|t| !t.is_empty());
            let fine = |t: &str| {
                t.split_once('.')
                    .is_none_or(|(_, decimals)| decimals.len() <= 3)
            };
            assert!(numbers.all(fine), "thousandths: {d}");
        }
    }
}

#[test]
fn every_profile_writes_its_lines_its_way() {
    let place = Place::new();
    let paths = |text: &str| {
        Document::parse(text)
            .unwrap()
            .descendants()
            .filter(|n| n.tag_name().name() == "path")
            .count()
    };
    let text = drawn(&place, &["--style", "ds00-fig3b", "--profile", "print"]);
    assert!(
        paths(&text) <= 6,
        "one or two paths for a layer: {}",
        paths(&text)
    );
    let text = drawn(&place, &["--style", "ds00-fig3b", "--profile", "edit"]);
    let document = Document::parse(&text).unwrap();
    let primitives: Vec<_> = document
        .descendants()
        .filter_map(|n| n.attribute("data-prim"))
        .collect();
    let distinct: BTreeSet<_> = primitives.iter().collect();
    assert!(
        primitives.len() > 50 && distinct.len() == primitives.len(),
        "a group for each primitive"
    );
    let text = drawn(&place, &["--style", "ds00-fig3b", "--profile", "plotter"]);
    assert!(
        paths(&text) > 50 && !text.contains("fill=\"#"),
        "centre lines only"
    );
}

#[test]
fn a_drawing_is_drawn_again_from_itself() {
    let place = Place::new();
    let first = drawn(
        &place,
        &[
            "--style",
            "lenient-sketch",
            "--camera",
            "40,10",
            "--profile",
            "edit",
        ],
    );
    // A style file may be gone: the drawing holds it.
    let output = place.umbrage(&["render", "out.svg", "-o", "again.svg"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let again = fs::read_to_string(place.path("again.svg")).unwrap();
    let lines = |text: &str| {
        text.lines()
            .filter(|l| !l.contains("<metadata>"))
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    assert_eq!(lines(&first), lines(&again));
    place.write("foreign.svg", "<svg xmlns=\"http://www.w3.org/2000/svg\"/>");
    place.assert_refused(
        &["render", "foreign.svg", "-o", "x.svg"],
        &["foreign.svg", "no metadata"],
    );
    place.write("broken.svg", &first.as_bytes()[..first.len() / 2]);
    place.assert_refused(
        &["render", "broken.svg", "-o", "x.svg"],
        &["broken.svg", "is no drawing"],
    );
}

#[test]
fn a_pdf_has_the_page_and_the_layers_of_the_drawing() {
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    let drawn = |file: &str, style: &str| {
        let arguments = [
            "render", &tree, "-o", file, "--style", style, "--paper", "a6",
        ];
        let output = place.umbrage(&arguments);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        fs::read(place.path(file)).unwrap()
    };
    let file = drawn("out.pdf", "crown-hatching");
    let text = String::from_utf8_lossy(&file);
    assert!(text.starts_with("%PDF-1."));
    assert!(
        text.contains("/MediaBox [0 0 297.6378 419.5275"),
        "{text:.400}"
    );
    let svg = String::from_utf8(drawn("out.svg", "crown-hatching")).unwrap();
    let document = Document::parse(&svg).unwrap();
    for layer in layers(&document) {
        let label = layer.attribute((INKSCAPE, "label")).unwrap();
        assert!(text.contains(&format!("({label})")), "{label}");
    }
}

#[test]
fn the_stages_of_drawings_are_timed() {
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    let report = place.json(&[
        "bench",
        "paper",
        &tree,
        "--style",
        "plotter-a4",
        "--size",
        "60x80",
        "-n",
        "1",
    ]);
    let rows = report["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 2);
    let stages: Vec<&str> = rows[1]["stages"]
        .as_array()
        .unwrap()
        .iter()
        .map(|s| s["stage"].as_str().unwrap())
        .collect();
    for stage in ["trace", "sort", "fit", "write"] {
        assert!(stages.contains(&stage), "{stage}: {stages:?}");
    }
    assert!(rows[0]["geometry_ms"].as_f64().unwrap() > 0.0);
    place.assert_refused(
        &["bench", "paper", &tree, "--style", "toon"],
        &["toon", "paper"],
    );
}

#[test]
fn the_same_drawing_comes_out_whatever_the_threads() {
    let place = Place::new();
    let first = drawn(&place, &["--style", "ds00-fig6a"]);
    let second = drawn(&place, &["--style", "ds00-fig6a"]);
    assert!(first == second, "two runs differ");
}

#[test]
fn wrong_papers_styles_and_models_are_refused() {
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    let ask = |more: &[&str], words: &[&str]| {
        place.assert_refused(&[&["render", &tree, "-o", "x.svg"], more].concat(), words);
    };
    ask(
        &["--style", "ds00-fig3a", "--paper", "0x0"],
        &["paper", "letter"],
    );
    ask(&["--style", "ds00-fig3a", "--paper", "15x15"], &["margin"]);
    ask(&["--style", "ds00-fig9"], &["ds00-fig9", "ds00-fig3a"]);
    ask(
        &["--style", "ds00-fig3a", "--camera-path", "orbit"],
        &["x.svg", "%04d"],
    );
    ask(
        &["--style", "ds00-fig3a", "--profile", "laser"],
        &["laser", "plotter"],
    );
    ask(&["--style", "silhouette-hatching"], &["x.svg", "png"]);
    let base = "format_version = 1\nkind = \"paper\"\ndescription = \"x\"\n";
    for (text, words) in [
        (
            "[primitive]\nform = { polygon = [[0.0, 1.0], [1.0, 0.0]] }",
            ["own.toml", "three points"],
        ),
        (
            "[foliage]\nthreshold = -1.0",
            ["own.toml", "foliage.threshold"],
        ),
        ("[shadow]\nform = \"grey\"", ["own.toml", "grey"]),
    ] {
        place.write("own.toml", format!("{base}{text}"));
        ask(&["--style", "own.toml"], &words);
    }
    let bare = crate::model_fixture::triangle();
    let bare = place.write("bare.gltf", bare.to_string());
    place.assert_refused(
        &[
            "render",
            &bare,
            "-o",
            "x.svg",
            "--style",
            "ds00-fig3a",
            "--foliage",
            "nothing",
        ],
        &["bare"],
    );
}

#[test]
fn one_leaf_no_stem_and_leaves_behind_the_camera_give_a_drawing() {
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    for more in [
        &["--style", "ds00-fig3a"][..],
        &["--style", "ds00-fig6f", "--camera", "0,1,0.05/0,1,-9"],
        &["--style", "ds00-fig4c", "--camera", "0,2.5,0.02/0,2.5,-1"],
        &["--style", "lenient-sketch", "--sun", "0,90"],
    ] {
        for file in ["a.svg", "a.png"] {
            let arguments = [
                &[
                    "render",
                    &tree,
                    "-o",
                    file,
                    "--validate",
                    "--paper",
                    "a6",
                    "--size",
                    "60x80",
                ],
                more,
            ]
            .concat();
            let output = place.umbrage(&arguments);
            assert_eq!(
                output.status.code(),
                Some(0),
                "{more:?}: {}",
                stderr(&output)
            );
        }
        let text = fs::read_to_string(place.path("a.svg")).unwrap();
        assert!(!text.contains("NaN") && !text.contains("inf,"), "{more:?}");
    }
}

#[test]
fn a_real_tree_gives_its_crown_and_its_trunk() {
    let place = Place::new();
    let oak = shared("eztree/oak_medium.glb");
    let report = place.json(&[
        "render",
        oak.to_str().unwrap(),
        "-o",
        "oak.svg",
        "--style",
        "ds00-fig3a",
        "--paper",
        "a6",
    ]);
    assert_eq!(report["primitives"], 5320);
    let layers: Vec<&str> = report["layers"]
        .as_array()
        .unwrap()
        .iter()
        .map(|l| l["name"].as_str().unwrap())
        .collect();
    assert_eq!(layers, ["stem contour", "stem hatch", "foliage contour"]);
    assert!(report["strokes"].as_u64().unwrap() > 900, "{report:#}");
}
