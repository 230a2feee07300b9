//! Inks of layers: every file has each layer's colour, bitmaps those of the lines.

use std::collections::BTreeMap;
use std::fs;

use glam::{Vec3, Vec4};
use umbrage::ink::paper::particles::Particle;
use umbrage::ink::paper::renderer::{PaperRenderer, PaperScene};
use umbrage::math::packing::f16_to_f32;

use crate::fixture;
use crate::paper::{SIZE, backdrop, scattered, style, view};
use crate::place::{Place, stderr};

const INKSCAPE: &str = "http://www.inkscape.org/namespaces/inkscape";
const RED_STEMS: &str = "format_version = 1\nkind = \"paper\"\ndescription = \"x\"\n\
    [primitive]\nsize = 0.3\n\
    [stem]\nstub = 0.0\nsingle = 0.0\npen = { colour = [1.0, 0.0, 0.0] }\nhatching_pen = { colour = [1.0, 0.5, 0.0] }\n\
    [foliage]\npen = { colour = [0.0, 1.0, 0.0] }\n\
    [shadow]\nbias = 0.1\nsoftness = 0.2\nblack = 0.1\nhatching = 0.9\npen = { colour = [0.0, 0.0, 1.0] }\nform = FORM\n\
    [ground]\ncount = 1000\nGROUND\n[sheet]\nink = [0.2, 0.2, 0.2]\n";

fn drawn(place: &Place, file: &str, [form, ground]: [&str; 2], more: &[&str]) -> Vec<u8> {
    place.write(
        "own.toml",
        RED_STEMS.replace("FORM", form).replace("GROUND", ground),
    );
    let arguments = [
        &[
            "render",
            "grow:shrub:1:100",
            "-o",
            file,
            "--style",
            "own.toml",
            "--paper",
            "a6",
            "--validate",
        ],
        more,
    ]
    .concat();
    let output = place.umbrage(&arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    fs::read(place.path(file)).unwrap()
}

/// Colours of each layer by its name: its strokes', and those of what it fills.
fn colours(svg: &[u8]) -> BTreeMap<String, Vec<String>> {
    let text = std::str::from_utf8(svg).unwrap();
    let document = roxmltree::Document::parse(text).unwrap();
    let layers = document
        .root_element()
        .children()
        .filter(|n| n.tag_name().name() == "g");
    let of = |layer: roxmltree::Node<'_, '_>| {
        let mut all = vec![layer.attribute("stroke").unwrap().to_owned()];
        let fills = layer.descendants().filter_map(|n| n.attribute("fill"));
        all.extend(fills.filter(|f| *f != "none").map(str::to_owned));
        all.sort();
        all.dedup();
        (
            layer.attribute((INKSCAPE, "label")).unwrap().to_owned(),
            all,
        )
    };
    layers.map(of).collect()
}

#[test]
fn every_layer_has_its_own_ink_in_every_profile() {
    let place = Place::new();
    let ground = "colour = [1.0, 0.0, 1.0]";
    let (hatch, black) = ("\"hatch\"", "\"black\"");
    for (profile, form) in [("print", black), ("edit", hatch), ("plotter", black)] {
        let svg = drawn(&place, "x.svg", [form, ground], &["--profile", profile]);
        let found = colours(&svg);
        let shadow = if form == hatch {
            "4 foliage hatch"
        } else {
            "5 shadow"
        };
        for (layer, colour) in [
            ("1 stem contour", "#ff0000"),
            ("2 stem hatch", "#ff8000"),
            ("3 foliage contour", "#00ff00"),
            (shadow, "#0000ff"),
            ("6 ground", "#ff00ff"),
        ] {
            assert_eq!(found[layer], [colour], "{profile} {form} {layer}");
        }
        assert_eq!(found.len(), 5, "{found:?}");
    }
}

#[test]
fn layers_without_an_ink_have_the_sheets() {
    let place = Place::new();
    let svg = drawn(&place, "x.svg", ["\"hatch\"", ""], &[]);
    let found = colours(&svg);
    assert!(
        !found.contains_key("6 ground"),
        "the shadow's ink: {found:?}"
    );
    let output = place.umbrage(&[
        "render",
        "grow:shrub:1:100",
        "-o",
        "y.svg",
        "--style",
        "lenient-sketch",
        "--paper",
        "a6",
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let found = colours(&fs::read(place.path("y.svg")).unwrap());
    assert!(found.values().all(|c| c == &["#12110f"]), "{found:?}");
}

/// Pixels of a picture (linear RGB) that are `ink` within a tenth.
fn pixels_of(picture: &[Vec4], ink: [f32; 3]) -> usize {
    let near = |p: &&Vec4| p.truncate().distance(Vec3::from(ink)) < 0.1;
    picture.iter().filter(near).count()
}

#[test]
fn bitmaps_have_the_inks_of_lines_and_of_shadow() {
    let style = style(
        "[primitive]\nsize = 0.5\n[foliage]\nthreshold = 500.0\npen = { width = 2.0, colour = [0.0, 1.0, 0.0] }\n\
         [stem]\nhatching = 0.0\npen = { width = 2.0, colour = [1.0, 0.0, 0.0] }\n\
         [shadow]\nform = \"black\"\nbias = 0.0\nsoftness = 0.01\nblack = 0.3\npen = { colour = [0.0, 0.0, 1.0] }\n\
         [ground]\nsize = 0.5\ncolour = [1.0, 0.0, 1.0]\n\
         [sheet]\npaper = [100.0, 75.0]\nmargin = 0.0\nresolution = 3.2\n",
    );
    // A board that stands among the leaves, as a stem; some of the discs are ground.
    let mut geometry = backdrop();
    geometry.positions.extend([
        Vec3::new(-0.4, -2.0, -2.5),
        Vec3::new(0.4, -2.0, -2.5),
        Vec3::new(0.0, 2.0, -2.5),
    ]);
    geometry.normals.extend([Vec3::Z; 3]);
    let particles: Vec<Particle> = scattered(120);
    let scene = PaperScene {
        geometry: &geometry,
        stems: &[3, 4, 5],
        particles: &particles,
        leaves: 80,
    };
    let renderer = PaperRenderer::new(&fixture::gpu(), &scene, &style, SIZE).unwrap();
    let bytes = renderer.bitmap(&scene, &view(), 1).unwrap().pixels;
    let halves: Vec<f32> = bytes
        .chunks_exact(2)
        .map(|b| f16_to_f32(u16::from_le_bytes([b[0], b[1]])))
        .collect();
    let picture: Vec<Vec4> = halves.chunks_exact(4).map(Vec4::from_slice).collect();
    for (name, ink) in [
        ("foliage", [0.0, 1.0, 0.0]),
        ("stem", [1.0, 0.0, 0.0]),
        ("shadow", [0.0, 0.0, 1.0]),
        ("ground", [1.0, 0.0, 1.0]),
    ] {
        let count = pixels_of(&picture, ink);
        assert!(count > 100, "{name}: {count} pixels");
    }
}

#[test]
fn shadow_on_the_ground_begins_at_the_foot_of_what_throws_it() {
    let style = style("[shadow]\nform = \"black\"\n[ground]\nsize = 0.1\n");
    // A board that stands upright on a field of small discs, the sun to its right.
    let mut geometry = backdrop();
    geometry.positions.extend([
        Vec3::new(0.0, -2.0, -6.4),
        Vec3::new(0.0, -2.0, -5.6),
        Vec3::new(0.0, 1.0, -6.4),
        Vec3::new(0.0, 1.0, -5.6),
    ]);
    geometry.normals.extend([Vec3::X; 4]);
    let field = |i: u32| {
        let [x, z] = [i % 80, i / 80].map(|k| (k as f32 - 40.0) * 0.08);
        crate::paper::particle(Vec3::new(x, -2.0, z - 6.0), i)
    };
    let particles: Vec<Particle> = (0..80 * 60).map(field).collect();
    let scene = PaperScene {
        geometry: &geometry,
        stems: &[3, 4, 5, 4, 6, 5],
        particles: &particles,
        leaves: 0,
    };
    let mut view = view();
    view.to_sun = Vec3::new(0.6, 0.8, 0.0);
    let renderer = PaperRenderer::new(&fixture::gpu(), &scene, &style, SIZE).unwrap();
    let maps = renderer.maps(&scene, &view).unwrap();
    let shadow_of = |inside: &dyn Fn(Vec3) -> bool| -> Vec<f32> {
        let seen = maps.foliage_number.iter().zip(&maps.shadow);
        seen.filter(|(n, _)| **n > 0 && inside(particles[**n as usize - 1].centre))
            .map(|(_, s)| *s)
            .collect()
    };
    let behind = shadow_of(&|p| (-0.6..-0.25).contains(&p.x) && (p.z + 6.0).abs() < 0.25);
    let before = shadow_of(&|p| p.x > 0.1);
    assert!(behind.len() > 20 && before.len() > 1000);
    assert!(behind.iter().all(|&s| s > 0.95), "{behind:?}");
    assert!(before.iter().all(|&s| s == 0.0), "ground throws shadows");
}

#[test]
fn pictures_have_the_inks_of_their_strokes() {
    let place = Place::new();
    drawn(
        &place,
        "x.png",
        ["\"hatch\"", "colour = [1.0, 0.0, 1.0]"],
        &["--size", "420x592"],
    );
    let picture = image::open(place.path("x.png")).unwrap().to_rgb8();
    // Ink that covers half a pixel at least: far from the paper, on the side of its own colour.
    let count = |ink: [i32; 3]| {
        let like = |p: &&image::Rgb<u8>| (0..3).all(|k| (i32::from(p.0[k]) - ink[k]).abs() < 100);
        picture.pixels().filter(like).count()
    };
    for ink in [
        [255, 0, 0],
        [255, 128, 0],
        [0, 255, 0],
        [0, 0, 255],
        [255, 0, 255],
    ] {
        assert!(count(ink) > 5, "{ink:?}: {} pixels", count(ink));
    }
}
