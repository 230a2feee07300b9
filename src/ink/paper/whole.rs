//! Vectors of the whole bitmap (Deussen and Strothotte 2000, section 3.4, first algorithm): the
//! lines of foliage and stems, merged by depth, are thinned and traced as one picture. Shorter files
//! than outlines of primitives, and lines that go on from one leaf to the next.

use std::collections::HashMap;

use glam::DVec2;

use super::curve::Polyline;
use super::trace::{Marks, smoothed, thinned, trace};

/// Shorter lines are specks, pixels.
const SPECK: f64 = 3.0;
/// Pixels on each side over which lines are smoothed.
const SMOOTH: usize = 2;
/// Points on each side that tell what a line is the border of.
const OWNED: usize = 3;
/// Points from a junction on that tell the direction in which a line leaves it.
const REACH: usize = 6;
/// Mean distance of a border from the middle of a pixel that has it across a corner only.
const CORNER: f64 = 0.95;
/// Cosine of the largest turn with which a line goes on through a junction.
const STRAIGHT: f64 = 0.5;

/// What lines are traced from.
#[derive(Debug, Clone, Copy)]
pub struct Whole<'a> {
    /// Pixels across and down.
    pub size: [usize; 2],
    /// Line pixels.
    pub marked: &'a [bool],
    /// Eye depth of what is seen in each pixel; 0: nothing.
    pub depth: &'a [f32],
    /// Number of what is seen in each pixel: its neighbours of the same number are no border.
    pub number: &'a [u32],
}

/// What is known of the outlines that lines of the bitmap stand for.
pub trait Outlines {
    /// The place of the outline of a number nearest to `p` (pixels), and how far round the outline it
    /// is; none where it is not near, or not seen.
    fn place(&mut self, number: u32, p: DVec2) -> Option<(DVec2, f64)>;

    /// Corners of the outline of a number on the short way between two places of it.
    fn between(&mut self, number: u32, from: f64, to: f64) -> Vec<DVec2>;
}

/// Nothing is known: lines lie on the edges of pixels.
impl Outlines for () {
    fn place(&mut self, _: u32, _: DVec2) -> Option<(DVec2, f64)> {
        None
    }

    fn between(&mut self, _: u32, _: f64, _: f64) -> Vec<DVec2> {
        Vec::new()
    }
}

/// The lines of the bitmap, pixels. Lines lie on the front side of borders; they are moved to the
/// borders themselves: onto outlines where those are known, elsewhere to the edges of pixels.
#[must_use]
pub fn lines(whole: &Whole<'_>, outlines: &mut impl Outlines) -> Vec<Polyline> {
    let marked = without_single(whole);
    let thin = thinned(&Marks {
        size: whole.size,
        marked: &marked,
    });
    let found = trace(&Marks {
        size: whole.size,
        marked: &thin,
    });
    let through = joined_through(found);
    let done = through.into_iter().map(|line| {
        let owners = whole.owners(&line);
        let points = line.points.iter().map(|&p| p + whole.border_from(p));
        let moved = Polyline {
            points: points.collect(),
            closed: line.closed,
        };
        outlined(&smoothed(&moved, SMOOTH), &owners, outlines)
    });
    done.filter(|l| l.points.len() > 1 && l.length() >= SPECK)
        .collect()
}

/// The marks without those that have no neighbour; ends of lines stay.
fn without_single(whole: &Whole<'_>) -> Vec<bool> {
    let [w, h] = whole.size;
    let near = |i: usize| {
        let (x, y) = (i % w, i / w);
        (y.saturating_sub(1)..(y + 2).min(h)).any(|v| {
            (x.saturating_sub(1)..(x + 2).min(w)).any(|u| v * w + u != i && whole.marked[v * w + u])
        })
    };
    (0..w * h).map(|i| whole.marked[i] && near(i)).collect()
}

impl Whole<'_> {
    /// What each point of a line (middles of pixels) is the border of: what most of its neighbours
    /// show, so that a line that shares its pixels with another does not go to and fro between them;
    /// and what it shows itself.
    fn owners(&self, line: &Polyline) -> Vec<[u32; 2]> {
        let number = |p: &DVec2| self.number[p.y as usize * self.size[0] + p.x as usize];
        let own: Vec<u32> = line.points.iter().map(number).collect();
        let count = own.len();
        let most = |i: usize| {
            let near = if line.closed {
                let at = |k| own[(i + count + k - OWNED.min(count)) % count];
                (0..=2 * OWNED.min(count)).map(at).collect()
            } else {
                own[i.saturating_sub(OWNED)..(i + OWNED + 1).min(count)].to_vec()
            };
            let times = |n: u32| near.iter().filter(|&&m| m == n).count();
            let best = near.iter().copied().max_by_key(|&n| (times(n), n));
            let best = best.filter(|&n| times(n) > times(own[i]));
            [best.unwrap_or(own[i]), own[i]]
        };
        (0..count).map(most).collect()
    }

    /// From the middle of a line's pixel to the border of what lies behind it: half a pixel, or a
    /// diagonal where that is seen across a corner only.
    fn border_from(&self, p: DVec2) -> DVec2 {
        let [w, h] = self.size.map(|s| s as i64);
        let (x, y) = (p.x as i64, p.y as i64);
        let at = |x: i64, y: i64| (y.clamp(0, h - 1) * w + x.clamp(0, w - 1)) as usize;
        let here = at(x, y);
        let depth = |i: usize| {
            if self.depth[i] > 0.0 {
                self.depth[i]
            } else {
                f32::INFINITY
            }
        };
        let (mut sum, mut beside) = (DVec2::ZERO, false);
        for (dx, dy) in [
            (1, 0),
            (0, 1),
            (-1, 0),
            (0, -1),
            (1, 1),
            (-1, 1),
            (-1, -1),
            (1, -1),
        ] {
            let there = at(x + dx, y + dy);
            if self.number[there] != self.number[here] && depth(there) > depth(here) {
                sum += DVec2::new(dx as f64, dy as f64).normalize();
                beside |= dx == 0 || dy == 0;
            }
        }
        let way = if beside { 0.5 } else { CORNER };
        way * sum.normalize_or_zero()
    }
}

/// A line on the outlines of its owners, corners and all.
fn outlined(line: &Polyline, owners: &[[u32; 2]], outlines: &mut impl Outlines) -> Polyline {
    let mut points = Vec::with_capacity(line.points.len());
    let mut before: Option<(u32, f64)> = None;
    for (&p, &[most, own]) in line.points.iter().zip(owners) {
        let mut on = |n: u32| outlines.place(n, p).map(|(q, round)| (q, (n, round)));
        let Some((place, now)) = on(most).or_else(|| on(own)) else {
            points.push(p);
            before = None;
            continue;
        };
        if let Some((number, from)) = before
            && number == now.0
        {
            points.extend(outlines.between(number, from, now.1));
        }
        points.push(place);
        before = Some(now);
    }
    Polyline {
        points,
        closed: line.closed,
    }
}

/// One end of a line: its number, and whether it is the last point.
type End = (usize, bool);

/// Lines that go on straight through junctions as one: tracing cuts them there.
pub(super) fn joined_through(lines: Vec<Polyline>) -> Vec<Polyline> {
    let mut at: HashMap<[i64; 2], Vec<End>> = HashMap::new();
    let key = |p: DVec2| [(2.0 * p.x) as i64, (2.0 * p.y) as i64];
    let open = |l: &Polyline| !l.closed && l.points.len() > 1;
    let mut order = Vec::new();
    for (i, line) in lines.iter().enumerate().filter(|(_, l)| open(l)) {
        for (p, last) in [
            (line.points[0], false),
            (line.points[line.points.len() - 1], true),
        ] {
            let ends = at.entry(key(p)).or_insert_with(|| {
                order.push(key(p));
                Vec::new()
            });
            ends.push((i, last));
        }
    }
    let leaving = |(i, last): End| {
        let p = &lines[i].points;
        let far = REACH.min(p.len() - 1);
        let (from, to) = if last {
            (p[p.len() - 1], p[p.len() - 1 - far])
        } else {
            (p[0], p[far])
        };
        (to - from).normalize_or_zero()
    };
    let mut next: HashMap<End, End> = HashMap::new();
    for ends in order.iter().map(|k| &at[k]) {
        let mut pairs: Vec<(f64, End, End)> = Vec::new();
        for (k, &a) in ends.iter().enumerate() {
            for &b in &ends[k + 1..] {
                let straight = -leaving(a).dot(leaving(b));
                if straight >= STRAIGHT && a.0 != b.0 {
                    pairs.push((straight, a, b));
                }
            }
        }
        pairs.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        for (_, a, b) in pairs {
            if !next.contains_key(&a) && !next.contains_key(&b) {
                next.insert(a, b);
                next.insert(b, a);
            }
        }
    }
    chained(lines, &next)
}

/// The lines in chains, as `next` joins their ends.
fn chained(lines: Vec<Polyline>, next: &HashMap<End, End>) -> Vec<Polyline> {
    let mut used = vec![false; lines.len()];
    let mut out = Vec::new();
    for start in 0..lines.len() {
        if used[start] {
            continue;
        }
        // Back to where the chain begins; round a ring no further than once.
        let (mut first, mut back) = (start, false);
        for _ in 0..lines.len() {
            match next.get(&(first, back)) {
                Some(&(before, last)) if before != start => (first, back) = (before, !last),
                _ => break,
            }
        }
        let mut points: Vec<DVec2> = Vec::new();
        let (mut at, mut reversed) = (first, back);
        let mut closed = lines[at].closed;
        loop {
            used[at] = true;
            let own = lines[at].points.iter().copied();
            let skip = usize::from(!points.is_empty());
            if reversed {
                points.extend(own.rev().skip(skip));
            } else {
                points.extend(own.skip(skip));
            }
            match next.get(&(at, !reversed)) {
                Some(&(then, last)) if !used[then] => (at, reversed) = (then, last),
                Some(&(then, _)) => {
                    closed |= then == first && points.len() > 3;
                    break;
                }
                None => break,
            }
        }
        if closed && points.len() > 3 && points.first() == points.last() {
            points.pop();
        }
        out.push(Polyline { points, closed });
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn whole<'a>(marked: &'a [bool], depth: &'a [f32], number: &'a [u32]) -> Whole<'a> {
        Whole {
            size: [60, 40],
            marked,
            depth,
            number,
        }
    }

    fn drawn(inks: impl Fn(i64, i64) -> bool) -> Vec<bool> {
        (0..60 * 40).map(|i| inks(i % 60, i / 60)).collect()
    }

    #[test]
    fn crossing_lines_go_on_through_the_crossing() {
        let marked =
            drawn(|x, y| (y == 20 && (5..55).contains(&x)) || (x == 30 && (4..37).contains(&y)));
        let (depth, number) = (vec![1.0; 2400], vec![1; 2400]);
        let mut found = lines(&whole(&marked, &depth, &number), &mut ());
        assert_eq!(found.len(), 2, "{found:?}");
        found.sort_by(|a, b| a.length().total_cmp(&b.length()));
        assert!((found[0].length() - 32.0).abs() < 1.0 && (found[1].length() - 49.0).abs() < 1.0);
    }

    #[test]
    fn single_pixels_go_and_ends_stay() {
        let marked = drawn(|x, y| (x == 3 && y == 3) || (y == 20 && (5..25).contains(&x)));
        let (depth, number) = (vec![1.0; 2400], vec![1; 2400]);
        let found = lines(&whole(&marked, &depth, &number), &mut ());
        assert_eq!(found.len(), 1);
        assert!((found[0].length() - 19.0).abs() < 1e-9, "ends stay");
    }

    #[test]
    fn lines_lie_on_the_borders_not_beside_them() {
        let (middle, radius) = (DVec2::new(30.2, 19.7), 12.3);
        let inside =
            |x: i64, y: i64| DVec2::new(x as f64 + 0.5, y as f64 + 0.5).distance(middle) < radius;
        let marked =
            drawn(|x, y| inside(x, y) && (-1..=1).any(|u| (-1..=1).any(|v| !inside(x + u, y + v))));
        let number: Vec<u32> = drawn(inside).iter().map(|&i| u32::from(i)).collect();
        let depth: Vec<f32> = number.iter().map(|&n| n as f32).collect();
        let found = lines(&whole(&marked, &depth, &number), &mut ());
        assert_eq!(found.len(), 1);
        assert!(found[0].closed);
        let off: Vec<f64> = found[0]
            .points
            .iter()
            .map(|p| p.distance(middle) - radius)
            .collect();
        let mean = off.iter().sum::<f64>() / off.len() as f64;
        let most = off.iter().map(|o| o.abs()).fold(0.0, f64::max);
        assert!(mean.abs() < 0.12 && most < 0.7, "mean {mean}, most {most}");
    }
}
