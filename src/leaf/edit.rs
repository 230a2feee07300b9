//! Edits of a leaf: thickness, absorption and scattering per channel, gloss, roughness, size.
//!
//! What an edit leaves standing: the light-visibility maps (they hold geometry alone). What follows
//! at once: reflectance and transmittance, and with them direct sunlight and the first bounce of
//! the sky, which are products of the two and of stored geometry. What has to be computed again:
//! light that met more than one leaf on its way.

use std::str::FromStr;
use std::sync::Arc;

use super::appearance::{Face, LeafMaterial, Mode};
use super::maps::SideMaps;
use crate::{Error, Result};

/// A new value, or a factor on the old one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Change {
    /// Written `0.25`.
    To(f64),
    /// Written `1.5x`.
    Times(f64),
}

impl Change {
    /// The value after the change.
    #[must_use]
    pub fn apply(self, old: f64) -> f64 {
        match self {
            Self::To(value) => value,
            Self::Times(factor) => old * factor,
        }
    }
}

impl FromStr for Change {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let (number, factor) = match text.trim().strip_suffix(['x', 'X']) {
            Some(number) => (number, true),
            None => (text.trim(), false),
        };
        let value: f64 = number.trim().parse().map_err(|_| {
            Error::usage(format!(
                "{text:?} is neither a number nor a factor like 1.5x"
            ))
        })?;
        if !(value >= 0.0 && value.is_finite()) {
            return Err(Error::usage(format!("{text:?} is not a number >= 0")));
        }
        Ok(if factor {
            Self::Times(value)
        } else {
            Self::To(value)
        })
    }
}

/// One change for all channels, or one for each of R, G, B: `0.5x` or `1x,2x,1x`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Channels(pub [Change; 3]);

impl FromStr for Channels {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let parts = text
            .split(',')
            .map(Change::from_str)
            .collect::<Result<Vec<_>>>()?;
        match parts[..] {
            [one] => Ok(Self([one; 3])),
            [r, g, b] => Ok(Self([r, g, b])),
            _ => Err(Error::usage(format!(
                "{text:?} has {} values; one or three are needed",
                parts.len()
            ))),
        }
    }
}

/// What is changed; `None` stays.
#[derive(Debug, Clone, Default)]
pub struct Edit {
    /// Mean thickness, millimetres; veins grow in proportion.
    pub thickness: Option<Change>,
    /// Absorption, 1/mm.
    pub sigma_a: Option<Channels>,
    /// Scattering, 1/mm.
    pub sigma_s: Option<Channels>,
    /// Factor on the glossy lobe.
    pub gloss: Option<f32>,
    /// Roughness of the whole leaf.
    pub roughness: Option<Change>,
    /// Where A and B come from. Going to the paper's mode keeps the constants the leaf came with.
    pub mode: Option<Mode>,
    /// One side alone.
    pub face: Option<Face>,
    /// Width and height of the maps.
    pub size: Option<[u32; 2]>,
}

impl Edit {
    /// Changes `leaf`; returns how many texels reflect less than gamma asks for, because no more
    /// may come out than fell in.
    ///
    /// # Errors
    /// The edited leaf is none: no thickness, a roughness above 1.
    pub fn apply(&self, leaf: &mut LeafMaterial) -> Result<usize> {
        if let Some(change) = self.thickness {
            leaf.thickness_mm = change.apply(leaf.thickness_mm);
        }
        if let Some(mode) = self.mode {
            leaf.mode = mode;
        }
        for face in Face::ALL {
            if self.face.is_some_and(|only| only != face) {
                continue;
            }
            let side = leaf.side_mut(face);
            for (sigma, change) in [
                (&mut side.sigma_a, self.sigma_a),
                (&mut side.sigma_s, self.sigma_s),
            ] {
                if let Some(Channels(changes)) = change {
                    for (s, change) in sigma.iter_mut().zip(changes) {
                        *s = change.apply(*s);
                    }
                }
            }
            if let Some(gloss) = self.gloss {
                side.gloss *= gloss;
            }
            if let Some(change) = self.roughness {
                let new = |m: f32| change.apply(f64::from(m)).clamp(1e-3, 1.0) as f32;
                side.m = new(side.m);
                if let Some(maps) = side.maps.as_mut().map(Arc::make_mut) {
                    maps.specular.iter_mut().for_each(|t| t[3] = new(t[3]));
                }
            }
        }
        if let Some(size) = self.size {
            resize(leaf, size)?;
        }
        leaf.check()?;
        Ok(limited(leaf))
    }
}

/// Texels whose gamma is limited by energy.
fn limited(leaf: &LeafMaterial) -> usize {
    if leaf.mode == Mode::Paper {
        return 0;
    }
    let mut count = 0;
    for face in Face::ALL {
        let Some(maps) = &leaf.side(face).maps else {
            continue;
        };
        let sampler = leaf.sampler(face);
        count += (0..maps.len())
            .filter(|&i| leaf.coverage(i) > 0.0)
            .filter(|&i| {
                let o = sampler.of(i);
                (0..3).any(|c| o.rho_d[c] > 0.0 && o.rho_d[c] + o.rho_t[c] >= 1.0 - 1e-6)
            })
            .count();
    }
    count
}

/// Maps of another size, each texel the mean of what it covers.
fn resize(leaf: &mut LeafMaterial, size: [u32; 2]) -> Result<()> {
    let most = crate::scene::textures::MAX_SIDE;
    if size.iter().any(|&n| n == 0 || n > most) {
        return Err(Error::usage(format!(
            "maps of {}x{} texels: each side must be 1 to {most}",
            size[0], size[1]
        )));
    }
    let Some(old) = leaf.size() else {
        return Ok(());
    };
    for face in Face::ALL {
        if let Some(maps) = &leaf.side(face).maps {
            let maps = SideMaps {
                size,
                gamma_delta: resample(&maps.gamma_delta, old, size),
                specular: resample(&maps.specular, old, size),
            };
            leaf.side_mut(face).maps = Some(Arc::new(maps));
        }
    }
    if let Some(mask) = &leaf.mask {
        let pixels: Vec<[f32; 4]> = mask.iter().map(|&v| [v; 4]).collect();
        leaf.mask = Some(resample(&pixels, old, size).iter().map(|p| p[0]).collect());
    }
    Ok(())
}

/// Box filter when shrinking, nearest texel when growing.
fn resample(pixels: &[[f32; 4]], old: [u32; 2], new: [u32; 2]) -> Vec<[f32; 4]> {
    let span = |i: u32, axis: usize| {
        let (from, to) = (u64::from(old[axis]), u64::from(new[axis]));
        let low = u64::from(i) * from / to;
        let high = ((u64::from(i) + 1) * from).div_ceil(to).max(low + 1);
        low as usize..high as usize
    };
    let mut out = Vec::with_capacity(new[0] as usize * new[1] as usize);
    for y in 0..new[1] {
        for x in 0..new[0] {
            let (mut sum, mut count) = ([0.0; 4], 0.0);
            for j in span(y, 1) {
                for i in span(x, 0) {
                    let p = pixels[j * old[0] as usize + i];
                    (0..4).for_each(|c| sum[c] += p[c]);
                    count += 1.0;
                }
            }
            out.push(sum.map(|s| s / count));
        }
    }
    out
}
