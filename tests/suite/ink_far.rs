//! Drawings of what is far away: branches as lines of about a pixel, contours that become fewer.

use std::collections::VecDeque;

use glam::{DVec3, Vec3};
use umbrage::foliage::{self, Leaves, Split};
use umbrage::ink::leaves::LeafTriangles;
use umbrage::ink::mix::Mix;
use umbrage::ink::plan::Attribute;
use umbrage::ink::plant::Plant;
use umbrage::ink::renderer::{Drawing, InkRenderer, InkScene};
use umbrage::ink::style::Style;
use umbrage::ink::view::View;
use umbrage::scene::grow::{self, GrowOptions, Species};
use umbrage::scene::{Camera, Geometry, Model};

use crate::fixture;
use crate::ink::{Disc, cards, draw_leaves};

/// A plant ready to be drawn at any distance.
struct Plants {
    model: Model,
    geometry: Geometry,
    split: Split,
    leaves: Leaves,
}

impl Plants {
    fn new(model: Model) -> Self {
        let geometry = Geometry::flatten(&model);
        let split = Split::with_or_without(&model, &geometry, Some("leaf")).unwrap();
        let leaves = Leaves::new(
            &geometry.positions,
            &split.foliage_indices,
            foliage::Primitive::Leaf,
        );
        Self {
            model,
            geometry,
            split,
            leaves,
        }
    }

    /// From a side, `metres` away from its middle, with depths and ids read back.
    fn drawn(&self, metres: f64, size: [u32; 2], style: &str) -> Drawing {
        let gpu = fixture::gpu();
        let (model, geometry) = (&self.model, &self.geometry);
        let triangles = LeafTriangles {
            indices: &self.split.foliage_indices,
            first: &self.leaves.first,
            triangles: &self.leaves.triangles,
        };
        let style = format!("format_version = 1\ndescription = \"far\"\n{style}");
        let style = Style::parse(&style).unwrap();
        let styles = std::slice::from_ref(&style);
        let foliage = &self.split.foliage_parts;
        let plant = Plant::new(model, geometry, triangles, foliage, None, styles).unwrap();
        let first = [geometry.positions[0]; 2];
        let all = geometry.positions.iter();
        let [low, high] = all.fold(first, |[a, b], &p| [a.min(p), b.max(p)]);
        let middle = geometry.origin + (0.5 * (low + high)).as_dvec3();
        let camera = Camera {
            eye: middle + metres * DVec3::Z,
            forward: DVec3::NEG_Z,
            fov: 20.0,
            aspect: f64::from(size[0]) / f64::from(size[1]),
            near: 0.01,
            roll: 0.0,
        };
        let view = View::new(camera, geometry.origin, size, Vec3::Y, &geometry.positions);
        let scene = InkScene {
            model,
            geometry,
            plant: &plant,
        };
        let renderer = InkRenderer::new(&gpu, &scene, &Mix::single(style), &view, 1).unwrap();
        let wanted = [Attribute::Depth, Attribute::Ids];
        renderer.draw_with(&scene, &view, &wanted).unwrap()
    }
}

fn tree(leaves: u32) -> Model {
    let options = GrowOptions {
        leaves: Some(leaves),
        ..GrowOptions::default()
    };
    grow::grow(Species::Broadleaf, &options).unwrap()
}

/// Leaves one of `every` thin stems of a tree (of branching order 2 and more) that are at least
/// `least` metres long, and says how many: of a whole crown far away hardly a branch is seen alone.
fn thinned(model: &mut Model, every: usize, least: f32) -> usize {
    let mut kept = 0;
    for part in model.meshes.iter_mut().flat_map(|m| &mut m.primitives) {
        let orders = part.botany.as_ref().map(|b| b.branch_order.clone());
        let Some(orders) = orders.filter(|o| !o.is_empty()) else {
            continue;
        };
        // Vertices of a stem follow each other, and no triangle has two stems'.
        let mut stems: Vec<Vec<u32>> = Vec::new();
        let mut last = None;
        for corners in part.indices.chunks_exact(3) {
            if last.is_none_or(|last| corners.iter().all(|&v| v > last)) {
                stems.push(Vec::new());
            }
            last = last.max(corners.iter().copied().max());
            stems.last_mut().unwrap().extend(corners);
        }
        stems.retain(|stem| {
            let at = |v: &u32| Vec3::from(part.positions[*v as usize]);
            let first = at(&stem[0]);
            let length = stem.iter().map(|v| at(v).distance(first));
            orders[stem[0] as usize] >= 2 && length.fold(0.0, f32::max) >= least
        });
        let chosen: Vec<Vec<u32>> = stems.into_iter().step_by(every).collect();
        kept += chosen.len();
        part.indices = chosen.concat();
    }
    kept
}

/// What a pixel shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Shown {
    Nothing,
    Leaf,
    Wood,
}

struct Mask {
    size: [i64; 2],
    shown: Vec<Shown>,
}

impl Mask {
    fn of(drawing: &Drawing, size: [u32; 2]) -> Self {
        let bytes = |wanted: Attribute| {
            let found = drawing.attributes.iter().find(|a| a.0 == wanted);
            &found.unwrap().1
        };
        let depth: Vec<f32> = bytemuck::pod_collect_to_vec(bytes(Attribute::Depth));
        let ids: Vec<[f32; 2]> = bytemuck::pod_collect_to_vec(bytes(Attribute::Ids));
        let one = |(d, id): (&f32, &[f32; 2])| match (*d > 0.0, id[1] > 0.0) {
            (false, _) => Shown::Nothing,
            (true, true) => Shown::Leaf,
            (true, false) => Shown::Wood,
        };
        Self {
            size: size.map(i64::from),
            shown: depth.iter().zip(&ids).map(one).collect(),
        }
    }

    fn at(&self, x: i64, y: i64) -> Shown {
        let [w, h] = self.size;
        if x < 0 || y < 0 || x >= w || y >= h {
            return Shown::Nothing;
        }
        self.shown[(y * w + x) as usize]
    }

    fn wood(&self) -> usize {
        self.shown.iter().filter(|s| **s == Shown::Wood).count()
    }

    /// Sizes of what hangs together by edges or corners, largest first; leaves hide no gap.
    fn pieces(&self) -> Vec<usize> {
        let [w, h] = self.size;
        let mut seen = vec![false; self.shown.len()];
        let mut out = Vec::new();
        for start in 0..self.shown.len() {
            if seen[start] || self.shown[start] != Shown::Wood {
                continue;
            }
            seen[start] = true;
            let (mut queue, mut size) = (VecDeque::from([start as i64]), 0);
            while let Some(i) = queue.pop_front() {
                size += 1;
                for k in 0..9 {
                    let (x, y) = (i % w + k % 3 - 1, i / w + k / 3 - 1);
                    if x < 0 || y < 0 || x >= w || y >= h || self.at(x, y) == Shown::Nothing {
                        continue;
                    }
                    let j = (y * w + x) as usize;
                    if !seen[j] {
                        seen[j] = true;
                        queue.push_back(j as i64);
                    }
                }
            }
            out.push(size);
        }
        out.sort_unstable_by(|a, b| b.cmp(a));
        out
    }

    /// Width of what is drawn at a pixel: the shortest run through it in rows and columns.
    fn width(&self, x: i64, y: i64) -> i64 {
        let run = |(dx, dy): (i64, i64)| {
            let reach = |sign: i64| {
                (1..)
                    .take_while(|k| self.at(x + sign * k * dx, y + sign * k * dy) != Shown::Nothing)
                    .count() as i64
            };
            1 + reach(1) + reach(-1)
        };
        [(1, 0), (0, 1)].map(run).into_iter().min().unwrap_or(0)
    }

    /// How many pixels of wood in a hundred are 1, 2, 3, ... wide.
    fn widths(&self) -> [f64; 6] {
        let mut out = [0.0; 6];
        let [w, _] = self.size;
        for i in (0..self.shown.len()).filter(|&i| self.shown[i] == Shown::Wood) {
            let i = i as i64;
            out[(self.width(i % w, i / w) - 1).min(5) as usize] += 100.0 / self.wood() as f64;
        }
        out
    }
}

#[test]
fn branches_far_away_are_unbroken_lines_of_a_pixel() {
    let size = [320, 320];
    let mut model = tree(40);
    let kept = thinned(&mut model, 60, 0.6);
    let plants = Plants::new(model);
    let seen = |lod: f32| {
        let style = "size = 0.1\n[contour]\nstrength = 1.0\n";
        let style = format!("[leaves]\nlod = {lod:.1}\n{style}");
        let mask = Mask::of(&plants.drawn(60.0, size, &style), size);
        let (pieces, widths) = (mask.pieces(), mask.widths());
        println!("{kept} stems, lod {lod}: pieces of {pieces:?}, widths {widths:.1?}");
        (pieces, widths)
    };
    // Stems that cross are one piece; broken ones are many.
    let (near, _) = seen(0.0);
    assert!(near.len() > 2 * kept, "{} without widening", near.len());
    let (pieces, widths) = seen(12.0);
    assert!(kept > 20 && pieces.len() <= kept, "{kept}: {pieces:?}");
    assert!(widths[0] + widths[1] > 90.0, "{widths:?}");
    assert!(widths[3..].iter().sum::<f64>() < 4.0, "{widths:?}");
}

fn contour_pixels(drawing: &Drawing) -> usize {
    let lines: Vec<f32> = bytemuck::pod_collect_to_vec(&drawing.lines[0]);
    lines.iter().filter(|v| **v > 0.0).count()
}

/// Contour pixels of the same picture of discs at growing distances, the gaps between them the
/// same in metres.
fn at_distances(contour: &str) -> Vec<usize> {
    let mut state = 977_u32;
    let mut next = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        f64::from(state >> 8) / 16_777_216.0
    };
    let discs: Vec<[f64; 4]> = (0..120)
        .map(|i| {
            let behind = 4.0 * f64::from((i * 389) % 120) / 120.0;
            [
                next() - 0.5,
                0.5 * (next() - 0.5),
                behind,
                0.02 + 0.04 * next(),
            ]
        })
        .collect();
    let style = Style::parse(&format!(
        "format_version = 1\ndescription = \"far\"\n\
         [leaves]\nfacing = 1.0\nshape = 0.0\ncluster_radius = 0.01\n\
         [contour]\nstrength = 1.0\n{contour}"
    ))
    .unwrap();
    let first: Vec<u32> = (0..=discs.len() as u32).map(|i| 2 * i).collect();
    let one = |metres: f64| {
        let seen = discs.iter().map(|&[x, y, behind, radius]| {
            let depth = metres + behind;
            Disc {
                at: DVec3::new(x * depth, y * depth, -depth).as_vec3(),
                radius: (radius * depth) as f32,
            }
        });
        let model = cards(&seen.collect::<Vec<_>>());
        contour_pixels(&draw_leaves(&model, &first, &style, [200, 150]).drawing)
    };
    [4.0, 6.0, 10.0, 20.0, 40.0, 80.0].map(one).to_vec()
}

#[test]
fn contours_become_fewer_with_distance() {
    let mapped = at_distances("threshold = 0.05\nmapping = 4.0\n");
    let linear = at_distances("threshold = 0.05\n");
    assert!(mapped.windows(2).all(|w| w[1] < w[0]), "{mapped:?}");
    assert!(mapped[0] as f64 > 1.3 * mapped[5] as f64, "{mapped:?}");
    // Linear depths are over the range of what is drawn, which has not changed; now and then a corner
    // lies between two places of the raster, and goes to the other one.
    assert!(
        linear.iter().all(|&n| n.abs_diff(linear[0]) <= 4),
        "{linear:?}"
    );
}

#[test]
fn a_tree_that_goes_away_has_fewer_contour_pixels() {
    let plants = Plants::new(tree(2000));
    let size = [240, 240];
    let seen = |contour: &str| -> Vec<(usize, f64)> {
        let one = |metres: f64| {
            let style =
                format!("[leaves]\nshape = 0.0\nlod = 12.0\n[contour]\nstrength = 1.0\n{contour}");
            let drawing = plants.drawn(metres, size, &style);
            let mask = Mask::of(&drawing, size);
            let covered = mask.shown.iter().filter(|s| **s != Shown::Nothing).count();
            let lines = contour_pixels(&drawing);
            (lines, lines as f64 / covered as f64)
        };
        [45.0, 80.0, 150.0].map(one).to_vec()
    };
    let (mapped, linear) = (seen("mapping = 4.0"), seen(""));
    println!("contour pixels, share of what is drawn: mapped {mapped:.3?}, linear {linear:.3?}");
    for found in [&mapped, &linear] {
        assert!(found.windows(2).all(|w| w[1].0 < w[0].0), "{found:?}");
    }
    // A small tree is hardly more than its outlines, unless far gaps count for less.
    assert!(mapped.windows(2).all(|w| w[1].1 <= w[0].1), "{mapped:?}");
    assert!(linear[2].1 > 1.3 * linear[0].1, "{linear:?}");
}
