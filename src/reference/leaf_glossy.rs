//! Twin of `leaf_glossy.glsl`, by Stogryn's form as the paper prints it.

use glam::DVec3;

use crate::abi::{GLOSSY_MIN_COSINE, GLOSSY_MIN_ROUGHNESS};
use crate::math::special::erf;

/// `f_s cos_i / rho_s` of directions to the light and to the viewer over a surface with normal z.
///
/// The paper's eq. 7 in Stogryn's variables: `l` the correlation length, `sigma` the RMS height,
/// of which only `m = 2 sigma / l` matters.
#[must_use]
pub fn glossy(to_light: DVec3, to_viewer: DVec3, m: f64, safe: bool) -> f64 {
    let (i, r) = (to_light, to_viewer);
    if i.z <= 0.0 || r.z <= 0.0 {
        return 0.0;
    }
    let m = m.max(f64::from(GLOSSY_MIN_ROUGHNESS));
    // With l = 1: sigma = m / 2.
    let sigma = 0.5 * m;
    let sum = i.z + r.z;
    // sin^2 ti + sin^2 tr + 2 sin ti sin tr cos(phi) of the horizontal parts.
    let across = (i.x + r.x).powi(2) + (i.y + r.y).powi(2);
    let stogryn = (1.0 + i.dot(r)).powi(2) / (sum.powi(4) * sigma * sigma)
        * (-across / (4.0 * sigma * sigma * sum * sum)).exp();
    let g = if safe {
        1.0 / (1.0 + lambda(i.z, m) + lambda(r.z, m))
    } else {
        1.0
    };
    g * stogryn / (4.0 * std::f64::consts::PI * r.z.max(f64::from(GLOSSY_MIN_COSINE)))
}

/// Smith's Lambda.
pub(super) fn lambda(cosine: f64, m: f64) -> f64 {
    let a = cosine / (m * (1.0 - cosine * cosine).max(1e-60).sqrt());
    if a > 5.0 {
        return 0.0;
    }
    0.5 * (erf(a) - 1.0) + (-a * a).exp() / (2.0 * a * std::f64::consts::PI.sqrt())
}
