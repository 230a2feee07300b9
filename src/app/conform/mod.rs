//! Conformance: every kernel against its CPU twin on the device at hand.
//!
//! A case lives in one file per room (`gpu`, `foliage`, `render`); the test suite runs the same
//! cases, so `umbrage conform` and the tests cannot drift apart.

mod foliage;
mod foliage_subset;
mod foliage_surface;
mod gpu;
mod render;
mod skylight;

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
    cases.extend(foliage_subset::cases());
    cases.extend(foliage_surface::cases());
    cases.extend(skylight::cases());
    cases.extend(render::cases());
    cases
}
