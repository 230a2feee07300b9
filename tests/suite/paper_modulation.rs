//! Thresholds and widths that change over the picture: what expressions are worth, what a mask
//! changes and what it leaves, what is refused.

use glam::DVec2;
use umbrage::ink::paper::drawing::{Placement, drawing};
use umbrage::ink::paper::expression::{Program, VARIABLES};
use umbrage::ink::paper::renderer::{Maps, PaperRenderer};
use umbrage::ink::paper::style::PaperStyle;
use umbrage::math::packing::f16_to_f32;
use umbrage::reference::modulate::value_of;
use umbrage::scene::textures::encode_png;

use crate::fixture;
use crate::paper::{SIZE, backdrop, maps, scattered, scene, style, view};
use crate::place::{Place, stderr};
use crate::small_model::small_tree;

#[test]
fn expressions_are_worth_what_they_say() {
    let mut inputs = [0.0; 14];
    for (k, value) in [
        ("x", 0.25),
        ("y", 0.5),
        ("z", 7.0),
        ("id", 9.0),
        ("mask", 1.0),
    ] {
        inputs[VARIABLES.iter().position(|v| *v == k).unwrap()] = value;
    }
    for (text, worth) in [
        ("1 + 2 * 3", 7.0),
        ("(1 + 2) * 3", 9.0),
        ("2 - 3 - 4", -5.0),
        ("16 / 4 / 2", 2.0),
        ("-2 ^ 2", -4.0),
        ("(-2) ^ 3", -8.0),
        ("2 ^ 3 ^ 2", 512.0),
        ("2 ^ -1", 0.5),
        ("--3", 3.0),
        ("1.5e1", 15.0),
        ("id % 4", 1.0),
        ("-1 % 4", 3.0),
        ("x < y", 1.0),
        ("x >= y", 0.0),
        ("y <= 0.5", 1.0),
        ("if(mask > 0.5, z, 100)", 7.0),
        ("clamp(z, 0, 2) + min(x, y) * max(x, y)", 2.125),
        ("mix(1, 3, x) + smooth(0, 1, y)", 2.0),
        ("abs(-x) + sqrt(4) + floor(2.7) + fract(2.25)", 4.5),
        ("sin(pi / 2) + cos(0) + exp(0) + log(1)", 3.0),
        // Where mathematics has no value.
        ("1 / 0", 0.0),
        ("1 % 0", 0.0),
        ("sqrt(-1)", 0.0),
        ("log(0)", 0.0),
        ("(-8) ^ 0.5", 0.0),
        ("0 ^ 0", 1.0),
        ("exp(1000) ^ 9", 1e9),
    ] {
        let program = Program::new(text).unwrap_or_else(|e| panic!("{text}: {e}"));
        let found = value_of(&program.ops, &inputs);
        assert!(
            (found - worth).abs() < 1e-5 * worth.abs().max(1.0),
            "{text} = {found}"
        );
    }
}

/// A mask that is white within a rectangle (pixels from the upper left corner), if there is one.
fn painted(place: &Place, white: Option<[u32; 4]>) -> String {
    let inside = |x: u32, y: u32| {
        white.is_some_and(|[a, b, c, d]| (a..c).contains(&x) && (b..d).contains(&y))
    };
    let pixels: Vec<u8> = (0..SIZE[0] * SIZE[1])
        .flat_map(|i| {
            let v = if inside(i % SIZE[0], i / SIZE[0]) {
                255
            } else {
                0
            };
            [v, v, v, 255]
        })
        .collect();
    place.write("mask.png", encode_png(SIZE[0], SIZE[1], &pixels).unwrap())
}

const PLACE: [u32; 4] = [100, 60, 180, 160];

/// A style whose leaves are drawn where the mask is white.
fn masked(mask: &str) -> PaperStyle {
    style(&format!(
        "[primitive]\nsize = 0.5\n[stem]\ndraw = false\n[foliage]\nthreshold = 6000.0\n\
         threshold_by = {{ mask = \"{mask}\", strength = -0.95 }}\n\
         pen = {{ width = 0.1 }}\n[sheet]\nresolution = 5.0\n"
    ))
}

/// The bitmap's ink in every pixel.
fn bitmap(style: &PaperStyle) -> Vec<f32> {
    let (geometry, particles) = (backdrop(), scattered(150));
    let scene = scene(&geometry, &particles);
    let gpu = fixture::gpu();
    let renderer = PaperRenderer::new(&gpu, &scene, style, SIZE).unwrap();
    let bytes = renderer.bitmap(&scene, &view(), 1).unwrap().pixels;
    let red = |p: &[u8]| f16_to_f32(u16::from_le_bytes([p[0], p[1]]));
    bytes.chunks_exact(8).map(red).collect()
}

/// Pixels that differ within `more` pixels of the painted place, and beyond.
fn changed<T: PartialEq>(before: &[T], after: &[T], more: u32) -> [usize; 2] {
    let mut found = [0; 2];
    for i in (0..before.len()).filter(|&i| before[i] != after[i]) {
        let (x, y) = (i as u32 % SIZE[0], i as u32 / SIZE[0]);
        let [a, b, c, d] = PLACE;
        let near = (a - more..c + more).contains(&x) && (b - more..d + more).contains(&y);
        found[usize::from(!near)] += 1;
    }
    found
}

#[test]
fn a_change_of_the_mask_changes_the_bitmap_only_there() {
    let place = Place::new();
    let before = bitmap(&masked(&painted(&place, None)));
    let after = bitmap(&masked(&painted(&place, Some(PLACE))));
    let [inside, outside] = changed(&before, &after, 1);
    assert!(
        inside > 100 && outside == 0,
        "{inside} inside, {outside} outside"
    );
}

/// Pixels that lines pass.
fn inked(maps: &Maps, style: &PaperStyle) -> Vec<bool> {
    let placement = Placement::new(style, maps.size);
    let (found, _) = drawing(maps, style, &view());
    let mut inked = vec![false; maps.size[0] * maps.size[1]];
    let strokes = found.layers.iter().flat_map(|l| &l.strokes);
    for p in strokes.flat_map(|s| &s.line.points) {
        let p = ((*p - placement.corner) / placement.scale).floor();
        let size = DVec2::new(maps.size[0] as f64, maps.size[1] as f64);
        if p.cmpge(DVec2::ZERO).all() && p.cmplt(size).all() {
            inked[p.y as usize * maps.size[0] + p.x as usize] = true;
        }
    }
    inked
}

#[test]
fn a_change_of_the_mask_changes_vectors_only_there() {
    let place = Place::new();
    let particles = scattered(150);
    let of = |white| {
        let style = masked(&painted(&place, white));
        inked(&maps(&particles, &style), &style)
    };
    // Gaps of two pixels are closed and pieces of three left out.
    let [inside, outside] = changed(&of(None), &of(Some(PLACE)), 4);
    assert!(
        inside > 50 && outside == 0,
        "{inside} inside, {outside} outside"
    );
}

#[test]
fn widths_follow_their_expression() {
    let style =
        style("[primitive]\nsize = 0.4\n[stem]\ndraw = false\n[foliage]\nwidth_by = \"2 * x\"\n");
    let maps = maps(&scattered(60), &style);
    let placement = Placement::new(&style, maps.size);
    let (found, _) = drawing(&maps, &style, &view());
    let mut count = 0;
    for stroke in found.layers.iter().flat_map(|l| &l.strokes) {
        for (p, w) in stroke.line.points.iter().zip(&stroke.widths) {
            let x = (p.x - placement.corner.x) / placement.scale / maps.size[0] as f64;
            let want = style.foliage.pen.width * 2.0 * x;
            // A pixel beside the line is 1/320 of the picture away.
            assert!(
                (w - want).abs() < 0.01 * style.foliage.pen.width,
                "{x}: {w} for {want}"
            );
            count += 1;
        }
    }
    assert!(count > 1000, "{count} points");
}

#[test]
fn wrong_modulations_are_refused_with_file_key_and_column() {
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    place.write("styles/mask.png", "no picture");
    let base = "format_version = 1\nkind = \"paper\"\ndescription = \"x\"\n";
    for (text, words) in [
        (
            "[foliage]\nthreshold_by = \"1 + depht\"",
            [
                "own.toml",
                "foliage.threshold_by",
                "column 5: `depht` is no variable",
            ],
        ),
        (
            "[stem]\nwidth_by = \"(x\"",
            ["own.toml", "stem.width_by", "column 3: expected `)`"],
        ),
        (
            "[foliage]\nwidth_by = { by = \"mask\" }",
            ["own.toml", "foliage.width_by", "no mask is given"],
        ),
        (
            "[foliage]\nwidth_by = { mask = \"mask.png\", by = \"x\" }",
            ["own.toml", "foliage.width_by", "`by` reads none"],
        ),
        (
            "[foliage]\nthreshold_by = { mask = \"none.png\" }",
            ["styles", "none.png", "cannot read"],
        ),
        (
            "[foliage]\nthreshold_by = { mask = \"mask.png\" }",
            ["styles", "mask.png", "PNG"],
        ),
        (
            "[foliage]\nthreshold_by = { by = \"x\", gain = 2.0 }",
            ["own.toml", "gain", "strength"],
        ),
        (
            "[foliage]\nthreshold_by = { by = \"x\", strength = nan }",
            ["own.toml", "foliage.threshold_by.strength", "-1000 to 1000"],
        ),
        (
            "[stem]\nthreshold_by = \"object\"",
            ["own.toml", "stem.threshold_by", "leaves only"],
        ),
    ] {
        let file = place.write("styles/own.toml", format!("{base}{text}"));
        place.assert_refused(&["render", &tree, "-o", "x.svg", "--style", &file], &words);
    }
}

#[test]
fn a_mask_lies_beside_its_style_and_is_found_again() {
    let place = Place::new();
    place.write("tree.glb", small_tree().glb());
    std::fs::create_dir_all(place.path("styles")).unwrap();
    let mask = painted(&place, Some(PLACE));
    std::fs::rename(mask, place.path("styles/mask.png")).unwrap();
    let text = "format_version = 1\nkind = \"paper\"\ndescription = \"x\"\n[foliage]\n\
                threshold_by = { mask = \"mask.png\", by = \"if(mask > 0.5, 1, 0.2)\" }\n\
                width_by = { by = \"shadow\", strength = 2 }\n";
    place.write("styles/own.toml", text);
    let common = ["--validate", "--size", "60x80", "--paper", "a6"];
    let mut drawn = Vec::new();
    for (input, output) in [
        ("tree.glb", "a.svg"),
        ("a.svg", "b.svg"),
        ("tree.glb", "a.png"),
    ] {
        let mut arguments = vec!["render", input, "-o", output];
        if input == "tree.glb" {
            arguments.extend(common);
            arguments.extend(["--style", "styles/own.toml"]);
        }
        let done = place.umbrage(&arguments);
        assert_eq!(done.status.code(), Some(0), "{output}: {}", stderr(&done));
        // The metadata hold the command line, which is another one.
        let bytes = std::fs::read(place.path(output)).unwrap();
        let lines = bytes.split(|&b| b == b'\n').map(<[u8]>::to_vec);
        drawn.push(
            lines
                .filter(|l| !l.starts_with(b"<metadata>"))
                .collect::<Vec<_>>(),
        );
    }
    assert!(drawn[0] == drawn[1], "drawn again, it is the same");
}
