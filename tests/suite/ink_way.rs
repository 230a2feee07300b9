//! The way from photograph to drawing has no leaps: every axis of a style is swept, and the
//! picture may change from step to step by little more than it does at most steps.

use umbrage::foliage::{Leaves, Primitive, Split};
use umbrage::ink::blend;
use umbrage::ink::leaves::LeafTriangles;
use umbrage::ink::mix::Mix;
use umbrage::ink::plant::{CrownLight, Plant};
use umbrage::ink::renderer::{InkRenderer, InkScene};
use umbrage::ink::style::Style;
use umbrage::ink::view::View;
use umbrage::math::packing::f16_to_f32;
use umbrage::scene::grow::{GrowOptions, Species, grow};
use umbrage::scene::{Camera, CameraSpec, Geometry, Lens, Model};

use crate::fixture;

/// A step may be so many times the median one.
const LEAP: f64 = 5.0;
/// Mean difference of pixels below which nobody sees a step, 0 to 1.
const FLOOR: f64 = 1e-3;

struct Tree {
    model: Model,
    geometry: Geometry,
    split: Split,
}

impl Tree {
    fn new(leaves: u32) -> Self {
        let options = GrowOptions {
            leaves: Some(leaves),
            ..GrowOptions::default()
        };
        let model = grow(Species::Broadleaf, &options).unwrap();
        let geometry = Geometry::flatten(&model);
        let split = Split::new(&model, &geometry, None).unwrap();
        Self {
            model,
            geometry,
            split,
        }
    }

    /// Mean difference between each of the pictures of `styles` and the next.
    fn steps(&self, styles: &[Style], size: u32) -> Vec<f64> {
        let gpu = fixture::gpu();
        let g = &self.geometry;
        let indices = &self.split.foliage_indices;
        let leaves = Leaves::new(&g.positions, indices, Primitive::Leaf);
        let list = LeafTriangles {
            indices,
            first: &leaves.first,
            triangles: &leaves.triangles,
        };
        // In place of a bake: away from the middle, darker within.
        let normals: Vec<_> = g
            .positions
            .iter()
            .map(|p| p.normalize_or(glam::Vec3::Y))
            .collect();
        let far = g.positions.iter().map(|p| p.length()).fold(0.0, f32::max);
        let ambient: Vec<f32> = g.positions.iter().map(|p| p.length() / far).collect();
        let light = CrownLight {
            normals: &normals,
            ambient: &ambient,
        };
        let plant = |style: &Style| {
            let foliage = &self.split.foliage_parts;
            Plant::new(
                &self.model,
                g,
                list,
                foliage,
                Some(light),
                std::slice::from_ref(style),
            )
            .unwrap()
        };
        let lens = Lens {
            fov: 30.0,
            aspect: 1.0,
            margin: 0.05,
        };
        let points = g.positions.iter().copied();
        let camera = Camera::new(&CameraSpec::default(), lens, g.origin, points);
        let to_sun = glam::Vec3::new(-0.4, 0.75, 0.5).normalize();
        let view = View::new(camera, g.origin, [2 * size; 2], to_sun, &g.positions);
        let mut known: Option<(Style, Plant, InkRenderer)> = None;
        let mut last: Option<Vec<f64>> = None;
        let mut steps = Vec::new();
        for style in styles {
            let same = |k: &(Style, Plant, InkRenderer)| {
                k.0.leaves.cluster_radius == style.leaves.cluster_radius
            };
            let (plant, mut renderer) = match known.take().filter(same) {
                Some((_, plant, renderer)) => (plant, renderer),
                None => {
                    let plant = plant(style);
                    let scene = InkScene {
                        model: &self.model,
                        geometry: g,
                        plant: &plant,
                    };
                    let renderer =
                        InkRenderer::new(&gpu, &scene, &Mix::single(style.clone()), &view, 2)
                            .unwrap();
                    (plant, renderer)
                }
            };
            let scene = InkScene {
                model: &self.model,
                geometry: g,
                plant: &plant,
            };
            renderer.restyle(&scene, style, &view).unwrap();
            let picture = reduced(&renderer.draw(&scene, &view).unwrap().pixels, size);
            if let Some(last) = &last {
                let off: f64 = picture.iter().zip(last).map(|(a, b)| (a - b).abs()).sum();
                steps.push(off / picture.len() as f64);
            }
            last = Some(picture);
            known = Some((style.clone(), plant, renderer));
        }
        steps
    }
}

/// Means of 2 x 2 pixels, as the eye sees them: square roots of linear values.
fn reduced(pixels: &[u8], size: u32) -> Vec<f64> {
    let row = 2 * size as usize;
    let value = |x: usize, y: usize, c: usize| {
        let at = 2 * (4 * (y * row + x) + c);
        f64::from(f16_to_f32(u16::from_le_bytes([pixels[at], pixels[at + 1]])))
    };
    let one = |i: usize| {
        let (x, y, c) = (
            2 * (i / 3 % size as usize),
            2 * (i / 3 / size as usize),
            i % 3,
        );
        let sum = value(x, y, c) + value(x + 1, y, c) + value(x, y + 1, c) + value(x + 1, y + 1, c);
        (0.25 * sum).max(0.0).sqrt()
    };
    (0..3 * (size * size) as usize).map(one).collect()
}

/// The largest step over what it may be.
fn leap(steps: &[f64]) -> f64 {
    let mut sorted = steps.to_vec();
    sorted.sort_by(f64::total_cmp);
    let median = sorted[sorted.len() / 2];
    sorted[sorted.len() - 1] / (LEAP * median + FLOOR)
}

/// Everything that a style can have, at half its strength.
fn everything() -> Style {
    Style::parse(
        "format_version = 1\ndescription = \"everything\"\n\
         [leaves]\ndisplacement = 0.4\norientation = 0.4\nfacing = 0.4\nsize = 1.0\nshape = 0.6\n\
         kept = 0.8\nswirl = 0.3\nelongation = 1.5\n\
         [contour]\nstrength = 0.6\nthreshold = 0.03\ndetail = 2.0\n\
         [silhouette]\nstrength = 0.5\n[hatching]\nstrength = 0.5\n\
         [shading]\nstrength = 0.7\ncolour = 0.6\nsteps = 4\nhardness = 0.4\ncrown = 0.5\n\
         shadow = 0.5\nshadow_texels = 192\nflat = 0.5\nvariation = 0.3\nbristles = 0.3\n\
         [edges]\nstrength = 0.3\nambient = 0.5\n[wash]\nstrength = 0.4\n",
    )
    .unwrap()
}

/// Axes and how far they are swept.
const AXES: [(&str, &str, f64, f64); 41] = [
    ("leaves", "displacement", 0.0, 1.0),
    ("leaves", "orientation", 0.0, 1.0),
    ("leaves", "facing", 0.0, 1.0),
    ("leaves", "size", 0.5, 2.0),
    ("leaves", "shape", 0.0, 1.0),
    ("leaves", "elongation", 0.5, 4.0),
    ("leaves", "swirl", 0.0, 1.0),
    ("leaves", "kept", 0.1, 1.0),
    ("leaves", "enlarge", 0.0, 1.0),
    ("contour", "strength", 0.0, 1.0),
    ("contour", "threshold", 0.0, 0.2),
    ("contour", "width", 0.5, 4.0),
    ("contour", "detail", 0.0, 10.0),
    ("silhouette", "strength", 0.0, 1.0),
    ("hatching", "strength", 0.0, 1.0),
    ("hatching", "packing", 0.0, 1.0),
    ("hatching", "white", 0.2, 1.0),
    ("hatching", "gamma", 0.5, 2.0),
    ("shading", "strength", 0.0, 1.0),
    ("shading", "colour", 0.0, 1.0),
    ("shading", "hardness", 0.0, 1.0),
    ("shading", "crown", 0.0, 1.0),
    ("shading", "ambient", 0.0, 1.0),
    ("shading", "depth", 0.0, 1.0),
    ("shading", "wrap", 0.0, 1.0),
    ("shading", "shadow", 0.0, 1.0),
    ("shading", "exposure", 0.5, 3.0),
    ("shading", "flat", 0.0, 1.0),
    ("shading", "variation", 0.0, 1.0),
    ("shading", "bristles", 0.0, 1.0),
    ("edges", "strength", 0.0, 1.0),
    ("edges", "threshold", 0.0, 0.5),
    ("edges", "width", 0.5, 4.0),
    ("edges", "ambient", 0.0, 1.0),
    ("wash", "strength", 0.0, 1.0),
    ("wash", "softness", 0.5, 8.0),
    ("wash", "wobble", 0.0, 8.0),
    ("wash", "darkening", 0.0, 3.0),
    ("wash", "density", 0.1, 2.0),
    ("wash", "middle", 0.0, 1.0),
    ("wash", "dark", 0.0, 1.0),
];

fn sweep((part, name, low, high): (&str, &str, f64, f64), steps: u32) -> Vec<Style> {
    let base = toml::Table::try_from(everything()).unwrap();
    let one = |k: u32| {
        let mut table = base.clone();
        let value = low + (high - low) * f64::from(k) / f64::from(steps);
        table[part].as_table_mut().unwrap()[name] = toml::Value::Float(value);
        table.try_into::<Style>().unwrap()
    };
    (0..=steps).map(one).collect()
}

fn way(from: &str, to: &str, steps: u32) -> Vec<Style> {
    let named = |name| {
        let mut style = Style::named(name).unwrap();
        style.shading.shadow_texels = 192;
        style
    };
    let (from, to) = (named(from), named(to));
    let one = |k: u32| blend::between(&from, &to, k as f32 / steps as f32).unwrap();
    (0..=steps).map(one).collect()
}

#[test]
fn the_way_from_photograph_to_drawing_has_no_leaps_and_a_switch_would_be_one() {
    let tree = Tree::new(200);
    let styles = way("photo", "silhouette-hatching", 16);
    let found = leap(&tree.steps(&styles, 40));
    assert!(found <= 1.0, "{found} of what a step may be");
    // The measure sees a switch: half the way with the lines off, then on.
    let mut hard = styles;
    for (k, style) in hard.iter_mut().enumerate() {
        style.hatching.strength = if k < 8 { 0.0 } else { 1.0 };
        style.contour.strength = if k < 8 { 0.0 } else { 1.0 };
    }
    let found = leap(&tree.steps(&hard, 40));
    assert!(found > 1.0, "a switch is {found} of what a step may be");
}

#[test]
fn axes_of_leaves_and_light_have_no_leaps() {
    let tree = Tree::new(200);
    for axis in AXES
        .iter()
        .filter(|a| ["facing", "shape", "kept", "shadow"].contains(&a.1))
    {
        let found = leap(&tree.steps(&sweep(*axis, 8), 32));
        assert!(
            found <= 1.0,
            "{}.{}: {found} of what a step may be",
            axis.0,
            axis.1
        );
    }
}

#[test]
#[ignore = "minutes: every axis and five ways in 100 steps; run by hand, prints what docs/ink.md has"]
fn every_axis_in_100_steps() {
    let tree = Tree::new(600);
    let mut worst = Vec::new();
    let ways = [
        "silhouette-hatching",
        "van-gogh",
        "toon",
        "watercolour",
        "minimal",
    ];
    let sweeps = AXES
        .iter()
        .map(|a| (format!("{}.{}", a.0, a.1), sweep(*a, 100)));
    let ways = ways.map(|to| (format!("photo to {to}"), way("photo", to, 100)));
    for (name, styles) in ways.into_iter().chain(sweeps) {
        let steps = tree.steps(&styles, 96);
        let mut sorted = steps.clone();
        sorted.sort_by(f64::total_cmp);
        let (median, most) = (sorted[50], sorted[99]);
        println!(
            "{name}: median {median:.5}, largest {most:.5}, {:.2} of the limit",
            leap(&steps)
        );
        worst.push((leap(&steps), name));
    }
    let over: Vec<_> = worst.iter().filter(|w| w.0 > 1.0).collect();
    assert!(over.is_empty(), "{over:?}");
}
