//! A clear sky (Preetham, Shirley, Smits 1999, A Practical Analytic Model for Daylight).

use glam::{DMat3, DQuat, DVec3};

/// XYZ to linear sRGB (IEC 61966-2-1).
const XYZ_TO_RGB: DMat3 = DMat3::from_cols_array(&[
    3.2406, -0.9689, 0.0557, -1.5372, 1.8758, -0.2040, -0.4986, 0.0415, 1.0570,
]);
/// kcd/m^2 to radiance of linear sRGB in which a sunlit white surface is about 1 to 3.
const SCALE: f64 = 0.05;

/// Radiance of a cloudless sky.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClearSky {
    up: DVec3,
    sun: DVec3,
    /// Perez coefficients A to E of Y, x and y.
    perez: [[f64; 5]; 3],
    /// Y (kcd/m^2), x and y at the zenith.
    zenith: [f64; 3],
}

impl ClearSky {
    /// Turbidities that the model was fitted to, 1 being air without dust.
    pub const TURBIDITY: std::ops::RangeInclusive<f64> = 1.7..=10.0;

    /// The sky for the sun at `sun` with turbidity `turbidity` (2 very clear, 10 hazy); a sun below
    /// the horizon is put onto it.
    #[must_use]
    pub fn new(up: DVec3, sun: DVec3, turbidity: f64) -> Self {
        let t = turbidity.clamp(*Self::TURBIDITY.start(), *Self::TURBIDITY.end());
        let theta = sun.dot(up).clamp(0.0, 1.0).acos();
        let line = |a: f64, b: f64| a * t + b;
        let perez = [
            [
                line(0.1787, -1.4630),
                line(-0.3554, 0.4275),
                line(-0.0227, 5.3251),
                line(0.1206, -2.5771),
                line(-0.0670, 0.3703),
            ],
            [
                line(-0.0193, -0.2592),
                line(-0.0665, 0.0008),
                line(-0.0004, 0.2125),
                line(-0.0641, -0.8989),
                line(-0.0033, 0.0452),
            ],
            [
                line(-0.0167, -0.2608),
                line(-0.0950, 0.0092),
                line(-0.0079, 0.2102),
                line(-0.0441, -1.6537),
                line(-0.0109, 0.0529),
            ],
        ];
        let chi = (4.0 / 9.0 - t / 120.0) * (std::f64::consts::PI - 2.0 * theta);
        let luminance = (4.0453 * t - 4.9710) * chi.tan() - 0.2155 * t + 2.4192;
        let cubic = |m: [[f64; 4]; 3]| {
            let row = |r: [f64; 4]| ((r[0] * theta + r[1]) * theta + r[2]) * theta + r[3];
            (row(m[0]) * t + row(m[1])) * t + row(m[2])
        };
        let x = cubic([
            [0.00166, -0.00375, 0.00209, 0.0],
            [-0.02903, 0.06377, -0.03202, 0.00394],
            [0.11693, -0.21196, 0.06052, 0.25886],
        ]);
        let y = cubic([
            [0.00275, -0.00610, 0.00317, 0.0],
            [-0.04214, 0.08970, -0.04153, 0.00516],
            [0.15346, -0.26756, 0.06670, 0.26688],
        ]);
        Self {
            up,
            sun,
            perez,
            zenith: [luminance.max(0.0), x, y],
        }
    }

    /// It with its zenith and its sun turned by `by`.
    #[must_use]
    pub fn turned(&self, by: DQuat) -> Self {
        Self {
            up: by * self.up,
            sun: by * self.sun,
            ..*self
        }
    }

    /// Radiance from the unit direction `d`, linear RGB; black below the horizon.
    #[must_use]
    pub fn radiance(&self, d: DVec3) -> DVec3 {
        let cos = d.dot(self.up);
        if cos <= 0.0 {
            return DVec3::ZERO;
        }
        let gamma = d.dot(self.sun).clamp(-1.0, 1.0).acos();
        let theta_sun = self.sun.dot(self.up).clamp(0.0, 1.0).acos();
        let f = |p: &[f64; 5], cos: f64, gamma: f64| {
            let horizon = 1.0 + p[0] * (p[1] / cos.max(0.01)).exp();
            horizon * (1.0 + p[2] * (p[3] * gamma).exp() + p[4] * gamma.cos().powi(2))
        };
        let [luminance, x, y] = [0, 1, 2].map(|k| {
            let p = &self.perez[k];
            self.zenith[k] * f(p, cos, gamma) / f(p, 1.0, theta_sun)
        });
        let xyz = DVec3::new(x / y, 1.0, (1.0 - x - y) / y) * luminance;
        (XYZ_TO_RGB * xyz * SCALE).max(DVec3::ZERO)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sky_is_blue_above_and_brightest_about_the_sun() {
        let sun = DVec3::new(0.6, 0.8, 0.0);
        let sky = ClearSky::new(DVec3::Y, sun, 2.5);
        let zenith = sky.radiance(DVec3::Y);
        assert!(
            zenith.z > zenith.x && zenith.min_element() > 0.0,
            "{zenith}"
        );
        assert!(sky.radiance(sun).y > 2.0 * zenith.y);
        assert_eq!(sky.radiance(DVec3::NEG_Y), DVec3::ZERO);
        for low in [DVec3::X, DVec3::new(0.1, -0.9, 0.2)] {
            let l = ClearSky::new(DVec3::Y, low, 3.0).radiance(DVec3::new(0.0, 1.0, 0.0));
            assert!(l.is_finite(), "{l}");
        }
    }
}
