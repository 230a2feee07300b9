//! Outlines of primitives as vectors (Deussen and Strothotte 2000, section 3.4, second algorithm):
//! every primitive's own outline is followed in the index buffer, and those parts are lines where
//! the primitive is seen and the depth leaps. The curve is the primitive's, not the pixels'.

use glam::DVec2;

use super::curve::Polyline;

/// What the device found.
#[derive(Debug, Clone, Copy)]
pub struct Seen<'a> {
    /// Pixels across and down.
    pub size: [usize; 2],
    /// Number of the primitive in each pixel; 0: none of them.
    pub primitive: &'a [u32],
    /// Strength of the contour in each pixel, 0 where there is none.
    pub contour: &'a [f32],
}

impl Seen<'_> {
    fn at(&self, p: DVec2) -> Option<usize> {
        let [w, h] = self.size;
        let inside = p.x >= 0.0 && p.y >= 0.0 && p.x < w as f64 && p.y < h as f64;
        inside.then(|| p.y as usize * w + p.x as usize)
    }

    /// Whether the outline that passes `p` is a line there: a pixel of the primitive just inside
    /// is a contour.
    fn draws(&self, number: u32, p: DVec2, inward: DVec2) -> bool {
        INSIDE.iter().any(|&d| {
            let pixel = self.at(p + d * inward);
            pixel.is_some_and(|i| self.primitive[i] == number && self.contour[i] > 0.0)
        })
    }
}

/// Pixels inwards at which the outline's own pixels are looked for.
const INSIDE: [f64; 3] = [0.35, 0.7, 1.1];
/// Distance of the points in which an outline is followed, pixels.
const STEP: f64 = 0.5;
/// Shorter gaps are closed, pixels: where two primitives meet a pixel belongs to one of them.
const GAP: f64 = 2.5;

/// Lines of one primitive's closed outline (pixels, either way round): whole if all of it is drawn,
/// none shorter than `shortest` (pixels).
#[must_use]
pub fn lines(seen: &Seen<'_>, number: u32, outline: &[DVec2], shortest: f64) -> Vec<Polyline> {
    let points = followed(outline);
    let count = points.len();
    if count < 8 {
        return Vec::new();
    }
    let turn: f64 = (0..count)
        .map(|i| points[i].perp_dot(points[(i + 1) % count]))
        .sum();
    let drawn: Vec<bool> = (0..count)
        .map(|i| {
            let along = points[(i + 1) % count] - points[(i + count - 1) % count];
            let inward = along.perp().normalize_or_zero() * turn.signum();
            seen.draws(number, points[i], inward)
        })
        .collect();
    let drawn = without_gaps(drawn, &points);
    let mut found = runs_of(&points, &drawn, true);
    found.retain(|l| l.points.len() > 1 && l.length() >= shortest);
    found
}

/// Numbers of the leaves that pixels show, from the lowest.
pub(super) fn shown(numbers: &[u32], leaves: usize) -> Vec<u32> {
    let mut seen = vec![false; leaves + 1];
    for &number in numbers {
        // Of the ground only the shadow is drawn.
        if let Some(seen) = seen.get_mut(number as usize) {
            *seen = true;
        }
    }
    (1..=leaves as u32).filter(|&n| seen[n as usize]).collect()
}

/// Points `STEP` apart round the outline.
fn followed(outline: &[DVec2]) -> Vec<DVec2> {
    let count = outline.len();
    let mut out = Vec::new();
    for (i, &a) in outline.iter().enumerate() {
        let b = outline[(i + 1) % count];
        let length = a.distance(b);
        if !length.is_finite() {
            return Vec::new();
        }
        let pieces = (length / STEP).ceil().clamp(1.0, 1e5) as u32;
        out.extend((0..pieces).map(|k| a.lerp(b, f64::from(k) / f64::from(pieces))));
    }
    out
}

/// The flags of a ring of points where short gaps between drawn ones are drawn too.
fn without_gaps(mut flags: Vec<bool>, points: &[DVec2]) -> Vec<bool> {
    let count = flags.len();
    // Starts right after a change, so that no gap is cut by the seam.
    let Some(first) = (0..count).find(|&i| flags[i] && !flags[(i + count - 1) % count]) else {
        return flags;
    };
    let at = |k: usize| (first + k) % count;
    let mut k = 0;
    while k < count {
        let end = (k..count).find(|&e| flags[at(e)]).unwrap_or(count);
        // From the last point before the gap to the first behind it.
        let way: f64 = (k..=end)
            .map(|e| points[at(e + count - 1)].distance(points[at(e)]))
            .sum();
        if end > k && way < GAP {
            (k..end).for_each(|e| flags[at(e)] = true);
        }
        k = end + 1;
    }
    flags
}

/// The points of each run of flags along a line; a whole ring stays a ring.
#[must_use]
pub fn runs_of(points: &[DVec2], keeps: &[bool], closed: bool) -> Vec<Polyline> {
    let count = points.len();
    if keeps.iter().all(|&k| k) {
        return vec![Polyline {
            points: points.to_vec(),
            closed,
        }];
    }
    let before = |i: usize| {
        if closed || i > 0 {
            keeps[(i + count - 1) % count]
        } else {
            false
        }
    };
    let starts = (0..count).filter(|&i| keeps[i] && !before(i));
    starts
        .map(|start| {
            let end = if closed { start + count } else { count };
            Polyline {
                points: (start..end)
                    .take_while(|i| keeps[i % count])
                    .map(|i| points[i % count])
                    .collect(),
                closed: false,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [usize; 2] = [160, 120];

    struct Disc {
        centre: DVec2,
        radius: f64,
        depth: f64,
    }

    fn circle(disc: &Disc) -> Vec<DVec2> {
        let at = |k: u32| {
            disc.centre
                + disc.radius * DVec2::from_angle(f64::from(k) * std::f64::consts::TAU / 96.0)
        };
        (0..96).map(at).collect()
    }

    /// Primitive and contour of discs by their definition.
    fn draw(discs: &[Disc], threshold: f64) -> (Vec<u32>, Vec<f32>) {
        let [w, h] = SIZE;
        let mut depth = vec![f64::INFINITY; w * h];
        let mut primitive = vec![0; w * h];
        for (number, d) in (1..).zip(discs) {
            for i in 0..w * h {
                let p = DVec2::new((i % w) as f64 + 0.5, (i / w) as f64 + 0.5);
                if p.distance(d.centre) < d.radius && d.depth < depth[i] {
                    (depth[i], primitive[i]) = (d.depth, number);
                }
            }
        }
        let farther = |i: usize| {
            let (x, y) = ((i % w) as i64, (i / w) as i64);
            (0..9).any(|k| {
                let (qx, qy) = (x + k % 3 - 1, y + k / 3 - 1);
                let q = qy.clamp(0, h as i64 - 1) * w as i64 + qx.clamp(0, w as i64 - 1);
                depth[i] < f64::INFINITY && depth[q as usize] - depth[i] > threshold
            })
        };
        let contour = (0..w * h)
            .map(|i| if farther(i) { 1.0 } else { 0.0 })
            .collect();
        (primitive, contour)
    }

    fn scattered(count: usize) -> Vec<Disc> {
        let mut state = 5_u32;
        let mut number = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / 16_777_216.0
        };
        (0..count)
            .map(|_| Disc {
                centre: DVec2::new(25.0 + 110.0 * number(), 25.0 + 70.0 * number()),
                radius: 6.0 + 14.0 * number(),
                depth: number(),
            })
            .collect()
    }

    #[test]
    fn a_disc_that_nothing_hides_is_one_closed_line() {
        let discs = scattered(1);
        let (primitive, contour) = draw(&discs, 0.01);
        let seen = Seen {
            size: SIZE,
            primitive: &primitive,
            contour: &contour,
        };
        let found = lines(&seen, 1, &circle(&discs[0]), 3.0);
        assert_eq!(found.len(), 1);
        assert!(found[0].closed);
    }

    #[test]
    fn what_is_drawn_is_what_is_seen_of_the_outlines_and_leaps_in_depth() {
        let discs = scattered(40);
        let (primitive, contour) = draw(&discs, 0.1);
        let seen = Seen {
            size: SIZE,
            primitive: &primitive,
            contour: &contour,
        };
        let (mut right, mut wrong, mut missed) = (0, 0, 0);
        let (mut pieces, mut arcs) = (0, 0);
        for (i, d) in discs.iter().enumerate() {
            let found = lines(&seen, i as u32 + 1, &circle(d), 3.0);
            pieces += found.len();
            // Truth: a point of the circle is seen where no nearer disc covers it, and is a line
            // where the nearest of what lies behind it just outside is farther by the threshold.
            let truth = |p: DVec2, slack: f64| {
                let out = p + (p - d.centre).normalize() * 0.7;
                let hidden = discs
                    .iter()
                    .any(|o| o.depth < d.depth && p.distance(o.centre) < o.radius - slack);
                let behind = discs
                    .iter()
                    .filter(|o| out.distance(o.centre) < o.radius)
                    .map(|o| o.depth);
                !hidden && behind.fold(f64::INFINITY, f64::min) - d.depth > 0.1
            };
            let ring: Vec<bool> = circle(d).iter().map(|&p| truth(p, 0.0)).collect();
            arcs += (0..96).filter(|&k| ring[k] && !ring[(k + 95) % 96]).count()
                + usize::from(ring.iter().all(|&r| r));
            let on_lines: Vec<DVec2> = found
                .iter()
                .flat_map(|l| l.points.iter().copied())
                .collect();
            for &p in &on_lines {
                let near = (-6..=6).any(|k| {
                    let a = (p - d.centre).to_angle() + f64::from(k) * 0.25 / d.radius;
                    truth(d.centre + d.radius * DVec2::from_angle(a), 0.5)
                });
                if near { right += 1 } else { wrong += 1 }
            }
            for (p, t) in circle(d).into_iter().zip(ring) {
                let found = on_lines.iter().any(|q| q.distance(p) < 1.5);
                missed += u32::from(t && !found);
            }
        }
        println!("right {right} wrong {wrong} missed {missed} pieces {pieces} arcs {arcs}");
        assert!(f64::from(wrong) < 0.01 * f64::from(right));
        assert!(f64::from(missed) < 0.02 * f64::from(right));
        assert!(f64::from(pieces as u32) <= 1.1 * f64::from(arcs as u32));
    }

    #[test]
    fn outlines_outside_the_picture_or_without_size_give_nothing() {
        let (primitive, contour) = draw(&[], 0.1);
        let seen = Seen {
            size: SIZE,
            primitive: &primitive,
            contour: &contour,
        };
        for outline in [
            vec![],
            vec![DVec2::ONE; 5],
            vec![
                DVec2::splat(-500.0),
                DVec2::new(-400.0, -500.0),
                DVec2::new(-450.0, -400.0),
            ],
            vec![DVec2::NAN; 9],
        ] {
            assert!(lines(&seen, 1, &outline, 3.0).is_empty());
        }
    }
}
