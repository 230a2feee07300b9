//! Contours against analytic outlines (measure M1) and on the nearer side (M3): discs, ellipses and
//! polygons, apart from each other and a thousand over one another.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};
use umbrage::abi::InkLeaf;
use umbrage::ink::style::Style;
use umbrage::ink::view::View;
use umbrage::scene::{Instance, Material, Mesh, Model, Primitive};

use crate::ink::{Drawn, draw_leaves};

/// A line pixel and an outline this far apart belong together, pixels.
const NEAR: f32 = 1.5;
/// Edge of the cells in which figures are looked for, pixels.
const CELL: f32 = 32.0;
/// Least difference of depth that is drawn, of the range.
const THRESHOLD: f32 = 1e-4;
/// Corners of the polygons, in shares of their size; each kind has a material of its own.
const POLYGONS: [&[(f32, f32)]; 4] = [
    &[(-0.9, -0.5), (1.0, -0.3), (0.1, 0.9)],
    &[(-1.0, -0.2), (0.2, -0.7), (0.9, 0.3), (-0.3, 0.6)],
    &[
        (-0.8, -0.6),
        (0.4, -0.8),
        (1.0, 0.1),
        (0.2, 0.8),
        (-0.9, 0.4),
    ],
    &[
        (-1.0, 0.0),
        (-0.4, -0.7),
        (0.5, -0.6),
        (0.9, 0.2),
        (0.1, 0.8),
        (-0.6, 0.6),
    ],
];

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Disc,
    Ellipse,
    Polygon,
}

/// A flat figure that faces the viewer.
#[derive(Debug, Clone, Copy)]
struct Figure {
    at: Vec3,
    radius: f32,
    turn: f32,
}

impl Kind {
    fn style(self) -> Style {
        let leaves = match self {
            Self::Disc => "shape = 0.0",
            Self::Ellipse => "shape = 0.0\nelongation = 2.5",
            Self::Polygon => "shape = 1.0",
        };
        Style::parse(&format!(
            "format_version = 1\ndescription = \"figures\"\n\
             [leaves]\nfacing = 1.0\ncluster_radius = 0.01\n{leaves}\n\
             [contour]\nstrength = 1.0\nthreshold = {THRESHOLD}\n"
        ))
        .unwrap()
    }

    /// Corners of the mesh of a figure, and its number of material.
    fn corners(self, number: usize) -> (usize, Vec<Vec2>) {
        let square = [(-0.7, -0.7), (0.7, -0.7), (0.7, 0.7), (-0.7, 0.7)];
        let (material, list) = match self {
            Self::Polygon => (number % POLYGONS.len(), POLYGONS[number % POLYGONS.len()]),
            Self::Disc | Self::Ellipse => (0, &square[..]),
        };
        (material, list.iter().map(|&c| Vec2::from(c)).collect())
    }

    /// Places of the corners.
    fn places(self, number: usize, figure: &Figure) -> Vec<Vec3> {
        let turn = Vec2::from_angle(figure.turn);
        let place = |c: &Vec2| figure.at + (figure.radius * turn.rotate(*c)).extend(0.0);
        self.corners(number).1.iter().map(place).collect()
    }

    /// A model of the figures, with the first triangle of each in its index list, and the figures
    /// in its order.
    fn model(self, figures: &[Figure]) -> (Model, Vec<u32>, Vec<usize>) {
        let mut parts = vec![Primitive::default(); POLYGONS.len()];
        let mut order = Vec::new();
        let mut first = vec![0];
        for (material, part) in parts.iter_mut().enumerate() {
            part.material = material;
            for (number, figure) in figures.iter().enumerate() {
                if self.corners(number).0 != material {
                    continue;
                }
                let start = part.positions.len() as u32;
                let places = self.places(number, figure);
                for k in 1..places.len() as u32 - 1 {
                    part.indices.extend([start, start + k, start + k + 1]);
                }
                first.push(first[first.len() - 1] + places.len() as u32 - 2);
                part.positions.extend(places.iter().map(|p| p.to_array()));
                order.push(number);
            }
        }
        parts.retain(|p| !p.indices.is_empty());
        let model = Model {
            name: "figures".into(),
            meshes: vec![Mesh {
                name: "figures".into(),
                primitives: parts,
            }],
            instances: vec![Instance {
                name: "figures".into(),
                mesh: 0,
                local_to_world: glam::DAffine3::IDENTITY,
                source: None,
            }],
            materials: vec![Material::default(); POLYGONS.len()],
            ..Model::default()
        };
        (model, first, order)
    }
}

/// The outline of a figure in the picture.
struct Outline {
    depth: f32,
    centre: Vec2,
    reach: f32,
    /// Half axes of an ellipse, pixels; none of a polygon.
    axes: Option<[Vec2; 2]>,
    corners: Vec<Vec2>,
}

impl Outline {
    fn new(kind: Kind, corners: &[Vec3], leaf: &InkLeaf, view: &View) -> Self {
        let focal = view.focal() as f32;
        let [w, h] = view.size.map(|s| s as f32);
        // The camera stands in the origin of the scene, leaves in the geometry's.
        let centre = Vec3::from(leaf.centre) - view.eye().as_vec3();
        let depth = -centre.z;
        let flat = |v: Vec3| Vec2::new(v.x, -v.y) * focal / depth;
        let pixel = |v: Vec3| flat(v) + 0.5 * Vec2::new(w, h);
        let axis = Vec3::from(leaf.axis);
        let side = axis.cross(Vec3::from(leaf.normal));
        let long = if kind == Kind::Ellipse {
            2.5_f32.sqrt()
        } else {
            1.0
        };
        let axes = [side / long, axis * long].map(|v| flat(v * leaf.radius));
        Self {
            depth,
            centre: pixel(centre),
            reach: 1.6 * leaf.radius * focal / depth + 2.0,
            axes: (kind != Kind::Polygon).then_some(axes),
            corners: corners.iter().map(|&c| pixel(c)).collect(),
        }
    }

    fn covers(&self, q: Vec2) -> bool {
        let away = q - self.centre;
        if let Some(axes) = self.axes {
            return axes
                .iter()
                .map(|a| (away.dot(*a) / a.length_squared()).powi(2))
                .sum::<f32>()
                <= 1.0;
        }
        // Corners go round against the clock where y goes up.
        let edges = self.edges();
        edges
            .into_iter()
            .all(|(a, b)| (b - a).perp_dot(q - a) <= 0.0)
    }

    fn edges(&self) -> Vec<(Vec2, Vec2)> {
        let next = self.corners.iter().cycle().skip(1);
        self.corners.iter().copied().zip(next.copied()).collect()
    }

    /// Points half a pixel apart, with the direction outwards.
    fn points(&self) -> Vec<(Vec2, Vec2)> {
        if let Some([a, b]) = self.axes {
            let steps = (2.0 * TAU * a.length().max(b.length())) as u32;
            let point = |k: u32| {
                let (sin, cos) = (TAU * k as f32 / steps as f32).sin_cos();
                let out = cos * a / a.length_squared() + sin * b / b.length_squared();
                (self.centre + cos * a + sin * b, out.normalize())
            };
            return (0..steps).map(point).collect();
        }
        let edge = |(a, b): (Vec2, Vec2)| {
            let steps = (2.0 * a.distance(b)).ceil();
            let out = (b - a).perp().normalize()
                * if self.covers(0.5 * (a + b) + 0.01 * (b - a).perp().normalize()) {
                    -1.0
                } else {
                    1.0
                };
            (0..steps as u32).map(move |k| (a.lerp(b, (k as f32 + 0.5) / steps), out))
        };
        self.edges().into_iter().flat_map(edge).collect()
    }
}

/// Things by the cells of the picture that they reach into.
struct Cells {
    across: usize,
    down: usize,
    lists: Vec<Vec<usize>>,
}

impl Cells {
    fn new(size: [u32; 2], things: impl Iterator<Item = (Vec2, f32)>) -> Self {
        let [across, down] = size.map(|s| (s as f32 / CELL) as usize + 1);
        let mut lists = vec![Vec::new(); across * down];
        for (i, (at, reach)) in things.enumerate() {
            let cell = |v: f32, most: usize| (v / CELL).clamp(0.0, most as f32 - 1.0) as usize;
            for y in cell(at.y - reach, down)..=cell(at.y + reach, down) {
                for x in cell(at.x - reach, across)..=cell(at.x + reach, across) {
                    lists[y * across + x].push(i);
                }
            }
        }
        Self {
            across,
            down,
            lists,
        }
    }

    fn at(&self, p: Vec2) -> &[usize] {
        let cell = |v: f32, most: usize| ((v / CELL).max(0.0) as usize).min(most - 1);
        &self.lists[cell(p.y, self.down) * self.across + cell(p.x, self.across)]
    }
}

/// Points of outlines that are seen, with something farther by `gap` behind them.
fn truth(outlines: &[Outline], size: [u32; 2], gap: f32) -> Vec<Vec2> {
    let cells = Cells::new(size, outlines.iter().map(|o| (o.centre, o.reach)));
    let [w, h] = size.map(|s| s as f32);
    let mut out = Vec::new();
    for o in outlines {
        for (p, outward) in o.points() {
            if !((1.0..w - 1.0).contains(&p.x) && (1.0..h - 1.0).contains(&p.y)) {
                continue;
            }
            // In by a pixel: what could hide it. Out by one: what it is seen against.
            let nearest = |q: Vec2| {
                let covering = cells.at(q).iter().filter(|&&i| outlines[i].covers(q));
                covering
                    .map(|&i| outlines[i].depth)
                    .fold(f32::INFINITY, f32::min)
            };
            if nearest(p - outward) >= o.depth && nearest(p + outward) - o.depth > gap {
                out.push(p);
            }
        }
    }
    out
}

/// Share of `from` that has one of `to` nearby.
fn near(from: &[Vec2], to: &[Vec2], size: [u32; 2]) -> f64 {
    let cells = Cells::new(size, to.iter().map(|&p| (p, NEAR)));
    let hit = |p: &&Vec2| cells.at(**p).iter().any(|&i| p.distance(to[i]) <= NEAR);
    from.iter().filter(hit).count() as f64 / from.len() as f64
}

fn f_of(found: &[Vec2], truth: &[Vec2], size: [u32; 2]) -> f64 {
    let (precision, recall) = (near(found, truth, size), near(truth, found, size));
    2.0 * precision * recall / (precision + recall)
}

/// Line pixels of a drawing.
fn lines(drawn: &Drawn, size: [u32; 2]) -> Vec<Vec2> {
    let line: Vec<f32> = bytemuck::pod_collect_to_vec(&drawn.drawing.lines[0]);
    places(size, |i| line[i] == 1.0)
}

fn places(size: [u32; 2], is: impl Fn(usize) -> bool) -> Vec<Vec2> {
    let w = size[0] as usize;
    let at = |i: usize| Vec2::new((i % w) as f32 + 0.5, (i / w) as f32 + 0.5);
    (0..w * size[1] as usize)
        .filter(|&i| is(i))
        .map(at)
        .collect()
}

/// Depth of a pixel and those around it.
fn around(depth: &[f32], size: [u32; 2], p: Vec2) -> (f32, Vec<f32>) {
    let [w, h] = size.map(|s| s as usize);
    let (x, y) = (p.x as usize, p.y as usize);
    let rows = y.saturating_sub(1)..=(y + 1).min(h - 1);
    let all = rows.flat_map(|y| (x.saturating_sub(1)..=(x + 1).min(w - 1)).map(move |x| (x, y)));
    (
        depth[y * w + x],
        all.map(|(x, y)| depth[y * w + x]).collect(),
    )
}

/// Draws figures; F of their lines, and the truth moved by two pixels as a check of the measure.
fn measured(kind: Kind, figures: &[Figure], size: [u32; 2]) -> (f64, f64, Vec<f32>, Vec<Vec2>) {
    let (model, first, order) = kind.model(figures);
    let drawn = draw_leaves(&model, &first, &kind.style(), size);
    let outline = |(leaf, &number): (&InkLeaf, &usize)| {
        let corners = kind.places(number, &figures[number]);
        Outline::new(kind, &corners, leaf, &drawn.view)
    };
    let outlines: Vec<_> = drawn.leaves.iter().zip(&order).map(outline).collect();
    assert_eq!(outlines.len(), figures.len());
    let [near, far] = drawn.view.depths;
    let truth = truth(&outlines, size, THRESHOLD * (far - near));
    let found = lines(&drawn, size);
    let moved: Vec<Vec2> = truth.iter().map(|p| *p + 2.0).collect();
    let f = f_of(&found, &truth, size);
    let wrong = f_of(&found, &moved, size);
    println!(
        "{kind:?} x {}: F {f:.4} of {} pixels; moved by two {wrong:.3}",
        figures.len(),
        found.len()
    );
    (
        f,
        wrong,
        bytemuck::pod_collect_to_vec(&drawn.drawing.attributes[0].1),
        found,
    )
}

/// Apart from each other, of many sizes.
fn apart() -> Vec<Figure> {
    let one = |i: u32| Figure {
        at: Vec3::new((i % 6) as f32 - 2.5, (i / 6) as f32 - 1.5, -4.0) * 0.7,
        radius: 0.04 + 0.008 * i as f32,
        turn: 0.37 * i as f32,
    };
    (0..24).map(one).collect()
}

fn random(count: u32) -> Vec<Figure> {
    let mut state = 12_345_u32;
    let mut next = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (state >> 8) as f32 / 16_777_216.0
    };
    (0..count)
        .map(|i| {
            // Depths apart by a step, in random order of place.
            let depth = 4.0 + 4.0 * ((i * 389) % count) as f32 / count as f32;
            let (x, y) = (next() - 0.5, next() - 0.5);
            Figure {
                at: Vec3::new(1.4 * x, y, -1.0) * depth,
                radius: depth * (0.012 + 0.024 * next()),
                turn: TAU * next(),
            }
        })
        .collect()
}

fn single_and_thousand(kind: Kind) {
    let (f, moved, ..) = measured(kind, &apart(), [640, 480]);
    assert!(f >= 0.99, "{kind:?} apart: F {f}");
    assert!(moved < 0.9, "the measure tells two pixels: {moved}");
    let size = [800, 600];
    let (f, moved, depth, found) = measured(kind, &random(1000), size);
    assert!(f >= 0.97, "1000 x {kind:?}: F {f}");
    assert!(moved < 0.95, "the measure tells two pixels: {moved}");
    // Every line pixel lies on what is nearer.
    let farther = |p: &Vec2| {
        let (own, around) = around(&depth, size, *p);
        own > 0.0 && around.iter().any(|&d| d == 0.0 || d > own)
    };
    assert!(found.iter().all(farther));
    // Without the sign of the difference lines lie on what is farther, too.
    let both = places(size, |i| {
        let p = Vec2::new((i % 800) as f32, (i / 800) as f32);
        let (own, around) = around(&depth, size, p);
        around.iter().any(|&d| d != own)
    });
    let wrong = both.iter().filter(|p| !farther(p)).count() as f64 / both.len() as f64;
    assert!(
        wrong > 0.1,
        "without the sign {wrong} lie on the farther side"
    );
}

#[test]
fn contours_of_discs_are_their_outlines_on_the_nearer_side() {
    single_and_thousand(Kind::Disc);
}

#[test]
fn contours_of_ellipses_are_their_outlines_on_the_nearer_side() {
    single_and_thousand(Kind::Ellipse);
}

#[test]
fn contours_of_polygons_are_their_outlines_on_the_nearer_side() {
    single_and_thousand(Kind::Polygon);
}
