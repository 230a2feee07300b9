//! The paper's iteration: freeze A and B, solve for albedo and thickness, update A and B.
//!
//! Kept to be compared: from most starts it leaves the range of the model at once, because with
//! frozen A the albedo `2 R / A` may exceed 1, and with frozen B no thickness may give the
//! transmittance.

use super::newton::Slab;
use crate::leaf::slab_table::{Share, SlabTable};

/// Rounds at most.
const ROUNDS: usize = 500;

/// How the iteration failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PaperFailure {
    /// The frozen A asks for an albedo of 1 or more.
    AlbedoAboveOne,
    /// The frozen B alone transmits more than was measured.
    NoThickness,
    /// It has not settled.
    Slow,
}

impl std::fmt::Display for PaperFailure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::AlbedoAboveOne => "asked for an albedo above 1",
            Self::NoThickness => "transmit too little for the frozen B",
            Self::Slow => "did not settle",
        })
    }
}

/// The slab of a pair by the paper's iteration from a start, and the rounds it took.
///
/// # Errors
/// How it failed.
pub fn paper_iteration(target: Share, start: Slab) -> Result<(Slab, usize), PaperFailure> {
    let mut slab = start;
    for round in 1..=ROUNDS {
        let (a, b) = SlabTable::shared().read(slab.omega, slab.delta);
        let omega = 2.0 * target.r / a;
        if omega.is_nan() || omega >= 1.0 {
            return Err(PaperFailure::AlbedoAboveOne);
        }
        let unscattered = target.t - 0.5 * omega * b;
        if unscattered.is_nan() || unscattered <= 0.0 || unscattered >= 1.0 {
            return Err(PaperFailure::NoThickness);
        }
        let next = Slab {
            omega,
            delta: -unscattered.ln(),
        };
        let moved = (next.omega - slab.omega)
            .abs()
            .max((next.delta - slab.delta).abs() / slab.delta);
        slab = next;
        if moved < 1e-9 {
            return Ok((slab, round));
        }
    }
    Err(PaperFailure::Slow)
}
