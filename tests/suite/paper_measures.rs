//! Depth differences of drawings on paper against discs whose silhouettes are known: where lines lie,
//! on which side, how many there are, and how large primitives become.

use glam::{DVec2, Vec3};
use umbrage::ink::paper::particles::Particle;
use umbrage::ink::paper::renderer::Maps;
use umbrage::reference::paper::gap;

use crate::paper::{SIZE, maps, particle, scattered, style, view};

/// A disc in the picture: middle and radius in pixels, depth.
struct Round {
    middle: DVec2,
    radius: f64,
    depth: f64,
}

fn rounds(particles: &[Particle], size: f64) -> Vec<Round> {
    let of = |p: &Particle| {
        let (middle, depth) = view().pixel(p.centre.as_dvec3());
        let radius = size * view().focal() / depth;
        Round {
            middle,
            radius,
            depth,
        }
    };
    particles.iter().map(of).collect()
}

fn pixels(maps: &Maps) -> impl Iterator<Item = (usize, DVec2)> + use<> {
    let width = maps.size[0];
    (0..width * maps.size[1]).map(move |i| {
        (
            i,
            DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5),
        )
    })
}

fn lines(maps: &Maps, threshold: f32) -> Vec<DVec2> {
    let over = |(i, _): &(usize, DVec2)| maps.foliage_difference[*i] > threshold;
    pixels(maps).filter(over).map(|(_, p)| p).collect()
}

/// Points of the discs' outlines that nothing hides and behind which the next thing is farther than a
/// threshold reaches, half a pixel apart.
fn silhouettes(discs: &[Round], threshold: f64) -> Vec<DVec2> {
    let mut out = Vec::new();
    for (k, disc) in discs.iter().enumerate() {
        let steps = (4.0 * std::f64::consts::PI * disc.radius).ceil() as u32;
        for s in 0..steps {
            let way = DVec2::from_angle(std::f64::consts::TAU * f64::from(s) / f64::from(steps));
            let p = disc.middle + disc.radius * way;
            let inside = p.x > 2.0
                && p.y > 2.0
                && p.x < f64::from(SIZE[0]) - 2.0
                && p.y < f64::from(SIZE[1]) - 2.0;
            let others = discs
                .iter()
                .enumerate()
                .filter(|(j, _)| *j != k)
                .map(|(_, d)| d);
            // What may be seen beside the point, within what a pixel can tell.
            let near: Vec<&Round> = others
                .filter(|d| d.middle.distance(p) < d.radius + 1.5)
                .collect();
            let hidden = near.iter().any(|d| d.depth <= disc.depth);
            let least = near.iter().map(|d| d.depth).fold(f64::INFINITY, f64::min);
            let reach =
                gap(threshold, disc.depth, 1.0, 11.0).map_or(f64::INFINITY, |g| disc.depth + g);
            if inside && !hidden && (least.is_infinite() || least > reach) {
                out.push(p);
            }
        }
    }
    out
}

/// Share of `points` that have one of `others` within 1.5 pixels.
fn near(points: &[DVec2], others: &[DVec2]) -> f64 {
    let [w, h] = SIZE.map(|s| s as usize + 8);
    let mut cells: Vec<Vec<DVec2>> = vec![Vec::new(); w * h];
    let cell = |p: DVec2| [(p.x + 4.0).max(0.0) as usize, (p.y + 4.0).max(0.0) as usize];
    for &p in others {
        let [x, y] = cell(p);
        if x < w && y < h {
            cells[y * w + x].push(p);
        }
    }
    let found = |p: &&DVec2| {
        let [x, y] = cell(**p);
        (y.saturating_sub(2)..(y + 3).min(h)).any(|v| {
            (x.saturating_sub(2)..(x + 3).min(w))
                .any(|u| cells[v * w + u].iter().any(|q| q.distance(**p) <= 1.5))
        })
    };
    points.iter().filter(found).count() as f64 / points.len().max(1) as f64
}

/// All outlines, seen or not: a line lies on one of them.
fn outlines(discs: &[Round]) -> Vec<DVec2> {
    let ring = |d: &Round| {
        let steps = (4.0 * std::f64::consts::PI * d.radius).ceil() as u32;
        let at = move |s: u32| std::f64::consts::TAU * f64::from(s) / f64::from(steps);
        let (middle, radius) = (d.middle, d.radius);
        (0..steps).map(move |s| middle + radius * DVec2::from_angle(at(s)))
    };
    discs.iter().flat_map(ring).collect()
}

#[test]
fn lines_are_the_silhouettes_of_discs() {
    for (count, size, threshold, limit) in [(1, 0.8, 1000.0, 0.99), (1000, 0.2, 300.0, 0.97)] {
        let style = style(&format!(
            "[primitive]\nsize = {size}\n[foliage]\nthreshold = {threshold}\n"
        ));
        let particles = if count == 1 {
            vec![particle(Vec3::new(0.1, -0.2, -4.0), 0)]
        } else {
            scattered(count)
        };
        let maps = maps(&particles, &style);
        let discs = rounds(&particles, size);
        let found = lines(&maps, threshold as f32);
        let score = |found: &[DVec2]| {
            let precision = near(found, &outlines(&discs));
            let recall = near(&silhouettes(&discs, threshold), found);
            2.0 * precision * recall / (precision + recall)
        };
        let f = score(&found);
        assert!(f >= limit, "{count} discs: F = {f}");
        // Three pixels aside they are not the silhouettes.
        let moved: Vec<DVec2> = found.iter().map(|&p| p + DVec2::splat(3.0)).collect();
        assert!(
            score(&moved) < 0.9,
            "{count} discs: F = {} moved",
            score(&moved)
        );
    }
}

#[test]
fn lines_lie_on_what_is_in_front() {
    let style = style("[primitive]\nsize = 0.4\n[foliage]\nthreshold = 300.0\n");
    let maps = maps(&scattered(200), &style);
    let [w, h] = maps.size;
    let farther = |i: usize, much: f32| {
        let (x, y) = (i % w, i / w);
        let depth = |k: usize| {
            if maps.foliage_depth[k] > 0.0 {
                maps.foliage_depth[k]
            } else {
                f32::INFINITY
            }
        };
        (y.max(1) - 1..=(y + 1).min(h - 1))
            .flat_map(|v| (x.max(1) - 1..=(x + 1).min(w - 1)).map(move |u| v * w + u))
            .any(|k| maps.foliage_number[k] != maps.foliage_number[i] && depth(k) > depth(i) + much)
    };
    let line = |i: &usize| maps.foliage_difference[*i] > 300.0;
    let found: Vec<usize> = (0..w * h).filter(line).collect();
    assert!(found.len() > 3000, "{}", found.len());
    assert!(
        found
            .iter()
            .all(|&i| maps.foliage_number[i] > 0 && farther(i, 0.0))
    );
    // Differences without sign would lie on both sides: those beside a line are not in front.
    let behind = found
        .iter()
        .flat_map(|&i| [i - 1, i + 1])
        .filter(|&i| maps.foliage_number[i] > 0 && maps.foliage_difference[i] <= 300.0);
    assert!(behind.filter(|&i| !farther(i, 0.0)).count() > 500);
}

#[test]
fn lines_become_fewer_with_the_threshold_and_with_distance() {
    let style = style("[primitive]\nsize = 0.4\n");
    let maps = maps(&scattered(200), &style);
    let counts =
        [10.0, 100.0, 400.0, 1000.0, 2000.0, 6000.0, 20000.0].map(|t| lines(&maps, t).len());
    assert!(counts.windows(2).all(|c| c[1] <= c[0]), "{counts:?}");
    assert!(counts[0] > counts[6] && counts[6] > 0, "{counts:?}");
    // Pairs of discs with the same gap, of the same size on screen, farther and farther away.
    let pair = |z: f32| {
        let one = |x: f32, z: f32, k: u32| particle(Vec3::new(x * z, 0.0, -z), k);
        let style = crate::paper::style(
            "[primitive]\nsize = 0.3\nconstant_size = 1.0\nlargest = 100.0\n[depth]\nsky_at_far = true\n",
        );
        let maps = crate::paper::maps(&[one(-0.1, z, 0), one(0.1, z + 0.4, 1)], &style);
        let between = |p: &DVec2| (p.x - f64::from(SIZE[0]) / 2.0).abs() < 20.0;
        lines(&maps, 1000.0).into_iter().filter(between).count()
    };
    let counts = [2.0, 3.0, 4.0, 6.0, 9.0].map(pair);
    assert!(counts.windows(2).all(|c| c[1] <= c[0]), "{counts:?}");
    assert!(counts[0] > counts[4], "{counts:?}");
}

#[test]
fn primitives_have_the_size_of_the_law_on_screen() {
    for weight in [0.0, 0.5, 1.0, 1.5] {
        let more =
            format!("[primitive]\nsize = 0.2\nconstant_size = {weight:?}\nlargest = 100.0\n");
        let style = style(&more);
        for depth in [1.5, 3.0, 6.0, 10.0] {
            let maps = maps(&[particle(Vec3::new(0.0, 0.0, -depth), 0)], &style);
            let across = pixels(&maps).filter(|(i, _)| maps.foliage_number[*i] == 1);
            let ends = across.fold([f64::INFINITY, 0.0], |[a, b], (_, p)| {
                [p.x.min(a), p.x.max(b)]
            });
            let measured = ends[1] - ends[0] + 1.0;
            // d is the size at the front, s the size without the law; z0 = 1 is the front.
            let depth = f64::from(depth);
            let (wanted, own) = (0.4 * view().focal(), 0.4 * view().focal() / depth);
            let r = if weight > 1.0 {
                weight * wanted / own
            } else {
                weight * wanted / own + 1.0 - weight
            };
            let seen = (own * r.max(1.0)).min(1e9);
            assert!(
                (measured - seen).abs() <= 1.0,
                "w = {weight}, z = {depth}: {measured} px, {seen} by the law"
            );
            let perspective = depth < 2.0 || weight <= 0.0 || (measured - own).abs() > 3.0;
            assert!(
                perspective,
                "w = {weight}, z = {depth}: {measured} px as without the law"
            );
        }
    }
}
