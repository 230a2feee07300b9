//! Conformance: every kernel against its CPU twin on the device at hand.
//!
//! A case lives in one file per room (`gpu`, `foliage`, `render`); the test suite runs the same
//! cases, so `umbrage conform` and the tests cannot drift apart.

mod foliage;
mod foliage_bins;
mod foliage_ends;
mod foliage_subset;
mod foliage_surface;
mod gloss_rays;
mod gpu;
mod ink;
mod ink_looks;
mod ink_places;
mod lamps;
mod leaf;
mod light;
mod lit;
mod lit_shadow;
mod matrix;
mod modulate;
mod paper;
mod paper_trace;
mod render;
mod skylight;
mod truth;

use crate::Result;
use crate::gpu::Gpu;

/// One comparison of a kernel with its twin.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// Dotted name in the dEQP manner: `foliage.density.two_balls`.
    pub name: &'static str,
    /// Runs kernel and twin and compares.
    pub run: fn(&Gpu) -> Result<Outcome>,
}

/// What a case found.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// Largest error, in the unit that `measure` names.
    pub error: f64,
    /// Largest error that passes.
    pub limit: f64,
    /// What `error` is: `relative density`, `degrees`, `differing triangles`.
    pub measure: &'static str,
}

impl Outcome {
    /// `error` against its limit.
    fn new(error: f64, limit: f64, measure: &'static str) -> Self {
        Self {
            error,
            limit,
            measure,
        }
    }

    /// The largest error of each `got` against its `expected`; NaN when one error is, or when there
    /// are more of one than of the other.
    fn worst<G, E>(
        (got, expected): (&[G], &[E]),
        error: impl Fn(&G, &E) -> f64,
        (limit, measure): (f64, &'static str),
    ) -> Self {
        let mut largest = 0.0f64;
        if got.len() != expected.len() {
            largest = f64::NAN;
        }
        for (g, e) in got.iter().zip(expected) {
            let one = error(g, e);
            // `max` would forget a NaN.
            if one.is_nan() || one > largest {
                largest = one;
            }
            if largest.is_nan() {
                break;
            }
        }
        Self::new(largest, limit, measure)
    }

    /// NaN never passes.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.error <= self.limit
    }
}

/// Every case of every room, in the order they are run.
#[must_use]
pub fn cases() -> Vec<Case> {
    let mut cases = gpu::cases();
    cases.extend(foliage::cases());
    cases.extend(foliage_bins::cases());
    cases.extend(foliage_ends::cases());
    cases.extend(foliage_subset::cases());
    cases.extend(foliage_surface::cases());
    cases.extend(skylight::cases());
    cases.extend(leaf::cases());
    cases.extend(render::cases());
    cases.extend(light::cases());
    cases.extend(lit::cases());
    cases.extend(truth::cases());
    cases.extend(lit_shadow::cases());
    cases.extend(lamps::cases());
    cases.extend(gloss_rays::cases());
    cases.extend(matrix::cases());
    cases.extend(ink::cases());
    cases.extend(ink_looks::cases());
    cases.extend(ink_places::cases());
    cases.extend(paper::cases());
    cases.extend(modulate::cases());
    cases.extend(paper_trace::cases());
    cases
}
