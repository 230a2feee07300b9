//! Ambient coefficients: the paper's transfer function and the transmittance of the field.

use glam::DVec3;

use super::density::Grid;
use super::realign::transmittance;

/// Parameters of equation 4.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transfer {
    /// Smallest coefficient, in \[0,1\].
    pub k_min: f64,
    /// Density from which on the coefficient is `k_min`.
    pub d_min: f64,
    /// Exponent n > 0.
    pub exponent: f64,
}

/// `k_a` of the density `d` = F(v) (Luft, Balzer, Deussen 2007, equation 4). With `d_min` <= 0 it
/// is a step.
#[must_use]
pub fn transfer(d: f64, t: &Transfer) -> f64 {
    if d <= 0.0 {
        1.0
    } else if d >= t.d_min {
        t.k_min
    } else {
        t.k_min + (1.0 - t.k_min) * (1.0 - d / t.d_min).powf(t.exponent)
    }
}

/// Mean transmittance from `q` over `directions`: the share of a uniform sky that arrives.
#[must_use]
pub fn mean_transmittance(
    grid: &Grid,
    leaf_area: &[f64],
    q: DVec3,
    directions: &[DVec3],
    extinction: f64,
) -> f64 {
    let sum: f64 = directions
        .iter()
        .map(|&w| transmittance(grid, leaf_area, q, w, extinction))
        .sum();
    sum / directions.len() as f64
}
