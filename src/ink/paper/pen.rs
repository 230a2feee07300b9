//! Line styles (Deussen and Strothotte 2000, section 3.4): width along a line, ends, an unsteady
//! hand. All lengths in millimetres of paper.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::curve::Polyline;

/// How a pen draws a line.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Pen {
    /// Width in the middle, 0.01 to 20.
    pub width: f64,
    /// Share of the width at the ends, 0 (pointed) to 1.
    pub ends: f64,
    /// Length over which the width grows from the ends, 0 to 1000; at most half the line.
    pub taper: f64,
    /// Way that a line goes on beyond its ends, 0 to 20.
    pub overshoot: f64,
    /// Largest sideways step of the hand, 0 to 10.
    pub tremor: f64,
    /// Way along the line from one such step to the next, 0.1 to 1000.
    pub wavelength: f64,
    /// Share of the width that open lines lose from their start to their end, 0 to 1: set down
    /// firmly, lifted slowly.
    pub lift: f64,
    /// Where open lines start.
    pub start: Start,
    /// Colour of its ink, sRGB, 0 to 1; none: the sheet's.
    pub colour: Option<[f32; 3]>,
}

/// Which end of an open line is drawn first.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    /// As it was found.
    #[default]
    Any,
    /// The upper one.
    Top,
    /// The left one.
    Left,
}

impl Start {
    /// Whether a line from `first` to `last` is to be turned round.
    fn turns(self, first: DVec2, last: DVec2) -> bool {
        match self {
            Self::Any => false,
            Self::Top => first.y > last.y,
            Self::Left => first.x > last.x,
        }
    }
}

impl Default for Pen {
    fn default() -> Self {
        Self {
            width: 0.3,
            ends: 1.0,
            taper: 2.0,
            overshoot: 0.0,
            tremor: 0.0,
            wavelength: 4.0,
            lift: 0.0,
            start: Start::Any,
            colour: None,
        }
    }
}

/// A drawn line: where the pen goes, and its width at each point.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Stroke {
    /// Way of the pen.
    pub line: Polyline,
    /// Width at each point.
    pub widths: Vec<f64>,
    /// Number of the primitive whose line it is.
    pub primitive: Option<u32>,
}

impl Stroke {
    /// Whether all widths are the same.
    #[must_use]
    pub fn is_even(&self) -> bool {
        self.widths.windows(2).all(|w| (w[0] - w[1]).abs() < 1e-6)
    }
}

impl Pen {
    /// The line as this pen draws it. `seed` chooses the unsteadiness: the same for one primitive in
    /// every frame. `pressure` multiplies the width at a place.
    #[must_use]
    pub fn draw(&self, line: &Polyline, seed: u32, pressure: impl Fn(DVec2) -> f64) -> Stroke {
        self.drawn(
            line,
            |points| self.shake(points, line.closed, seed),
            pressure,
        )
    }

    /// As [`Pen::draw`], with an unsteadiness (-1 to 1) that `hand` tells for each place: parts of
    /// a line are drawn as they are in the whole.
    #[must_use]
    pub fn draw_over(
        &self,
        line: &Polyline,
        hand: impl Fn(DVec2) -> f64,
        pressure: impl Fn(DVec2) -> f64,
    ) -> Stroke {
        let lean = |points: &mut [DVec2]| {
            let whole = points.to_vec();
            for (i, point) in points.iter_mut().enumerate() {
                *point += sideways(&whole, i, line.closed) * self.tremor * hand(whole[i]);
            }
        };
        self.drawn(line, lean, pressure)
    }

    fn drawn(
        &self,
        line: &Polyline,
        shake: impl Fn(&mut [DVec2]),
        pressure: impl Fn(DVec2) -> f64,
    ) -> Stroke {
        let mut points = line.points.clone();
        if let ([first, .., last], false) = (points.as_slice(), line.closed)
            && self.start.turns(*first, *last)
        {
            points.reverse();
        }
        if !line.closed && self.overshoot > 0.0 {
            extend(&mut points, self.overshoot);
        }
        if self.tremor > 0.0 && points.len() > 2 {
            shake(&mut points);
        }
        let line = Polyline {
            points,
            closed: line.closed,
        };
        let length = line.length();
        let reach = self.taper.min(0.5 * length);
        let mut along = 0.0;
        let mut before = line.points.first().copied().unwrap_or_default();
        let widths = line.points.iter().map(|&p| {
            along += p.distance(before);
            before = p;
            let from_end = along.min(length - along);
            let share = if line.closed || reach <= 0.0 || from_end >= reach {
                1.0
            } else {
                let t = (from_end / reach).clamp(0.0, 1.0);
                self.ends + (1.0 - self.ends) * t * (2.0 - t)
            };
            let lifted = if line.closed || length <= 0.0 {
                1.0
            } else {
                1.0 - self.lift * along / length
            };
            self.width * share * lifted * pressure(p).max(0.0)
        });
        Stroke {
            widths: widths.collect(),
            line,
            primitive: None,
        }
    }

    /// Moves the points sideways by smooth noise along the line.
    fn shake(&self, points: &mut [DVec2], closed: bool, seed: u32) {
        let count = points.len();
        if count < 3 {
            return;
        }
        let whole = Polyline {
            points: points.to_vec(),
            closed,
        };
        // On a ring a whole number of waves, so that it closes.
        let waves = (whole.length() / self.wavelength.max(1e-6)).max(1.0);
        let waves = if closed { waves.round() } else { waves };
        let total = whole.length().max(f64::MIN_POSITIVE);
        let mut along = 0.0;
        for (i, point) in points.iter_mut().enumerate() {
            if i > 0 {
                along += whole.points[i].distance(whole.points[i - 1]);
            }
            let side = sideways(&whole.points, i, closed);
            let at = waves * along / total;
            let period = closed.then_some(waves as u32);
            *point += side * self.tremor * noise(at, period, seed);
        }
    }
}

/// Unit vector across a line at its point `i`.
fn sideways(points: &[DVec2], i: usize, closed: bool) -> DVec2 {
    let count = points.len();
    let (before, after) = if closed {
        ((i + count - 1) % count, (i + 1) % count)
    } else {
        (i.saturating_sub(1), (i + 1).min(count - 1))
    };
    (points[after] - points[before]).perp().normalize_or_zero()
}

/// Moves the ends on along their directions.
fn extend(points: &mut [DVec2], way: f64) {
    let count = points.len();
    if count < 2 {
        return;
    }
    let first = (points[0] - points[1]).normalize_or_zero();
    let last = (points[count - 1] - points[count - 2]).normalize_or_zero();
    points[0] += way * first;
    points[count - 1] += way * last;
}

/// Smooth noise of one coordinate, -1 to 1; it comes again after `period`.
#[must_use]
pub fn noise(at: f64, period: Option<u32>, seed: u32) -> f64 {
    let floor = at.floor();
    let t = at - floor;
    let value = |k: f64| {
        let k = k as i64 as u32;
        let k = period.map_or(k, |p| k % p.max(1));
        let mut x = k.wrapping_mul(0x9e37_79b9) ^ seed.wrapping_mul(0x85eb_ca6b);
        x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
        x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
        f64::from((x ^ (x >> 16)) >> 8) / 8_388_608.0 - 1.0
    };
    let smooth = t * t * (3.0 - 2.0 * t);
    value(floor) + (value(floor + 1.0) - value(floor)) * smooth
}

/// The outline of a stroke of varying width, to be filled (rule: not zero): both sides of an open
/// one, and of a ring an outer and an inner line.
#[must_use]
pub fn filled(stroke: &Stroke) -> Vec<Polyline> {
    let points = &stroke.line.points;
    let count = points.len();
    if count < 2 {
        return Vec::new();
    }
    let closed = stroke.line.closed;
    let side = |i: usize| {
        let (a, b) = if closed {
            (points[(i + count - 1) % count], points[(i + 1) % count])
        } else {
            (points[i.saturating_sub(1)], points[(i + 1).min(count - 1)])
        };
        (b - a).perp().normalize_or_zero() * 0.5 * stroke.widths[i]
    };
    let left = (0..count).map(|i| points[i] + side(i));
    let right = (0..count).rev().map(|i| points[i] - side(i));
    if closed {
        // The inner line runs the other way round, so that the ring has a hole.
        return [left.collect(), right.collect()]
            .map(|points| Polyline {
                points,
                closed: true,
            })
            .into();
    }
    let cap = |i: usize, sign: f64| {
        let across = side(i) * sign;
        (1..4).map(move |k| {
            points[i]
                + DVec2::from_angle(-f64::from(k) * std::f64::consts::FRAC_PI_4).rotate(across)
        })
    };
    let points = left
        .chain(cap(count - 1, 1.0))
        .chain(right)
        .chain(cap(0, -1.0))
        .collect();
    vec![Polyline {
        points,
        closed: true,
    }]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn straight() -> Polyline {
        Polyline {
            points: (0..=100)
                .map(|k| DVec2::new(f64::from(k) * 0.2, 0.0))
                .collect(),
            closed: false,
        }
    }

    fn ring() -> Polyline {
        let at = |k: u32| 5.0 * DVec2::from_angle(std::f64::consts::TAU * f64::from(k) / 200.0);
        Polyline {
            points: (0..200).map(at).collect(),
            closed: true,
        }
    }

    #[test]
    fn ends_are_pointed_and_the_middle_is_as_wide_as_the_pen() {
        let pen = Pen {
            ends: 0.2,
            taper: 3.0,
            width: 0.5,
            ..Pen::default()
        };
        let stroke = pen.draw(&straight(), 1, |_| 1.0);
        assert!((stroke.widths[0] - 0.1).abs() < 1e-9);
        assert!((stroke.widths[100] - 0.1).abs() < 1e-9);
        assert!((stroke.widths[50] - 0.5).abs() < 1e-9);
        assert!(stroke.widths[..15].windows(2).all(|w| w[0] <= w[1]));
        let rings = pen.draw(&ring(), 1, |_| 1.0);
        assert!(rings.is_even(), "a ring has no ends");
    }

    #[test]
    fn a_line_starts_where_the_pen_says_and_is_lifted_towards_its_end() {
        let pen = Pen {
            start: Start::Left,
            lift: 0.5,
            ..Pen::default()
        };
        let mut line = straight();
        line.points.reverse();
        let stroke = pen.draw(&line, 1, |_| 1.0);
        assert_eq!(stroke.line.points[0], DVec2::ZERO);
        assert!((stroke.widths[0] - 0.3).abs() < 1e-9);
        assert!((stroke.widths[50] - 0.225).abs() < 1e-9);
        assert!((stroke.widths[100] - 0.15).abs() < 1e-9);
        let rings = pen.draw(&ring(), 1, |_| 1.0);
        assert!(
            rings.is_even() && rings.line == ring(),
            "a ring has no ends"
        );
    }

    #[test]
    fn parts_of_a_line_are_drawn_as_they_are_in_the_whole() {
        let pen = Pen {
            tremor: 0.3,
            ..Pen::default()
        };
        let hand = |p: DVec2| noise(p.x, None, 5);
        let whole = pen.draw_over(&straight(), hand, |_| 1.0);
        let part = Polyline {
            points: straight().points[30..70].to_vec(),
            closed: false,
        };
        let part = pen.draw_over(&part, hand, |_| 1.0);
        assert_eq!(part.line.points, whole.line.points[30..70]);
        assert!(whole.line.points.iter().any(|p| p.y.abs() > 0.1));
    }

    #[test]
    fn an_unsteady_hand_stays_within_its_tremor_and_repeats_itself() {
        let pen = Pen {
            tremor: 0.3,
            ..Pen::default()
        };
        for line in [straight(), ring()] {
            let a = pen.draw(&line, 7, |_| 1.0);
            assert_eq!(a, pen.draw(&line, 7, |_| 1.0));
            assert_ne!(a, pen.draw(&line, 8, |_| 1.0));
            let apart = |(p, q): (&DVec2, &DVec2)| p.distance(*q);
            let most = a
                .line
                .points
                .iter()
                .zip(&line.points)
                .map(apart)
                .fold(0.0, f64::max);
            assert!(most <= 0.3 + 1e-9 && most > 0.1, "{most}");
            let steps = a.line.round().collect::<Vec<_>>();
            assert!(
                steps.windows(2).all(|s| s[0].distance(s[1]) < 0.35),
                "no leaps"
            );
        }
    }

    #[test]
    fn a_filled_stroke_has_the_area_of_its_width_along_its_length() {
        let area = |lines: &[Polyline]| {
            let one = |l: &Polyline| {
                let round: Vec<DVec2> = l.round().collect();
                0.5 * round.windows(2).map(|p| p[0].perp_dot(p[1])).sum::<f64>()
            };
            lines.iter().map(one).sum::<f64>().abs()
        };
        let pen = Pen {
            width: 0.5,
            ..Pen::default()
        };
        let open = filled(&pen.draw(&straight(), 1, |_| 1.0));
        let caps = std::f64::consts::PI * 0.25 * 0.25;
        assert!((area(&open) - 10.0 - caps).abs() < 0.03, "{}", area(&open));
        let round = filled(&pen.draw(&ring(), 1, |_| 1.0));
        assert!(
            (area(&round) - 0.5 * std::f64::consts::TAU * 5.0).abs() < 0.05,
            "{}",
            area(&round)
        );
    }

    #[test]
    fn lines_without_length_are_drawn_without_numbers_that_are_none() {
        let pen = Pen {
            tremor: 0.2,
            overshoot: 0.5,
            ..Pen::default()
        };
        for points in [vec![], vec![DVec2::ONE], vec![DVec2::ONE; 5]] {
            for closed in [false, true] {
                let stroke = pen.draw(
                    &Polyline {
                        points: points.clone(),
                        closed,
                    },
                    1,
                    |_| 1.0,
                );
                assert!(stroke.line.points.iter().all(|p| p.is_finite()));
                assert!(stroke.widths.iter().all(|w| w.is_finite()));
                assert!(
                    filled(&stroke)
                        .iter()
                        .all(|l| l.points.iter().all(|p| p.is_finite()))
                );
            }
        }
    }
}
