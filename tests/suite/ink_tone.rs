//! Tone of drawings: what hatching gives from afar against what was asked for.

use glam::{DVec3, Vec3};
use umbrage::foliage::{Leaves, Primitive, Split};
use umbrage::ink::leaves::LeafTriangles;
use umbrage::ink::mix::Mix;
use umbrage::ink::plan::Attribute;
use umbrage::ink::plant::Plant;
use umbrage::ink::renderer::{InkRenderer, InkScene};
use umbrage::ink::strokes::tile_of;
use umbrage::ink::style::Style;
use umbrage::ink::view::View;
use umbrage::math::packing::f16_to_f32;
use umbrage::reference::ink_tile::ink_of_tile;
use umbrage::scene::grow::{self, GrowOptions, Species};
use umbrage::scene::{Camera, Geometry};

use crate::fixture;

const SIZE: [u32; 2] = [320, 320];
/// Darkness beyond it is drawn as this.
const DARKEST: f64 = 0.9;

/// Ink of every pixel, darkness that was asked for, hatch coordinates; none where nothing is.
struct Hatched {
    ink: Vec<f64>,
    wanted: Vec<Option<f64>>,
    hatch: Vec<[f64; 3]>,
    style: Style,
}

fn halves(bytes: &[u8]) -> Vec<f64> {
    bytes
        .chunks_exact(2)
        .map(|b| f64::from(f16_to_f32(u16::from_le_bytes([b[0], b[1]]))))
        .collect()
}

/// A shrub in nothing but hatching, black on white.
fn shrub(hatching: &str) -> Hatched {
    let gpu = fixture::gpu();
    let options = GrowOptions {
        leaves: Some(1500),
        ..GrowOptions::default()
    };
    let model = grow::grow(Species::Shrub, &options).unwrap();
    let geometry = Geometry::flatten(&model);
    let split = Split::new(&model, &geometry, None).unwrap();
    let leaves = Leaves::new(&geometry.positions, &split.foliage_indices, Primitive::Leaf);
    let triangles = LeafTriangles {
        indices: &split.foliage_indices,
        first: &leaves.first,
        triangles: &leaves.triangles,
    };
    let style = Style::parse(&format!(
        "format_version = 1\ndescription = \"tone\"\n\
         [leaves]\norientation = 1.0\nsize = 2.5\nshape = 0.0\ncluster_radius = 0.4\n\
         displacement = 1.0\nfacing = 1.0\n\
         [shading]\ncrown = 0.0\ndepth = 0.0\n\
         [hatching]\nstrength = 1.0\n{hatching}\n\
         [paper]\ncolour = [1.0, 1.0, 1.0]\nink = [0.0, 0.0, 0.0]\n"
    ))
    .unwrap();
    let foliage = &split.foliage_parts;
    let plant = Plant::new(
        &model,
        &geometry,
        triangles,
        foliage,
        None,
        std::slice::from_ref(&style),
    )
    .unwrap();
    let camera = Camera {
        eye: DVec3::new(0.0, 1.0, 4.0),
        forward: DVec3::NEG_Z,
        fov: 40.0,
        aspect: 1.0,
        near: 0.01,
        roll: 0.0,
    };
    let to_sun = Vec3::new(0.6, 0.6, 0.5).normalize();
    let view = View::new(camera, geometry.origin, SIZE, to_sun, &geometry.positions);
    let scene = InkScene {
        model: &model,
        geometry: &geometry,
        plant: &plant,
    };
    let renderer = InkRenderer::new(&gpu, &scene, &Mix::single(style.clone()), &view, 1).unwrap();
    let wanted = [Attribute::Depth, Attribute::Normal, Attribute::Hatch];
    let drawing = renderer.draw_with(&scene, &view, &wanted).unwrap();
    let of = |a: Attribute| &drawing.attributes.iter().find(|x| x.0 == a).unwrap().1;
    let depth: Vec<f32> = bytemuck::pod_collect_to_vec(of(Attribute::Depth));
    let normal = halves(of(Attribute::Normal));
    let hatch = halves(of(Attribute::Hatch));
    let (white, gamma) = (style.hatching.white, style.hatching.gamma);
    let darkness = |i: usize| {
        let dark = (1.0 - normal[4 * i + 3] / f64::from(white)).clamp(0.0, 1.0);
        (depth[i] > 0.0).then(|| dark.powf(f64::from(gamma)))
    };
    Hatched {
        ink: halves(&drawing.pixels)
            .iter()
            .step_by(4)
            .map(|v| 1.0 - v)
            .collect(),
        wanted: (0..depth.len()).map(darkness).collect(),
        hatch: hatch.chunks_exact(4).map(|h| [h[0], h[1], h[2]]).collect(),
        style,
    }
}

/// Root mean square, over what is drawn, of the drawing's tone minus the wanted one, both seen
/// through a Gaussian of `sigma` pixels.
fn tone_error(drawn: &Hatched, sigma: f64) -> f64 {
    let [w, h] = SIZE.map(|s| s as usize);
    let reach = (3.0 * sigma) as usize;
    let weights: Vec<f64> = (0..=reach)
        .map(|k| (-0.5 * (k as f64 / sigma).powi(2)).exp())
        .collect();
    let blurred = |values: &[f64]| {
        let pass = |values: &[f64], across: bool| -> Vec<f64> {
            let one = |i: usize| {
                let (x, y) = (i % w, i / w);
                let (at, size) = if across { (x, w) } else { (y, h) };
                let range = at.saturating_sub(reach)..=(at + reach).min(size - 1);
                range
                    .map(|k| {
                        let j = if across { y * w + k } else { k * w + x };
                        weights[k.abs_diff(at)] * values[j]
                    })
                    .sum()
            };
            (0..values.len()).map(one).collect()
        };
        pass(&pass(values, true), false)
    };
    let mask: Vec<f64> = drawn
        .wanted
        .iter()
        .map(|w| f64::from(u8::from(w.is_some())))
        .collect();
    let over = |v: Vec<f64>| -> Vec<f64> { v.iter().zip(&mask).map(|(v, m)| v * m).collect() };
    let wanted = drawn
        .wanted
        .iter()
        .map(|w| w.unwrap_or(0.0).min(DARKEST))
        .collect();
    let (ink, wanted) = (blurred(&over(drawn.ink.clone())), blurred(&over(wanted)));
    let weight = blurred(&mask);
    let (mut sum, mut count) = (0.0, 0.0);
    for i in (0..mask.len()).filter(|&i| mask[i] > 0.0) {
        sum += ((ink[i] - wanted[i]) / weight[i]).powi(2);
        count += 1.0;
    }
    assert!(count > 10_000.0, "{count} pixels");
    (sum / count).sqrt()
}

#[test]
fn hatching_has_the_tone_that_is_asked_for() {
    let drawn = shrub("scale = 0.5");
    let wanted: Vec<f64> = drawn.wanted.iter().flatten().copied().collect();
    let mean = wanted.iter().sum::<f64>() / wanted.len() as f64;
    // Twice the spacing of strokes at the drawing's own mean tone.
    let sigma = 2.0 * 1.7 / mean;
    let error = tone_error(&drawn, sigma);
    println!("tone error of a shrub: {error:.4}, mean tone {mean:.3}, sigma {sigma:.1} pixels");
    assert!(error <= 0.03, "{error}");
    // Strokes twice as wide as their tones were made for.
    let wide: Vec<String> = tile_of(&drawn.style)
        .unwrap()
        .strokes
        .iter()
        .map(|s| {
            let mut numbers = s.to_listed();
            numbers[5] *= 1.6;
            format!("{numbers:?}")
        })
        .collect();
    let wrong = shrub(&format!("scale = 0.5\nstrokes = [{}]", wide.join(", ")));
    let error = tone_error(&wrong, sigma);
    assert!(error > 0.03, "wider strokes must be told: {error}");
}

#[test]
fn every_pixel_has_the_ink_of_the_twin() {
    let drawn = shrub("scale = 0.37\npacking_steps = 3");
    let tile = tile_of(&drawn.style).unwrap();
    let (mut off, mut count) = (0, 0);
    for (i, wanted) in drawn.wanted.iter().enumerate() {
        let Some(darkness) = *wanted else {
            continue;
        };
        let [u, v, level] = drawn.hatch[i];
        let place = glam::DVec2::new(u, v);
        let expected = ink_of_tile(&tile.levels, place, level, darkness);
        // Hatch coordinates are read back as halves: up to a quarter of a texel.
        let near = [-0.3, 0.0, 0.3].iter().flat_map(|dx| {
            let tile = &tile;
            [-0.3, 0.0, 0.3].map(move |dy| {
                let p = place + glam::DVec2::new(*dx, dy) / 512.0;
                ink_of_tile(&tile.levels, p, level, darkness)
            })
        });
        let (low, high) = near.fold((expected, expected), |(a, b), v| (a.min(v), b.max(v)));
        let got = drawn.ink[i];
        off += u32::from(got < low - 0.06 || got > high + 0.06);
        count += 1;
    }
    assert!(count > 10_000 && off < count / 100, "{off} of {count}");
}
