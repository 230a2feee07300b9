//! Lines of drawings on paper as they are written: no specks in real trees, and narrow branches in
//! one piece.

use glam::{DVec2, Vec3};
use umbrage::ink::paper::drawing::{Placement, drawing};
use umbrage::ink::paper::particles::Particle;
use umbrage::ink::paper::renderer::{PaperRenderer, PaperScene};
use umbrage::ink::paper::style::PaperStyle;

use crate::fixture;
use crate::paper::{SIZE, backdrop, particle, scene, style, view};
use crate::place::{Place, stderr};

/// Lengths of the paths in a layer of a file, millimetres; curves by their chords in eighths.
fn lengths(text: &str, layer: &str) -> Vec<f64> {
    let Some(from) = text.find(&format!("\"{layer}\"")) else {
        return Vec::new();
    };
    let own = &text[from..];
    let own = &own[..own[1..].find("inkscape:label=\"").unwrap_or(own.len() - 1)];
    own.split(" d=\"M").skip(1).map(length).collect()
}

fn length(path: &str) -> f64 {
    let path = path.split('"').next().unwrap_or_default();
    let mut places: Vec<DVec2> = Vec::new();
    let numbers = |t: &str| -> Vec<DVec2> {
        let values: Vec<f64> = t
            .split([' ', ',', 'Z'])
            .filter(|v| !v.is_empty())
            .map(|v| v.parse().unwrap())
            .collect();
        values
            .chunks_exact(2)
            .map(|p| DVec2::new(p[0], p[1]))
            .collect()
    };
    let commands = path.char_indices().filter(|c| "LC".contains(c.1));
    let mut starts: Vec<usize> = commands.map(|c| c.0).collect();
    starts.push(path.len());
    places.extend(numbers(&path[..starts[0]]));
    for pair in starts.windows(2) {
        let points = numbers(&path[pair[0] + 1..pair[1]]);
        if path[pair[0]..].starts_with('L') {
            places.extend(points);
            continue;
        }
        for c in points.chunks_exact(3) {
            let a = places[places.len() - 1];
            let at = |k: i32| {
                let t = f64::from(k) / 8.0;
                let s = 1.0 - t;
                s * s * s * a + 3.0 * s * s * t * c[0] + 3.0 * s * t * t * c[1] + t * t * t * c[2]
            };
            places.extend((1..=8).map(at));
        }
    }
    if path.ends_with('Z') {
        places.push(places[0]);
    }
    places.windows(2).map(|p| p[0].distance(p[1])).sum()
}

#[test]
fn written_outlines_of_a_tree_have_no_specks() {
    let place = Place::new();
    let pieces = |name: &str, more: &str| {
        let text = format!(
            "format_version = 1\nkind = \"paper\"\ndescription = \"x\"\n[primitive]\nsize = 0.08\n\
             [foliage]\nthreshold = 300.0\npen = {{ width = 0.2 }}\n{more}"
        );
        let own = place.write(&format!("{name}.toml"), text);
        let file = format!("{name}.svg");
        let done = place.umbrage(&[
            "render",
            "grow:broadleaf:1:2500",
            "-o",
            &file,
            "--style",
            &own,
            "--profile",
            "edit",
            "--paper",
            "a5",
        ]);
        assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
        let text = std::fs::read_to_string(place.path(&file)).unwrap();
        ["1 stem contour", "3 foliage contour"].map(|l| lengths(&text, l))
    };
    // 3 pixels at 6 for a millimetre (M10).
    let short = |all: &[f64]| all.iter().filter(|&&l| l < 0.5).count();
    let found = pieces("default", "");
    for all in &found {
        println!("{} pieces, {} short", all.len(), short(all));
        assert!(!all.is_empty() && short(all) * 100 <= all.len());
    }
    assert!(found[1].len() > 300, "{}", found[1].len());
    let all = pieces("all", "shortest = 0.0\n");
    assert!(short(&all[1]) > 20, "0 keeps all");
}

/// A straight upright branch of eight sides.
fn branch(foot: Vec3, length: f32, radii: [f32; 2]) -> (Vec<Vec3>, Vec<Vec3>, Vec<u32>) {
    let (mut places, mut normals, mut indices) = (Vec::new(), Vec::new(), Vec::new());
    for ring in 0..20_u32 {
        let share = ring as f32 / 19.0;
        let radius = radii[0] + share * (radii[1] - radii[0]);
        for side in 0..8_u32 {
            let (sin, cos) = (std::f32::consts::FRAC_PI_4 * side as f32).sin_cos();
            let out = Vec3::new(cos, 0.0, sin);
            places.push(foot + share * length * Vec3::Y + radius * out);
            normals.push(out);
            if ring > 0 {
                let (a, b) = ((ring - 1) * 8 + side, (ring - 1) * 8 + (side + 1) % 8);
                indices.extend([a, b, b + 8, a, b + 8, a + 8]);
            }
        }
    }
    (places, normals, indices)
}

/// Strokes of outlines of stems and on them, in pixels.
fn drawn(radii: [f32; 2], style: &PaperStyle, leaves: &[Particle]) -> [Vec<Vec<DVec2>>; 2] {
    let mut geometry = backdrop();
    let (places, normals, stems) = branch(Vec3::new(0.4, -1.5, -6.0), 3.0, radii);
    (geometry.positions, geometry.normals) = (places, normals);
    let scene = PaperScene {
        stems: &stems,
        ..scene(&geometry, leaves)
    };
    let renderer = PaperRenderer::new(&fixture::gpu(), &scene, style, SIZE).unwrap();
    let maps = renderer.maps(&scene, &view()).unwrap();
    let (found, _) = drawing(&maps, style, &view());
    let placement = Placement::new(style, maps.size);
    ["stem contour", "stem hatch"].map(|name| {
        let layer = found.layers.iter().find(|l| l.name == name);
        let lines = layer.map_or(&[][..], |l| &l.strokes).iter();
        let pixels = |p: &DVec2| (*p - placement.corner) / placement.scale;
        lines
            .map(|s| s.line.points.iter().map(pixels).collect())
            .collect()
    })
}

#[test]
fn a_narrow_branch_is_one_line_along_its_axis() {
    let style = style("");
    // About two pixels wide, and half a pixel at its tip.
    let [lines, strokes] = drawn([0.02, 0.005], &style, &[]);
    assert_eq!((lines.len(), strokes.len()), (1, 0), "{lines:?}");
    let [low, high] = [-1.5, 1.5].map(|y| view().pixel(glam::DVec3::new(0.4, y, -6.0)).0);
    for p in &lines[0] {
        assert!((p.x - low.x).abs() < 0.6, "{p} {low} {high} {:?}", lines[0]);
    }
    let ends = [lines[0][0].y, lines[0][lines[0].len() - 1].y];
    let length = (ends[0] - ends[1]).abs();
    assert!(
        length > 0.93 * (low.y - high.y),
        "{length} {low} {high} {:?}",
        lines[0]
    );
}

#[test]
fn a_branch_that_grows_narrow_is_two_lines_and_then_one() {
    let [lines, _] = drawn([0.12, 0.005], &style("[stem]\nhatching = 0.0\n"), &[]);
    // Two borders that are one line round the foot, or two; and the line to the tip.
    assert!((2..=3).contains(&lines.len()), "{} lines", lines.len());
    let highest = |l: &Vec<DVec2>| l.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    let lowest = |l: &Vec<DVec2>| l.iter().map(|p| p.y).fold(0.0, f64::max);
    let tip = lines
        .iter()
        .min_by(|a, b| highest(a).total_cmp(&highest(b)))
        .unwrap();
    let rest = lines.iter().filter(|l| *l != tip).map(highest);
    let gap = rest.fold(f64::INFINITY, f64::min) - lowest(tip);
    assert!(gap < 1.0, "{gap} pixels between the borders and the line");
}

#[test]
fn what_is_before_a_narrow_branch_hides_it() {
    let leaf = particle(Vec3::new(0.32, 0.0, -4.8), 0);
    let style = style("[primitive]\nsize = 0.4\n[foliage]\nthreshold = 60000.0\n");
    let [lines, _] = drawn([0.02, 0.01], &style, &[leaf]);
    assert_eq!(lines.len(), 2, "above and below the leaf");
}

#[test]
fn nothing_is_hatched_on_branches_narrower_than_a_stub() {
    let text = |stub: f64| {
        format!("[stem]\nsingle = 0.0\nhatching = 1.0\nwhite = 1.0\nstub = {stub:.1}\n")
    };
    let [_, all] = drawn([0.06, 0.06], &style(&text(0.0)), &[]);
    let [_, none] = drawn([0.06, 0.06], &style(&text(1.0)), &[]);
    assert!(
        all.len() > 20 && none.is_empty(),
        "{} {}",
        all.len(),
        none.len()
    );
}
