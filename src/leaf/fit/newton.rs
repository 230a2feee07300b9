//! One colour: the slab that reflects R and transmits T.
//!
//! There is exactly one for every R > 0, T > 0, R + T < 1: reflectance grows with albedo and
//! thickness, transmittance with the albedo and falls with the thickness, so the map is one to
//! one (Gale and Nikaido 1965). Newton's method finds it in `(logit omega, ln Delta)` on
//! `(logit R, logit T)`, where the map is nearly linear.

use std::sync::LazyLock;

use crate::leaf::slab_table::{Share, SlabTable};

/// Least reflectance and transmittance, and least absorbed share, of what is fitted.
pub const FLOOR: f64 = 1e-3;
/// Largest difference in `logit R` and `logit T` that counts as solved.
const TOLERANCE: f64 = 1e-9;
/// Newton steps at most; from the nearest cell of the coarse table 4 or 5 are usual.
const STEPS: usize = 60;
/// Range of `logit omega` and `ln Delta` in which a slab is looked for.
const U: [f64; 2] = [-25.0, 30.0];
const V: [f64; 2] = [-16.0, 12.0];

/// A homogeneous slab.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slab {
    /// Scattering albedo.
    pub omega: f64,
    /// Optical thickness.
    pub delta: f64,
}

/// What Newton's method found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution {
    /// The slab.
    pub slab: Slab,
    /// Steps taken.
    pub steps: usize,
    /// Largest difference in `logit R` and `logit T`.
    pub residual: f64,
}

/// Moves a measured pair into the range of the model: at least [`FLOOR`] each, and at most
/// 1 - [`FLOOR`] together; says whether it had to.
#[must_use]
pub fn clamp(r: f64, t: f64) -> (Share, bool) {
    // NaN becomes the floor.
    let floor = |x: f64| if x > FLOOR { x.min(1e3) } else { FLOOR };
    let (mut cr, mut ct) = (floor(r), floor(t));
    let sum = cr + ct;
    if sum > 1.0 - FLOOR {
        let keep = (1.0 - 3.0 * FLOOR) / (sum - 2.0 * FLOOR);
        (cr, ct) = (FLOOR + (cr - FLOOR) * keep, FLOOR + (ct - FLOOR) * keep);
    }
    let moved = (cr, ct) != (r, t);
    (Share { r: cr, t: ct }, moved)
}

/// The slab of a pair in the range of the model.
#[must_use]
pub fn invert(target: Share) -> Slab {
    solve(target).slab
}

/// The slab of a pair in the range of the model, and how it was found.
#[must_use]
pub fn solve(target: Share) -> Solution {
    let wanted = logits(target);
    let mut at = start(wanted);
    let mut here = residual(at, wanted);
    let mut steps = 0;
    while steps < STEPS && size(here) > TOLERANCE {
        steps += 1;
        let step = newton_step(at, here);
        let mut share = 1.0;
        let next = loop {
            let tried = [
                (at[0] + share * step[0]).clamp(U[0], U[1]),
                (at[1] + share * step[1]).clamp(V[0], V[1]),
            ];
            let error = residual(tried, wanted);
            if norm(error) < norm(here) {
                break Some((tried, error));
            }
            share *= 0.5;
            if share < 1e-4 {
                break None;
            }
        };
        // Nothing nearer: as good as the table's numbers allow.
        let Some(next) = next else { break };
        (at, here) = next;
    }
    Solution {
        slab: slab_at(at),
        steps,
        residual: size(here),
    }
}

fn slab_at([u, v]: [f64; 2]) -> Slab {
    Slab {
        omega: 1.0 / (1.0 + (-u).exp()),
        delta: v.exp(),
    }
}

fn logit(x: f64) -> f64 {
    let x = x.clamp(1e-300, 1.0 - 1e-16);
    (x / (1.0 - x)).ln()
}

fn logits(s: Share) -> [f64; 2] {
    [logit(s.r), logit(s.t)]
}

fn residual(at: [f64; 2], wanted: [f64; 2]) -> [f64; 2] {
    let slab = slab_at(at);
    let found = logits(SlabTable::shared().share(slab.omega, slab.delta));
    [found[0] - wanted[0], found[1] - wanted[1]]
}

fn size(r: [f64; 2]) -> f64 {
    r[0].abs().max(r[1].abs())
}

fn norm(r: [f64; 2]) -> f64 {
    r[0] * r[0] + r[1] * r[1]
}

/// The step that would end at once if the map were linear, limited to a decade or so.
fn newton_step(at: [f64; 2], here: [f64; 2]) -> [f64; 2] {
    let [[a, b], [c, d]] = jacobian(at);
    let determinant = a * d - b * c;
    let step = if determinant.abs() > 1e-30 {
        [
            -(d * here[0] - b * here[1]) / determinant,
            -(a * here[1] - c * here[0]) / determinant,
        ]
    } else {
        [-here[0], -here[1]]
    };
    let longest = (step[0] / 3.0).abs().max((step[1] / 1.5).abs());
    step.map(|s| if longest > 1.0 { s / longest } else { s })
}

/// Slopes of `logit R` and `logit T` by `logit omega` and `ln Delta`.
fn jacobian(at: [f64; 2]) -> [[f64; 2]; 2] {
    let Slab { omega, delta } = slab_at(at);
    let column = SlabTable::shared().at(omega);
    let Some([la, lb]) = column.slopes(at[1]) else {
        return differences(at);
    };
    let (a, b) = column.read(delta);
    let r = 0.5 * omega * a;
    let scattered = 0.5 * omega * b;
    let direct = (-delta).exp();
    let t = direct + scattered;
    let spread = 1.0 - omega;
    let by_u = |slope: f64| spread * (1.0 + omega * slope);
    [
        [by_u(la[0]) / (1.0 - r), la[1] / (1.0 - r)],
        [
            scattered * by_u(lb[0]) / (t * (1.0 - t)),
            (scattered * lb[1] - delta * direct) / (t * (1.0 - t)),
        ],
    ]
}

/// The same by differences, outside of the table.
fn differences(at: [f64; 2]) -> [[f64; 2]; 2] {
    const H: f64 = 1e-5;
    let along = |du: f64, dv: f64| {
        let a = residual([at[0] + du, at[1] + dv], [0.0; 2]);
        let b = residual([at[0] - du, at[1] - dv], [0.0; 2]);
        [(a[0] - b[0]) / (2.0 * H), (a[1] - b[1]) / (2.0 * H)]
    };
    let (by_u, by_v) = (along(H, 0.0), along(0.0, H));
    [[by_u[0], by_v[0]], [by_u[1], by_v[1]]]
}

/// Cells per unit of logit, and half the side, of the table of starts.
const PER_LOGIT: f64 = 4.0;
const HALF: usize = 32;
const SIDE: usize = 2 * HALF + 1;

/// For cells of `(logit R, logit T)`: the nearest slab of a coarse grid.
static STARTS: LazyLock<Vec<[f64; 2]>> = LazyLock::new(|| {
    let coarse: Vec<([f64; 2], [f64; 2])> = (0..31)
        .flat_map(|i| (0..33).map(move |j| [-6.0 + 0.5 * f64::from(i), -5.0 + 0.3 * f64::from(j)]))
        .map(|at| (at, residual(at, [0.0; 2])))
        .collect();
    (0..SIDE * SIDE)
        .map(|cell| {
            let centre = [cell % SIDE, cell / SIDE].map(|i| (i as f64 - HALF as f64) / PER_LOGIT);
            let far = |found: &[f64; 2]| norm([found[0] - centre[0], found[1] - centre[1]]);
            coarse
                .iter()
                .min_by(|a, b| far(&a.1).total_cmp(&far(&b.1)))
                .expect("the grid has slabs")
                .0
        })
        .collect()
});

fn start(wanted: [f64; 2]) -> [f64; 2] {
    let [i, j] = wanted.map(|w| {
        let place = (w * PER_LOGIT).round() + HALF as f64;
        place.clamp(0.0, (SIDE - 1) as f64) as usize
    });
    STARTS[j * SIDE + i]
}
