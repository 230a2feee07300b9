//! The order in which a plotter draws: short ways with the pen up, lines that meet joined, nothing
//! drawn twice.

use std::collections::HashMap;

use glam::{DVec2, IVec2};

use super::curve::Polyline;

/// Points in square cells.
struct Grid {
    cell: f64,
    cells: HashMap<IVec2, Vec<u32>>,
    low: IVec2,
    high: IVec2,
}

impl Grid {
    fn new(cell: f64) -> Self {
        Self {
            cell,
            cells: HashMap::new(),
            low: IVec2::MAX,
            high: IVec2::MIN,
        }
    }

    fn key(&self, p: DVec2) -> IVec2 {
        (p / self.cell).floor().as_ivec2()
    }

    fn add(&mut self, p: DVec2, number: u32) {
        let key = self.key(p);
        self.low = self.low.min(key);
        self.high = self.high.max(key);
        self.cells.entry(key).or_default().push(number);
    }

    fn remove(&mut self, p: DVec2, number: u32) {
        if let Some(list) = self.cells.get_mut(&self.key(p)) {
            list.retain(|&n| n != number);
        }
    }

    /// The entry nearest to `p`; `place` tells where an entry is.
    fn nearest(&self, p: DVec2, place: impl Fn(u32) -> DVec2) -> Option<u32> {
        let middle = self.key(p);
        let reach = (self.high - middle).max(middle - self.low);
        let last = reach.x.max(reach.y).max(0);
        let mut best: Option<(f64, u32)> = None;
        for ring in 0..=last {
            // Everything in this ring and beyond is at least so far.
            if best.is_some_and(|b| b.0 <= f64::from(ring - 1).max(0.0) * self.cell) {
                break;
            }
            let mut look = |x: i32, y: i32| {
                let Some(list) = self.cells.get(&IVec2::new(x, y)) else {
                    return;
                };
                for &n in list {
                    let d = place(n).distance(p);
                    if best.is_none_or(|b| (d, n) < b) {
                        best = Some((d, n));
                    }
                }
            };
            for k in -ring..=ring {
                look(middle.x + k, middle.y - ring);
                if ring > 0 {
                    look(middle.x + k, middle.y + ring);
                }
            }
            for k in 1 - ring..ring {
                look(middle.x - ring, middle.y + k);
                look(middle.x + ring, middle.y + k);
            }
        }
        best.map(|b| b.1)
    }
}

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
    while let Some(n) = grid.nearest(at, |n| ends(&lines, n)) {
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
    ((area.x * area.y) / (lines.len().max(1) as f64))
        .sqrt()
        .max(1e-3)
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

/// Lines without what an earlier one draws already: pieces that run along one for more than two
/// `gap`s, nearer than `gap` and in its direction.
#[must_use]
pub fn without_repeats(lines: &[Polyline], gap: f64) -> Vec<Polyline> {
    let mut drawn = Drawn {
        gap,
        cells: HashMap::new(),
    };
    let mut out = Vec::new();
    for line in lines {
        let points = resampled(line, 0.5 * gap);
        if points.len() < 2 {
            out.push(line.clone());
            continue;
        }
        let repeats = drawn.repeats(&points, line.closed);
        if repeats.iter().any(|&r| r) {
            out.extend(kept_pieces(&points, &repeats, line.closed));
        } else {
            out.push(line.clone());
        }
        drawn.add(&points);
    }
    out
}

/// Points about `step` apart along the whole line; of a ring the first comes again.
fn resampled(line: &Polyline, step: f64) -> Vec<DVec2> {
    let round: Vec<DVec2> = line.round().collect();
    let mut out = Vec::new();
    for p in round.windows(2) {
        let count = (p[0].distance(p[1]) / step).ceil().clamp(1.0, 1e6) as u32;
        out.extend((0..count).map(|k| p[0].lerp(p[1], f64::from(k) / f64::from(count))));
    }
    out.extend(round.last());
    out
}

/// What is drawn: places and directions in cells of `gap`.
struct Drawn {
    gap: f64,
    cells: HashMap<IVec2, Vec<(DVec2, DVec2)>>,
}

impl Drawn {
    fn key(&self, p: DVec2) -> IVec2 {
        (p / self.gap).floor().as_ivec2()
    }

    fn add(&mut self, points: &[DVec2]) {
        for (i, &p) in points.iter().enumerate() {
            let key = self.key(p);
            let way = direction(points, i);
            self.cells.entry(key).or_default().push((p, way));
        }
    }

    fn covers(&self, p: DVec2, way: DVec2) -> bool {
        let middle = self.key(p);
        (0..9).any(|k| {
            let cell = middle + IVec2::new(k % 3 - 1, k / 3 - 1);
            self.cells.get(&cell).is_some_and(|list| {
                let near = |&(q, other): &(DVec2, DVec2)| {
                    q.distance_squared(p) < self.gap * self.gap && other.dot(way).abs() > 0.97
                };
                list.iter().any(near)
            })
        })
    }

    /// Which points lie on runs that were drawn before.
    fn repeats(&self, points: &[DVec2], closed: bool) -> Vec<bool> {
        let count = points.len();
        let mut out: Vec<bool> = (0..count)
            .map(|i| self.covers(points[i], direction(points, i)))
            .collect();
        // Crossings and touches are no repeats.
        let least = 5;
        let mut at = 0;
        while at < count {
            let end = (at..count).find(|&i| out[i] != out[at]).unwrap_or(count);
            let whole = at == 0 && end == count;
            let at_seam = closed && (at == 0 || end == count);
            if out[at] && end - at < least && !whole && !at_seam {
                out[at..end].fill(false);
            }
            at = end;
        }
        out
    }
}

fn direction(points: &[DVec2], i: usize) -> DVec2 {
    let (a, b) = (i.saturating_sub(1), (i + 1).min(points.len() - 1));
    (points[b] - points[a]).normalize_or_zero()
}

/// Runs of points that are no repeats.
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
}
