//! The glossy term: Stogryn's rough surface, which is Beckmann's distribution.
//!
//! Wang et al. 2005, eq. 7. With m = 2 sigma / l (RMS height over correlation length) and a the
//! angle of the half vector to the normal,
//!
//! ```text
//! D = exp(-tan^2 a / m^2) / (pi m^2 cos^4 a)       f_s = rho_s D / (4 cos_i cos_r)
//! ```
//!
//! A light's contribution is `f_s cos_i = rho_s D / (4 cos_r)`: the cosine of incidence cancels
//! here, and never stands in a denominator. `shaders/include/leaf_glossy.glsl` is the other half.

use crate::abi::{GLOSSY_MIN_COSINE, GLOSSY_MIN_ROUGHNESS};
use crate::math::special::erf;

/// What keeps the lobe's energy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Shadowing {
    /// Nothing: the paper. At 89 degrees and m = 0.5 the lobe gives back 8.6 times what came in.
    Paper,
    /// Smith's height-correlated masking and shadowing: never more than what came in.
    #[default]
    Safe,
}

/// `f_s cos_i / rho_s` from the cosines of incidence, of reflection and of the half vector to the
/// normal. 0 where either direction is below the surface.
#[must_use]
pub fn glossy(cos_i: f64, cos_r: f64, cos_half: f64, m: f64, shadowing: Shadowing) -> f64 {
    if !(cos_i > 0.0 && cos_r > 0.0 && cos_half > 0.0) {
        return 0.0;
    }
    let m = m.max(f64::from(GLOSSY_MIN_ROUGHNESS));
    let d = distribution(cos_half, m);
    let g = match shadowing {
        Shadowing::Paper => 1.0,
        Shadowing::Safe => 1.0 / (1.0 + smith(cos_i, m) + smith(cos_r, m)),
    };
    g * d / (4.0 * cos_r.max(f64::from(GLOSSY_MIN_COSINE)))
}

/// Beckmann's distribution of half vectors; its integral times the cosine is 1.
#[must_use]
pub fn distribution(cos_half: f64, m: f64) -> f64 {
    let c2 = (cos_half * cos_half).clamp(1e-12, 1.0);
    let tan2 = (1.0 - c2) / c2;
    (-tan2 / (m * m)).exp() / (std::f64::consts::PI * m * m * c2 * c2)
}

/// Smith's Lambda of Beckmann's distribution.
#[must_use]
pub fn smith(cosine: f64, m: f64) -> f64 {
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    let a = cosine / (m * sine).max(1e-30);
    // Beyond 5 both terms are below 1e-12.
    if a > 5.0 {
        return 0.0;
    }
    0.5 * (erf(a) - 1.0) + (-a * a).exp() / (2.0 * a * std::f64::consts::PI.sqrt())
}

/// Share of light at an angle of incidence that the lobe reflects, for `rho_s` = 1: integrated
/// over half vectors, with the integrand's own distribution.
#[must_use]
pub fn directional_albedo(cos_i: f64, m: f64, shadowing: Shadowing) -> f64 {
    let sin_i = (1.0 - cos_i * cos_i).max(0.0).sqrt();
    // The lobe is cut off where reflections go below the surface, so smooth rules gain nothing.
    let (rings, turns) = (600, 128);
    let mut sum = 0.0;
    for ring in 0..rings {
        // tan^2 = -m^2 ln(1 - u) has density D cos; u = 1 - e^{-t^2} spreads the far slopes.
        let width = 5.0 / f64::from(rings);
        let t = (f64::from(ring) + 0.5) * width;
        let weight = width * 2.0 * t * (-t * t).exp();
        let tan = m * t;
        let c = 1.0 / (1.0 + tan * tan).sqrt();
        let s = tan * c;
        let mut around = 0.0;
        for k in 0..turns {
            let turn = (f64::from(k) + 0.5) * std::f64::consts::PI / f64::from(turns);
            let along = s * turn.cos() * sin_i + c * cos_i;
            let cos_r = 2.0 * along * c - cos_i;
            if along <= 0.0 || cos_r <= 0.0 {
                continue;
            }
            let g = match shadowing {
                Shadowing::Paper => 1.0,
                Shadowing::Safe => 1.0 / (1.0 + smith(cos_i, m) + smith(cos_r, m)),
            };
            around += g * along / (cos_i * c);
        }
        sum += weight * around / f64::from(turns);
    }
    sum
}
