//! Drawings on paper along a camera's way: a frame alone is that of the sequence, and nothing is
//! drawn by chance anew from frame to frame.

use std::collections::BTreeMap;
use std::fs;

use roxmltree::Document;

use glam::Vec3;
use umbrage::ink::paper::renderer::PaperRenderer;

use crate::paper::{backdrop, scattered, scene, style, view};
use crate::place::{Place, stderr};

/// Ellipses with everything random that primitives have, hatched in shadow and on stems.
const STYLE: &str = "format_version = 1\nkind = \"paper\"\ndescription = \"x\"\nseed = 3\n\
    [primitive]\nform = \"ellipse\"\nsize = 0.3\naspect = 0.5\ndeformation = 0.3\n\
    [foliage]\nthreshold = 200.0\n[foliage.pen]\ntremor = 0.1\nwavelength = 2.0\n\
    [shadow]\nform = \"hatch\"\n[sheet]\nprofile = \"edit\"\nresolution = 4.0\n";

fn prepared() -> Place {
    let place = Place::new();
    place.write("own.toml", STYLE);
    let output = place.umbrage(&["grow", "shrub", "--leaves", "200", "-o", "shrub.glb"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    place
}

fn draw(place: &Place, output: &str, way: &str, more: &[&str]) {
    let first = ["render", "shrub.glb", "-o", output, "--style", "own.toml"];
    let then = ["--paper", "80x110", "--size", "60x80", "--camera-path", way];
    let output = place.umbrage(&[&first[..], &then, more].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}

#[test]
fn a_frame_alone_is_that_of_the_sequence_and_is_drawn_again_from_itself() {
    let place = prepared();
    let read = |name: &str| fs::read(place.path(name)).unwrap();
    for ending in ["svg", "png"] {
        let name = format!("f%04d.{ending}");
        draw(
            &place,
            &name,
            "orbit:frames=8",
            &["--frames", "1..2", "--validate"],
        );
        let alone = format!("alone.{ending}");
        draw(
            &place,
            &alone,
            "orbit:frames=8",
            &["--frames", "2..2", "--validate"],
        );
        let frames = [1, 2].map(|k| read(&format!("f{k:04}.{ending}")));
        assert!(frames[1] == read(&alone), "frame 2 alone is another");
        assert!(frames[0] != frames[1]);
    }
    let output = place.umbrage(&["render", "f0001.svg", "-o", "again.svg"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    // The metadata say what each was drawn from.
    let lines = |name: &str| {
        let text = fs::read_to_string(place.path(name)).unwrap();
        let kept = text.lines().filter(|l| !l.contains("<metadata>"));
        kept.map(str::to_owned).collect::<Vec<_>>()
    };
    assert!(lines("f0001.svg") == lines("again.svg"), "frame 1 again");
}

/// Width and height of every outline of a primitive that is seen whole, millimetres.
fn whole_outlines(text: &str) -> BTreeMap<String, [f64; 2]> {
    let document = Document::parse(text).unwrap();
    let mut out = BTreeMap::new();
    for group in document.descendants() {
        let Some(primitive) = group.attribute("data-prim") else {
            continue;
        };
        let paths: Vec<_> = group.children().filter_map(|n| n.attribute("d")).collect();
        let [path] = paths.as_slice() else { continue };
        if !path.ends_with('Z') {
            continue;
        }
        let numbers: Vec<f64> = path
            .split(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-'))
            .filter_map(|t| t.parse().ok())
            .collect();
        let mut low = [f64::MAX; 2];
        let mut high = [f64::MIN; 2];
        for (k, v) in numbers.into_iter().enumerate() {
            low[k % 2] = low[k % 2].min(v);
            high[k % 2] = high[k % 2].max(v);
        }
        out.insert(primitive.to_owned(), [high[0] - low[0], high[1] - low[1]]);
    }
    out
}

#[test]
fn a_small_turn_of_the_camera_changes_no_primitives_shape() {
    let place = prepared();
    draw(
        &place,
        "f%04d.svg",
        "orbit:frames=360",
        &["--frames", "0..1"],
    );
    let frame = |name: &str| whole_outlines(&fs::read_to_string(place.path(name)).unwrap());
    let (before, after) = (frame("f0000.svg"), frame("f0001.svg"));
    let mut both = 0;
    for (primitive, a) in &before {
        if let Some(b) = after.get(primitive) {
            both += 1;
            // A degree brings some nearer; control points of curves lie a little beside them.
            let near = |k: usize| (a[k] - b[k]).abs() < 0.04 * a[0].max(a[1]) + 0.03;
            assert!(near(0) && near(1), "{primitive}: {a:?}, then {b:?}");
        }
    }
    assert!(both > 10, "{both} of {} seen whole twice", before.len());
}

#[test]
fn a_resting_sun_is_drawn_once_and_a_moved_one_again() {
    let style = style("[primitive]\nform = \"ellipse\"\nsize = 0.5\n[shadow]\nform = \"hatch\"\n");
    let (geometry, particles) = (backdrop(), scattered(120));
    let scene = scene(&geometry, &particles);
    let gpu = crate::fixture::gpu();
    let renderer = || PaperRenderer::new(&gpu, &scene, &style, [320, 240]).unwrap();
    let sun_passes = |maps: &umbrage::ink::paper::renderer::Maps| {
        let of_sun = |p: &&umbrage::gpu::PassTime| p.label.starts_with("sun ");
        maps.passes.iter().filter(of_sun).count()
    };
    let kept = renderer();
    let first = kept.maps(&scene, &view()).unwrap();
    // The camera moves, the sun rests.
    let mut other = view();
    other.camera.eye.x += 0.4;
    let second = kept.maps(&scene, &other).unwrap();
    assert!(sun_passes(&first) > 0 && sun_passes(&second) == 0);
    assert!(second.shadow == renderer().maps(&scene, &other).unwrap().shadow);
    assert!(second.shadow.iter().any(|&s| s > 0.5), "there is shadow");
    let mut turned = view();
    turned.to_sun = Vec3::new(0.6, 0.8, 0.0);
    let third = kept.maps(&scene, &turned).unwrap();
    assert!(sun_passes(&third) > 0);
    assert!(third.shadow == renderer().maps(&scene, &turned).unwrap().shadow);
}
