//! Tone of drawings: what hatching gives from afar against what was asked for.

use glam::{DVec3, Vec3};
use umbrage::foliage::{self, Leaves, Split};
use umbrage::ink::leaves::LeafTriangles;
use umbrage::ink::mix::Mix;
use umbrage::ink::plan::Attribute;
use umbrage::ink::plant::Plant;
use umbrage::ink::renderer::{InkRenderer, InkScene};
use umbrage::ink::strokes::{Stroke, tile_of};
use umbrage::ink::style::Style;
use umbrage::ink::view::View;
use umbrage::math::packing::f16_to_f32;
use umbrage::reference::ink_tile::ink_of_tile;
use umbrage::scene::grow::{self, GrowOptions, Species};
use umbrage::scene::{Camera, Geometry, Instance, Material, Mesh, Model, Primitive};

use crate::fixture;
use crate::ink::{Disc, cards};

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

/// What is hatched: leaves, if it has any, else a smooth body.
struct Thing {
    model: Model,
    eye: DVec3,
    fov: f64,
    /// Pattern of what is foliage.
    foliage: &'static str,
    /// The style beside hatching.
    style: &'static str,
}

/// A shrub of large leaves on its clusters' spheres.
fn shrub() -> Thing {
    let options = GrowOptions {
        leaves: Some(1500),
        ..GrowOptions::default()
    };
    Thing {
        model: grow::grow(Species::Shrub, &options).unwrap(),
        eye: DVec3::new(0.0, 1.0, 4.0),
        fov: 40.0,
        foliage: "leaf",
        style: "[leaves]\norientation = 1.0\nsize = 2.5\nshape = 0.0\ncluster_radius = 0.4\n\
                displacement = 1.0\nfacing = 1.0\n\
                [shading]\ncrown = 0.0\ndepth = 0.0\n",
    }
}

/// A surface over `[0, 1]^2` as a smooth body.
fn body(at: impl Fn(f32, f32) -> (Vec3, Vec3), style: &'static str) -> Thing {
    let mut part = Primitive::default();
    let cells = 48;
    for y in 0..=cells {
        for x in 0..=cells {
            let (place, normal) = at(x as f32 / cells as f32, y as f32 / cells as f32);
            part.positions.push(place.to_array());
            part.normals.push(normal.to_array());
        }
    }
    for i in (0..cells * cells).map(|i| i / cells * (cells + 1) + i % cells) {
        let below = i + cells + 1;
        part.indices
            .extend([i, below, i + 1, i + 1, below, below + 1]);
    }
    let instance = Instance {
        name: "body".into(),
        mesh: 0,
        local_to_world: glam::DAffine3::IDENTITY,
        source: None,
    };
    Thing {
        model: Model {
            name: "body".into(),
            meshes: vec![Mesh {
                name: "body".into(),
                primitives: vec![part],
            }],
            instances: vec![instance],
            materials: vec![Material::default()],
            ..Model::default()
        },
        eye: DVec3::new(0.0, 0.0, 4.0),
        fov: 36.0,
        foliage: "leaf",
        style,
    }
}

/// A plane of 2 m that faces the viewer; its normals turn from side to side, so that its tone goes
/// from light to dark.
fn plane() -> Thing {
    let at = |x: f32, y: f32| {
        let turn = 2.4 * (0.5 - x);
        (
            Vec3::new(2.0 * x - 1.0, 1.0 - 2.0 * y, 0.0),
            Vec3::new(-turn.sin(), 0.0, turn.cos()),
        )
    };
    body(
        at,
        "[bodies]\nsmooth = true\ncluster_radius = 0.2\n[shading]\nambient = 0.1\n",
    )
}

fn on_sphere(x: f32, y: f32) -> Vec3 {
    let (turn, down) = (std::f32::consts::TAU * x, std::f32::consts::PI * y);
    Vec3::new(down.sin() * turn.sin(), down.cos(), down.sin() * turn.cos())
}

/// A sphere of 1 m as a smooth body.
fn smooth_sphere() -> Thing {
    let at = |x: f32, y: f32| (on_sphere(x, y), on_sphere(x, y));
    body(at, "[bodies]\nsmooth = true\ncluster_radius = 0.15\n")
}

/// Cards on a sphere of 1 m, which one cluster holds.
fn sphere() -> Thing {
    let discs = (0..900).map(|i| {
        // Equal areas, turned by the golden angle.
        let down = (1.0 - (i as f32 + 0.5) / 450.0).acos() / std::f32::consts::PI;
        Disc {
            at: on_sphere(i as f32 * 0.381_966, down),
            radius: 0.12,
        }
    });
    Thing {
        model: cards(&discs.collect::<Vec<_>>()),
        eye: DVec3::new(0.0, 0.0, 4.0),
        fov: 36.0,
        foliage: ".*",
        style: "[leaves]\norientation = 1.0\nshape = 0.0\ncluster_radius = 1.0\n\
                displacement = 1.0\nfacing = 1.0\n\
                [shading]\ncrown = 0.0\ndepth = 0.0\n",
    }
}

/// A thing in nothing but hatching, black on white.
fn hatched(thing: &Thing, hatching: &str) -> Hatched {
    let gpu = fixture::gpu();
    let model = &thing.model;
    let geometry = Geometry::flatten(model);
    let split = Split::with_or_without(model, &geometry, Some(thing.foliage)).unwrap();
    let leaves = Leaves::new(
        &geometry.positions,
        &split.foliage_indices,
        foliage::Primitive::Leaf,
    );
    let triangles = LeafTriangles {
        indices: &split.foliage_indices,
        first: &leaves.first,
        triangles: &leaves.triangles,
    };
    let style = Style::parse(&format!(
        "format_version = 1\ndescription = \"tone\"\n{}\
         [hatching]\nstrength = 1.0\n{hatching}\n\
         [paper]\ncolour = [1.0, 1.0, 1.0]\nink = [0.0, 0.0, 0.0]\n",
        thing.style
    ))
    .unwrap();
    let foliage = &split.foliage_parts;
    let styles = std::slice::from_ref(&style);
    let plant = Plant::new(model, &geometry, triangles, foliage, None, styles).unwrap();
    let camera = Camera {
        eye: thing.eye,
        forward: DVec3::NEG_Z,
        fov: thing.fov,
        aspect: 1.0,
        near: 0.01,
        roll: 0.0,
    };
    let to_sun = Vec3::new(0.6, 0.6, 0.5).normalize();
    let view = View::new(camera, geometry.origin, SIZE, to_sun, &geometry.positions);
    let scene = InkScene {
        model,
        geometry: &geometry,
        plant: &plant,
    };
    let renderer = InkRenderer::new(&gpu, &scene, &Mix::single(style.clone()), &view, 1).unwrap();
    let wanted = [Attribute::Depth, Attribute::Normal, Attribute::Hatch];
    let drawing = renderer.draw_with(&scene, &view, &wanted).unwrap();
    let of = |a: Attribute| &drawing.attributes.iter().find(|x| x.0 == a).unwrap().1;
    let depth: Vec<f32> = bytemuck::pod_collect_to_vec(of(Attribute::Depth));
    let normal = halves(of(Attribute::Normal));
    let hatch: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(of(Attribute::Hatch));
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
        hatch: hatch
            .iter()
            .map(|h| [h[0], h[1], h[2]].map(f64::from))
            .collect(),
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

/// Strokes of the tile with one number changed.
fn strokes_with(style: &Style, change: impl Fn(&mut [f32; 8])) -> String {
    let listed = tile_of(style).unwrap().strokes;
    let one = |s: &Stroke| {
        let mut numbers = s.to_listed();
        change(&mut numbers);
        format!("{numbers:?}")
    };
    let listed: Vec<String> = listed.iter().map(one).collect();
    format!("scale = 0.5\nstrokes = [{}]", listed.join(", "))
}

/// The error of a thing's tone, through a Gaussian of twice the spacing of strokes at its own mean
/// tone; and what that is of strokes twice as wide as their tones were made for.
fn measured(name: &str, thing: &Thing, limit: f64) {
    let drawn = hatched(thing, "scale = 0.5");
    let wanted: Vec<f64> = drawn.wanted.iter().flatten().copied().collect();
    let mean = wanted.iter().sum::<f64>() / wanted.len() as f64;
    let sigma = 2.0 * 1.7 / mean;
    let error = tone_error(&drawn, sigma);
    let wide = strokes_with(&drawn.style, |numbers| numbers[5] *= 1.6);
    let wrong = tone_error(&hatched(thing, &wide), sigma);
    println!(
        "tone error of a {name}: {error:.4}, mean tone {mean:.3}, sigma {sigma:.1} pixels; of wider strokes {wrong:.4}"
    );
    assert!(error <= limit, "{name}: {error}");
    assert!(
        wrong > 2.0 * limit,
        "{name}: wider strokes must be told: {wrong}"
    );
}

#[test]
fn hatching_of_leaves_has_the_tone_that_is_asked_for() {
    measured("shrub", &shrub(), 0.03);
}

#[test]
fn hatching_of_a_plane_has_the_tone_that_is_asked_for() {
    measured("plane", &plane(), 0.03);
}

#[test]
fn hatching_of_a_sphere_has_the_tone_that_is_asked_for() {
    measured("sphere", &sphere(), 0.03);
}

#[test]
fn hatching_of_a_smooth_sphere_has_the_tone_that_is_asked_for() {
    measured("smooth sphere", &smooth_sphere(), 0.03);
}

#[test]
fn every_pixel_has_the_ink_of_the_twin() {
    let drawn = hatched(&shrub(), "scale = 0.37\npacking_steps = 3");
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
