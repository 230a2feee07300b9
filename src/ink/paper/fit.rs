//! Smooth curves through polylines, within a stated distance (Schneider 1990, "An algorithm for
//! automatically fitting digitized curves"), with a check of its own: no piece is kept that leaves
//! the polyline by more than the tolerance, wherever its points lie.

use glam::DVec2;

use super::curve::{Curve, Piece, Polyline, cubic};

/// How a polyline becomes a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitSettings {
    /// Largest distance between the two, in the polyline's unit; 0 keeps the polyline as it is.
    pub tolerance: f64,
    /// Turns sharper than this stay corners, radians.
    pub corner: f64,
}

impl FitSettings {
    /// As drawings are written, within `tolerance` millimetres.
    #[must_use]
    pub const fn within(tolerance: f64) -> Self {
        Self {
            tolerance,
            corner: 1.2,
        }
    }
}

/// Newton steps before a piece is split.
const STEPS: u32 = 6;

/// The curve of a polyline.
#[must_use]
pub fn fit(line: &Polyline, settings: &FitSettings) -> Curve {
    let mut points: Vec<DVec2> = line
        .points
        .iter()
        .copied()
        .filter(|p| p.is_finite())
        .collect();
    points.dedup();
    let closed = line.closed && points.len() > 2;
    if closed && points.first() == points.last() {
        points.pop();
    }
    let Some(&start) = points.first() else {
        return Curve::default();
    };
    if settings.tolerance <= 0.0 || points.len() < 3 {
        let mut pieces: Vec<Piece> = points[1..].iter().map(|&p| Piece::Line(p)).collect();
        if closed {
            pieces.push(Piece::Line(start));
        }
        return Curve {
            start,
            pieces,
            closed,
        };
    }
    let mut corners = corners(&points, closed, settings);
    if closed {
        // A ring is cut at its sharpest corner, or anywhere where it has none.
        let first = corners.first().copied().unwrap_or(0);
        points.rotate_left(first);
        corners = corners.iter().map(|&c| c - first).collect();
        points.push(points[0]);
    }
    let smooth_ring = closed && corners.is_empty();
    corners.retain(|&c| c > 0 && c + 1 < points.len());
    let mut pieces = Vec::new();
    let mut from = 0;
    for &to in corners.iter().chain(std::iter::once(&(points.len() - 1))) {
        let run = &points[from..=to];
        let mut ends = [tangent(run, settings.tolerance), {
            let back: Vec<DVec2> = run.iter().rev().copied().collect();
            tangent(&back, settings.tolerance)
        }];
        if smooth_ring {
            // One tangent through the place where the ring was cut.
            let through = (ends[0] - ends[1]).normalize_or(ends[0]);
            ends = [through, -through];
        }
        piece(run, ends, settings.tolerance, &mut pieces, 0);
        from = to;
    }
    Curve {
        start: points[0],
        pieces,
        closed,
    }
}

/// Points where the line turns sharply, looked at over a few tolerances, so that the steps of
/// pixels are none.
fn corners(points: &[DVec2], closed: bool, settings: &FitSettings) -> Vec<usize> {
    let count = points.len();
    let reach = 3.0 * settings.tolerance;
    let away = |from: usize, forward: bool| {
        let mut at = from;
        for _ in 0..count {
            let next = match (forward, closed) {
                (true, true) => (at + 1) % count,
                (false, true) => (at + count - 1) % count,
                (true, false) if at + 1 < count => at + 1,
                (false, false) if at > 0 => at - 1,
                _ => return None,
            };
            at = next;
            if points[at].distance(points[from]) >= reach {
                return Some(points[at]);
            }
        }
        None
    };
    let turn = |i: usize| {
        let (before, after) = (away(i, false)?, away(i, true)?);
        Some((points[i] - before).angle_to(after - points[i]).abs())
    };
    let turns: Vec<f64> = (0..count).map(|i| turn(i).unwrap_or(0.0)).collect();
    let sharpest = |i: usize| {
        // Of neighbours within reach only the sharpest is the corner.
        let near = (1..count).take_while(|&k| {
            let j = (i + k) % count;
            (closed || i + k < count) && points[j].distance(points[i]) < reach
        });
        let back = (1..count).take_while(|&k| {
            let j = (i + count - k) % count;
            (closed || k <= i) && points[j].distance(points[i]) < reach
        });
        near.into_iter().all(|k| turns[(i + k) % count] < turns[i])
            && back
                .into_iter()
                .all(|k| turns[(i + count - k) % count] <= turns[i])
    };
    (0..count)
        .filter(|&i| turns[i] > settings.corner && sharpest(i))
        .collect()
}

/// Direction in which a run starts: towards its points within a few tolerances, so that one
/// pixel's step does not turn it.
fn tangent(run: &[DVec2], tolerance: f64) -> DVec2 {
    let reach = 4.0 * tolerance;
    let near = run[1..].iter().take_while(|p| p.distance(run[0]) <= reach);
    let mean: DVec2 = near.map(|&p| p - run[0]).sum();
    mean.try_normalize()
        .or_else(|| (run[1] - run[0]).try_normalize())
        .unwrap_or(DVec2::X)
}

/// Fits one smooth run, splitting it where it is farthest off.
fn piece(run: &[DVec2], ends: [DVec2; 2], tolerance: f64, out: &mut Vec<Piece>, depth: u32) {
    let last = run[run.len() - 1];
    if run.len() == 2 || straight(run, tolerance * 0.5) {
        out.push(Piece::Line(last));
        return;
    }
    let mut at = chord_lengths(run);
    let mut worst = (f64::INFINITY, run.len() / 2);
    for _ in 0..STEPS {
        let curve = least_squares(run, &at, ends);
        worst = farthest(run, &at, curve);
        if worst.0 <= tolerance && stays_near(curve, run, tolerance) {
            out.push(Piece::Cubic(curve[1], curve[2], last));
            return;
        }
        if worst.0 > 16.0 * tolerance {
            break;
        }
        for (t, p) in at.iter_mut().zip(run) {
            *t = nearest(curve, *p, *t);
        }
    }
    // Not at the very ends, so that every split has fewer points.
    let split = worst.1.clamp(1, run.len() - 2);
    // Recursion ends since runs get shorter; very uneven ones are halved instead.
    let split = if depth > 24 { run.len() / 2 } else { split };
    let split = split.clamp(1, run.len() - 2);
    let around = tolerance_window(run, split, tolerance);
    let through = (run[around.1] - run[around.0])
        .try_normalize()
        .unwrap_or(DVec2::X);
    piece(
        &run[..=split],
        [ends[0], -through],
        tolerance,
        out,
        depth + 1,
    );
    piece(&run[split..], [through, ends[1]], tolerance, out, depth + 1);
}

/// Points about `middle` that give its tangent.
fn tolerance_window(run: &[DVec2], middle: usize, tolerance: f64) -> (usize, usize) {
    let reach = 3.0 * tolerance;
    let mut low = middle - 1;
    while low > 0 && run[low].distance(run[middle]) < reach {
        low -= 1;
    }
    let mut high = middle + 1;
    while high + 1 < run.len() && run[high].distance(run[middle]) < reach {
        high += 1;
    }
    (low, high)
}

/// Whether all points of a run lie along its chord.
fn straight(run: &[DVec2], tolerance: f64) -> bool {
    let (a, b) = (run[0], run[run.len() - 1]);
    run.iter()
        .all(|&p| distance_to_segment(p, a, b) <= tolerance)
}

/// Distance of a point from a segment.
#[must_use]
pub fn distance_to_segment(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    p.distance(nearest_on(p, a, b))
}

/// Point of a segment that is nearest to `p`.
#[must_use]
pub fn nearest_on(p: DVec2, a: DVec2, b: DVec2) -> DVec2 {
    let way = b - a;
    let square = way.length_squared();
    let t = if square > 0.0 {
        ((p - a).dot(way) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    a + t * way
}

fn chord_lengths(run: &[DVec2]) -> Vec<f64> {
    let mut sum = 0.0;
    let mut out = vec![0.0];
    for p in run.windows(2) {
        sum += p[0].distance(p[1]);
        out.push(sum);
    }
    out.iter()
        .map(|&l| if sum > 0.0 { l / sum } else { 0.0 })
        .collect()
}

/// Control points by least squares along the given end tangents.
fn least_squares(run: &[DVec2], at: &[f64], ends: [DVec2; 2]) -> [DVec2; 4] {
    let (a, d) = (run[0], run[run.len() - 1]);
    let (mut c00, mut c01, mut c11, mut x0, mut x1) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (&p, &t) in run.iter().zip(at) {
        let s = 1.0 - t;
        let (b0, b1, b2, b3) = (s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t);
        let (u, v) = (b1 * ends[0], b2 * ends[1]);
        let rest = p - (b0 + b1) * a - (b2 + b3) * d;
        c00 += u.dot(u);
        c01 += u.dot(v);
        c11 += v.dot(v);
        x0 += u.dot(rest);
        x1 += v.dot(rest);
    }
    let determinant = c00 * c11 - c01 * c01;
    let chord = a.distance(d);
    let third = chord / 3.0;
    let (mut l, mut r) = (third, third);
    if determinant.abs() > 1e-12 * (c00 * c11).max(f64::MIN_POSITIVE) {
        l = (x0 * c11 - x1 * c01) / determinant;
        r = (c00 * x1 - c01 * x0) / determinant;
    }
    // Backward or huge handles make loops: the chord's third instead (Wu and Barsky's rule).
    let sane = |h: f64| h > 1e-3 * chord && h < 8.0 * chord;
    if !sane(l) || !sane(r) {
        (l, r) = (third, third);
    }
    [a, a + l * ends[0], d + r * ends[1], d]
}

/// Largest distance of the run from the curve at its parameters, and where.
fn farthest(run: &[DVec2], at: &[f64], curve: [DVec2; 4]) -> (f64, usize) {
    let distances = run
        .iter()
        .zip(at)
        .map(|(&p, &t)| p.distance(cubic(curve, t)));
    let worst = distances
        .zip(0..)
        .max_by(|a: &(f64, usize), b| a.0.total_cmp(&b.0));
    worst.unwrap_or((0.0, 0))
}

/// Whether the curve stays near the run between its points too.
fn stays_near(curve: [DVec2; 4], run: &[DVec2], tolerance: f64) -> bool {
    let net: f64 = curve.windows(2).map(|p| p[0].distance(p[1])).sum();
    let count = (net / tolerance).ceil().clamp(4.0, 512.0) as usize;
    let mut near = 0;
    (1..count).all(|k| {
        let p = cubic(curve, k as f64 / count as f64);
        // The nearest segment moves on along the run.
        let window = near..(near + 12).min(run.len() - 1);
        let best = window
            .map(|i| (distance_to_segment(p, run[i], run[i + 1]), i))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let best = best.filter(|b| b.0 <= tolerance).or_else(|| {
            (0..run.len() - 1)
                .map(|i| (distance_to_segment(p, run[i], run[i + 1]), i))
                .min_by(|a, b| a.0.total_cmp(&b.0))
        });
        near = best.map_or(near, |b| b.1);
        best.is_some_and(|b| b.0 <= tolerance)
    })
}

/// One Newton step towards the parameter of the curve's point nearest to `p`.
fn nearest(curve: [DVec2; 4], p: DVec2, t: f64) -> f64 {
    let [a, b, c, d] = curve;
    let s = 1.0 - t;
    let first = 3.0 * (s * s * (b - a) + 2.0 * s * t * (c - b) + t * t * (d - c));
    let second = 6.0 * (s * (c - 2.0 * b + a) + t * (d - 2.0 * c + b));
    let away = cubic(curve, t) - p;
    let slope = first.dot(first) + away.dot(second);
    if slope.abs() < 1e-12 {
        return t;
    }
    (t - away.dot(first) / slope).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETTINGS: FitSettings = FitSettings {
        tolerance: 0.3,
        corner: 1.0,
    };

    fn circle(radius: f64, count: usize) -> Polyline {
        let at = |k: usize| {
            let a = std::f64::consts::TAU * k as f64 / count as f64;
            DVec2::new(50.0 + radius * a.cos(), 50.0 + radius * a.sin())
        };
        Polyline {
            points: (0..count).map(at).collect(),
            closed: true,
        }
    }

    /// Largest distance of every point of `a` from `b`.
    fn apart(a: &Polyline, b: &Polyline) -> f64 {
        let around: Vec<DVec2> = b.round().collect();
        let distance = |p: DVec2| {
            let pieces = around
                .windows(2)
                .map(|s| distance_to_segment(p, s[0], s[1]));
            pieces.fold(f64::INFINITY, f64::min)
        };
        a.round().map(distance).fold(0.0, f64::max)
    }

    #[test]
    fn a_circle_becomes_a_closed_curve_of_few_pieces_within_the_tolerance() {
        for radius in [2.0, 8.0, 100.0] {
            let line = circle(radius, 64.max((8.0 * radius) as usize));
            let curve = fit(&line, &SETTINGS);
            assert!(curve.closed && curve.start.distance(curve.end()) < 1e-12);
            assert!(curve.pieces.len() <= 10, "{radius}: {}", curve.pieces.len());
            let flat = curve.flattened(0.1);
            assert!(
                apart(&flat, &line) <= 0.31,
                "{radius}: {}",
                apart(&flat, &line)
            );
            assert!(apart(&line, &flat) <= 0.31);
        }
    }

    #[test]
    fn corners_stay_and_sides_are_straight() {
        let mut points = Vec::new();
        for (from, to) in [
            ([0, 0], [40, 0]),
            ([40, 0], [40, 30]),
            ([40, 30], [0, 30]),
            ([0, 30], [0, 0]),
        ] {
            let a = DVec2::new(f64::from(from[0]), f64::from(from[1]));
            let b = DVec2::new(f64::from(to[0]), f64::from(to[1]));
            points.extend((0..20).map(|k| a.lerp(b, f64::from(k) / 20.0)));
        }
        let curve = fit(
            &Polyline {
                points,
                closed: true,
            },
            &SETTINGS,
        );
        assert_eq!(curve.pieces.len(), 4);
        assert!(curve.pieces.iter().all(|p| matches!(p, Piece::Line(_))));
    }

    #[test]
    fn any_line_is_kept_within_the_tolerance() {
        let mut state = 7_u32;
        let mut number = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / 16_777_216.0
        };
        for round in 0..200 {
            let count = 2 + round % 60;
            let mut p = DVec2::ZERO;
            let points: Vec<DVec2> = (0..count)
                .map(|_| {
                    p += DVec2::new(number() - 0.4, number() - 0.5) * 2.0;
                    p
                })
                .collect();
            let line = Polyline {
                points,
                closed: round % 3 == 0 && count > 3,
            };
            let flat = fit(&line, &SETTINGS).flattened(0.05);
            let (there, back) = (apart(&flat, &line), apart(&line, &flat));
            assert!(there <= 0.31 && back <= 0.31, "{round}: {there} {back}");
        }
    }

    #[test]
    fn lines_without_length_or_with_numbers_that_are_none_end() {
        let nan = DVec2::new(f64::NAN, 0.0);
        for points in [
            vec![],
            vec![DVec2::ONE],
            vec![DVec2::ONE; 9],
            vec![nan, DVec2::ONE, nan, DVec2::ZERO],
        ] {
            for closed in [false, true] {
                let curve = fit(
                    &Polyline {
                        points: points.clone(),
                        closed,
                    },
                    &SETTINGS,
                );
                assert!(curve.start.is_finite());
                assert!(curve.pieces.iter().all(|p| p.end().is_finite()));
            }
        }
    }
}
