//! What a leaf does with light: two sides, each a slab with its own tissue and surface.
//!
//! Wang et al. 2005, section 3 (BRDF and BTDF, eq. 1): a side reflects `rho_d / pi + f_s` and lets
//! `rho_t / pi` through, where
//!
//! ```text
//! rho_d = gamma omega A / 2        rho_t = exp(-Delta) + omega B / 2
//! omega = sigma_s / (sigma_a + sigma_s)     Delta = (sigma_a + sigma_s) h (1 + d)
//! ```
//!
//! `h` is the thickness of the leaf, `d` its local deviation (veins), `gamma` what the diffuse
//! reflectance has beyond the tissue's. Only `sigma h` can be measured; `h` is a free scale.

use std::sync::Arc;

use super::maps::SideMaps;
use super::slab_table::{Column, Share, SlabTable};
use crate::abi::LeafTissue;
use crate::math::slab::{Incidence, solve};
use crate::{Error, Result};

/// Thickness of a leaf where nothing is known, millimetres.
pub const USUAL_THICKNESS_MM: f64 = 0.2;
/// Fresnel reflectance of a leaf's surface (n about 1.45), where nothing is known.
pub const USUAL_GLOSS: f32 = 0.035;

/// Which side of a leaf light falls on. The upper side is the one its normal points away from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Face {
    /// Adaxial; the front of triangles.
    Upper,
    /// Abaxial; the back of triangles.
    Lower,
}

impl Face {
    /// Both, upper first.
    pub const ALL: [Self; 2] = [Self::Upper, Self::Lower];

    /// `upper` or `lower`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Upper => "upper",
            Self::Lower => "lower",
        }
    }
}

/// How A and B follow from the tissue.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mode {
    /// Constants of the leaf, found once: the paper. Wrong beyond a quarter more or less
    /// thickness, and not bounded by the energy that falls in.
    Paper,
    /// Of every texel's own albedo and thickness, from the table.
    #[default]
    Exact,
}

impl Mode {
    /// `paper` or `exact`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Exact => "exact",
        }
    }
}

impl std::str::FromStr for Mode {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        match text {
            "paper" => Ok(Self::Paper),
            "exact" => Ok(Self::Exact),
            _ => Err(Error::usage(format!(
                "{text:?} is no mode of leaf optics; there are paper, exact"
            ))),
        }
    }
}

impl std::fmt::Display for Mode {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// What one side does with light that falls on it; linear RGB.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SideOptics {
    /// Diffusely reflected share.
    pub rho_d: [f32; 3],
    /// Diffusely transmitted share.
    pub rho_t: [f32; 3],
    /// Intensity of the glossy lobe.
    pub rho_s: [f32; 3],
    /// Roughness m of the glossy lobe: `sqrt(2)` times the RMS slope, Beckmann's alpha.
    pub m: f32,
}

/// One side of a leaf.
#[derive(Debug, Clone)]
pub struct Side {
    /// Absorption coefficient per channel, 1/mm, >= 0.
    pub sigma_a: [f64; 3],
    /// Scattering coefficient per channel, 1/mm, >= 0.
    pub sigma_s: [f64; 3],
    /// Factor on the diffuse reflectance, >= 0, where there are no maps.
    pub gamma: [f32; 3],
    /// Intensity of the glossy lobe, \[0, 1\], where there are no maps.
    pub rho_s: [f32; 3],
    /// Roughness m, (0, 1], where there are no maps.
    pub m: f32,
    /// The paper's constants `[A, B]` per channel.
    pub constants: [[f64; 2]; 3],
    /// Factor on the intensity of the maps and of [`Self::rho_s`]: an edit of the whole leaf.
    pub gloss: f32,
    /// What differs from texel to texel.
    pub maps: Option<Arc<SideMaps>>,
}

/// A leaf.
#[derive(Debug, Clone)]
pub struct LeafMaterial {
    /// Name for messages and files.
    pub name: String,
    /// Mean thickness h, millimetres, > 0.
    pub thickness_mm: f64,
    /// Where A and B come from.
    pub mode: Mode,
    /// The upper side.
    pub upper: Side,
    /// The lower side.
    pub lower: Side,
    /// Where the leaf is, 0 to 1 per texel of the maps; `None`: everywhere.
    pub mask: Option<Arc<[f32]>>,
}

impl Side {
    /// A side without maps, of a tissue in 1/mm; the paper's constants are those of the tissue at
    /// `thickness_mm`.
    #[must_use]
    pub fn of_tissue(sigma_a: [f64; 3], sigma_s: [f64; 3], thickness_mm: f64) -> Self {
        let mut side = Self {
            sigma_a,
            sigma_s,
            gamma: [1.0; 3],
            rho_s: [0.0; 3],
            m: 0.3,
            constants: [[0.0; 2]; 3],
            gloss: 1.0,
            maps: None,
        };
        side.fix_constants(thickness_mm);
        side
    }

    /// A side from its diffuse reflectance and transmittance, per channel, at a thickness; also
    /// how many channels had to be moved into the range of the model.
    #[must_use]
    pub fn of_albedo(rho_d: [f64; 3], rho_t: [f64; 3], thickness_mm: f64) -> (Self, usize) {
        let mut sigma = [[0.0; 3]; 2];
        let mut clamped = 0;
        for c in 0..3 {
            let (target, moved) = super::fit::clamp(rho_d[c], rho_t[c]);
            clamped += usize::from(moved);
            let slab = super::fit::invert(target);
            let total = slab.delta / thickness_mm;
            sigma[0][c] = (1.0 - slab.omega) * total;
            sigma[1][c] = slab.omega * total;
        }
        (Self::of_tissue(sigma[0], sigma[1], thickness_mm), clamped)
    }

    /// Scattering albedo of a channel; 0 for a tissue that does nothing.
    #[must_use]
    pub fn omega(&self, channel: usize) -> f64 {
        let total = self.sigma_a[channel] + self.sigma_s[channel];
        if total > 0.0 {
            self.sigma_s[channel] / total
        } else {
            0.0
        }
    }

    /// Extinction of a channel, 1/mm.
    #[must_use]
    pub fn sigma_t(&self, channel: usize) -> f64 {
        self.sigma_a[channel] + self.sigma_s[channel]
    }

    /// Takes the paper's constants from the tissue as it is now.
    pub fn fix_constants(&mut self, thickness_mm: f64) {
        for c in 0..3 {
            let (a, b) = SlabTable::shared().read(self.omega(c), self.sigma_t(c) * thickness_mm);
            self.constants[c] = [a, b];
        }
    }

    /// Reflectance and transmittance per channel of the tissue alone for light that does not come
    /// straight down, which the model itself leaves out (Wang et al. use the values of normal
    /// incidence for every direction).
    ///
    /// # Errors
    /// An incidence out of range.
    pub fn share(&self, thickness_mm: f64, incidence: Incidence) -> Result<[Share; 3]> {
        let mut out = [Share { r: 0.0, t: 0.0 }; 3];
        for (c, share) in out.iter_mut().enumerate() {
            let light = solve(self.omega(c), self.sigma_t(c) * thickness_mm, incidence)?;
            *share = Share {
                r: light.rho_d,
                t: light.t_diff + light.t_dir,
            };
        }
        Ok(out)
    }

    fn constant_texel(&self) -> Texel {
        Texel {
            gamma: self.gamma,
            delta: 0.0,
            rho_s: self.rho_s,
            m: self.m,
        }
    }

    pub(super) fn texel(&self, index: usize) -> Texel {
        self.maps
            .as_ref()
            .map_or_else(|| self.constant_texel(), |maps| maps.texel(index))
    }

    /// The side as `leaf/albedo.comp` takes it.
    #[must_use]
    pub fn tissue(&self, thickness_mm: f64, mode: Mode, texels: u32) -> LeafTissue {
        let times = |sigma: [f64; 3]| sigma.map(|s| (s * thickness_mm) as f32);
        LeafTissue {
            absorption: times(self.sigma_a),
            scattering: times(self.sigma_s),
            a: self.constants.map(|c| c[0] as f32),
            b: self.constants.map(|c| c[1] as f32),
            mode: match mode {
                Mode::Paper => crate::abi::LEAF_PAPER,
                Mode::Exact => crate::abi::LEAF_EXACT,
            },
            count: texels,
        }
    }
}

/// What a texel of the maps says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Texel {
    /// Factor on the diffuse reflectance.
    pub gamma: [f32; 3],
    /// Deviation of the thickness over the thickness, >= -1.
    pub delta: f32,
    /// Intensity of the glossy lobe.
    pub rho_s: [f32; 3],
    /// Roughness.
    pub m: f32,
}

impl LeafMaterial {
    /// One side.
    #[must_use]
    pub fn side(&self, face: Face) -> &Side {
        match face {
            Face::Upper => &self.upper,
            Face::Lower => &self.lower,
        }
    }

    /// One side, to be changed.
    pub fn side_mut(&mut self, face: Face) -> &mut Side {
        match face {
            Face::Upper => &mut self.upper,
            Face::Lower => &mut self.lower,
        }
    }

    /// Width and height of the maps, if there are any.
    #[must_use]
    pub fn size(&self) -> Option<[u32; 2]> {
        let maps = self.upper.maps.as_ref().or(self.lower.maps.as_ref());
        maps.map(|m| m.size)
    }

    /// What light on `face` meets, texel by texel.
    #[must_use]
    pub fn sampler(&self, face: Face) -> Sampler<'_> {
        let side = self.side(face);
        Sampler {
            leaf: self,
            side,
            columns: [0, 1, 2].map(|c| SlabTable::shared().at(side.omega(c))),
        }
    }

    /// What light on `face` meets, of the leaf as a whole.
    #[must_use]
    pub fn optics(&self, face: Face) -> SideOptics {
        self.sampler(face).mean()
    }

    /// How much of a texel is leaf, \[0, 1\].
    #[must_use]
    pub fn coverage(&self, index: usize) -> f32 {
        self.mask
            .as_ref()
            .map_or(1.0, |mask| mask.get(index).copied().unwrap_or(0.0))
    }

    /// Refuses what no leaf can have.
    ///
    /// # Errors
    /// Names the leaf, the value and its range.
    pub fn check(&self) -> Result<()> {
        let refuse = |what: String| Err(Error::usage(format!("leaf {:?}: {what}", self.name)));
        if !(self.thickness_mm > 0.0 && self.thickness_mm.is_finite()) {
            return refuse(format!(
                "thickness {} mm is not a number > 0",
                self.thickness_mm
            ));
        }
        for face in Face::ALL {
            let side = self.side(face);
            let name = face.name();
            for (label, sigma) in [("sigma_a", side.sigma_a), ("sigma_s", side.sigma_s)] {
                if let Some(s) = sigma.iter().find(|s| !(**s >= 0.0 && s.is_finite())) {
                    return refuse(format!("{name} {label} {s} is not a number >= 0"));
                }
            }
            let factors = side.gamma.iter().chain([&side.gloss]);
            if let Some(g) = factors.clone().find(|g| !(**g >= 0.0 && g.is_finite())) {
                return refuse(format!("{name} factor {g} is not a number >= 0"));
            }
            if let Some(s) = side.rho_s.iter().find(|s| !(0.0..=1.0).contains(*s)) {
                return refuse(format!("{name} rho_s {s} is outside [0, 1]"));
            }
            if !(side.m > 0.0 && side.m <= 1.0) {
                return refuse(format!("{name} roughness {} is outside (0, 1]", side.m));
            }
            if let Some(maps) = &side.maps {
                maps.check()
                    .or_else(|what| refuse(format!("{name} {what}")))?;
            }
        }
        self.check_sizes()
    }

    fn check_sizes(&self) -> Result<()> {
        let refuse = |what: String| Err(Error::usage(format!("leaf {:?}: {what}", self.name)));
        if let (Some(a), Some(b)) = (&self.upper.maps, &self.lower.maps)
            && a.size != b.size
        {
            return refuse(format!(
                "the maps of the upper side have {}x{} texels, those of the lower {}x{}",
                a.size[0], a.size[1], b.size[0], b.size[1]
            ));
        }
        if let (Some(mask), Some([w, h])) = (&self.mask, self.size())
            && mask.len() != w as usize * h as usize
        {
            return refuse(format!(
                "the mask has {} texels, the maps have {w}x{h}",
                mask.len()
            ));
        }
        Ok(())
    }
}

/// One side of a leaf, ready to be read many times.
#[derive(Debug, Clone)]
pub struct Sampler<'a> {
    leaf: &'a LeafMaterial,
    side: &'a Side,
    columns: [Column; 3],
}

impl Sampler<'_> {
    /// At the texel `index` (row by row from the top left); without maps every index is the same.
    #[must_use]
    pub fn of(&self, index: usize) -> SideOptics {
        self.optics(self.side.texel(index))
    }

    /// The mean over the leaf's texels, weighted by the mask; without maps that of the constants.
    #[must_use]
    pub fn mean(&self) -> SideOptics {
        let Some(maps) = &self.side.maps else {
            return self.optics(self.side.constant_texel());
        };
        // Some ten thousand texels give the mean of any map to a thousandth; an odd stride visits
        // all columns.
        let step = match maps.len() / 16_384 {
            0 | 1 => 1,
            n => n | 1,
        };
        let (mut sum, mut weights) = ([0.0_f64; 10], 0.0);
        for index in (0..maps.len()).step_by(step) {
            let w = f64::from(self.leaf.coverage(index));
            if w <= 0.0 {
                continue;
            }
            let o = self.of(index);
            let values = o.rho_d.into_iter().chain(o.rho_t).chain(o.rho_s);
            for (s, v) in sum.iter_mut().zip(values.chain([o.m])) {
                *s += w * f64::from(v);
            }
            weights += w;
        }
        if weights <= 0.0 {
            return self.optics(self.side.constant_texel());
        }
        let mean = sum.map(|v| (v / weights) as f32);
        SideOptics {
            rho_d: [mean[0], mean[1], mean[2]],
            rho_t: [mean[3], mean[4], mean[5]],
            rho_s: [mean[6], mean[7], mean[8]],
            m: mean[9],
        }
    }

    /// At a texture coordinate (repeating, v downwards), bilinearly between the texels' optics.
    #[must_use]
    pub fn at(&self, uv: [f32; 2]) -> SideOptics {
        let Some([w, h]) = self.side.maps.as_ref().map(|m| m.size) else {
            return self.of(0);
        };
        let place = |t: f32, n: u32| {
            let x = if t.is_finite() { t - t.floor() } else { 0.0 } * n as f32 - 0.5;
            let low = x.floor();
            let wrap = |i: f32| (i as i64).rem_euclid(i64::from(n)) as usize;
            ([wrap(low), wrap(low + 1.0)], x - low)
        };
        let ((x, fx), (y, fy)) = (place(uv[0], w), place(uv[1], h));
        let mut out = SideOptics::default();
        for (j, wy) in [1.0 - fy, fy].into_iter().enumerate() {
            for (i, wx) in [1.0 - fx, fx].into_iter().enumerate() {
                let o = self.of(y[j] * w as usize + x[i]);
                for c in 0..3 {
                    out.rho_d[c] += wx * wy * o.rho_d[c];
                    out.rho_t[c] += wx * wy * o.rho_t[c];
                    out.rho_s[c] += wx * wy * o.rho_s[c];
                }
                out.m += wx * wy * o.m;
            }
        }
        out
    }

    fn optics(&self, texel: Texel) -> SideOptics {
        let side = self.side;
        let mut out = SideOptics {
            m: texel.m.clamp(crate::abi::GLOSSY_MIN_ROUGHNESS, 1.0),
            ..SideOptics::default()
        };
        let thickness = self.leaf.thickness_mm * (1.0 + f64::from(texel.delta)).max(0.0);
        for c in 0..3 {
            let omega = side.omega(c);
            let delta = side.sigma_t(c) * thickness;
            let (a, b) = match self.leaf.mode {
                Mode::Paper => (side.constants[c][0], side.constants[c][1]),
                Mode::Exact => self.columns[c].read(delta),
            };
            let rho_t = (-delta).exp() + 0.5 * omega * b;
            let mut rho_d = f64::from(texel.gamma[c]) * 0.5 * omega * a;
            if self.leaf.mode == Mode::Exact {
                // gamma may not give back more than came in.
                rho_d = rho_d.min(1.0 - rho_t).max(0.0);
            }
            out.rho_d[c] = rho_d as f32;
            out.rho_t[c] = rho_t as f32;
            out.rho_s[c] = (side.gloss * texel.rho_s[c]).max(0.0);
        }
        out
    }
}
