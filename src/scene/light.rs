//! Sun and sky: the lights a scene has besides those of its model.

use glam::DVec3;

/// A sun at infinity: one shadowed directional light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sun {
    /// Degrees clockwise from +z towards +x seen from above; 0 is behind a camera of azimuth 0.
    pub azimuth: f64,
    /// Degrees above the horizon, -90..90.
    pub elevation: f64,
    /// Linear RGB intensity `I_i` of eq. 1: what a white surface facing the sun reflects.
    pub color: [f32; 3],
}

impl Default for Sun {
    /// A late-morning sun, high to the upper left of the automatic camera.
    fn default() -> Self {
        Self {
            azimuth: -28.0,
            elevation: 50.0,
            color: [2.05, 1.92, 1.66],
        }
    }
}

impl Sun {
    /// Unit vector towards the sun.
    #[must_use]
    pub fn direction(&self) -> DVec3 {
        spherical(self.azimuth, self.elevation)
    }
}

/// Light from everywhere, `I_a` of eq. 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sky {
    /// Linear RGB from above (normal +y).
    pub zenith: [f32; 3],
    /// Linear RGB from below (normal -y): light that the ground throws back.
    pub ground: [f32; 3],
}

impl Default for Sky {
    fn default() -> Self {
        Self {
            zenith: [0.68, 0.72, 0.77],
            ground: [0.36, 0.35, 0.30],
        }
    }
}

impl Sky {
    /// The paper's constant ambient intensity (Luft, Balzer, Deussen 2007, section 2.2).
    #[must_use]
    pub fn constant(color: [f32; 3]) -> Self {
        Self {
            zenith: color,
            ground: color,
        }
    }

    /// `I_a` for a surface with unit normal `n`: the irradiance of two half-spheres of constant
    /// radiance is linear in `n.y`.
    #[must_use]
    pub fn ambient(&self, n: glam::Vec3) -> [f32; 3] {
        let up = 0.5 + 0.5 * n.y;
        std::array::from_fn(|c| self.ground[c] + (self.zenith[c] - self.ground[c]) * up)
    }
}

/// Unit vector from azimuth (degrees from +z towards +x) and elevation (degrees above the xz plane).
#[must_use]
pub fn spherical(azimuth: f64, elevation: f64) -> DVec3 {
    let (sin_a, cos_a) = azimuth.to_radians().sin_cos();
    let (sin_e, cos_e) = elevation.to_radians().sin_cos();
    DVec3::new(sin_a * cos_e, sin_e, cos_a * cos_e)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn azimuth_turns_from_z_towards_x() {
        assert!(spherical(0.0, 0.0).distance(DVec3::Z) < 1e-12);
        assert!(spherical(90.0, 0.0).distance(DVec3::X) < 1e-12);
        assert!(spherical(17.0, 90.0).distance(DVec3::Y) < 1e-12);
    }

    #[test]
    fn constant_sky_ignores_the_normal() {
        let sky = Sky::constant([0.1, 0.2, 0.3]);
        assert_eq!(sky.ambient(glam::Vec3::NEG_Y), sky.ambient(glam::Vec3::X));
    }
}
