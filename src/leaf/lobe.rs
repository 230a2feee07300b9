//! The glossy lobe as spherical harmonics, over the angle of view: b(v) of Wang et al. 2005,
//! section 4.1.
//!
//! The lobe does not change when surface and viewer turn about the normal together, so that it is
//! tabulated for viewers in the half plane y = 0, x > 0 alone, where all coefficients of sines
//! (m < 0) are 0: 15 of 25 remain.

use glam::DVec3;

use super::glossy::{Shadowing, smith};
use crate::abi::{GLOSSY_MIN_COSINE, GLOSSY_MIN_ROUGHNESS, LOBE_COEFFICIENTS, LOBE_NODES};
use crate::math::sh;

/// Coefficients of a node.
const WIDTH: usize = LOBE_COEFFICIENTS as usize;
/// Rule over half vectors: rings of equal parts of the far slopes, turns of half a circle.
const RULE: (u32, u32) = (64, 48);

/// Coefficients l(l+1)/2 + m (0 <= m <= l) of the lobe's reflection times the cosine of the light,
/// for `rho_s` = 1: [`LOBE_NODES`] angles of view, even from 0 to 90 degrees, of all bands that
/// kernels know. At 90 degrees the cosine of view is taken as that at 89.
#[must_use]
pub fn table(roughness: f64, shadowing: Shadowing) -> Vec<f32> {
    let last = f64::from(LOBE_NODES - 1);
    let nodes = (0..LOBE_NODES).map(|i| (90.0 * f64::from(i) / last).min(89.0));
    nodes
        .flat_map(|degrees| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            lobe(DVec3::new(sin, 0.0, cos), roughness, shadowing)
        })
        .map(|v| v as f32)
        .collect()
}

/// The lobe seen from `to_eye`: integrated over half vectors by their own distribution.
fn lobe(to_eye: DVec3, roughness: f64, shadowing: Shadowing) -> [f64; WIDTH] {
    let m = roughness.max(f64::from(GLOSSY_MIN_ROUGHNESS));
    let cos_eye = to_eye.z.max(f64::from(GLOSSY_MIN_COSINE));
    let (rings, turns) = RULE;
    let width = 5.0 / f64::from(rings);
    let mut out = [0.0; WIDTH];
    for ring in 0..rings {
        // tan^2 = -m^2 ln(1 - u) has density D cos; u = 1 - e^{-t^2} spreads the far slopes.
        let t = (f64::from(ring) + 0.5) * width;
        let weight = width * 2.0 * t * (-t * t).exp() / f64::from(turns);
        let c = 1.0 / (1.0 + (m * t).powi(2)).sqrt();
        let s = m * t * c;
        for turn in 0..turns {
            let turn = (f64::from(turn) + 0.5) * std::f64::consts::PI / f64::from(turns);
            let middle = DVec3::new(s * turn.cos(), s * turn.sin(), c);
            let along = middle.dot(to_eye);
            let to_light = 2.0 * along * middle - to_eye;
            if along <= 0.0 || to_light.z <= 0.0 {
                continue;
            }
            let g = match shadowing {
                Shadowing::Paper => 1.0,
                Shadowing::Safe => 1.0 / (1.0 + smith(cos_eye, m) + smith(to_light.z, m)),
            };
            let share = weight * g * along / (cos_eye * c);
            let y = sh::evaluate(to_light);
            for l in 0..sh::MAX_ORDER {
                for k in 0..=l {
                    out[l * (l + 1) / 2 + k] += share * y[l * (l + 1) + k];
                }
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::leaf::glossy::directional_albedo;

    /// The first coefficient is the albedo of the angle of view.
    #[test]
    fn lobes_have_the_albedo_of_their_angle() {
        let y0 = sh::evaluate(DVec3::Z)[0];
        for m in [0.1, 0.3, 0.6] {
            for shadowing in [Shadowing::Paper, Shadowing::Safe] {
                for node in [0, 20, 40, 60] {
                    let angle = 90.0 * f64::from(node) / f64::from(LOBE_NODES - 1);
                    let wanted = directional_albedo(angle.to_radians().cos(), m, shadowing);
                    let found = f64::from(table(m, shadowing)[node as usize * WIDTH]) / y0;
                    assert!(
                        (found / wanted - 1.0).abs() < 0.02,
                        "{m} {angle}: {found} {wanted}"
                    );
                }
            }
        }
    }

    /// A lobe that is almost a mirror has the harmonics of the mirrored direction.
    #[test]
    fn smooth_surfaces_mirror() {
        let to_eye = DVec3::new(0.6, 0.0, 0.8);
        let found = lobe(to_eye, 0.002, Shadowing::Paper);
        let y = sh::evaluate(DVec3::new(-0.6, 0.0, 0.8));
        for l in 0..sh::MAX_ORDER {
            for k in 0..=l {
                let difference = found[l * (l + 1) / 2 + k] - y[l * (l + 1) + k];
                assert!(difference.abs() < 2e-3, "{l} {k}: {difference}");
            }
        }
    }
}
