//! Lines and outlines of marks by walking, against plain linking.

use glam::DVec2;

use super::{Case, Outcome};
use crate::ink::paper::curve::Polyline;
use crate::ink::paper::region::outlines;
use crate::ink::paper::trace::{Marks, thinned, trace};
use crate::math::sampling::uniform;
use crate::reference::trace as twin;

const SIZE: [usize; 2] = [47, 38];
const SEEDS: std::ops::Range<u32> = 0..24;

pub(super) fn cases() -> Vec<Case> {
    vec![
        Case {
            name: "ink.paper.trace.lines",
            run: |_| Ok(lines()),
        },
        Case {
            name: "ink.paper.trace.thinned",
            run: |_| Ok(thin()),
        },
        Case {
            name: "ink.paper.trace.outlines",
            run: |_| Ok(borders()),
        },
        Case {
            name: "ink.paper.trace.areas",
            run: |_| Ok(areas()),
        },
    ]
}

/// Pixels at random, few to many.
fn noise(seed: u32) -> Vec<bool> {
    let share = 0.1 + 0.8 * f64::from(seed) / f64::from(SEEDS.end);
    let count = (SIZE[0] * SIZE[1]) as u32;
    (0..count).map(|i| uniform(seed, i) < share).collect()
}

/// Discs at random, some of which are holes.
fn blobs(seed: u32) -> Vec<bool> {
    let number = |k: u32| uniform(900 + seed, k);
    let disc = |k: u32| {
        let centre = DVec2::new(number(4 * k), number(4 * k + 1));
        let centre = centre * DVec2::new(SIZE[0] as f64, SIZE[1] as f64);
        (
            centre,
            1.5 + 7.0 * number(4 * k + 2),
            number(4 * k + 3) < 0.6,
        )
    };
    let discs: Vec<_> = (0..14).map(disc).collect();
    let mark = |i: usize| {
        let p = DVec2::new((i % SIZE[0]) as f64 + 0.5, (i / SIZE[0]) as f64 + 0.5);
        let over = discs.iter().rev().find(|d| d.0.distance(p) < d.1);
        over.is_some_and(|d| d.2)
    };
    (0..SIZE[0] * SIZE[1]).map(mark).collect()
}

/// Circles at random, some across each other.
fn circles(seed: u32) -> Vec<bool> {
    let number = |k: u32| uniform(1900 + seed, k);
    let circle = |k: u32| {
        let centre = DVec2::new(number(3 * k), number(3 * k + 1));
        let centre = centre * DVec2::new(SIZE[0] as f64, SIZE[1] as f64);
        (centre, 2.5 + 4.0 * number(3 * k + 2))
    };
    let circles: Vec<_> = (0..7).map(circle).collect();
    let mark = |i: usize| {
        let p = DVec2::new((i % SIZE[0]) as f64 + 0.5, (i / SIZE[0]) as f64 + 0.5);
        circles.iter().any(|c| (c.0.distance(p) - c.1).abs() < 0.6)
    };
    (0..SIZE[0] * SIZE[1]).map(mark).collect()
}

/// Every kind of pictures.
fn pictures() -> impl Iterator<Item = Vec<bool>> {
    SEEDS.flat_map(|seed| [noise(seed), blobs(seed), circles(seed)])
}

fn plain(marked: &[bool]) -> twin::Marks<'_> {
    twin::Marks {
        size: SIZE.map(|s| s as i64),
        marked,
    }
}

/// A traced line as the twin tells it.
fn pairs(line: &Polyline) -> twin::Line {
    let pixel = |p: &DVec2| p.y as usize * SIZE[0] + p.x as usize;
    let numbers: Vec<usize> = line.points.iter().map(pixel).collect();
    let mut pairs: Vec<_> = numbers.windows(2).map(|n| (n[0], n[1])).collect();
    match (line.closed, numbers.as_slice()) {
        (true, [first, .., last]) => pairs.push((*last, *first)),
        (false, [alone]) => pairs.push((*alone, *alone)),
        _ => {}
    }
    let mut pairs: Vec<_> = pairs.iter().map(|&(a, b)| (a.min(b), a.max(b))).collect();
    pairs.sort_unstable();
    (pairs, line.closed)
}

/// Lines that only one of the two has.
fn lines() -> Outcome {
    let (mut differing, mut all, mut rings) = (0, 0, 0);
    let both = pictures().map(|marked| {
        let thin = thinned(&marks(&marked));
        [marked, thin]
    });
    for marked in both.flatten() {
        let mut found: Vec<_> = trace(&marks(&marked)).iter().map(pairs).collect();
        let want = twin::lines(&plain(&marked));
        found.sort_unstable();
        all += want.len();
        rings += want.iter().filter(|l| l.1).count();
        let same = |l: &twin::Line| found.binary_search(l).is_ok();
        differing += want.iter().filter(|l| !same(l)).count();
        differing += found.len().abs_diff(want.len());
    }
    // Nothing to compare is no agreement.
    let error = if all < 1000 || rings < 20 {
        f64::NAN
    } else {
        differing as f64
    };
    Outcome::new(error, 0.0, "lines that only one has")
}

fn marks(marked: &[bool]) -> Marks<'_> {
    Marks { size: SIZE, marked }
}

/// Pixels that only one of the two keeps.
fn thin() -> Outcome {
    let (mut differing, mut gone) = (0, 0);
    for marked in pictures() {
        let found = thinned(&marks(&marked));
        let want = twin::thinned(&plain(&marked));
        differing += found.iter().zip(&want).filter(|(a, b)| a != b).count();
        gone += want.iter().zip(&marked).filter(|(a, b)| a != b).count();
    }
    let error = if gone < 1000 {
        f64::NAN
    } else {
        differing as f64
    };
    Outcome::new(error, 0.0, "pixels that only one keeps")
}

/// Largest distance of an outline's places from those of the twin's; NaN where one has other
/// outlines, or one that is open.
fn borders() -> Outcome {
    let (mut worst, mut all) = (0.0_f64, 0);
    for marked in pictures() {
        let mut found: Vec<Vec<DVec2>> = Vec::new();
        for line in outlines(SIZE, &marked, 0.0) {
            if !line.closed {
                worst = f64::NAN;
            }
            found.push(twin::in_order(line.points));
        }
        found.sort_by(|a, b| twin::place_order(&a[0], &b[0]));
        let want = twin::areas(&plain(&marked)).outlines;
        all += want.len();
        let counts = |o: &[Vec<DVec2>]| o.iter().map(Vec::len).collect::<Vec<_>>();
        if counts(&found) != counts(&want) {
            worst = f64::NAN;
        }
        for (a, b) in found.iter().flatten().zip(want.iter().flatten()) {
            // `max` would forget a NaN.
            if worst < a.distance(*b) {
                worst = a.distance(*b);
            }
        }
    }
    let error = if all < 100 { f64::NAN } else { worst };
    Outcome::new(error, 1e-9, "pixels")
}

/// Area within all outlines, holes taken off.
fn areas() -> Outcome {
    let (mut found, mut want) = (Vec::new(), Vec::new());
    for marked in pictures() {
        let signed = |line: &Polyline| {
            let round: Vec<DVec2> = line.round().collect();
            0.5 * round.windows(2).map(|p| p[0].perp_dot(p[1])).sum::<f64>()
        };
        let all: f64 = outlines(SIZE, &marked, 0.0).iter().map(signed).sum();
        found.push(all.abs());
        want.push(twin::areas(&plain(&marked)).area);
    }
    let error = |a: &f64, b: &f64| (a - b).abs();
    Outcome::worst((&found, &want), error, (1e-8, "square pixels"))
}
