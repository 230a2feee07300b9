//! Areas: the outlines of marked pixels, to be filled; and, for pens, the lines that fill them.

use glam::DVec2;

use super::curve::Polyline;

/// Closed outlines of the marked pixels (marching squares over the marks, softened by their eight
/// neighbours), to be filled by the even-odd rule. Areas of fewer than about `least` pixels are
/// left out.
#[must_use]
pub fn outlines(size: [usize; 2], marked: &[bool], least: f64) -> Vec<Polyline> {
    let field = Field::new(size, marked);
    let [w, h] = [size[0] as i64, size[1] as i64];
    // Edges of cells on which the outline goes on, by the edge where it comes in: marks lie to its
    // left.
    let mut next = std::collections::HashMap::new();
    for y in -1..h {
        for x in -1..w {
            field.cell(x, y, &mut next);
        }
    }
    let mut starts: Vec<Edge> = next.keys().copied().collect();
    starts.sort_unstable();
    let mut out = Vec::new();
    for start in starts {
        let mut points = Vec::new();
        let mut at = start;
        while let Some(to) = next.remove(&at) {
            points.push(field.place(at));
            at = to;
        }
        let line = Polyline {
            points,
            closed: true,
        };
        if line.points.len() > 2 && area(&line.points).abs() >= least {
            out.push(line);
        }
    }
    out
}

/// Area within a ring, positive where it runs from x to y.
fn area(points: &[DVec2]) -> f64 {
    let count = points.len();
    0.5 * (0..count)
        .map(|i| points[i].perp_dot(points[(i + 1) % count]))
        .sum::<f64>()
}

/// The edge between a pixel and the next: to the right (`true`) or below.
type Edge = (i64, i64, bool);

/// Values between the marks.
struct Field {
    size: [i64; 2],
    values: Vec<f64>,
}

impl Field {
    fn new([w, h]: [usize; 2], marked: &[bool]) -> Self {
        let size = [w as i64, h as i64];
        let mark = |x: i64, y: i64| {
            let inside = x >= 0 && y >= 0 && x < size[0] && y < size[1];
            f64::from(u8::from(inside && marked[(y * size[0] + x) as usize]))
        };
        let soft = |x: i64, y: i64| {
            let weight = |dx: i64, dy: i64| [4.0, 2.0, 1.0][(dx.abs() + dy.abs()) as usize];
            let near = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy)));
            near.map(|(dx, dy)| weight(dx, dy) * mark(x + dx, y + dy))
                .sum::<f64>()
                / 16.0
        };
        // Halves are none: an outline never passes through the middle of a pixel.
        let values = (0..size[0] * size[1]).map(|i| soft(i % size[0], i / size[0]) - 0.5 + 1e-4);
        Self {
            size,
            values: values.collect(),
        }
    }

    fn get(&self, x: i64, y: i64) -> f64 {
        let inside = x >= 0 && y >= 0 && x < self.size[0] && y < self.size[1];
        if inside {
            self.values[(y * self.size[0] + x) as usize]
        } else {
            -0.5
        }
    }

    /// Where the outline crosses an edge.
    fn place(&self, (x, y, right): Edge) -> DVec2 {
        let (qx, qy) = if right { (x + 1, y) } else { (x, y + 1) };
        let (a, b) = (self.get(x, y), self.get(qx, qy));
        let t = a / (a - b);
        let at = |x: i64, y: i64| DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
        at(x, y).lerp(at(qx, qy), t)
    }

    /// The pieces of outline in the cell between four pixels, from edge to edge.
    fn cell(&self, x: i64, y: i64, next: &mut std::collections::HashMap<Edge, Edge>) {
        let inside =
            [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(dx, dy)| self.get(x + dx, y + dy) > 0.0);
        // Edges of the cell in the order of its corners: above, right, below, left.
        let edges = [
            (x, y, true),
            (x + 1, y, false),
            (x, y + 1, true),
            (x, y, false),
        ];
        // Each run of marked corners gives one piece. At a saddle the mean decides whether two
        // opposite corners hang together.
        let count = inside.iter().filter(|&&i| i).count();
        let saddle = count == 2 && inside[0] == inside[2];
        let joined = saddle && {
            let corners = [(0, 0), (1, 0), (1, 1), (0, 1)];
            corners
                .iter()
                .map(|(dx, dy)| self.get(x + dx, y + dy))
                .sum::<f64>()
                > 0.0
        };
        for k in 0..4 {
            // Into the marks at edge k (from corner k, out, to corner k + 1, in).
            if inside[k] || !inside[(k + 1) % 4] {
                continue;
            }
            let mut last = (k + 1) % 4;
            while inside[(last + 1) % 4] {
                last = (last + 1) % 4;
            }
            let mut exit = last;
            if joined {
                exit = (last + 2) % 4;
            }
            next.insert(edges[exit], edges[k]);
        }
    }
}

/// Lines `spacing` apart in direction `angle` (radians from x) over the marked pixels, as a pen
/// fills them.
#[must_use]
pub fn filling(size: [usize; 2], marked: &[bool], spacing: f64, angle: f64) -> Vec<Polyline> {
    let [w, h] = [size[0] as f64, size[1] as f64];
    let along = DVec2::from_angle(angle);
    let across = along.perp();
    let middle = 0.5 * DVec2::new(w, h);
    let reach = 0.5 * w.hypot(h);
    let inside = |p: DVec2| {
        let within = p.x >= 0.0 && p.y >= 0.0 && p.x < w && p.y < h;
        within && marked[p.y as usize * size[0] + p.x as usize]
    };
    let rows = (reach / spacing.max(0.25)).floor() as i64;
    let steps = (2.0 * reach / 0.5).ceil() as u32;
    let mut out = Vec::new();
    for row in -rows..=rows {
        let start = middle + across * row as f64 * spacing.max(0.25) - along * reach;
        let at = |k: u32| start + along * (0.5 * f64::from(k));
        let mut from: Option<DVec2> = None;
        for k in 0..=steps {
            match (from, inside(at(k))) {
                (None, true) => from = Some(at(k)),
                (Some(begin), false) => {
                    if begin.distance(at(k)) > 1.0 {
                        out.push(Polyline {
                            points: vec![begin, at(k - 1)],
                            closed: false,
                        });
                    }
                    from = None;
                }
                _ => {}
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [usize; 2] = [60, 50];

    fn marks(inside: impl Fn(f64, f64) -> bool) -> Vec<bool> {
        (0..SIZE[0] * SIZE[1])
            .map(|i| inside((i % SIZE[0]) as f64 + 0.5, (i / SIZE[0]) as f64 + 0.5))
            .collect()
    }

    #[test]
    fn a_disc_and_a_ring_have_their_outlines_and_areas() {
        let disc = marks(|x, y| (x - 20.0).hypot(y - 24.0) < 12.0);
        let found = outlines(SIZE, &disc, 4.0);
        assert_eq!(found.len(), 1);
        let truth = std::f64::consts::PI * 144.0;
        assert!((area(&found[0].points).abs() - truth).abs() < 0.02 * truth);
        for p in &found[0].points {
            assert!(
                (p.distance(DVec2::new(20.0, 24.0)) - 12.0).abs() < 0.8,
                "{p}"
            );
        }
        let ring = marks(|x, y| (8.0..16.0).contains(&(x - 28.0).hypot(y - 24.0)));
        let found = outlines(SIZE, &ring, 4.0);
        assert_eq!(found.len(), 2, "outside and hole");
        let signs: Vec<bool> = found.iter().map(|l| area(&l.points) > 0.0).collect();
        assert_ne!(signs[0], signs[1], "the hole runs the other way");
    }

    #[test]
    fn what_touches_the_border_closes_and_specks_go() {
        let left = marks(|x, _| x < 20.0);
        let found = outlines(SIZE, &left, 4.0);
        assert_eq!(found.len(), 1);
        assert!((area(&found[0].points).abs() - 1000.0).abs() < 40.0);
        let dot = marks(|x, y| x as i32 == 30 && y as i32 == 30);
        assert!(outlines(SIZE, &dot, 4.0).is_empty());
        assert!(outlines(SIZE, &marks(|_, _| false), 0.0).is_empty());
        assert!(outlines([0, 0], &[], 0.0).is_empty());
    }

    #[test]
    fn every_pattern_of_pixels_closes() {
        let mut state = 9_u32;
        for _ in 0..50 {
            let noise: Vec<bool> = (0..SIZE[0] * SIZE[1])
                .map(|_| {
                    state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    state >> 31 == 1
                })
                .collect();
            for line in outlines(SIZE, &noise, 0.0) {
                let first = line.points[0];
                let last = line.points[line.points.len() - 1];
                assert!(first.distance(last) < 1.5, "{first} {last}");
            }
        }
    }

    #[test]
    fn a_pen_fills_an_area_at_its_spacing() {
        let disc = marks(|x, y| (x - 30.0).hypot(y - 25.0) < 15.0);
        for (spacing, angle) in [(2.0, 0.0), (1.0, 0.8), (3.0, 1.5)] {
            let total: f64 = filling(SIZE, &disc, spacing, angle)
                .iter()
                .map(Polyline::length)
                .sum();
            let ink = total * spacing;
            let truth = std::f64::consts::PI * 225.0;
            assert!(
                (ink - truth).abs() < 0.08 * truth,
                "{spacing} {angle}: {ink} {truth}"
            );
        }
    }
}
