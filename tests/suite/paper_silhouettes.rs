//! Outlines of a whole generated plant's branches against the silhouettes of the ideal cones that
//! its mesh stands for (Deussen and Strothotte 2000, section 3.1).

use std::collections::{HashMap, HashSet};
use std::f64::consts::TAU;

use glam::{DVec2, DVec3, IVec2, Vec3};
use umbrage::ink::paper::drawing::{Placement, drawing};
use umbrage::ink::paper::fit::distance_to_segment;
use umbrage::ink::paper::renderer::{PaperRenderer, PaperScene};
use umbrage::ink::view::View;
use umbrage::scene::grow::{GrowOptions, Species, grow};
use umbrage::scene::{Camera, Geometry};

use crate::fixture;
use crate::paper::style;

const SIZE: [u32; 2] = [480, 640];

/// A closed curve through a ring's vertices, as few waves as there can be: of points on a circle
/// that circle, whatever their number.
struct Ring {
    middle: DVec3,
    /// Cosine and sine of one turn, two turns and so on.
    waves: Vec<[DVec3; 2]>,
}

impl Ring {
    fn new(points: &[DVec3]) -> Self {
        let count = points.len() as f64;
        let sum = |weight: &dyn Fn(f64) -> f64| -> DVec3 {
            let each = points.iter().enumerate();
            each.map(|(k, &p)| p * weight(TAU * k as f64 / count))
                .sum::<DVec3>()
                / count
        };
        let wave = |m: usize| {
            let m = m as f64;
            [sum(&|a| 2.0 * (m * a).cos()), sum(&|a| 2.0 * (m * a).sin())]
        };
        Self {
            middle: sum(&|_| 1.0),
            waves: (1..=(points.len() - 1) / 2).map(wave).collect(),
        }
    }

    /// A point of the curve, and its derivative by the angle.
    fn at(&self, angle: f64) -> [DVec3; 2] {
        let mut out = [self.middle, DVec3::ZERO];
        for (m, [c, s]) in (1..).zip(&self.waves) {
            let m = f64::from(m);
            let (sin, cos) = (m * angle).sin_cos();
            out[0] += cos * *c + sin * *s;
            out[1] += m * (cos * *s - sin * *c);
        }
        out
    }
}

/// Pairs of rings that a generated mesh joins, and rings whose tip is a point.
fn sections(places: &[DVec3], indices: &[u32]) -> Vec<[Ring; 2]> {
    let triangles: Vec<[u32; 3]> = indices
        .chunks_exact(3)
        .map(|t| [t[0], t[1], t[2]])
        .collect();
    let ring = |first: u32, count: u32| {
        let points = &places[first as usize..(first + count) as usize];
        Ring::new(points)
    };
    let quad = |k: usize| {
        let (one, two) = (triangles.get(k)?, triangles.get(k + 1)?);
        let [a, b, d] = *one;
        (b == a + 1 && *two == [a, d, d - 1]).then_some([a, d - 1])
    };
    let mut out = Vec::new();
    let mut k = 0;
    while k < triangles.len() {
        if let Some([below, above]) = quad(k) {
            let sides =
                (0..).take_while(|&n| quad(k + 2 * n as usize) == Some([below + n, above + n]));
            let sides = sides.count() as u32;
            out.push([ring(below, sides), ring(above, sides)]);
            k += 2 * sides as usize;
        } else {
            let [a, b, tip] = triangles[k];
            let goes_on =
                |n: &u32| triangles.get(k + *n as usize) == Some(&[a + n, b + n, tip + n]);
            let sides = (0..).take_while(goes_on).count() as u32;
            if sides > 2 {
                out.push([ring(a, sides), Ring::new(&[places[tip as usize]; 3])]);
            }
            k += sides.max(1) as usize;
        }
    }
    out
}

/// Silhouettes of the surface that straight lines from ring to ring make, pixels.
fn ideal(sections: &[[Ring; 2]], view: &View) -> Vec<[DVec2; 2]> {
    const STEPS: u32 = 32;
    let eye = view.eye();
    let mut out = Vec::new();
    for [below, above] in sections {
        let point = |angle: f64, t: f64| {
            let ([p, along], [q, other]) = (below.at(angle), above.at(angle));
            (p.lerp(q, t), along.lerp(other, t).cross(q - p))
        };
        let facing = |angle: f64, t: f64| {
            let (p, normal) = point(angle, t);
            normal.dot(p - eye)
        };
        let pixel = |angle: f64, t: f64| view.pixel(point(angle, t).0).0;
        let length = pixel(0.0, 0.0).distance(pixel(0.0, 1.0));
        let rows = (0.25 * length).ceil().clamp(2.0, 64.0) as u32;
        let mut before: Vec<DVec2> = Vec::new();
        for row in 0..=rows {
            let t = (f64::from(row) / f64::from(rows)).clamp(1e-4, 1.0 - 1e-4);
            let mut now = Vec::new();
            for k in 0..STEPS {
                let [mut a, mut b] = [k, k + 1].map(|k| TAU * f64::from(k) / f64::from(STEPS));
                let sign = facing(a, t) > 0.0;
                if sign == (facing(b, t) > 0.0) {
                    continue;
                }
                for _ in 0..20 {
                    let middle = 0.5 * (a + b);
                    if (facing(middle, t) > 0.0) == sign {
                        a = middle;
                    } else {
                        b = middle;
                    }
                }
                now.push(pixel(a, t));
            }
            if now.len() == before.len() {
                out.extend(before.iter().zip(&now).map(|(&a, &b)| [a, b]));
            }
            before = now;
        }
    }
    out
}

/// A grown plant's branches up to the second order, and a view of all of it.
fn plant(species: Species) -> (Geometry, Vec<u32>, View) {
    let options = GrowOptions {
        seed: 2,
        leaves: Some(400),
        ..GrowOptions::default()
    };
    let model = grow(species, &options).unwrap();
    let wood = &model.meshes[0].primitives[0];
    let order = &wood.botany.as_ref().unwrap().branch_order;
    let triangles = wood.indices.chunks_exact(3);
    let drawn = triangles.filter(|t| order[t[0] as usize] <= 2);
    let stems: Vec<u32> = drawn.flatten().copied().collect();
    let positions: Vec<Vec3> = wood.positions.iter().map(|&p| Vec3::from(p)).collect();
    let places = || stems.iter().map(|&i| positions[i as usize]);
    let min = places().fold(Vec3::INFINITY, Vec3::min);
    let max = places().fold(Vec3::NEG_INFINITY, Vec3::max);
    let reach = f64::from((max - min).max_element());
    let camera = Camera {
        eye: (0.5 * (min + max)).as_dvec3() + reach * DVec3::new(0.0, 0.1, 1.7),
        forward: DVec3::NEG_Z,
        fov: 40.0,
        aspect: f64::from(SIZE[0]) / f64::from(SIZE[1]),
        near: 0.01,
        roll: 0.0,
    };
    let view = View::new(camera, DVec3::ZERO, SIZE, Vec3::Y, &[min, max]);
    let geometry = Geometry {
        positions,
        normals: wood.normals.iter().map(|&n| Vec3::from(n)).collect(),
        indices: wood.indices.clone(),
        min,
        max,
        ..Geometry::default()
    };
    (geometry, stems, view)
}

/// Distances of points from lines, pixels, at most 4.
fn distances(points: &[DVec2], lines: &[[DVec2; 2]]) -> Vec<f64> {
    let key = |p: DVec2| (p / 4.0).floor().as_ivec2();
    let mut cells: HashMap<IVec2, Vec<[DVec2; 2]>> = HashMap::new();
    for line in lines {
        // Longer pieces pass further cells.
        let count = (line[0].distance(line[1]) / 2.0).ceil().clamp(1.0, 200.0) as u32;
        let on = |k: u32| key(line[0].lerp(line[1], f64::from(k) / f64::from(count)));
        let passed: HashSet<IVec2> = (0..=count).map(on).collect();
        passed
            .into_iter()
            .for_each(|k| cells.entry(k).or_default().push(*line));
    }
    let least = |p: &DVec2| {
        let about = (-1..=1).flat_map(|y| (-1..=1).map(move |x| IVec2::new(x, y)));
        let near = about.filter_map(|k| cells.get(&(key(*p) + k))).flatten();
        near.map(|l| distance_to_segment(*p, l[0], l[1]))
            .fold(4.0, f64::min)
    };
    points.iter().map(least).collect()
}

/// Outlines of a plant against its ideal cones.
fn held_against_its_cones(species: Species) {
    let (geometry, stems, view) = plant(species);
    let style = style("[stem]\nhatching = 0.0\n");
    let scene = PaperScene {
        geometry: &geometry,
        stems: &stems,
        particles: &[],
        leaves: 0,
    };
    let renderer = PaperRenderer::new(&fixture::gpu(), &scene, &style, SIZE).unwrap();
    let maps = renderer.maps(&scene, &view).unwrap();
    let (found, _) = drawing(&maps, &style, &view);
    let places: Vec<DVec3> = geometry.positions.iter().map(|p| p.as_dvec3()).collect();
    let truth = ideal(&sections(&places, &stems), &view);
    let placement = Placement::new(&style, maps.size);
    // Where the plant stands its end is drawn, which is no cone's silhouette.
    let foot = f64::from(SIZE[1]) - 60.0;
    let points = found.layers[0].strokes.iter().flat_map(|s| &s.line.points);
    let points = points.map(|p| (*p - placement.corner) / placement.scale);
    let points: Vec<DVec2> = points.filter(|p| p.y < foot).collect();
    let mut off = distances(&points, &truth);
    off.sort_by(f64::total_cmp);
    let mean = off.iter().sum::<f64>() / off.len() as f64;
    let [half, most, all] = [0.5, 0.98, 1.0].map(|q| off[((off.len() - 1) as f64 * q) as usize]);
    println!(
        "{}: {} points, mean {mean:.3} px, half within {half:.3}, 98 % within {most:.3}, all within {all:.3}",
        species.name(),
        off.len()
    );
    assert!(off.len() > 4000, "{} points", off.len());
    assert!(
        mean <= 0.26 && most <= 1.0 && all <= 2.0,
        "{}: {mean} {most} {all}",
        species.name()
    );
}

#[test]
fn outlines_of_a_whole_broadleaf_are_the_silhouettes_of_its_cones() {
    held_against_its_cones(Species::Broadleaf);
}

#[test]
fn outlines_of_a_whole_shrub_are_the_silhouettes_of_its_cones() {
    held_against_its_cones(Species::Shrub);
}

#[test]
fn outlines_of_a_whole_conifer_are_the_silhouettes_of_its_cones() {
    held_against_its_cones(Species::Conifer);
}
