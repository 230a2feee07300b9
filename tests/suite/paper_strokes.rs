//! Strokes of drawings on paper as their style asks for them: along and across branches, crossing,
//! anchored; how a pen starts and lifts; and lines of pixels that are thin.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec2, DVec3};
use umbrage::ink::paper::drawing::{Placement, drawing};
use umbrage::ink::paper::pen::Stroke;
use umbrage::ink::paper::renderer::{Maps, PaperRenderer, PaperScene};
use umbrage::ink::paper::style::PaperStyle;
use umbrage::ink::paper::trace::{Marks, trace};
use umbrage::ink::view::View;
use umbrage::scene::Geometry;

use crate::fixture;
use crate::paper::{SIZE, backdrop, maps, particle, scattered, scene, style, view};

/// A turned branch before the camera: its surface, and its direction in the picture (y downwards).
fn branch() -> (Geometry, Vec<u32>, DVec2) {
    const SIDES: u32 = 24;
    let axis = DVec3::new(0.5, 1.0, 0.0).normalize();
    let (across, back) = (axis.cross(DVec3::Z), DVec3::Z);
    let foot = DVec3::new(0.0, 0.0, -5.0) - 2.0 * axis;
    let mut geometry = backdrop();
    geometry.positions.clear();
    geometry.normals.clear();
    let mut stems = Vec::new();
    for ring in 0..=8 {
        for side in 0..SIDES {
            let angle = TAU * f64::from(side) / f64::from(SIDES);
            let out = angle.cos() * across + angle.sin() * back;
            let place = foot + 0.5 * f64::from(ring) * axis + 0.7 * out;
            geometry.positions.push(place.as_vec3());
            geometry.normals.push(out.as_vec3());
            if ring > 0 {
                let next = (side + 1) % SIDES;
                let (a, b) = ((ring - 1) * SIDES + side, (ring - 1) * SIDES + next);
                stems.extend([a, b, b + SIDES, a, b + SIDES, a + SIDES]);
            }
        }
    }
    let ends = [foot, foot + axis].map(|p| view().pixel(p).0);
    (geometry, stems, (ends[1] - ends[0]).normalize())
}

/// Strokes on the branch, hatched as `stem` says.
fn on_branch(stem: &str) -> (Vec<Stroke>, DVec2) {
    let (geometry, stems, way) = branch();
    let style = style(&format!(
        "[foliage]\ndraw = false\n[stem]\nhatching = 0.7\nwhite = 1.0\nstroke = 3.0\n{stem}"
    ));
    let particles = [];
    let scene = PaperScene {
        stems: &stems,
        ..scene(&geometry, &particles)
    };
    let renderer = PaperRenderer::new(&fixture::gpu(), &scene, &style, SIZE).unwrap();
    let maps = renderer.maps(&scene, &view()).unwrap();
    (layer(&maps, &style, &view(), "stem hatch"), way)
}

fn layer(maps: &Maps, style: &PaperStyle, view: &View, name: &str) -> Vec<Stroke> {
    let (found, _) = drawing(maps, style, view);
    let layer = found.layers.into_iter().find(|l| l.name == name);
    layer.map_or_else(Vec::new, |l| l.strokes)
}

/// Angle from `way` to a stroke, a quarter turn or less either way.
fn turn(stroke: &Stroke, way: DVec2) -> f64 {
    let p = &stroke.line.points;
    let angle = way.angle_to(p[p.len() - 1] - p[0]);
    (angle + FRAC_PI_2).rem_euclid(PI) - FRAC_PI_2
}

/// Share of the strokes whose angle from `way` is `wanted` within a fifth of a radian.
fn share(strokes: &[Stroke], way: DVec2, wanted: f64) -> f64 {
    let off = |s: &Stroke| (turn(s, way) - wanted + FRAC_PI_2).rem_euclid(PI) - FRAC_PI_2;
    let near = strokes.iter().filter(|s| off(s).abs() < 0.2).count();
    near as f64 / strokes.len().max(1) as f64
}

#[test]
fn strokes_on_stems_run_across_the_branch_or_along_it() {
    for places in ["diffused", "anchored"] {
        let vector = format!("[vector]\nstrokes = \"{places}\"\n");
        let (across, way) = on_branch(&vector);
        let (along, _) = on_branch(&format!("along = true\n{vector}"));
        let found = [share(&across, way, FRAC_PI_2), share(&along, way, 0.0)];
        assert!(
            across.len().min(along.len()) > 60,
            "{} {}",
            across.len(),
            along.len()
        );
        assert!(found.iter().all(|&s| s > 0.9), "{places}: {found:?}");
    }
}

/// Turn of the strokes that cross others.
const CROSSED: f64 = 1.2;

#[test]
fn strokes_on_stems_cross_above_a_second_tone() {
    let (single, way) = on_branch("crossing = 1.0\n");
    let (crossed, _) = on_branch("crossing = 0.3\n");
    let second = |strokes: &[Stroke]| share(strokes, way, FRAC_PI_2 + CROSSED);
    assert!(second(&single) < 0.05, "{} cross", second(&single));
    let share = second(&crossed);
    assert!(
        (0.1..0.6).contains(&share),
        "{share} of {} cross",
        crossed.len()
    );
}

/// Discs in shadow, hatched as `shadow` says.
fn in_shadow(shadow: &str, view: &View, dark: f32) -> (Vec<Stroke>, Maps, Placement) {
    let style = style(&format!(
        "[primitive]\nsize = 1.2\n[stem]\ndraw = false\n[foliage]\ndraw = false\n\
         [shadow]\nform = \"hatch\"\nhatching = 0.9\nangle = 30.0\nstroke = 3.0\n{shadow}"
    ));
    let (geometry, particles) = (backdrop(), scattered(60));
    let scene = scene(&geometry, &particles);
    let renderer = PaperRenderer::new(&fixture::gpu(), &scene, &style, SIZE).unwrap();
    let mut maps = renderer.maps(&scene, view).unwrap();
    maps.shadow.fill(dark);
    let placement = Placement::new(&style, maps.size);
    (layer(&maps, &style, view, "foliage hatch"), maps, placement)
}

#[test]
fn strokes_in_shadow_cross_above_a_second_tone() {
    let way = DVec2::from_angle((-30.0_f64).to_radians());
    let of = |dark| in_shadow("crossing = 0.5\n", &view(), dark).0;
    let (light, deep) = (of(0.4), of(1.0));
    let [first, second] = [0.0, CROSSED].map(|turn| share(&light, way, turn));
    assert!(first > 0.95 && second < 0.01, "{first} {second}");
    let [first, second] = [0.0, CROSSED].map(|turn| share(&deep, way, turn));
    assert!(
        first > 0.2 && second > 0.2 && first + second > 0.95,
        "{first} {second}"
    );
}

/// Edge of the cells that anchored strokes are counted in, metres.
const CELL: f64 = 0.12;

/// Middles of strokes in half shadow, metres.
fn middles(places: &str, view: &View) -> Vec<DVec3> {
    let places = format!("[vector]\nstrokes = \"{places}\"\ncell = {CELL}\n");
    let (strokes, maps, placement) = in_shadow(&places, view, 0.3);
    let last = DVec2::new(maps.size[0] as f64, maps.size[1] as f64) - 1.0;
    let place = |s: &Stroke| {
        let p = &s.line.points;
        let pixel = (0.5 * (p[0] + p[p.len() - 1]) - placement.corner) / placement.scale;
        let at = pixel.clamp(DVec2::ZERO, last);
        let at = at.y as usize * maps.size[0] + at.x as usize;
        view.point(pixel, f64::from(maps.foliage_depth[at]))
    };
    strokes.iter().map(place).collect()
}

#[test]
fn anchored_strokes_lie_on_no_grid() {
    let found = middles("anchored", &view());
    for axis in [DVec3::X, DVec3::Y] {
        let mut parts = [0; 4];
        for p in &found {
            parts[(4.0 * (p.dot(axis) / CELL).rem_euclid(1.0)) as usize % 4] += 1;
        }
        let share = |n: i32| f64::from(n) / found.len() as f64;
        let even = |n: &i32| (0.12..0.4).contains(&share(*n));
        assert!(
            parts.iter().all(even),
            "{axis}: {parts:?} in quarters of a cell"
        );
    }
}

#[test]
fn anchored_strokes_stay_where_they_are_and_diffused_ones_do_not() {
    let mut aside = view();
    aside.camera.eye.x += 0.02;
    for (places, limits) in [("anchored", 0.8..1.01), ("diffused", 0.0..0.6)] {
        let (before, after) = (middles(places, &view()), middles(places, &aside));
        let stays = |p: &&DVec3| {
            let pixel = -p.z / view().focal();
            after.iter().any(|q| q.distance(**p) < 1.2 * pixel)
        };
        let share = before.iter().filter(stays).count() as f64 / before.len() as f64;
        assert!(before.len() > 150, "{}", before.len());
        assert!(
            limits.contains(&share),
            "{places}: {share} of {} stay",
            before.len()
        );
    }
}

#[test]
fn lines_start_where_their_pen_says_and_lose_what_it_lifts() {
    for (start, turned) in [("left", DVec2::X), ("top", DVec2::Y)] {
        let style = style(&format!(
            "[primitive]\nsize = 0.45\n[foliage]\nthreshold = 500.0\n\
             pen = {{ start = \"{start}\", lift = 0.5, width = 0.4, ends = 1.0 }}\n[stem]\ndraw = false\n"
        ));
        let maps = maps(&scattered(80), &style);
        let strokes = layer(&maps, &style, &view(), "foliage contour");
        let open: Vec<&Stroke> = strokes.iter().filter(|s| !s.line.closed).collect();
        assert!(open.len() > 40, "{} open lines", open.len());
        for stroke in open {
            let ends = [0, stroke.widths.len() - 1];
            let [a, b] = ends.map(|k| stroke.line.points[k].dot(turned));
            assert!(a <= b, "{start}: from {a} to {b}");
            let [first, last] = ends.map(|k| stroke.widths[k]);
            assert!((first - 0.4).abs() < 1e-9 && (last - 0.2).abs() < 1e-9);
        }
    }
}

/// Measure M2: lines of discs are one ring each, a pixel wide.
#[test]
fn lines_of_discs_are_thin_rings() {
    let style = style("[primitive]\nsize = 0.2\n[foliage]\nthreshold = 500.0\n");
    // Nothing meets: radii of 11 to 41 pixels.
    let places = [
        [-0.5, 0.35, 4.0],
        [0.0, 0.3, 2.0],
        [0.5, 0.3, 1.5],
        [-0.45, -0.3, 1.2],
        [0.3, -0.3, 1.0],
    ];
    let discs: Vec<_> = (0..)
        .zip(places)
        .map(|(k, [x, y, z])| particle(glam::Vec3::new(x * z, y * z, -z), k))
        .collect();
    let maps = maps(&discs, &style);
    let size = maps.size;
    let marked: Vec<bool> = maps.foliage_difference.iter().map(|&d| d > 500.0).collect();
    let found = trace(&Marks {
        size,
        marked: &marked,
    });
    let rings = found.iter().filter(|l| l.closed).count();
    assert_eq!(
        (found.len(), rings),
        (discs.len(), discs.len()),
        "a ring for each"
    );
    // Degree 2, where pixels across a corner count only if none beside joins them.
    let at = |x: i64, y: i64| {
        let [w, h] = size.map(|s| s as i64);
        x >= 0 && y >= 0 && x < w && y < h && marked[(y * w + x) as usize]
    };
    let degree = |i: usize| {
        let (x, y) = ((i % size[0]) as i64, (i / size[0]) as i64);
        let beside = [(1, 0), (0, 1), (-1, 0), (0, -1)].map(|(u, v)| at(x + u, y + v));
        let corner = [(1, 1), (-1, 1), (-1, -1), (1, -1)]
            .map(|(u, v)| at(x + u, y + v) && !at(x + u, y) && !at(x, y + v));
        beside.iter().chain(&corner).filter(|&&b| b).count()
    };
    let all: Vec<usize> = (0..marked.len()).filter(|&i| marked[i]).collect();
    let two = all.iter().filter(|&&i| degree(i) == 2).count();
    let share = two as f64 / all.len() as f64;
    assert!(all.len() > 500 && share >= 0.98, "{share} of {}", all.len());
}
