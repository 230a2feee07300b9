//! Lines and outlines of small pictures of marks by plain linking: what belongs together is joined
//! pair by pair, and nothing is walked. Twin of `ink::paper::trace` and `ink::paper::region`.

use std::collections::BTreeMap;

use glam::DVec2;

/// A picture of marks.
#[derive(Debug, Clone, Copy)]
pub struct Marks<'a> {
    /// Pixels across and down.
    pub size: [i64; 2],
    /// Whether a pixel is marked, row by row.
    pub marked: &'a [bool],
}

impl Marks<'_> {
    fn get(&self, x: i64, y: i64) -> bool {
        let [w, h] = self.size;
        (0..w).contains(&x) && (0..h).contains(&y) && self.marked[(y * w + x) as usize]
    }
}

/// A line: the pairs of neighbouring pixels that it joins (the lower number first; a single pixel
/// with itself), in order of their numbers, and whether it is a ring.
pub type Line = (Vec<(usize, usize)>, bool);

/// Things joined pair by pair.
struct Linked(Vec<usize>);

impl Linked {
    fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    fn of(&self, mut at: usize) -> usize {
        while self.0[at] != at {
            at = self.0[at];
        }
        at
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.of(a), self.of(b));
        self.0[a.max(b)] = a.min(b);
    }

    /// Numbers of the things that hang together.
    fn groups(&self) -> Vec<Vec<usize>> {
        let mut out: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for at in 0..self.0.len() {
            out.entry(self.of(at)).or_default().push(at);
        }
        out.into_values().collect()
    }
}

/// All lines, in order. Pixels beside each other are neighbours, and those across a corner where
/// neither of the other two is marked; a line goes on where a pixel has two neighbours.
#[must_use]
pub fn lines(marks: &Marks<'_>) -> Vec<Line> {
    let [w, h] = marks.size;
    let mut pairs = Vec::new();
    for y in 0..h {
        for x in (0..w).filter(|&x| marks.get(x, y)) {
            for (dx, dy) in [(1, 0), (0, 1), (1, 1), (-1, 1)] {
                let corner = dx != 0 && dy != 0;
                let around = corner && (marks.get(x + dx, y) || marks.get(x, y + dy));
                if marks.get(x + dx, y + dy) && !around {
                    pairs.push(((y * w + x) as usize, ((y + dy) * w + x + dx) as usize));
                }
            }
        }
    }
    let mut at_pixel: Vec<Vec<usize>> = vec![Vec::new(); marks.marked.len()];
    for (n, &(a, b)) in pairs.iter().enumerate() {
        at_pixel[a].push(n);
        at_pixel[b].push(n);
    }
    let mut linked = Linked::new(pairs.len());
    for list in &at_pixel {
        if let &[a, b] = list.as_slice() {
            linked.join(a, b);
        }
    }
    let ring = |line: &[(usize, usize)]| {
        let ends = line.iter().flat_map(|&(a, b)| [a, b]);
        ends.into_iter().all(|p| at_pixel[p].len() == 2)
    };
    let whole = |group: Vec<usize>| {
        let mut line: Vec<_> = group.into_iter().map(|n| pairs[n]).collect();
        line.sort_unstable();
        let closed = ring(&line);
        (line, closed)
    };
    let mut out: Vec<Line> = linked.groups().into_iter().map(whole).collect();
    let alone = (0..at_pixel.len()).filter(|&p| marks.marked[p] && at_pixel[p].is_empty());
    out.extend(alone.map(|p| (vec![(p, p)], false)));
    out.sort_unstable();
    out
}

/// The marks made thin, as T. Zhang and C. Suen (*A fast parallel algorithm for thinning digital
/// patterns*, 1984) print it: P2 above, then clockwise to P9; conditions (a) to (d), then (c') and
/// (d').
#[must_use]
pub fn thinned(marks: &Marks<'_>) -> Vec<bool> {
    let [w, h] = marks.size;
    let mut now = marks.marked.to_vec();
    loop {
        let before = now.clone();
        for second in [false, true] {
            let old = now.clone();
            let old = Marks {
                size: marks.size,
                marked: &old,
            };
            for (x, y) in (0..h).flat_map(|y| (0..w).map(move |x| (x, y))) {
                let p = |dx, dy| u32::from(old.get(x + dx, y + dy));
                let (p2, p3, p4, p5) = (p(0, -1), p(1, -1), p(1, 0), p(1, 1));
                let (p6, p7, p8, p9) = (p(0, 1), p(-1, 1), p(-1, 0), p(-1, -1));
                let round = [p2, p3, p4, p5, p6, p7, p8, p9, p2];
                let b: u32 = round[..8].iter().sum();
                let a = round.windows(2).filter(|q| q[0] == 0 && q[1] == 1).count();
                let (c, d) = if second {
                    (p2 * p4 * p8, p2 * p6 * p8)
                } else {
                    (p2 * p4 * p6, p4 * p6 * p8)
                };
                if (2..=6).contains(&b) && a == 1 && c == 0 && d == 0 {
                    now[(y * w + x) as usize] = false;
                }
            }
        }
        if now == before {
            return now;
        }
    }
}

/// Outlines of areas and how large these are.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Areas {
    /// Where each outline crosses lines between pixels' middles, in order of place; outlines in
    /// the order of their first places.
    pub outlines: Vec<Vec<DVec2>>,
    /// Area within, without holes, square pixels.
    pub area: f64,
}

/// What is inside of the softened marks (1 2 1 across and down) where they are a half or more, cell
/// by cell between four pixels; beyond the picture nothing is.
#[must_use]
pub fn areas(marks: &Marks<'_>) -> Areas {
    let [w, h] = marks.size;
    let mark = |x, y| f64::from(u8::from(marks.get(x, y)));
    let across = |x, y| 0.25 * (mark(x - 1, y) + 2.0 * mark(x, y) + mark(x + 1, y));
    let value = |x: i64, y: i64| {
        if x < 0 || y < 0 || x >= w || y >= h {
            return -0.5;
        }
        0.25 * (across(x, y - 1) + 2.0 * across(x, y) + across(x, y + 1)) - 0.5 + 1e-4
    };
    let middle = |(x, y): (i64, i64)| DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
    // Crossings by the two pixels that they lie between, and which hang together.
    let mut crossings: BTreeMap<[(i64, i64); 2], (usize, DVec2)> = BTreeMap::new();
    let mut joined = Vec::new();
    let mut area = 0.0;
    for (x, y) in (-1..h).flat_map(|y| (-1..w).map(move |x| (x, y))) {
        let corners = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)];
        let values = corners.map(|(x, y)| value(x, y));
        let mean = values.iter().sum::<f64>();
        // Corners and crossings in their order round the cell, the crossings with their numbers.
        let mut round: Vec<(DVec2, Option<usize>)> = Vec::new();
        for k in 0..4 {
            let (p, q, a, b) = (
                corners[k],
                corners[(k + 1) % 4],
                values[k],
                values[(k + 1) % 4],
            );
            if a > 0.0 {
                round.push((middle(p), None));
            }
            if (a > 0.0) != (b > 0.0) {
                let number = crossings.len();
                let at = middle(p) + (middle(q) - middle(p)) * (a / (a - b));
                let entry = crossings.entry([p.min(q), p.max(q)]);
                round.push((at, Some(entry.or_insert((number, at)).0)));
            }
        }
        let parts = if round.len() == 6 && round.iter().filter(|r| r.1.is_some()).count() == 4 {
            saddle(&round, mean > 0.0, &mut joined)
        } else {
            let numbers: Vec<usize> = round.iter().filter_map(|r| r.1).collect();
            joined.extend(numbers.chunks_exact(2).map(|n| [n[0], n[1]]));
            vec![round.iter().map(|r| r.0).collect()]
        };
        area += parts.iter().map(|p| shoelace(p)).sum::<f64>();
    }
    let mut linked = Linked::new(crossings.len());
    for [a, b] in joined {
        linked.join(a, b);
    }
    let mut places = vec![DVec2::ZERO; crossings.len()];
    for (number, at) in crossings.into_values() {
        places[number] = at;
    }
    let whole = |group: Vec<usize>| in_order(group.into_iter().map(|n| places[n]).collect());
    let mut outlines: Vec<Vec<DVec2>> = linked.groups().into_iter().map(whole).collect();
    outlines.sort_by(|a, b| place_order(&a[0], &b[0]));
    Areas { outlines, area }
}

/// Two opposite corners: one part where the mean of all is inside, two where it is not.
fn saddle(
    round: &[(DVec2, Option<usize>)],
    one: bool,
    joined: &mut Vec<[usize; 2]>,
) -> Vec<Vec<DVec2>> {
    // Each corner stands between its two crossings.
    let corner = |k: usize| (k + round.len() - 1) % round.len();
    let corners: Vec<usize> = (0..6).filter(|&k| round[k].1.is_none()).collect();
    let beside = |k: usize| [round[corner(k)], round[(k + 1) % 6]];
    let numbers = |k: usize| beside(k).map(|r| r.1.unwrap_or(0));
    let [[a, b], [c, d]] = [numbers(corners[0]), numbers(corners[1])];
    if one {
        joined.extend([[b, c], [d, a]]);
        return vec![round.iter().map(|r| r.0).collect()];
    }
    joined.extend([[a, b], [c, d]]);
    let part = |k: usize| {
        let [a, b] = beside(k).map(|r| r.0);
        vec![a, round[k].0, b]
    };
    corners.into_iter().map(part).collect()
}

fn shoelace(points: &[DVec2]) -> f64 {
    let next = points.iter().cycle().skip(1);
    0.5 * points
        .iter()
        .zip(next)
        .map(|(a, b)| a.perp_dot(*b))
        .sum::<f64>()
}

/// By place: from above, then from the left. What differs by roundings is equal.
#[must_use]
pub fn place_order(a: &DVec2, b: &DVec2) -> std::cmp::Ordering {
    let [a, b] = [a, b].map(|p| (*p * 1e6).round());
    a.y.total_cmp(&b.y).then(a.x.total_cmp(&b.x))
}

/// Places of an outline from above, then from the left.
#[must_use]
pub fn in_order(mut places: Vec<DVec2>) -> Vec<DVec2> {
    places.sort_by(place_order);
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marks(rows: &[&str]) -> ([i64; 2], Vec<bool>) {
        let marked = rows.iter().flat_map(|r| r.bytes().map(|b| b == b'#'));
        ([rows[0].len() as i64, rows.len() as i64], marked.collect())
    }

    #[test]
    fn lines_rings_and_dots_are_told_apart() {
        let (size, marked) = marks(&[
            "##......##.",
            "..##...#..#",
            "....#..#..#",
            "........##.",
            ".#.........",
        ]);
        let marked = Marks {
            size,
            marked: &marked,
        };
        let mut found: Vec<_> = lines(&marked).iter().map(|l| (l.0.len(), l.1)).collect();
        found.sort_unstable();
        assert_eq!(found, [(1, false), (4, false), (8, true)]);
        let (size, cross) = marks(&[".#.", "###", ".#."]);
        let cross = Marks {
            size,
            marked: &cross,
        };
        assert_eq!(lines(&cross).len(), 4);
    }

    #[test]
    fn a_square_with_a_hole_has_two_outlines() {
        let row = |y: i32| {
            let within = |a: i32, b: i32, x: i32| (a..b).contains(&x) && (a..b).contains(&y);
            let mark = |x: i32| within(2, 14, x) && !within(6, 10, x);
            (0..16).map(|x| if mark(x) { '#' } else { '.' }).collect()
        };
        let rows: Vec<String> = (0..16).map(row).collect();
        let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
        let (size, marked) = marks(&rows);
        let found = areas(&Marks {
            size,
            marked: &marked,
        });
        assert_eq!(found.outlines.len(), 2);
        assert!((found.area - 128.0).abs() < 2.0, "{}", found.area);
    }

    #[test]
    fn a_bar_becomes_a_line() {
        let (size, bar) = marks(&["#######", "#######", "#######"]);
        let thin = thinned(&Marks { size, marked: &bar });
        let kept: Vec<usize> = (0..21).filter(|&i| thin[i]).collect();
        assert!(kept.iter().all(|i| i / 7 == 1), "{kept:?}");
        assert!(kept.len() >= 3, "{kept:?}");
    }
}
