//! Vectors of drawings on paper against what they stand for: lines of the whole bitmap and of
//! primitives against analytic outlines, strokes of hatching tiles against the tile's texels.

use std::collections::HashMap;

use glam::{DVec2, DVec3, IVec2, Vec3};
use umbrage::abi::{INK_TILE, InkCluster};
use umbrage::ink::clusters::Cluster;
use umbrage::ink::motion::Course;
use umbrage::ink::paper::clutter::clutter;
use umbrage::ink::paper::curve::Polyline;
use umbrage::ink::paper::drawing::{Placement, drawing};
use umbrage::ink::paper::fit::{FitSettings, fit};
use umbrage::ink::paper::particles::{Particle, unit};
use umbrage::ink::paper::tiles::{Ground, Laid, TileLine, tile_lines};
use umbrage::ink::strokes::{Tile, TileSettings};
use umbrage::ink::view::{Hatch, tiles_about};
use umbrage::reference::ink::hatch;
use umbrage::reference::ink_tile::ink_of_tile;

use crate::paper::{maps, scattered, style, view};

const SIZE: usize = 320;

fn curves(lines: &[Polyline]) -> Vec<DVec2> {
    let settings = FitSettings {
        tolerance: 0.02,
        corner: 1.2,
    };
    let points = |l: &Polyline| fit(l, &settings).flattened(0.1).points;
    lines.iter().flat_map(points).collect()
}

/// Middle and radius in the picture, and depth.
fn discs(particles: &[Particle], size: f64) -> Vec<(DVec2, f64, f64)> {
    let view = view();
    let one = |p: &Particle| {
        let (middle, depth) = view.pixel(p.centre.as_dvec3());
        (middle, size * unit(&view) * view.focal() / depth, depth)
    };
    particles.iter().map(one).collect()
}

#[test]
fn lines_of_the_whole_bitmap_lie_on_the_analytic_outlines() {
    let style = style(
        "[primitive]\nsize = 0.45\n[foliage]\nthreshold = 500.0\n[stem]\ndraw = false\n\
         [vector]\nlines = \"bitmap\"\n[sheet]\ntolerance = 0.02\n",
    );
    let particles = scattered(80);
    let maps = maps(&particles, &style);
    let (found, _) = drawing(&maps, &style, &view());
    let placement = Placement::new(&style, maps.size);
    let lines: Vec<Polyline> = found.layers[0]
        .strokes
        .iter()
        .map(|s| s.line.clone())
        .collect();
    let discs = discs(&particles, 0.45);
    let (mut sum, mut count, mut most) = (0.0, 0.0, 0.0_f64);
    for p in curves(&lines) {
        let pixel = (p - placement.corner) / placement.scale;
        let off = discs.iter().map(|d| (pixel.distance(d.0) - d.1).abs());
        let off = off.fold(f64::INFINITY, f64::min);
        sum += off;
        count += 1.0;
        most = most.max(off);
    }
    assert!(count > 1500.0, "{count} points");
    assert!(
        sum / count <= 0.3 && most <= 1.0,
        "mean {} px, most {most}",
        sum / count
    );
    // And what is drawn along primitives is there: as much line, in fewer strokes for its length.
    let along = umbrage::ink::paper::style::PaperStyle {
        vector: umbrage::ink::paper::vectors::Vectors::default(),
        ..style
    };
    let (primitives, _) = drawing(&maps, &along, &view());
    let ratio = found.content().length / primitives.content().length;
    assert!(
        (0.9..1.1).contains(&ratio),
        "{ratio} of the primitives' line"
    );
}

/// Points of outlines that nothing hides, a quarter of a pixel apart, and whether what is seen behind
/// each is far enough for a line.
fn seen_outlines(rings: &[Vec<DVec2>], depths: &[f64], threshold: f64) -> Vec<(DVec2, bool)> {
    let bounds = |ring: &Vec<DVec2>| {
        let low = ring.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        [
            low,
            ring.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max),
        ]
    };
    let boxes: Vec<[DVec2; 2]> = rings.iter().map(bounds).collect();
    let inside = |p: DVec2, k: usize| {
        let ring = &rings[k];
        if p.cmplt(boxes[k][0]).any() || p.cmpgt(boxes[k][1]).any() {
            return false;
        }
        let crosses = |i: &usize| {
            let (a, b) = (ring[*i], ring[(i + 1) % ring.len()]);
            (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
        };
        (0..ring.len()).filter(crosses).count() % 2 == 1
    };
    let mapped = |z: f64| 65535.0 * 11.0 * (z - 1.0) / (z * 10.0);
    let first = |p: DVec2, but: usize| {
        let over = (0..rings.len()).filter(|&k| k != but && inside(p, k));
        over.map(|k| depths[k]).fold(f64::INFINITY, f64::min)
    };
    let mut out = Vec::new();
    for (k, ring) in rings.iter().enumerate() {
        for (i, &a) in ring.iter().enumerate() {
            let b = ring[(i + 1) % ring.len()];
            let count = (4.0 * a.distance(b)).ceil() as u32;
            for s in 0..count {
                let p = a.lerp(b, f64::from(s) / f64::from(count));
                let [w, h] = crate::paper::SIZE.map(|s| f64::from(s) - 2.0);
                let behind = first(p, k);
                if p.x > 2.0 && p.y > 2.0 && p.x < w && p.y < h && behind > depths[k] {
                    let leap = mapped(behind) - mapped(depths[k]);
                    out.push((p, behind.is_infinite() || leap > 1.05 * threshold));
                }
            }
        }
    }
    out
}

/// Mean and largest distance (4 where it is more) of points from the nearest of others, and the
/// share within a pixel.
fn distances(points: &[DVec2], others: &[DVec2]) -> [f64; 3] {
    const CELL: f64 = 2.0;
    let key = |p: DVec2| (p / CELL).floor().as_ivec2();
    let mut cells: HashMap<IVec2, Vec<DVec2>> = HashMap::new();
    for &p in others {
        cells.entry(key(p)).or_default().push(p);
    }
    let least = |p: &DVec2| {
        let about = (-2..=2).flat_map(|y| (-2..=2).map(move |x| IVec2::new(x, y)));
        let near = about.filter_map(|k| cells.get(&(key(*p) + k))).flatten();
        near.map(|q| q.distance(*p)).fold(4.0, f64::min)
    };
    let all: Vec<f64> = points.iter().map(least).collect();
    let count = all.len() as f64;
    let within = all.iter().filter(|d| **d <= 1.0).count() as f64;
    let most = all.iter().copied().fold(0.0, f64::max);
    [all.iter().sum::<f64>() / count, most, within / count]
}

#[test]
fn lines_of_the_whole_bitmap_lie_on_outlines_that_are_seen() {
    for form in [
        "\"disc\"",
        "\"ellipse\"",
        "{ polygon = [[0.0, -1.0], [0.7, 0.2], [0.0, 0.9], [-0.6, 0.0]] }",
    ] {
        let style = style(&format!(
            "[primitive]\nform = {form}\nsize = 0.45\n[foliage]\nthreshold = 500.0\n[stem]\ndraw = false\n\
             [vector]\nlines = \"bitmap\"\n"
        ));
        let particles = scattered(80);
        let maps = maps(&particles, &style);
        let (found, _) = drawing(&maps, &style, &view());
        let placement = Placement::new(&style, maps.size);
        let lines: Vec<Polyline> = found.layers[0]
            .strokes
            .iter()
            .map(|s| s.line.clone())
            .collect();
        let points = curves(&lines)
            .into_iter()
            .map(|p| (p - placement.corner) / placement.scale);
        let points: Vec<DVec2> = points.collect();
        let rings = umbrage::ink::paper::renderer::outlines(&maps, &style, &view());
        let depths: Vec<f64> = particles.iter().map(|p| -f64::from(p.centre.z)).collect();
        let seen = seen_outlines(&rings, &depths, 500.0);
        let all: Vec<DVec2> = seen.iter().map(|s| s.0).collect();
        let drawn: Vec<DVec2> = seen.iter().filter(|s| s.1).map(|s| s.0).collect();
        let inside = |p: &DVec2| p.x > 6.0 && p.y > 6.0 && p.x < 314.0 && p.y < 234.0;
        let points: Vec<DVec2> = points.into_iter().filter(inside).collect();
        let drawn: Vec<DVec2> = drawn.into_iter().filter(inside).collect();
        let [mean, most, _] = distances(&points, &all);
        assert!(
            points.len() > 10_000 && mean <= 0.3 && most <= 1.0,
            "{form}: lines are off by {mean} px, at most {most}"
        );
        // Where two outlines are nearer than two pixels one line stands for both.
        let [mean, most, within] = distances(&drawn, &points);
        assert!(
            mean <= 0.3 && most <= 2.5 && within >= 0.99,
            "{form}: outlines are off by {mean} px, at most {most}; {within} within a pixel"
        );
    }
}

#[test]
fn outlines_are_not_cut_into_pieces() {
    in_one_piece("");
}

#[test]
fn outlines_go_on_over_gaps_of_a_pixel() {
    // Every fortieth column has no lines of its own: an outline has a gap where it crosses one.
    in_one_piece("threshold_by = \"if(fract(8 * x) < 0.025, 60000, 1)\"\n");
}

/// Strokes against the arcs that are seen, and how many are shorter than three pixels (M10).
fn in_one_piece(foliage: &str) {
    let style = style(&format!(
        "[primitive]\nsize = 0.45\n[foliage]\nthreshold = 500.0\n{foliage}[stem]\ndraw = false\n"
    ));
    let particles = scattered(80);
    let maps = maps(&particles, &style);
    let (found, _) = drawing(&maps, &style, &view());
    let placement = Placement::new(&style, maps.size);
    let discs = discs(&particles, 0.45);
    // Truth: a point of a circle is a line where no nearer disc covers it and the nearest of what
    // lies behind it just outside is farther by the threshold.
    let [near, far] = [1.0, 11.0];
    let mapped = |z: f64| 65535.0 * far * (z - near) / (z * (far - near));
    let drawn = |i: usize, angle: f64| {
        let (middle, radius, depth) = discs[i];
        let way = DVec2::from_angle(angle);
        let (p, out) = (middle + radius * way, middle + (radius + 0.7) * way);
        let in_picture = p.x > 0.0 && p.y > 0.0 && p.x < 320.0 && p.y < 240.0;
        let hidden = discs.iter().any(|d| d.2 < depth && p.distance(d.0) < d.1);
        let behind = discs
            .iter()
            .filter(|d| out.distance(d.0) < d.1)
            .map(|d| d.2);
        let behind = behind.fold(f64::INFINITY, f64::min);
        in_picture && !hidden && (behind.is_infinite() || mapped(behind) - mapped(depth) > 500.0)
    };
    let mut arcs = 0;
    for (i, disc) in discs.iter().enumerate() {
        let count = (disc.1 * 12.6).ceil() as usize;
        let at = |k: usize| drawn(i, std::f64::consts::TAU * (k % count) as f64 / count as f64);
        let ring: Vec<bool> = (0..count).map(at).collect();
        arcs += (0..count)
            .filter(|&k| ring[k] && !ring[(k + count - 1) % count])
            .count();
        arcs += usize::from(ring.iter().all(|&r| r));
    }
    let strokes = &found.layers[0].strokes;
    let pieces = strokes.len() as f64 / arcs as f64;
    let short = strokes
        .iter()
        .filter(|s| s.line.length() / placement.scale < 3.0)
        .count();
    assert!(
        pieces <= 1.05 && pieces > 0.8,
        "{} strokes, {arcs} arcs",
        strokes.len()
    );
    assert!(
        short as f64 <= 0.01 * strokes.len() as f64,
        "{short} short ones"
    );
}

#[test]
fn lines_crowd_less_with_more_abstraction() {
    let tail = |threshold: f64| {
        let style = style(&format!(
            "[primitive]\nsize = 0.3\n[foliage]\nthreshold = {threshold:.1}\n[stem]\ndraw = false\n"
        ));
        let maps = maps(&scattered(400), &style);
        clutter(&drawing(&maps, &style, &view()).0, 4.0)
    };
    let [fine, middle, coarse] = [30.0, 1500.0, 9000.0].map(tail);
    assert!(
        fine.tail > middle.tail && middle.tail > coarse.tail && coarse.length > 100.0,
        "{fine:?} {middle:?} {coarse:?}"
    );
}

/// A round cluster before the camera, all its pixels, and a darkness that grows to the right.
struct Patch {
    clusters: Vec<InkCluster>,
    number: Vec<u32>,
    darkness: Vec<f32>,
}

fn patch(texel: f64) -> Patch {
    let view = view();
    let cluster = |x: f32, y: f32, z: f32, k: u32| {
        let centre = Vec3::new(x, y, z);
        let own = Cluster {
            centre,
            radius: 0.8,
            leaves: 9,
        };
        let course = Course::stateless(&view, centre.as_dvec3());
        let tiles = tiles_about(0.8, 5.0 / view.focal(), texel);
        view.cluster(
            &own,
            0.1,
            &Hatch::new(&course, DVec2::splat(tiles)).scattered(k),
        )
    };
    let clusters = vec![cluster(-1.2, 0.3, -5.0, 0), cluster(1.1, -0.4, -4.0, 1)];
    let size = [SIZE, 240];
    let pixels = (0..size[0] * size[1]).map(|i| {
        let p = DVec2::new((i % SIZE) as f64 + 0.5, (i / SIZE) as f64 + 0.5);
        let of = |c: &InkCluster| {
            p.distance(DVec2::from(c.pixel.map(f64::from))) < f64::from(c.pixel_radius)
        };
        let number = clusters.iter().position(of).map_or(0, |k| k as u32 + 1);
        (number, 0.1 + 0.7 * p.x as f32 / SIZE as f32)
    });
    let (number, darkness) = pixels.unzip();
    Patch {
        clusters,
        number,
        darkness,
    }
}

/// Ink of strokes in each pixel, from 16 samples.
fn rasterised(lines: &[TileLine]) -> Vec<f64> {
    const FINE: usize = 4;
    let width = SIZE * FINE;
    let mut ink = vec![false; width * 240 * FINE];
    for line in lines {
        for (pair, widths) in line.line.points.windows(2).zip(line.widths.windows(2)) {
            let half = 0.25 * (widths[0] + widths[1]);
            let low = ((pair[0].min(pair[1]) - half) * FINE as f64).floor();
            let high = ((pair[0].max(pair[1]) + half) * FINE as f64).ceil();
            for y in low.y.max(0.0) as usize..(high.y as usize).min(240 * FINE) {
                for x in low.x.max(0.0) as usize..(high.x as usize).min(width) {
                    let p = DVec2::new(x as f64 + 0.5, y as f64 + 0.5) / FINE as f64;
                    let far = umbrage::ink::paper::fit::distance_to_segment(p, pair[0], pair[1]);
                    ink[y * width + x] |= far <= half;
                }
            }
        }
    }
    let share = |i: usize| {
        let (x, y) = (i % SIZE * FINE, i / SIZE * FINE);
        let of = (0..FINE * FINE).filter(|k| ink[(y + k / FINE) * width + x + k % FINE]);
        of.count() as f64 / (FINE * FINE) as f64
    };
    (0..SIZE * 240).map(share).collect()
}

#[test]
fn strokes_of_tiles_are_the_texels_of_the_picture_in_real_time() {
    let tile = Tile::new(&TileSettings::default());
    for texel in [0.8, 1.3] {
        let patch = patch(texel);
        let ground = Ground {
            size: [SIZE, 240],
            cluster: &patch.number,
            darkness: &patch.darkness,
        };
        let lines = tile_lines(&ground, &patch.clusters, &tile.strokes, texel);
        assert!(lines.len() > 50, "{} strokes", lines.len());
        let raster: Vec<f64> = (0..SIZE * 240)
            .map(|i| {
                let Some(k) = (patch.number[i] as usize).checked_sub(1) else {
                    return 0.0;
                };
                let p = DVec2::new((i % SIZE) as f64 + 0.5, (i / SIZE) as f64 + 0.5);
                // The picture in real time, at the octave and level that strokes are taken from.
                let cluster = &patch.clusters[k];
                let (place, own) = hatch(cluster, p, f64::from(cluster.front), (0.0, 0.0)).unwrap();
                let laid = Laid::new(cluster, texel).unwrap();
                let texels = laid.linear.determinant().abs().sqrt() * f64::from(INK_TILE);
                let repeated = (own - texels.log2()).round();
                let place = place * (f64::from(laid.octave) - repeated).exp2();
                let level = f64::from(laid.level);
                ink_of_tile(&tile.levels, place, level, f64::from(patch.darkness[i]))
            })
            .collect();
        let (mut on, mut all) = (0.0, 0.0);
        for line in &lines {
            for p in &line.line.points {
                let (x, y) = (p.x as usize, p.y as usize);
                assert_eq!(
                    patch.number[y * SIZE + x],
                    line.cluster + 1,
                    "a stroke leaves its cluster at {p}"
                );
                let near = (y.max(1) - 1..=(y + 1).min(239)).any(|v| {
                    (x.max(1) - 1..=(x + 1).min(SIZE - 1)).any(|u| raster[v * SIZE + u] > 0.3)
                });
                on += f64::from(u8::from(near));
                all += 1.0;
            }
        }
        assert!(on > 0.98 * all, "texel {texel}: {on} of {all} on ink");
        let vector = rasterised(&lines);
        let ratio = vector.iter().sum::<f64>() / raster.iter().sum::<f64>();
        assert!(
            (0.9..1.1).contains(&ratio),
            "texel {texel}: {ratio} of the ink"
        );
        let missed = (0..SIZE * 240).filter(|&i| raster[i] > 0.7).filter(|&i| {
            let (x, y) = (i % SIZE, i / SIZE);
            (x > 0 && y > 0 && x < SIZE - 1 && y < 239)
                && (0..9).all(|k| vector[(y + k / 3 - 1) * SIZE + x + k % 3 - 1] <= 0.0)
        });
        let dark = raster.iter().filter(|&&r| r > 0.7).count();
        let missed = missed.count();
        assert!(
            missed * 50 < dark,
            "texel {texel}: {missed} of {dark} missed"
        );
    }
}

#[test]
fn a_cluster_about_the_camera_has_no_strokes() {
    let view = view();
    let own = Cluster {
        centre: Vec3::new(0.0, 0.0, 0.2),
        radius: 3.0,
        leaves: 1,
    };
    let course = Course::stateless(&view, DVec3::ZERO);
    let cluster = view.cluster(&own, 0.1, &Hatch::new(&course, DVec2::ONE));
    assert!(Laid::new(&cluster, 1.0).is_none());
}
