//! The way from photograph to drawing has no leaps: every axis of a style is swept, and the
//! picture may change from step to step by little more than it does at most steps.

use umbrage::foliage::{self, Leaves, Split};
use umbrage::gpu::Gpu;
use umbrage::ink::blend;
use umbrage::ink::leaves::LeafTriangles;
use umbrage::ink::mix::Mix;
use umbrage::ink::plant::{CrownLight, Plant};
use umbrage::ink::renderer::{InkRenderer, InkScene};
use umbrage::ink::style::Style;
use umbrage::ink::view::View;
use umbrage::math::packing::f16_to_f32;
use umbrage::scene::grow::{GrowOptions, Species, grow};
use umbrage::scene::model::Primitive;
use umbrage::scene::{Camera, CameraSpec, Geometry, Lens, Model};

use crate::fixture;

/// A step may be so many times the median one.
const LEAP: f64 = 5.0;
/// Mean difference of pixels below which nobody sees a step, 0 to 1.
const FLOOR: f64 = 1e-3;

/// Triangles of the wood.
const TRIANGLES: usize = 12_000;

/// A tree on a device, with what the last picture was drawn with.
pub(crate) struct Tree<'a> {
    gpu: &'a Gpu,
    model: Model,
    geometry: Geometry,
    split: Split,
    known: Option<(Style, u32, Plant, InkRenderer)>,
}

impl<'a> Tree<'a> {
    pub(crate) fn new(gpu: &'a Gpu, leaves: u32) -> Self {
        let options = GrowOptions {
            leaves: Some(leaves),
            ..GrowOptions::default()
        };
        let mut model = grow(Species::Broadleaf, &options).unwrap();
        let wood = model.meshes.iter_mut().flat_map(|m| &mut m.primitives);
        wood.for_each(thinned);
        let geometry = Geometry::flatten(&model);
        let split = Split::new(&model, &geometry, None).unwrap();
        Self {
            gpu,
            model,
            geometry,
            split,
            known: None,
        }
    }

    fn plant(&self, style: &Style) -> Plant {
        let g = &self.geometry;
        let indices = &self.split.foliage_indices;
        let leaves = Leaves::new(&g.positions, indices, foliage::Primitive::Leaf);
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
        let foliage = &self.split.foliage_parts;
        let styles = std::slice::from_ref(style);
        Plant::new(&self.model, g, list, foliage, Some(light), styles).unwrap()
    }

    fn view(&self, size: u32) -> View {
        let g = &self.geometry;
        let lens = Lens {
            fov: 30.0,
            aspect: 1.0,
            margin: 0.05,
        };
        let points = g.positions.iter().copied();
        let camera = Camera::new(&CameraSpec::default(), lens, g.origin, points);
        let to_sun = glam::Vec3::new(-0.4, 0.75, 0.5).normalize();
        View::new(camera, g.origin, [2 * size; 2], to_sun, &g.positions)
    }

    /// Mean difference between each of the pictures of `styles` and the next.
    pub(crate) fn steps(&mut self, styles: &[Style], size: u32) -> Vec<f64> {
        let view = self.view(size);
        let mut last: Option<Vec<f32>> = None;
        let mut steps = Vec::new();
        for style in styles {
            let same = |k: &(Style, u32, Plant, InkRenderer)| {
                k.0.leaves.cluster_radius == style.leaves.cluster_radius
                    && k.0.bodies == style.bodies
                    && k.1 == size
            };
            let (plant, known) = match self.known.take().filter(same) {
                Some((_, _, plant, renderer)) => (plant, Some(renderer)),
                None => (self.plant(style), None),
            };
            let scene = InkScene {
                model: &self.model,
                geometry: &self.geometry,
                plant: &plant,
            };
            let mix = Mix::single(style.clone());
            let mut renderer = known
                .unwrap_or_else(|| InkRenderer::new(self.gpu, &scene, &mix, &view, 2).unwrap());
            renderer.restyle(&scene, style, &view).unwrap();
            let picture = reduced(&renderer.draw(&scene, &view).unwrap().pixels, size);
            if let Some(last) = &last {
                let off = picture
                    .iter()
                    .zip(last)
                    .map(|(a, b)| f64::from((a - b).abs()));
                steps.push(off.sum::<f64>() / picture.len() as f64);
            }
            last = Some(picture);
            self.known = Some((style.clone(), size, plant, renderer));
        }
        steps
    }
}

/// Trunk and boughs come first: twigs are most of the work and little of the picture.
fn thinned(part: &mut Primitive) {
    part.indices.truncate(3 * TRIANGLES);
    let last = part.indices.iter().max().map_or(0, |&i| i as usize + 1);
    part.positions.truncate(last);
    part.normals.truncate(last);
    part.texcoords.truncate(last);
    part.texcoords1.truncate(last);
    part.colors.truncate(last);
    part.ambient.truncate(last);
    part.botany = None;
}

/// Means of 2 x 2 pixels, as the eye sees them: square roots of linear values.
fn reduced(pixels: &[u8], size: u32) -> Vec<f32> {
    let halves: Vec<f32> = pixels
        .chunks_exact(2)
        .map(|b| f16_to_f32(u16::from_le_bytes([b[0], b[1]])))
        .collect();
    let row = 8 * size as usize;
    let mut means = Vec::with_capacity(3 * (size * size) as usize);
    for pair in halves.chunks_exact(2 * row) {
        for x in (0..row).step_by(8) {
            for c in x..x + 3 {
                let sum = pair[c] + pair[c + 4] + pair[row + c] + pair[row + c + 4];
                means.push((0.25 * sum).max(0.0).sqrt());
            }
        }
    }
    means
}

/// The largest step over what it may be.
pub(crate) fn leap(steps: &[f64]) -> f64 {
    let mut sorted = steps.to_vec();
    sorted.sort_by(f64::total_cmp);
    let median = sorted[sorted.len() / 2];
    sorted[sorted.len() - 1] / (LEAP * median + FLOOR)
}

pub(crate) fn way(from: &str, to: &str, steps: u32) -> Vec<Style> {
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
    let gpu = fixture::gpu();
    let mut tree = Tree::new(&gpu, 200);
    let styles = way("photo", "silhouette-hatching", 16);
    let found = leap(&tree.steps(&styles, 40));
    assert!(found <= 1.0, "{found} of what a step may be");
    // The measure sees a switch: the photograph, then at once the drawing.
    let (first, last) = (&styles[0], &styles[16]);
    let hard = [first, first, first, last, last].map(Style::clone);
    let found = leap(&tree.steps(&hard, 40));
    assert!(found > 1.0, "a switch is {found} of what a step may be");
}
