//! Lines of pixels as polylines.

use glam::DVec2;

use super::curve::Polyline;

/// A picture of marks.
#[derive(Debug, Clone, Copy)]
pub struct Marks<'a> {
    /// Pixels across and down.
    pub size: [usize; 2],
    /// Whether a pixel is marked, row by row.
    pub marked: &'a [bool],
}

impl Marks<'_> {
    fn get(&self, x: i64, y: i64) -> bool {
        let [w, h] = self.size.map(|s| s as i64);
        x >= 0 && y >= 0 && x < w && y < h && self.marked[(y * w + x) as usize]
    }

    /// Neighbours a line goes on to: those beside, and those across a corner that no pixel beside
    /// joins already.
    fn neighbours(&self, at: usize, out: &mut Vec<usize>) {
        out.clear();
        let w = self.size[0] as i64;
        let (x, y) = (at as i64 % w, at as i64 / w);
        for (dx, dy) in [(1, 0), (0, 1), (-1, 0), (0, -1)] {
            if self.get(x + dx, y + dy) {
                out.push(((y + dy) * w + x + dx) as usize);
            }
        }
        for (dx, dy) in [(1, 1), (-1, 1), (-1, -1), (1, -1)] {
            let joined = self.get(x + dx, y) || self.get(x, y + dy);
            if !joined && self.get(x + dx, y + dy) {
                out.push(((y + dy) * w + x + dx) as usize);
            }
        }
    }
}

/// Every line of marked pixels once, through the middles of its pixels: from end to end, from
/// junction to junction, and rings. Single pixels become lines of one point.
#[must_use]
pub fn trace(marks: &Marks<'_>) -> Vec<Polyline> {
    let mut tracer = Tracer {
        marks,
        used: vec![0_u8; marks.marked.len()],
        near: Vec::with_capacity(8),
    };
    let marked: Vec<usize> = (0..marks.marked.len())
        .filter(|&i| marks.marked[i])
        .collect();
    let mut out = Vec::new();
    let mut list = Vec::with_capacity(8);
    for &at in &marked {
        marks.neighbours(at, &mut list);
        if list.len() == 2 {
            continue;
        }
        if list.is_empty() {
            out.push(Polyline {
                points: vec![tracer.middle(at)],
                closed: false,
            });
        }
        for next in list.clone() {
            if let Some(line) = tracer.walk(at, next) {
                out.push(line);
            }
        }
    }
    // What is left are rings.
    for &at in &marked {
        marks.neighbours(at, &mut list);
        if list.len() == 2
            && let Some(mut line) = tracer.walk(at, list[0])
        {
            line.closed = line.points.len() > 3;
            if line.closed {
                line.points.pop();
            }
            out.push(line);
        }
    }
    out
}

struct Tracer<'a> {
    marks: &'a Marks<'a>,
    /// For each pixel the directions in which it was left, one bit each.
    used: Vec<u8>,
    near: Vec<usize>,
}

impl Tracer<'_> {
    fn middle(&self, at: usize) -> DVec2 {
        let w = self.marks.size[0];
        DVec2::new((at % w) as f64 + 0.5, (at / w) as f64 + 0.5)
    }

    /// The bit of the step from one pixel to a neighbour.
    fn bit(&self, from: usize, to: usize) -> u8 {
        let w = self.marks.size[0] as i64;
        let (dx, dy) = (
            to as i64 % w - from as i64 % w,
            to as i64 / w - from as i64 / w,
        );
        // Eight directions, the middle left out.
        let number = (dy + 1) * 3 + dx + 1;
        1 << (if number > 4 { number - 1 } else { number })
    }

    /// The line that leaves `from` towards `next`, to the next end or junction; none where it was
    /// walked before.
    fn walk(&mut self, from: usize, next: usize) -> Option<Polyline> {
        let first = self.bit(from, next);
        if self.used[from] & first != 0 {
            return None;
        }
        let (mut before, mut at) = (from, next);
        let mut points = vec![self.middle(from)];
        loop {
            let (forth, back) = (self.bit(before, at), self.bit(at, before));
            self.used[before] |= forth;
            self.used[at] |= back;
            points.push(self.middle(at));
            let mut near = std::mem::take(&mut self.near);
            self.marks.neighbours(at, &mut near);
            let next = (near.len() == 2 && at != from)
                .then(|| near.iter().copied().find(|&n| n != before))
                .flatten();
            self.near = near;
            let Some(next) = next else { break };
            (before, at) = (at, next);
        }
        Some(Polyline {
            points,
            closed: false,
        })
    }
}

/// The marks with lines made one pixel thin (Zhang and Suen 1984): what is connected stays so.
#[must_use]
pub fn thinned(marks: &Marks<'_>) -> Vec<bool> {
    let [w, h] = marks.size;
    let mut now = marks.marked.to_vec();
    let mut left: Vec<usize> = (0..w * h).filter(|&i| now[i]).collect();
    loop {
        let before = left.len();
        for second in [false, true] {
            let current = Marks {
                size: marks.size,
                marked: &now,
            };
            let gone: Vec<usize> = left
                .iter()
                .copied()
                .filter(|&i| goes(&current, i, second))
                .collect();
            for i in gone {
                now[i] = false;
            }
            left.retain(|&i| now[i]);
        }
        if left.len() == before {
            return now;
        }
    }
}

/// Whether a pixel goes in the first or second half of a round of thinning.
fn goes(marks: &Marks<'_>, at: usize, second: bool) -> bool {
    let w = marks.size[0] as i64;
    let (x, y) = (at as i64 % w, at as i64 / w);
    // From above, clockwise.
    let ring = [
        (0, -1),
        (1, -1),
        (1, 0),
        (1, 1),
        (0, 1),
        (-1, 1),
        (-1, 0),
        (-1, -1),
    ]
    .map(|(dx, dy)| marks.get(x + dx, y + dy));
    let count = ring.iter().filter(|&&m| m).count();
    let rises = (0..8).filter(|&k| !ring[k] && ring[(k + 1) % 8]).count();
    let [up, right, down, left] = [ring[0], ring[2], ring[4], ring[6]];
    let open = if second {
        !(up && left && (right || down))
    } else {
        !(right && down && (up || left))
    };
    (2..=6).contains(&count) && rises == 1 && open
}

/// A line with the stairs of its pixels smoothed: every point becomes the mean of itself and its
/// `reach` neighbours on each side, weighted 1 to `reach` + 1. Ends and rings stay ends and rings.
#[must_use]
pub fn smoothed(line: &Polyline, reach: usize) -> Polyline {
    let count = line.points.len();
    if reach == 0 || count < 3 {
        return line.clone();
    }
    let mean = |i: usize| {
        // Fewer neighbours near the ends, as many on each side, so that ends stay.
        let here = if line.closed {
            reach.min((count - 1) / 2)
        } else {
            reach.min(i).min(count - 1 - i)
        };
        let (mut sum, mut weights) = (DVec2::ZERO, 0.0);
        for k in -(here as i64)..=here as i64 {
            let weight = (here as i64 + 1 - k.abs()) as f64;
            let j = (i as i64 + k).rem_euclid(count as i64) as usize;
            sum += weight * line.points[j];
            weights += weight;
        }
        sum / weights
    };
    Polyline {
        points: (0..count).map(mean).collect(),
        closed: line.closed,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marks(rows: &[&str]) -> ([usize; 2], Vec<bool>) {
        let size = [rows[0].len(), rows.len()];
        (
            size,
            rows.iter()
                .flat_map(|r| r.bytes().map(|b| b == b'#'))
                .collect(),
        )
    }

    fn lines(rows: &[&str]) -> Vec<Polyline> {
        let (size, marked) = marks(rows);
        trace(&Marks {
            size,
            marked: &marked,
        })
    }

    #[test]
    fn a_line_a_ring_and_a_dot_are_one_line_each() {
        let found = lines(&[
            "##......##.",
            "..##...#..#",
            "....#..#..#",
            "........##.",
            ".#.........",
        ]);
        let mut shapes: Vec<(usize, bool)> =
            found.iter().map(|l| (l.points.len(), l.closed)).collect();
        shapes.sort_unstable();
        assert_eq!(shapes, [(1, false), (5, false), (8, true)]);
    }

    #[test]
    fn a_junction_parts_three_lines() {
        let found = lines(&["#...#", ".#.#.", "..#..", "..#..", "..#.."]);
        assert_eq!(found.len(), 3);
        assert!(found.iter().all(|l| l.points.len() == 3 && !l.closed));
    }

    #[test]
    fn every_marked_pixel_is_on_a_line() {
        let mut state = 3_u32;
        let mut number = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            state >> 16
        };
        for share in [100, 300, 700, 1000] {
            let size = [37, 29];
            let marked: Vec<bool> = (0..size[0] * size[1])
                .map(|_| number() % 1000 < share)
                .collect();
            let found = trace(&Marks {
                size,
                marked: &marked,
            });
            let mut seen = vec![false; marked.len()];
            for p in found.iter().flat_map(|l| &l.points) {
                seen[p.y as usize * size[0] + p.x as usize] = true;
            }
            assert_eq!(seen, marked, "share {share}");
        }
    }

    #[test]
    fn thinning_leaves_thin_lines_that_hang_together() {
        let size = [40, 30];
        // A bar three pixels wide, and a ring two wide.
        let inside = |i: usize| {
            let (x, y) = ((i % 40) as f64, (i / 40) as f64);
            let r = (x - 28.0).hypot(y - 14.0);
            ((4.0..=15.0).contains(&x) && (10.0..=12.0).contains(&y)) || (r > 6.5 && r < 8.6)
        };
        let marked: Vec<bool> = (0..1200).map(inside).collect();
        let thin = thinned(&Marks {
            size,
            marked: &marked,
        });
        assert!(thin.iter().zip(&marked).all(|(t, m)| !t || *m));
        let found = trace(&Marks {
            size,
            marked: &thin,
        });
        let rings = found.iter().filter(|l| l.closed).count();
        assert_eq!((found.len(), rings), (2, 1), "{found:?}");
    }

    #[test]
    fn smoothing_keeps_ends_and_rounds_stairs() {
        let line = Polyline {
            points: (0..40)
                .map(|i| DVec2::new(f64::from(i), f64::from(i / 4)))
                .collect(),
            closed: false,
        };
        let smooth = smoothed(&line, 4);
        assert_eq!(smooth.points[0], line.points[0]);
        assert_eq!(smooth.points[39], line.points[39]);
        for p in &smooth.points[8..32] {
            assert!((p.y - (p.x - 1.5) / 4.0).abs() < 0.15, "{p}");
        }
    }
}
