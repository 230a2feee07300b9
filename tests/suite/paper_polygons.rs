//! Outlines of one's own, inline and from files: what is filled, what is refused.

use glam::DVec2;
use umbrage::ink::paper::renderer::outlines;

use crate::paper::{maps, scattered, style, view};
use crate::place::{Place, stderr};
use crate::small_model::small_tree;

/// A hook, whose middle lies beside it.
const HOOK: &str = "[[-0.6, -0.7], [0.6, -0.7], [0.6, 0.7], [0.3, 0.7], [0.3, -0.4], [-0.6, -0.4]]";

fn inside(p: DVec2, ring: &[DVec2]) -> bool {
    let mut odd = false;
    for (i, &a) in ring.iter().enumerate() {
        let b = ring[(i + 1) % ring.len()];
        if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x) {
            odd = !odd;
        }
    }
    odd
}

fn is_near(p: DVec2, ring: &[DVec2]) -> bool {
    (0..ring.len()).any(|i| {
        let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
        umbrage::ink::paper::fit::distance_to_segment(p, a, b) < 0.35
    })
}

#[test]
fn the_device_fills_outlines_that_are_not_seen_whole_from_their_middle() {
    let style = style(&format!(
        "[primitive]\nform = {{ polygon = {HOOK} }}\nsize = 0.8\n"
    ));
    let particles = scattered(40);
    let maps = maps(&particles, &style);
    let rings = outlines(&maps, &style, &view());
    let boxes: Vec<(DVec2, DVec2)> = rings
        .iter()
        .map(|r| {
            let low = r.iter().copied().fold(DVec2::INFINITY, DVec2::min);
            (
                low - 1.0,
                r.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max) + 1.0,
            )
        })
        .collect();
    let (mut right, mut wrong, mut filled) = (0, 0, 0);
    for (i, &number) in maps.foliage_number.iter().enumerate() {
        let p = DVec2::new(
            (i % maps.size[0]) as f64 + 0.5,
            (i / maps.size[0]) as f64 + 0.5,
        );
        let about = |k: &usize| p.cmpge(boxes[*k].0).all() && p.cmple(boxes[*k].1).all();
        let about: Vec<usize> = (0..rings.len()).filter(about).collect();
        if about.iter().any(|&k| is_near(p, &rings[k])) {
            continue;
        }
        let holds = about.iter().filter(|&&k| inside(p, &rings[k]));
        let depth = |k: usize| -particles[k].centre.z;
        let nearest = holds.min_by(|a, b| depth(**a).total_cmp(&depth(**b)));
        if nearest.map_or(0, |&k| k as u32 + 1) == number {
            right += 1;
            filled += u32::from(number > 0);
        } else {
            wrong += 1;
        }
    }
    assert!(
        wrong == 0 && filled > 5_000,
        "{right} right, {filled} filled, {wrong} wrong"
    );
}

const BASE: &str = "format_version = 1\nkind = \"paper\"\ndescription = \"x\"\n";

#[test]
fn outlines_come_from_files_and_stay_in_the_drawing() {
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    let svg = |d: &str| format!("<svg xmlns='http://www.w3.org/2000/svg'><path d='{d}'/></svg>");
    place.write(
        "own/leaf.svg",
        svg("M50 100 C10 80 20 20 50 0 C60 40 55 60 60 70 C80 70 85 85 50 100 Z"),
    );
    place.write("own/leaf.toml", format!("polygon = {HOOK}"));
    let nine = [HOOK; 9].join(", ");
    place.write("own/nine.toml", format!("views = [{nine}]"));
    for file in ["leaf.svg", "leaf.toml", "nine.toml"] {
        let text = format!("{BASE}[primitive]\nform = {{ file = \"{file}\" }}\nsize = 1.0\n");
        place.write("own/own.toml", text);
        let arguments = [
            "render",
            &tree,
            "-o",
            "a.svg",
            "--style",
            "own/own.toml",
            "--paper",
            "a6",
            "--validate",
        ];
        let done = place.umbrage(&arguments);
        assert_eq!(done.status.code(), Some(0), "{file}: {}", stderr(&done));
        // The drawing holds the outline: the file may go.
        std::fs::rename(place.path("own"), place.path("gone")).unwrap();
        let done = place.umbrage(&["render", "a.svg", "-o", "b.svg"]);
        std::fs::rename(place.path("gone"), place.path("own")).unwrap();
        assert_eq!(done.status.code(), Some(0), "{file}: {}", stderr(&done));
    }
}

#[test]
fn outlines_that_cannot_be_filled_are_refused_with_their_file() {
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    let svg = |d: &str| format!("<svg xmlns='http://www.w3.org/2000/svg'><path d='{d}'/></svg>");
    for (file, text, words) in [
        ("a.svg", svg("M0 0 L1 1 Z"), ["a.svg", "three points"]),
        (
            "b.svg",
            svg("M0 0 L10 10 L10 0 L0 9 Z"),
            ["b.svg", "crosses itself: sides 1 and 3"],
        ),
        (
            "c.svg",
            svg("M0 0 L1 0 L1 1 Z M3 3 h1 v1 z"),
            ["c.svg", "several lines"],
        ),
        (
            "d.toml",
            "polygon = [[0.0, 0.5], [0.5, 0.0]]".into(),
            ["d.toml", "three points"],
        ),
        (
            "e.toml",
            "polygon = [[0.0, 5.0], [0.5, 0.0], [0.0, 0.0]]".into(),
            ["e.toml", "unit disc"],
        ),
        ("f.toml", "shape = 1".into(), ["f.toml", "shape"]),
        (
            "g.toml",
            format!("views = [{HOOK}]"),
            ["g.toml", "expected nine"],
        ),
        ("h.svg", "<svg/>".into(), ["h.svg", "0 paths"]),
    ] {
        place.write(file, text);
        place.write(
            "own.toml",
            format!("{BASE}[primitive]\nform = {{ file = \"{file}\" }}\n"),
        );
        place.assert_refused(
            &["render", &tree, "-o", "x.svg", "--style", "own.toml"],
            &words,
        );
    }
    place.write(
        "own.toml",
        format!("{BASE}[primitive]\nform = {{ file = \"none.svg\" }}\n"),
    );
    place.assert_refused(
        &["render", &tree, "-o", "x.svg", "--style", "own.toml"],
        &["none.svg", "cannot read"],
    );
}
