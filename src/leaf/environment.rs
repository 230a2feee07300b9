//! Distant light: environments, their spherical harmonics and the sun.

use std::path::Path;
use std::sync::Arc;

use glam::{DQuat, DVec3};

use crate::abi::SH_MAX_COEFFICIENTS;
use crate::math::sh;
use crate::scene::float_image::{FloatImage, Transfer};
use crate::{Error, Result};

/// RGB of each coefficient, of every band that transfer may have.
pub type Coefficients = [DVec3; SH_MAX_COEFFICIENTS as usize];

/// What surrounds the scene, without the sun.
#[derive(Debug, Clone)]
pub enum Environment {
    /// The same from everywhere.
    Constant(DVec3),
    /// `a + b (d . up)`: lies in bands 0 and 1, so that it is exact.
    Linear {
        /// Radiance at the horizon.
        a: DVec3,
        /// Difference to the zenith.
        b: DVec3,
        /// Unit vector to the zenith.
        up: DVec3,
    },
    /// A panorama.
    Panorama(Panorama),
    /// A clear sky (Preetham, Shirley, Smits 1999, A Practical Analytic Model for Daylight), black
    /// below the horizon.
    Clear(super::sky::ClearSky),
}

/// An equirectangular image: rows from the zenith to the nadir.
#[derive(Debug, Clone)]
pub struct Panorama {
    width: usize,
    height: usize,
    pixels: Arc<[[f32; 3]]>,
    /// Turns world directions so that the zenith is +z.
    to_z_up: DQuat,
}

/// The sun: a disc of even radiance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sun {
    /// Unit vector to it.
    pub towards: DVec3,
    /// Angular radius, degrees.
    pub radius_degrees: f64,
    /// Irradiance on a surface that faces it.
    pub irradiance: DVec3,
}

impl Sun {
    /// Radiance of the disc: E = pi L sin^2 alpha.
    #[must_use]
    pub fn radiance(&self) -> DVec3 {
        let sin = self.radius_degrees.to_radians().sin();
        self.irradiance / (std::f64::consts::PI * sin * sin)
    }

    /// Coefficients of the disc, in closed form, seen through the window of strength `window`.
    #[must_use]
    pub fn coefficients(&self, window: f64) -> Coefficients {
        let y = sh::disc(self.towards, self.radius_degrees.to_radians());
        let factors = sh::window(window);
        // The disc's mean, times irradiance: a point of no extent has no radiance.
        let area = sh::disc_solid_angle(self.radius_degrees.to_radians());
        std::array::from_fn(|k| {
            let share = if area > 0.0 {
                y[k] / area
            } else {
                sh::evaluate(self.towards)[k]
            };
            share * factors[sh::band(k)] * self.irradiance
        })
    }
}

impl Environment {
    /// Radiance from the unit direction `d`.
    #[must_use]
    pub fn radiance(&self, d: DVec3) -> DVec3 {
        match self {
            Self::Constant(l) => *l,
            Self::Linear { a, b, up } => *a + *b * d.dot(*up),
            Self::Panorama(p) => p.radiance(d),
            Self::Clear(sky) => sky.radiance(d),
        }
    }

    /// It as a thing sees it that was turned by the inverse of `by`.
    #[must_use]
    pub fn turned(&self, by: DQuat) -> Self {
        match self {
            Self::Constant(l) => Self::Constant(*l),
            Self::Linear { a, b, up } => Self::Linear {
                a: *a,
                b: *b,
                up: by * *up,
            },
            Self::Panorama(p) => Self::Panorama(Panorama {
                to_z_up: p.to_z_up * by.inverse(),
                ..p.clone()
            }),
            Self::Clear(sky) => Self::Clear(sky.turned(by)),
        }
    }

    /// Its projection.
    #[must_use]
    pub fn coefficients(&self) -> Coefficients {
        let mut out = [DVec3::ZERO; SH_MAX_COEFFICIENTS as usize];
        match self {
            Self::Constant(l) => out[0] = *l * (4.0 * std::f64::consts::PI).sqrt(),
            Self::Linear { a, b, up } => {
                // Band 1 is (y, z, x) times a constant.
                let y1 = sh::evaluate(DVec3::Z)[2];
                out[0] = *a / sh::evaluate(DVec3::Z)[0];
                out[1] = *b * (up.y / y1);
                out[2] = *b * (up.z / y1);
                out[3] = *b * (up.x / y1);
            }
            Self::Panorama(p) => p.project(&mut out),
            Self::Clear(sky) => project_grid(&mut out, (256, 128), |d| sky.radiance(d)),
        }
        out
    }
}

/// Adds the projection of `radiance` on a grid of azimuth times polar angle about +z, by middles
/// and exact solid angles.
fn project_grid(
    out: &mut Coefficients,
    (width, height): (usize, usize),
    radiance: impl Fn(DVec3) -> DVec3,
) {
    for row in 0..height {
        for column in 0..width {
            let (d, solid_angle) = cell(row, column, width, height);
            let light = radiance(d) * solid_angle;
            for (sum, y) in out.iter_mut().zip(sh::evaluate(d)) {
                *sum += y * light;
            }
        }
    }
}

/// Middle and solid angle of a cell of an equirectangular grid about +z.
fn cell(row: usize, column: usize, width: usize, height: usize) -> (DVec3, f64) {
    use std::f64::consts::PI;
    let theta = |r: f64| PI * r / height as f64;
    let phi = 2.0 * PI * (column as f64 + 0.5) / width as f64;
    let (sin, cos) = theta(row as f64 + 0.5).sin_cos();
    let d = DVec3::new(sin * phi.cos(), sin * phi.sin(), cos);
    let band = theta(row as f64).cos() - theta(row as f64 + 1.0).cos();
    (d, 2.0 * PI / width as f64 * band)
}

impl Panorama {
    /// Reads an EXR or Radiance HDR file (or an sRGB PNG or JPEG); `up` is the unit vector to its zenith.
    ///
    /// # Errors
    /// Neither, damaged, or with texels that are NaN, infinite or negative (counted).
    pub fn read(path: &Path, up: DVec3) -> Result<Self> {
        let wrong = |e: &dyn std::fmt::Display| Error::file(path, format!("environment: {e}"));
        let bytes = std::fs::read(path).map_err(|e| wrong(&e))?;
        let image = FloatImage::decode(&path.to_string_lossy(), &bytes, Transfer::Srgb)?;
        let (width, height) = (image.width as usize, image.height as usize);
        let pixels = image.pixels.iter().map(|p| [p[0], p[1], p[2]]).collect();
        Self::new(width, height, pixels, up).map_err(|reason| Error::file(path, reason))
    }

    /// A panorama of `width * height` pixels.
    ///
    /// # Errors
    /// What is wrong with the pixels.
    pub fn new(
        width: usize,
        height: usize,
        pixels: Vec<[f32; 3]>,
        up: DVec3,
    ) -> Result<Self, String> {
        if width == 0 || height == 0 || pixels.len() != width * height {
            return Err(format!(
                "environment: {} pixels are not {width}x{height}",
                pixels.len()
            ));
        }
        let bad = pixels
            .iter()
            .filter(|p| p.iter().any(|v| !v.is_finite() || *v < 0.0))
            .count();
        if bad > 0 {
            return Err(format!(
                "environment: {bad} texels are negative or not finite"
            ));
        }
        Ok(Self {
            width,
            height,
            pixels: pixels.into(),
            to_z_up: DQuat::from_rotation_arc(up, DVec3::Z),
        })
    }

    fn radiance(&self, d: DVec3) -> DVec3 {
        use std::f64::consts::PI;
        let d = self.to_z_up * d;
        let row = d.z.clamp(-1.0, 1.0).acos() / PI * self.height as f64;
        let turn = d.y.atan2(d.x) / (2.0 * PI);
        let column = (turn - turn.floor()) * self.width as f64;
        let row = (row as usize).min(self.height - 1);
        let column = (column as usize).min(self.width - 1);
        DVec3::from(self.pixels[row * self.width + column].map(f64::from))
    }

    fn project(&self, out: &mut Coefficients) {
        let back = self.to_z_up.inverse();
        for row in 0..self.height {
            for column in 0..self.width {
                let (d, solid_angle) = cell(row, column, self.width, self.height);
                let pixel = self.pixels[row * self.width + column].map(f64::from);
                let light = DVec3::from(pixel) * solid_angle;
                for (sum, y) in out.iter_mut().zip(sh::evaluate(back * d)) {
                    *sum += y * light;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sampling::fibonacci_directions;

    fn value(c: &Coefficients, d: DVec3) -> DVec3 {
        c.iter().zip(sh::evaluate(d)).map(|(&l, y)| y * l).sum()
    }

    #[test]
    fn smooth_environments_are_exact() {
        let up = DVec3::new(0.2, 0.9, -0.3).normalize();
        let (a, b) = (DVec3::new(0.3, 0.2, 0.1), DVec3::new(0.1, 0.2, 0.05));
        for sky in [Environment::Constant(a), Environment::Linear { a, b, up }] {
            let c = sky.coefficients();
            for d in fibonacci_directions(50) {
                let error = (value(&c, d) - sky.radiance(d)).abs().max_element();
                assert!(error < 1e-12, "{sky:?}: {error}");
            }
        }
    }

    #[test]
    fn a_panorama_of_a_linear_sky_is_nearly_that_sky() {
        let (a, b) = (DVec3::splat(0.3), DVec3::new(0.1, 0.2, 0.05));
        let up = DVec3::Y;
        let sky = Environment::Linear { a, b, up };
        let (w, h) = (64, 32);
        let pixels = (0..w * h)
            .map(|i| {
                let z = cell(i / w, i % w, w, h).0.z;
                (a + b * z).as_vec3().to_array()
            })
            .collect();
        let panorama = Environment::Panorama(Panorama::new(w, h, pixels, up).unwrap());
        let (found, wanted) = (panorama.coefficients(), sky.coefficients());
        for (f, w) in found.iter().zip(wanted) {
            assert!((*f - w).abs().max_element() < 1e-3, "{f} for {w}");
        }
        assert!((panorama.radiance(up) - a - b).abs().max_element() < 1e-2);
    }

    #[test]
    fn turned_skies_are_the_same_in_the_turned_frame() {
        let (a, b) = (DVec3::splat(0.3), DVec3::new(0.1, 0.2, 0.05));
        let pixels = (0..64 * 32).map(|i| [(i % 64) as f32, 1.0, (i / 64) as f32]);
        let sun = DVec3::new(0.3, 0.8, 0.2).normalize();
        let by = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 1.1);
        for sky in [
            Environment::Constant(a),
            Environment::Linear { a, b, up: DVec3::Y },
            Environment::Panorama(Panorama::new(64, 32, pixels.collect(), DVec3::Y).unwrap()),
            Environment::Clear(super::super::sky::ClearSky::new(DVec3::Y, sun, 2.5)),
        ] {
            let turned = sky.turned(by);
            // At the horizon the clear sky ends.
            let off_horizon = |d: &DVec3| d.y.abs() > 1e-3;
            for d in fibonacci_directions(50).into_iter().filter(off_horizon) {
                let error = (turned.radiance(by * d) - sky.radiance(d)).abs();
                assert!(error.max_element() < 1e-6, "{sky:?}: {error}");
            }
        }
    }

    #[test]
    fn damaged_panoramas_are_refused_with_a_count() {
        let mut pixels = vec![[1.0_f32; 3]; 8];
        pixels[2][1] = f32::NAN;
        pixels[5][0] = -1.0;
        let error = Panorama::new(4, 2, pixels, DVec3::Y).unwrap_err();
        assert!(error.contains("2 texels"), "{error}");
    }

    #[test]
    fn the_suns_irradiance_is_kept() {
        let sun = Sun {
            towards: DVec3::new(1.0, 2.0, 3.0).normalize(),
            radius_degrees: 0.2665,
            irradiance: DVec3::splat(3.0),
        };
        let c = sun.coefficients(0.0);
        // Irradiance on a plane that faces it, by the clamped cosine.
        let y = sh::evaluate(sun.towards);
        let e: f64 = (0..c.len())
            .map(|k| {
                let l = sh::band(k);
                let zonal = (4.0 * std::f64::consts::PI / (2 * l + 1) as f64).sqrt();
                c[k].x * y[k] * zonal * sh::CLAMPED_COSINE[l]
            })
            .sum();
        assert!((e / 3.0 - 1.0).abs() < 0.05, "{e}");
        let direct = sun.radiance() * sh::disc_solid_angle(0.2665_f64.to_radians());
        assert!((direct / 3.0 - 1.0).abs().max_element() < 1e-4);
    }
}
