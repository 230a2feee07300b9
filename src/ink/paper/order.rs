//! The order in which a plotter draws: short ways with the pen up, lines that meet joined, nothing
//! drawn twice.

use std::collections::HashMap;

use glam::{DVec2, IVec2};
use rayon::prelude::*;

use super::curve::Polyline;
use super::fit::{FitSettings, distance_to_segment, fit};
use super::grid::Grid;
use crate::math::hashing::WordHash;

/// The lines from `start` on, each begun at the free end nearest to where the last one ended;
/// rings begin at their nearest point.
#[must_use]
pub fn sorted(lines: Vec<Polyline>, start: DVec2) -> Vec<Polyline> {
    let mut lines: Vec<Polyline> = lines.into_iter().filter(|l| !l.points.is_empty()).collect();
    let ends = |lines: &[Polyline], n: u32| {
        let line = &lines[n as usize / 2];
        let last = line.points.len() - 1;
        line.points[if n.is_multiple_of(2) || line.closed {
            0
        } else {
            last
        }]
    };
    let mut grid = Grid::new(cell_for(&lines));
    for n in 0..2 * lines.len() as u32 {
        if n % 2 == 0 || !lines[n as usize / 2].closed {
            grid.add(ends(&lines, n), n);
        }
    }
    let mut at = start;
    let mut out = Vec::with_capacity(lines.len());
    while out.len() < lines.len()
        && let Some(n) = grid.nearest(at, |n| ends(&lines, n))
    {
        for end in [n & !1, n | 1] {
            grid.remove(ends(&lines, end), end);
        }
        let mut line = std::mem::take(&mut lines[n as usize / 2]);
        if line.closed {
            let near = |i: &usize| line.points[*i].distance_squared(at);
            let first = (0..line.points.len()).min_by(|a, b| near(a).total_cmp(&near(b)));
            line.points.rotate_left(first.unwrap_or(0));
            at = line.points[0];
        } else {
            if n % 2 == 1 {
                line.points.reverse();
            }
            at = line.points[line.points.len() - 1];
        }
        out.push(line);
    }
    out
}

/// Cells that hold about two ends each.
fn cell_for(lines: &[Polyline]) -> f64 {
    let all = || {
        lines
            .iter()
            .flat_map(|l| [l.points[0], l.points[l.points.len() - 1]])
    };
    let low = all().fold(DVec2::INFINITY, DVec2::min);
    let high = all().fold(DVec2::NEG_INFINITY, DVec2::max);
    let area = (high - low).max(DVec2::splat(1e-9));
    let count = lines.len().max(1) as f64;
    // Ends may all lie on one line.
    let side = area.x.max(area.y) / count;
    ((area.x * area.y) / count).sqrt().max(side).max(1e-3)
}

/// Joins lines, in their order, whose ends are at most `gap` apart; a line whose own ends meet
/// becomes a ring.
#[must_use]
pub fn joined(lines: Vec<Polyline>, gap: f64) -> Vec<Polyline> {
    let mut out: Vec<Polyline> = Vec::with_capacity(lines.len());
    for line in lines {
        let meets = out.last().is_some_and(|last| {
            !last.closed
                && !line.closed
                && last.points[last.points.len() - 1].distance(line.points[0]) <= gap
        });
        match out.last_mut() {
            Some(last) if meets => last.points.extend(line.points),
            _ => out.push(line),
        }
    }
    for line in &mut out {
        let count = line.points.len();
        if !line.closed && count > 3 && line.points[0].distance(line.points[count - 1]) <= gap {
            line.closed = true;
            line.points.pop();
        }
    }
    out
}

/// Way with the pen up, from `start` through the lines in their order.
#[must_use]
pub fn pen_up(lines: &[Polyline], start: DVec2) -> f64 {
    let mut at = start;
    let mut sum = 0.0;
    for line in lines.iter().filter(|l| !l.points.is_empty()) {
        sum += at.distance(line.points[0]);
        at = line.points[if line.closed {
            0
        } else {
            line.points.len() - 1
        }];
    }
    sum
}

/// Lines as a plotter draws them: nothing twice, sorted, joined where ends are at most `gap` apart.
/// What counts is the curves that are written: where they come nearer to each other than the lines
/// that they stand for, what lies along another goes too.
#[must_use]
pub fn ordered(lines: &[Polyline], gap: f64, curves: &FitSettings) -> Vec<Polyline> {
    let mut lines = lines.to_vec();
    for round in 0..ROUNDS {
        let written: Vec<Polyline> = lines
            .par_iter()
            .map(|l| fit(l, curves).flattened(0.5 * gap))
            .collect();
        let kept = kept(&written, gap);
        if round > 0 && kept.iter().all(Option::is_none) {
            break;
        }
        let pieces = lines.into_iter().zip(kept);
        let once = pieces.flat_map(|(line, pieces)| pieces.unwrap_or_else(|| vec![line]));
        lines = joined(sorted(once.collect(), DVec2::ZERO), gap);
    }
    lines
}

/// Rounds in which curves are held against each other at most.
const ROUNDS: u32 = 6;

/// Lines without what is drawn already, by an earlier one or by themselves: pieces that run along it
/// for more than two `gap`s, nearer than `gap` and in its direction.
#[must_use]
pub fn without_repeats(lines: &[Polyline], gap: f64) -> Vec<Polyline> {
    let whole = |(line, pieces): (&Polyline, Option<Vec<Polyline>>)| {
        pieces.unwrap_or_else(|| vec![line.clone()])
    };
    lines.iter().zip(kept(lines, gap)).flat_map(whole).collect()
}

/// What is kept of each line; none: all of it.
fn kept(lines: &[Polyline], gap: f64) -> Vec<Option<Vec<Polyline>>> {
    let mut drawn = Drawn::new(gap);
    let one = |line: &Polyline| {
        let points = resampled(line, drawn.step());
        if points.len() < 2 {
            return None;
        }
        let repeats = drawn.draw(&points, line.closed);
        let any = repeats.iter().any(|&r| r);
        any.then(|| kept_pieces(&points, &repeats, line.closed))
    };
    lines.iter().map(one).collect()
}

/// Points `step` apart or a little less along the whole line, whatever its own; of a ring the first
/// comes again.
fn resampled(line: &Polyline, step: f64) -> Vec<DVec2> {
    let round: Vec<DVec2> = line.round().collect();
    let (Some(&first), Some(&last)) = (round.first(), round.last()) else {
        return Vec::new();
    };
    let count = (line.length() / step).ceil().clamp(1.0, 1e7);
    let each = line.length() / count;
    let mut out = vec![first];
    // Way along the line to the next point.
    let mut left = each;
    for p in round.windows(2) {
        let length = p[0].distance(p[1]);
        let mut at = left;
        while at < length && out.len() < count as usize {
            out.push(p[0].lerp(p[1], at / length));
            at += each;
        }
        left = at - length;
    }
    if round.len() > 1 {
        out.push(last);
    }
    out
}

/// Shorter runs of points along what is drawn are crossings and touches, longer ones repeats.
const TOUCH: usize = 5;
/// So many points behind the pen are not what a line may repeat of itself.
const BEHIND: usize = 8;

/// A short piece of what is drawn.
struct Piece {
    ends: [DVec2; 2],
    way: DVec2,
}

/// What is drawn, by the cells that its pieces start in.
struct Drawn {
    gap: f64,
    cells: HashMap<IVec2, Vec<Piece>, WordHash>,
}

impl Drawn {
    fn new(gap: f64) -> Self {
        Self {
            gap,
            cells: HashMap::default(),
        }
    }

    /// Distance of the points in which lines are looked at.
    fn step(&self) -> f64 {
        0.5 * self.gap
    }

    /// Cells are so large that what is within the gap starts in a neighbour.
    fn key(&self, p: DVec2) -> IVec2 {
        (p / (self.gap + self.step())).floor().as_ivec2()
    }

    fn add(&mut self, ends: [DVec2; 2]) {
        let key = self.key(ends[0]);
        let way = (ends[1] - ends[0]).normalize_or_zero();
        self.cells.entry(key).or_default().push(Piece { ends, way });
    }

    fn covers(&self, p: DVec2, way: DVec2) -> bool {
        let middle = self.key(p);
        let near = |piece: &Piece| {
            let [a, b] = piece.ends;
            piece.way.dot(way).abs() > 0.97 && distance_to_segment(p, a, b) < self.gap
        };
        (0..9).any(|k| {
            let cell = middle + IVec2::new(k % 3 - 1, k / 3 - 1);
            let list = self.cells.get(&cell);
            list.is_some_and(|list| list.iter().any(near))
        })
    }

    /// Draws a line but for the points that lie on runs that were drawn before, and tells which
    /// these are.
    fn draw(&mut self, points: &[DVec2], closed: bool) -> Vec<bool> {
        let count = points.len();
        // A ring's end is just behind its start.
        let first = if closed { BEHIND } else { 0 };
        let mut repeats: Vec<bool> = Vec::with_capacity(count);
        let mut added = vec![false; count];
        for i in 0..count {
            if let Some(k) = i.checked_sub(BEHIND)
                && k >= first
                && !repeats[k]
                && !repeats[k + 1]
            {
                self.add([points[k], points[k + 1]]);
                added[k] = true;
            }
            repeats.push(self.covers(points[i], direction(points, i)));
        }
        without_touches(&mut repeats, closed);
        for k in 0..count - 1 {
            if !added[k] && !repeats[k] && !repeats[k + 1] {
                self.add([points[k], points[k + 1]]);
            }
        }
        repeats
    }
}

/// Runs that are too short for repeats are none, unless they are all there is.
fn without_touches(repeats: &mut [bool], closed: bool) {
    let count = repeats.len();
    let mut at = 0;
    while at < count {
        let end = (at..count)
            .find(|&i| repeats[i] != repeats[at])
            .unwrap_or(count);
        let whole = at == 0 && end == count;
        let at_seam = closed && (at == 0 || end == count);
        if repeats[at] && end - at < TOUCH && !whole && !at_seam {
            repeats[at..end].fill(false);
        }
        at = end;
    }
}

fn direction(points: &[DVec2], i: usize) -> DVec2 {
    let (a, b) = (i.saturating_sub(1), (i + 1).min(points.len() - 1));
    (points[b] - points[a]).normalize_or_zero()
}

/// Runs of points that are no repeats; what is left between them is specks where it is short.
fn kept_pieces(points: &[DVec2], repeats: &[bool], closed: bool) -> Vec<Polyline> {
    let mut pieces: Vec<Polyline> = Vec::new();
    let mut run: Vec<DVec2> = Vec::new();
    for (&p, &repeat) in points.iter().zip(repeats) {
        if !repeat {
            run.push(p);
        } else if run.len() > 1 {
            pieces.push(Polyline {
                points: std::mem::take(&mut run),
                closed: false,
            });
        } else {
            run.clear();
        }
    }
    if run.len() > 1 {
        // A ring's last run goes on in its first.
        let seam =
            closed && !repeats[0] && pieces.first().is_some_and(|f| f.points[0] == points[0]);
        if seam && pieces.len() > 1 {
            let first = pieces.remove(0);
            run.extend(first.points.into_iter().skip(1));
        }
        pieces.push(Polyline {
            points: run,
            closed: false,
        });
    }
    pieces.retain(|p| p.points.len() >= TOUCH);
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    fn segment(a: [f64; 2], b: [f64; 2]) -> Polyline {
        Polyline {
            points: vec![DVec2::from(a), DVec2::from(b)],
            closed: false,
        }
    }

    fn scattered(count: u32) -> Vec<Polyline> {
        let mut state = 11_u32;
        let mut number = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / 16_777_216.0
        };
        (0..count)
            .map(|_| {
                let a = [200.0 * number(), 150.0 * number()];
                segment(
                    a,
                    [a[0] + 4.0 * number() - 2.0, a[1] + 4.0 * number() - 2.0],
                )
            })
            .collect()
    }

    #[test]
    fn one_small_ring_far_from_the_start_is_found_at_once() {
        let ring = Polyline {
            points: [[900.0, 900.0], [900.1, 900.0], [900.0, 900.1]]
                .map(DVec2::from)
                .into(),
            closed: true,
        };
        // Its ends have no extent: cells of a thousandth of a millimetre.
        assert_eq!(sorted(vec![ring], DVec2::ZERO).len(), 1);
        let upright: Vec<_> = (0..300)
            .map(|k| segment([5.0, f64::from(k)], [5.0, f64::from(k) + 0.5]))
            .collect();
        assert_eq!(sorted(upright, DVec2::ZERO).len(), 300);
    }

    #[test]
    fn sorting_takes_the_nearest_end_every_time() {
        let lines = scattered(400);
        let before = pen_up(&lines, DVec2::ZERO);
        let order = sorted(lines.clone(), DVec2::ZERO);
        assert_eq!(order.len(), lines.len());
        let mut left: Vec<Polyline> = lines;
        let mut at = DVec2::ZERO;
        for line in &order {
            let ends = |l: &Polyline| l.points[0].distance(at).min(l.points[1].distance(at));
            let least = left.iter().map(ends).fold(f64::INFINITY, f64::min);
            assert!((line.points[0].distance(at) - least).abs() < 1e-9);
            let same = |l: &Polyline| {
                l.points.contains(&line.points[0]) && l.points.contains(&line.points[1])
            };
            let found = left.iter().position(same).expect("one of the lines");
            left.swap_remove(found);
            at = line.points[1];
        }
        assert!(pen_up(&order, DVec2::ZERO) < 0.2 * before);
    }

    #[test]
    fn what_meets_is_joined_and_rings_close() {
        let lines = vec![
            segment([0.0, 0.0], [5.0, 0.0]),
            segment([5.05, 0.0], [5.0, 5.0]),
            segment([5.0, 5.0], [0.0, 0.08]),
            segment([9.0, 9.0], [9.0, 8.0]),
        ];
        let out = joined(lines, 0.1);
        assert_eq!(out.len(), 2);
        assert!(out[0].closed && out[0].points.len() == 5, "{out:?}");
    }

    #[test]
    fn nothing_is_drawn_twice_but_crossings_stay() {
        let lines = vec![
            segment([0.0, 0.0], [10.0, 0.0]),
            segment([4.0, 0.05], [14.0, 0.05]),
            segment([5.0, -3.0], [5.0, 3.0]),
            segment([10.0, 0.0], [0.0, 0.0]),
        ];
        let out = without_repeats(&lines, 0.1);
        let total: f64 = out.iter().map(Polyline::length).sum();
        assert!((total - 20.0).abs() < 0.4, "{total}: {out:?}");
        assert!(out.contains(&lines[2]), "a crossing is whole");
    }

    /// Longest way, in points `step` apart, that lines run along each other or along themselves.
    fn doubled(lines: &[Polyline], gap: f64, step: f64) -> f64 {
        let all: Vec<Vec<DVec2>> = lines.iter().map(|l| resampled(l, step)).collect();
        let mut most = 0;
        for (k, line) in all.iter().enumerate() {
            let mut run = 0;
            for (i, &p) in line.iter().enumerate() {
                let way = direction(line, i);
                let along = |a: DVec2, b: DVec2| {
                    let other = (b - a).normalize_or_zero();
                    other.perp_dot(way).abs() < 0.05 && distance_to_segment(p, a, b) < gap
                };
                // Strokes of other places do not meet.
                let near = |j: &usize| all[*j][0].distance(line[0]) < 8.0;
                let repeats = (0..=k).filter(near).any(|j| {
                    let before = if j == k {
                        i.saturating_sub(40)
                    } else {
                        all[j].len()
                    };
                    all[j][..before].windows(2).any(|s| along(s[0], s[1]))
                });
                run = if repeats { run + 1 } else { 0 };
                most = most.max(run);
            }
        }
        f64::from(most) * step
    }

    #[test]
    fn curves_that_are_written_run_along_none_that_is_there() {
        let curves = FitSettings::within(0.05);
        // Strokes and their neighbours: a little aside, moved along, turned and bent another way.
        let mut lines = Vec::new();
        for k in 0..60 {
            let (row, t) = (f64::from(k), f64::from(k) / 60.0);
            let foot = DVec2::new(24.0 * (row % 6.0), 12.0 * (row / 6.0).floor());
            let arc = |along: f64, aside: f64, turn: f64, sag: f64| Polyline {
                points: (0..=12)
                    .map(|i| {
                        let s = f64::from(i) / 12.0;
                        let p = DVec2::new(6.0 * s + along, aside + sag * s * (1.0 - s));
                        foot + DVec2::from_angle(turn).rotate(p)
                    })
                    .collect(),
                closed: false,
            };
            lines.push(arc(0.0, 0.0, 0.1, 0.6));
            lines.push(arc(
                4.0 * t,
                0.02 + 0.16 * t,
                0.1 + 0.08 * (0.5 - t),
                0.6 - 0.5 * t,
            ));
        }
        let written = |lines: &[Polyline]| -> Vec<Polyline> {
            let one = |l: &Polyline| fit(l, &curves).flattened(0.02);
            lines.iter().map(one).collect()
        };
        assert!(doubled(&written(&lines), 0.1, 0.04) > 2.0);
        let out = ordered(&lines, 0.1, &curves);
        let left = doubled(&written(&out), 0.099, 0.04);
        assert!(left < 0.3, "{left} mm twice");
        let least = out
            .iter()
            .map(Polyline::length)
            .fold(f64::INFINITY, f64::min);
        assert!(least > 0.15, "a speck of {least} mm is left");
        // No more went than lies along another.
        let [all, kept] = [&lines, &out].map(|l| l.iter().map(Polyline::length).sum::<f64>());
        assert!(kept > 0.6 * all && kept < 0.9 * all, "{kept} of {all}");
    }

    #[test]
    fn a_line_that_comes_back_along_itself_goes_one_way() {
        let back = Polyline {
            points: [[0.0, 0.0], [10.0, 0.0], [10.0, 0.05], [0.0, 0.05]]
                .map(DVec2::from)
                .to_vec(),
            closed: false,
        };
        let ring = Polyline {
            closed: true,
            ..back.clone()
        };
        for line in [back, ring] {
            let out = without_repeats(&[line], 0.1);
            let total: f64 = out.iter().map(Polyline::length).sum();
            assert!((total - 10.0).abs() < 0.6, "{total}: {out:?}");
        }
        let round: Vec<DVec2> = (0..40)
            .map(|k| DVec2::from_angle(f64::from(k) * std::f64::consts::TAU / 40.0))
            .collect();
        let round = [Polyline {
            points: round,
            closed: true,
        }];
        assert_eq!(without_repeats(&round, 0.1), round, "a ring is whole");
    }

    #[test]
    fn what_is_not_drawn_keeps_nothing_away() {
        // Each would be a repeat of the one before; only every second one is.
        let lines = [0.0, 0.08, 0.16, 0.24].map(|y| segment([0.0, y], [8.0, y]));
        let out = without_repeats(&lines, 0.1);
        assert_eq!(out, [lines[0].clone(), lines[2].clone()]);
    }
}
