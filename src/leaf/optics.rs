//! What a material makes of light, as far as the precomputation needs it: mean values per side.

use super::appearance::{Face, LeafMaterial};
use super::glossy::Shadowing;
use super::import::Said;
use crate::Result;
use crate::abi::LeafSides;
use crate::scene::{Material, Model};

/// Reflectance and transmittance per channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Optics {
    /// Diffuse reflectance of the front (upper) side.
    pub rho_d_front: [f32; 3],
    /// Diffuse reflectance of the back (lower) side.
    pub rho_d_back: [f32; 3],
    /// Diffuse transmittance.
    pub rho_t: [f32; 3],
    /// Specular intensity of both sides; lights of small extent only.
    pub rho_s: [f32; 3],
    /// Roughness m of the specular term: root mean square slope times the square root of 2.
    pub roughness: f32,
    /// Form of the specular term.
    pub shadowing: Shadowing,
}

impl Optics {
    /// An opaque, diffuse surface.
    #[must_use]
    pub fn opaque(rho: [f32; 3]) -> Self {
        Self {
            rho_d_front: rho,
            rho_d_back: rho,
            rho_t: [0.0; 3],
            rho_s: [0.0; 3],
            roughness: 0.3,
            shadowing: Shadowing::Paper,
        }
    }

    /// What `leaf` is as a whole; light goes through equally either way.
    #[must_use]
    pub fn of_leaf(leaf: &LeafMaterial) -> Self {
        let [upper, lower] = Face::ALL.map(|face| leaf.optics(face));
        Self {
            rho_d_front: upper.rho_d,
            rho_d_back: lower.rho_d,
            rho_t: [0, 1, 2].map(|c| 0.5 * (upper.rho_t[c] + lower.rho_t[c])),
            rho_s: upper.rho_s,
            roughness: upper.m,
            shadowing: Shadowing::Paper,
        }
    }

    /// What `material` says: the mean of its colour, and where it has
    /// `KHR_materials_diffuse_transmission` with factor f, `rho_d = (1 - f) base` and
    /// `rho_t = f tint`; otherwise nothing goes through. As [`super::import`] reads it.
    ///
    /// # Errors
    /// A texture that cannot be decoded.
    pub fn of_material(model: &Model, material: &Material) -> Result<Self> {
        let said = Said::new(model, material)?;
        let mut out = Self::opaque(said.rho_d.map(|v| v as f32));
        out.rho_t = said.rho_t.unwrap_or_default().map(|v| v as f32);
        Ok(out)
    }

    /// Channels in which a side would give back more than falls on it; kernels scale those.
    #[must_use]
    pub fn above_one(&self) -> usize {
        (0..3)
            .filter(|&c| {
                let shine = self.rho_s[c].max(0.0);
                let most = self.rho_d_front[c].max(self.rho_d_back[c]);
                most + shine + self.rho_t[c] > 1.0 + 1e-6
            })
            .count()
    }

    /// The form of the kernels of transfer: the glossy reflection is part of the diffuse one.
    #[must_use]
    pub fn transfer_sides(&self) -> LeafSides {
        let mut all = *self;
        for c in 0..3 {
            all.rho_d_front[c] += self.rho_s[c].max(0.0);
            all.rho_d_back[c] += self.rho_s[c].max(0.0);
        }
        all.sides()
    }

    /// The form of the kernels. Values below 0 count as 0, sums above 1 are scaled to 1.
    #[must_use]
    pub fn sides(&self) -> LeafSides {
        let mut out = LeafSides {
            rho_d_front: self.rho_d_front.map(|v| v.max(0.0)),
            rho_d_back: self.rho_d_back.map(|v| v.max(0.0)),
            rho_t: self.rho_t.map(|v| v.max(0.0)),
        };
        for c in 0..3 {
            let most = out.rho_d_front[c].max(out.rho_d_back[c]) + out.rho_t[c];
            if most > 1.0 {
                for v in [
                    &mut out.rho_d_front[c],
                    &mut out.rho_d_back[c],
                    &mut out.rho_t[c],
                ] {
                    *v /= most;
                }
            }
        }
        out
    }
}

/// Linear mean of what is visible of a base colour texture, times the factor.
///
/// # Errors
/// A texture that cannot be decoded.
pub fn mean_colour(model: &Model, material: &Material) -> Result<[f32; 3]> {
    let mean = Said::new(model, material)?.mean;
    Ok([0, 1, 2].map(|c| material.base_color[c] * mean[c] as f32))
}
