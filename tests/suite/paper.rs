//! Lines of drawings on paper against analytic outlines: places, thresholds, the sun's shadow.

use glam::{DVec2, DVec3, Vec3};
use umbrage::ink::paper::curve::Polyline;
use umbrage::ink::paper::drawing::{Placement, drawing};
use umbrage::ink::paper::order::{pen_up, sorted, without_repeats};
use umbrage::ink::paper::particles::{Particle, unit};
use umbrage::ink::paper::renderer::{Maps, PaperRenderer, PaperScene};
use umbrage::ink::paper::style::PaperStyle;
use umbrage::ink::view::View;
use umbrage::math::sampling::uniform;
use umbrage::reference::paper::gap;
use umbrage::scene::{Camera, Geometry};

use crate::fixture;

pub(crate) const SIZE: [u32; 2] = [320, 240];

pub(crate) fn style(more: &str) -> PaperStyle {
    let text = format!("format_version = 1\nkind = \"paper\"\ndescription = \"x\"\n{more}");
    PaperStyle::parse(&text).unwrap()
}

pub(crate) fn particle(at: Vec3, seed: u32) -> Particle {
    Particle {
        centre: at,
        normal: Vec3::Z,
        axis: None,
        seed,
        object: 0,
    }
}

/// A camera at the origin that looks towards -z; depths from 1 to 11.
pub(crate) fn view() -> View {
    let camera = Camera {
        eye: DVec3::ZERO,
        forward: DVec3::NEG_Z,
        fov: 60.0,
        aspect: f64::from(SIZE[0]) / f64::from(SIZE[1]),
        near: 0.01,
        roll: 0.0,
    };
    let ends = [Vec3::new(0.0, 0.0, -1.0), Vec3::new(0.0, 0.0, -11.0)];
    View::new(camera, DVec3::ZERO, SIZE, Vec3::Y, &ends)
}

pub(crate) fn maps(particles: &[Particle], style: &PaperStyle) -> Maps {
    let geometry = backdrop();
    let scene = scene(&geometry, particles);
    let gpu = fixture::gpu();
    let renderer = PaperRenderer::new(&gpu, &scene, style, SIZE).unwrap();
    renderer.maps(&scene, &view()).unwrap()
}

/// A thing of no size whose bounds are those of the depths.
pub(crate) fn backdrop() -> Geometry {
    Geometry {
        positions: vec![
            Vec3::new(-5.0, -5.0, -11.0),
            Vec3::new(5.0, 5.0, -1.0),
            Vec3::ZERO,
        ],
        normals: vec![Vec3::Z; 3],
        indices: vec![0, 1, 2],
        min: Vec3::new(-5.0, -5.0, -11.0),
        max: Vec3::new(5.0, 5.0, -1.0),
        ..Geometry::default()
    }
}

pub(crate) fn scene<'a>(geometry: &'a Geometry, particles: &'a [Particle]) -> PaperScene<'a> {
    PaperScene {
        geometry,
        stems: &[],
        particles,
        leaves: particles.len(),
    }
}

/// Discs scattered over the picture.
pub(crate) fn scattered(count: u32) -> Vec<Particle> {
    let one = |i: u32| {
        let depth = 2.0 + 8.0 * uniform(3, 3 * i);
        let x = depth * 0.6 * (2.0 * uniform(3, 3 * i + 1) - 1.0);
        let y = depth * 0.42 * (2.0 * uniform(3, 3 * i + 2) - 1.0);
        particle(Vec3::new(x as f32, y as f32, -depth as f32), i)
    };
    (0..count).map(one).collect()
}

#[test]
fn what_the_device_draws_is_inside_the_outlines_that_vectors_follow() {
    for form in ["\"disc\"", "\"ellipse\"", "\"maple\"", "\"leaf\""] {
        let style = style(&format!(
            "[primitive]\nform = {form}\nsize = 0.5\ndeformation = 0.15\n"
        ));
        let particles = scattered(60);
        let maps = maps(&particles, &style);
        let outlines = umbrage::ink::paper::renderer::outlines(&maps, &style, &view());
        let inside = |p: DVec2, ring: &[DVec2]| {
            let mut odd = false;
            for (i, &a) in ring.iter().enumerate() {
                let b = ring[(i + 1) % ring.len()];
                if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
                {
                    odd = !odd;
                }
            }
            odd
        };
        let near = |p: DVec2, ring: &[DVec2]| {
            (0..ring.len()).any(|i| {
                let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
                umbrage::ink::paper::fit::distance_to_segment(p, a, b) < 0.35
            })
        };
        let bounds = |ring: &Vec<DVec2>| {
            let low = ring.iter().copied().fold(DVec2::INFINITY, DVec2::min);
            let high = ring.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
            [low - 1.0, high + 1.0]
        };
        let boxes: Vec<[DVec2; 2]> = outlines.iter().map(bounds).collect();
        let (mut right, mut wrong) = (0, 0);
        for (i, &number) in maps.foliage_number.iter().enumerate() {
            let p = DVec2::new(
                (i % maps.size[0]) as f64 + 0.5,
                (i / maps.size[0]) as f64 + 0.5,
            );
            // The nearest particle whose outline holds the pixel.
            let mut best = (f64::INFINITY, 0);
            let mut doubtful = false;
            for (k, ring) in outlines.iter().enumerate() {
                if p.cmplt(boxes[k][0]).any() || p.cmpgt(boxes[k][1]).any() {
                    continue;
                }
                doubtful |= near(p, ring);
                let depth = -f64::from(particles[k].centre.z);
                if inside(p, ring) && depth < best.0 {
                    best = (depth, k as u32 + 1);
                }
            }
            if !doubtful {
                if best.1 == number {
                    right += 1;
                } else {
                    wrong += 1;
                }
            }
        }
        assert!(
            right > 10_000 && wrong == 0,
            "{form}: {right} right, {wrong} wrong"
        );
    }
}

#[test]
fn vectors_lie_on_the_analytic_outlines() {
    let style = style(
        "[primitive]\nsize = 0.45\n[foliage]\nthreshold = 500.0\n[stem]\ndraw = false\n[sheet]\ntolerance = 0.02\n",
    );
    let particles = scattered(80);
    let maps = maps(&particles, &style);
    let (found, _) = drawing(&maps, &style, &view());
    let placement = Placement::new(&style, maps.size);
    let view = view();
    let (mut sum, mut count, mut most) = (0.0, 0.0, 0.0_f64);
    for stroke in found.layers.iter().flat_map(|l| &l.strokes) {
        let number = stroke.primitive.unwrap() as usize - 1;
        let (middle, depth) = view.pixel(particles[number].centre.as_dvec3());
        let radius = 0.45 * unit(&view) * view.focal() / depth;
        let curve = umbrage::ink::paper::fit::fit(
            &stroke.line,
            &umbrage::ink::paper::fit::FitSettings {
                tolerance: 0.02,
                corner: 1.2,
            },
        );
        for p in curve.flattened(0.1).points {
            let pixel = (p - placement.corner) / placement.scale;
            let off = (pixel.distance(middle) - radius).abs();
            sum += off;
            count += 1.0;
            most = most.max(off);
        }
    }
    assert!(count > 2000.0, "{count} points");
    assert!(
        sum / count <= 0.3 && most <= 1.0,
        "mean {} px, most {most} px",
        sum / count
    );
}

#[test]
fn a_threshold_switches_at_its_gap_in_depth() {
    let style =
        style("[primitive]\nsize = 0.8\n[foliage]\nthreshold = 1000.0\n[stem]\ndraw = false\n");
    for z in [2.0, 4.0, 6.0] {
        let truth = gap(1000.0, z, 1.0, 11.0).unwrap();
        // Line pixels of the front disc whose background is the back disc.
        let lines = |behind: f64| {
            let front = particle(Vec3::new(0.0, 0.0, -z as f32), 0);
            // The back disc is larger on screen: nearer the middle of the picture, behind the front.
            let back = particle(Vec3::new(0.25, 0.0, -(z + behind) as f32), 1);
            let maps = maps(&[front, back], &style);
            let (middle, depth) = view().pixel(back.centre.as_dvec3());
            let radius = 0.8 * view().focal() / depth;
            let counts = |i: &usize| {
                let p = DVec2::new(
                    (i % maps.size[0]) as f64 + 0.5,
                    (i / maps.size[0]) as f64 + 0.5,
                );
                maps.foliage_number[*i] == 1
                    && maps.foliage_difference[*i] > 1000.0
                    && p.distance(middle) < radius - 3.0
            };
            (0..maps.foliage_number.len()).filter(counts).count()
        };
        assert!(lines(1.01 * truth) > 10, "z {z}: a gap of {truth} draws");
        assert_eq!(lines(0.99 * truth), 0, "z {z}: a smaller one does not");
    }
}

#[test]
fn a_change_of_the_shadow_changes_lines_only_there() {
    let style = style(
        "[primitive]\nsize = 0.5\n[foliage]\nthreshold = 3000.0\n[shadow]\nform = \"detail\"\npressure = 0.0\n[stem]\ndraw = false\n",
    );
    let mut maps = maps(&scattered(150), &style);
    let rasters = |maps: &Maps| {
        let placement = Placement::new(&style, maps.size);
        let (found, _) = drawing(maps, &style, &view());
        let mut inked = vec![false; maps.size[0] * maps.size[1]];
        for p in found
            .layers
            .iter()
            .flat_map(|l| &l.strokes)
            .flat_map(|s| &s.line.points)
        {
            let p = ((*p - placement.corner) / placement.scale).floor();
            if p.x >= 0.0 && p.y >= 0.0 && p.x < maps.size[0] as f64 && p.y < maps.size[1] as f64 {
                inked[p.y as usize * maps.size[0] + p.x as usize] = true;
            }
        }
        inked
    };
    maps.shadow.fill(0.0);
    let before = rasters(&maps);
    let region = |i: usize| {
        (100..180).contains(&(i % maps.size[0])) && (60..160).contains(&(i / maps.size[0]))
    };
    let shadow: Vec<f32> = (0..maps.shadow.len())
        .map(|i| if region(i) { 1.0 } else { 0.0 })
        .collect();
    let width = maps.size[0];
    maps.shadow = shadow;
    let after = rasters(&maps);
    let (mut inside, mut outside) = (0, 0);
    for i in (0..before.len()).filter(|&i| before[i] != after[i]) {
        let (x, y) = ((i % width) as i64, (i / width) as i64);
        // Gaps and specks that the change closes reach a few pixels on.
        if (96..184).contains(&x) && (56..164).contains(&y) {
            inside += 1;
        } else {
            outside += 1;
        }
    }
    assert!(
        inside > 30 && outside == 0,
        "{inside} inside, {outside} outside"
    );
}

#[test]
fn a_plotter_draws_nothing_twice_and_sorted() {
    let style = style(
        "[primitive]\nsize = 0.45\n[foliage]\nthreshold = 300.0\n[stem]\ndraw = false\n[sheet]\nprofile = \"plotter\"\n",
    );
    let maps = maps(&scattered(150), &style);
    let (found, order) = drawing(&maps, &style, &view());
    let lines: Vec<Polyline> = found.layers[0]
        .strokes
        .iter()
        .map(|s| s.line.clone())
        .collect();
    let length: f64 = lines.iter().map(Polyline::length).sum();
    let again: f64 = without_repeats(&lines, 0.1)
        .iter()
        .map(Polyline::length)
        .sum();
    assert!(
        (length - again).abs() < 0.005 * length,
        "{length} mm, {again} mm without repeats"
    );
    let greedy = pen_up(&sorted(lines.clone(), DVec2::ZERO), DVec2::ZERO);
    assert!(
        order.pen_up[1] <= 1.3 * greedy,
        "{order:?} against {greedy}"
    );
    assert!(order.pen_up[1] < 0.5 * order.pen_up[0], "{order:?}");
}
