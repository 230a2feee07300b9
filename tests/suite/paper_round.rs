//! Bitmap and vectors of one drawing show the same lines (measure M8, without another program:
//! `scripts/paper-check.py` has resvg and Inkscape look).

use std::fs;

use glam::DVec2;
use umbrage::ink::paper::drawing::{Placement, drawing};
use umbrage::ink::paper::laid::lay;
use umbrage::ink::paper::pen::Stroke;
use umbrage::ink::paper::renderer::{PaperRenderer, PaperScene};
use umbrage::ink::paper::style::PaperStyle;
use umbrage::math::packing::{f16_to_f32, f32_to_f16};

use crate::fixture;
use crate::paper::{SIZE, backdrop, scattered, view};
use crate::place::{Place, stderr};

fn inked(pixels: &[u8]) -> Vec<bool> {
    let light = |p: &[u8]| f16_to_f32(u16::from_le_bytes([p[0], p[1]]));
    pixels.chunks_exact(8).map(|p| light(p) < 0.5).collect()
}

/// Share of the pixels of either picture that have ink of the other within a pixel.
fn agreement(a: &[bool], b: &[bool]) -> f64 {
    let [w, h] = SIZE.map(|s| s as usize);
    let near = |picture: &[bool], i: usize| {
        let (x, y) = (i % w, i / w);
        let rows = y.saturating_sub(1)..=(y + 1).min(h - 1);
        rows.flat_map(|y| (x.saturating_sub(1)..=(x + 1).min(w - 1)).map(move |x| y * w + x))
            .any(|k| picture[k])
    };
    let (mut same, mut all) = (0, 0);
    for i in (0..w * h).filter(|&i| a[i] || b[i]) {
        all += 1;
        same += usize::from((!a[i] || near(b, i)) && (!b[i] || near(a, i)));
    }
    f64::from(same as u32) / f64::from(all.max(1))
}

fn laid(strokes: &[Stroke], shift: DVec2) -> Vec<bool> {
    let mut strokes = strokes.to_vec();
    for stroke in &mut strokes {
        stroke.line.points.iter_mut().for_each(|p| *p += shift);
    }
    let size = SIZE.map(|s| s as usize);
    let mut pixels = f32_to_f16(1.0).to_le_bytes().repeat(4 * size[0] * size[1]);
    lay(&mut pixels, size, &strokes, [0.0; 3]);
    inked(&pixels)
}

#[test]
fn vectors_and_the_bitmap_show_the_same_lines() {
    let more = "[primitive]\nform = \"ellipse\"\nsize = 0.5\ndeformation = 0.15\n\
                [foliage]\nthreshold = 1000.0\npen = { width = 0.4 }\n\
                [sheet]\npaper = [100.0, 75.0]\nmargin = 0.0\nresolution = 3.2\ncolour = [1.0, 1.0, 1.0]\nink = [0.0, 0.0, 0.0]\n";
    let text = format!("format_version = 1\nkind = \"paper\"\ndescription = \"x\"\n{more}");
    let style = PaperStyle::parse(&text).unwrap();
    let particles = scattered(80);
    let geometry = backdrop();
    let scene = PaperScene {
        geometry: &geometry,
        stems: &[],
        particles: &particles,
        leaves: particles.len(),
    };
    let renderer = PaperRenderer::new(&fixture::gpu(), &scene, &style, SIZE).unwrap();
    let bitmap = inked(&renderer.bitmap(&scene, &view(), 1).unwrap().pixels);
    let maps = renderer.maps(&scene, &view()).unwrap();
    let placement = Placement::new(&style, maps.size);
    let (found, _) = drawing(&maps, &style, &view());
    let strokes: Vec<Stroke> = found
        .layers
        .into_iter()
        .flat_map(|l| l.strokes)
        .map(|mut s| {
            for p in &mut s.line.points {
                *p = (*p - placement.corner) / placement.scale;
            }
            s.widths.iter_mut().for_each(|w| *w /= placement.scale);
            s
        })
        .collect();
    let ink = bitmap.iter().filter(|&&b| b).count();
    assert!(ink > 3000, "{ink} pixels of ink");
    let same = agreement(&bitmap, &laid(&strokes, DVec2::ZERO));
    assert!(same >= 0.97, "{same}");
    // Two pixels aside they are not the same lines.
    let moved = agreement(&bitmap, &laid(&strokes, DVec2::splat(2.0)));
    assert!(moved < 0.8, "{moved}");
}

#[test]
fn a_bare_tree_shows_its_branches_through_where_leaves_were() {
    let place = Place::new();
    let strokes = |style: &str| {
        fs::write(place.path("own.toml"), style).unwrap();
        let output = place.umbrage(&[
            "render",
            "grow:shrub:1:400",
            "-o",
            "out.svg",
            "--style",
            "own.toml",
            "--paper",
            "a6",
            "--json",
        ]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let said: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let layers = said["layers"].as_array().unwrap();
        assert!(
            layers.iter().all(|l| l["number"].as_u64().unwrap() <= 2),
            "{said}"
        );
        said["length_mm"].as_f64().unwrap()
    };
    let head = "format_version = 1\nkind = \"paper\"\ndescription = \"x\"\n[primitive]\nsize = 1.0\n[foliage]\ndraw = false\n";
    let hidden = strokes(head);
    let bare = strokes(&format!("{head}hides = false\n"));
    assert!(
        bare > 1.3 * hidden,
        "{bare} mm bare, {hidden} mm behind leaves"
    );
}
