//! Images of a leaf to tissue and maps.
//!
//! Per side: the slab of every texel and channel; their arithmetic mean over the leaf is the
//! tissue; then one thickness per texel, and what reflectance that leaves over is gamma.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::newton::{Slab, clamp, invert};
use super::paper::paper_iteration;
use super::thickness::{Channel, exact_thickness, paper_thickness};
use crate::leaf::appearance::{Face, LeafMaterial, Mode, Side};
use crate::leaf::maps::SideMaps;
use crate::leaf::slab_table::{Column, SlabTable};
use crate::{Error, Result};

/// Images of one side, linear, rows from the top.
#[derive(Debug, Clone, Default)]
pub struct SideImages {
    /// Diffuse reflectance, RGB.
    pub reflectance: Vec<[f32; 3]>,
    /// Intensity of the gloss; empty: [`FitOptions::rho_s`] everywhere.
    pub specular: Vec<[f32; 3]>,
    /// Roughness m; empty: [`FitOptions::roughness`] everywhere.
    pub roughness: Vec<f32>,
}

/// What was measured.
#[derive(Debug, Clone, Default)]
pub struct FitInput {
    /// Name of the leaf.
    pub name: String,
    /// Width and height of every image.
    pub size: [u32; 2],
    /// Thickness h, millimetres: a free scale, since only products with it can be measured.
    pub thickness_mm: f64,
    /// Where the leaf is, \[0, 1\]; its veins are leaf too.
    pub mask: Vec<f32>,
    /// Transmittance, RGB; the same from both sides (reciprocity).
    pub transmittance: Vec<[f32; 3]>,
    /// The upper side.
    pub upper: SideImages,
    /// The lower side; without reflectance it is taken to be like the upper.
    pub lower: SideImages,
}

/// Choices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitOptions {
    /// Constant A and B with the paper's closed forms, or the table.
    pub mode: Mode,
    /// Surface reflection contained in the reflectance images, which is taken off first (0.035 for
    /// integrating spheres), \[0, 1).
    pub surface: f32,
    /// Gloss where there is no image of it.
    pub rho_s: [f32; 2],
    /// Roughness where there is no image of it, upper and lower.
    pub roughness: [f32; 2],
}

impl Default for FitOptions {
    fn default() -> Self {
        Self {
            mode: Mode::Exact,
            surface: 0.0,
            rho_s: [crate::leaf::appearance::USUAL_GLOSS; 2],
            roughness: [0.3, 0.5],
        }
    }
}

/// What one side's fit leaves over.
#[derive(Debug, Clone, Default)]
pub struct Residual {
    /// Model minus measured transmittance per texel and channel; 0 outside the leaf.
    pub transmittance: Vec<[f32; 3]>,
    /// Its root mean square over the leaf, per channel.
    pub rms: [f64; 3],
    /// Texels of which some channel was outside the model's range.
    pub clamped: usize,
    /// Texels whose gamma was lowered so that no more comes out than fell in.
    pub limited: usize,
    /// Texels for which the paper's closed form has no thickness in any channel.
    pub without_thickness: usize,
    /// Channels of texels for which the paper's iteration failed, in the order of
    /// [`super::PaperFailure`]; Newton's method stepped in. 0 with [`Mode::Exact`].
    pub iteration_failures: [usize; 3],
}

/// A leaf and how well it fits.
#[derive(Debug, Clone)]
pub struct Fitted {
    /// The leaf.
    pub material: LeafMaterial,
    /// Upper and lower.
    pub residuals: [Residual; 2],
    /// Texels of the leaf.
    pub texels: usize,
}

/// Fits both sides. `progress` is told the texels done and all of them, now and then, from any
/// thread.
///
/// # Errors
/// Images of different sizes, no mask or an empty one, a thickness or options out of range.
pub fn fit(
    input: &FitInput,
    options: &FitOptions,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<Fitted> {
    check(input, options)?;
    let leaf: Vec<usize> = (0..input.mask.len())
        .filter(|&i| input.mask[i] > 0.0)
        .collect();
    if leaf.is_empty() {
        return Err(Error::usage(format!(
            "leaf {:?}: the mask is empty: no texel is leaf",
            input.name
        )));
    }
    let done = Progress {
        done: AtomicUsize::new(0),
        all: 4 * leaf.len(),
        tell: progress,
    };
    let side = |images: &SideImages, face: usize| {
        SideFit {
            input,
            options,
            images,
            face,
            leaf: &leaf,
            progress: &done,
        }
        .run()
    };
    let (upper, first) = side(&input.upper, 0);
    let below = if input.lower.reflectance.is_empty() {
        SideImages {
            reflectance: input.upper.reflectance.clone(),
            ..input.lower.clone()
        }
    } else {
        input.lower.clone()
    };
    let (lower, second) = side(&below, 1);
    let material = LeafMaterial {
        name: input.name.clone(),
        thickness_mm: input.thickness_mm,
        mode: options.mode,
        upper,
        lower,
        mask: Some(Arc::from(input.mask.clone())),
    };
    material.check()?;
    Ok(Fitted {
        material,
        residuals: [first, second],
        texels: leaf.len(),
    })
}

fn check(input: &FitInput, options: &FitOptions) -> Result<()> {
    let refuse = |what: String| Err(Error::usage(format!("leaf {:?}: {what}", input.name)));
    let [w, h] = input.size;
    let count = w as usize * h as usize;
    if count == 0 {
        return refuse("the images are empty".into());
    }
    if !(input.thickness_mm > 0.0 && input.thickness_mm.is_finite()) {
        return refuse(format!(
            "thickness {} mm is not a number > 0",
            input.thickness_mm
        ));
    }
    if !(0.0..1.0).contains(&options.surface) {
        return refuse(format!(
            "surface reflection {} is outside [0, 1)",
            options.surface
        ));
    }
    if input.mask.is_empty() {
        return refuse("there is no leaf mask: which texels are leaf?".into());
    }
    let sizes = [
        ("mask", input.mask.len(), false),
        ("transmittance", input.transmittance.len(), false),
        ("upper reflectance", input.upper.reflectance.len(), false),
        ("lower reflectance", input.lower.reflectance.len(), true),
        ("upper specular", input.upper.specular.len(), true),
        ("lower specular", input.lower.specular.len(), true),
        ("upper roughness", input.upper.roughness.len(), true),
        ("lower roughness", input.lower.roughness.len(), true),
    ];
    for (name, length, optional) in sizes {
        if length != count && !(optional && length == 0) {
            return refuse(format!("{name} has {length} texels, {w}x{h} are {count}"));
        }
    }
    Ok(())
}

struct Progress<'a> {
    done: AtomicUsize,
    all: usize,
    tell: &'a (dyn Fn(usize, usize) + Sync),
}

impl Progress<'_> {
    fn add(&self, texels: usize) {
        let done = self.done.fetch_add(texels, Ordering::Relaxed) + texels;
        (self.tell)(done, self.all);
    }
}

/// Where the paper's iteration starts.
const PAPER_START: Slab = Slab {
    omega: 0.5,
    delta: 1.0,
};

/// Texels that one task takes.
const CHUNK: usize = 1024;

struct SideFit<'a> {
    input: &'a FitInput,
    options: &'a FitOptions,
    images: &'a SideImages,
    face: usize,
    leaf: &'a [usize],
    progress: &'a Progress<'a>,
}

/// What a task adds up: absorption and scattering times thickness, transmittance, weight.
#[derive(Clone, Copy, Default)]
struct Sums {
    absorption: [f64; 3],
    scattering: [f64; 3],
    transmittance: [f64; 3],
    weight: f64,
    clamped: usize,
    failures: [usize; 3],
}

/// A fitted texel.
struct TexelFit {
    gamma: [f32; 3],
    delta: f32,
    error: [f32; 3],
    limited: bool,
    without_thickness: bool,
}

impl SideFit<'_> {
    fn run(&self) -> (Side, Residual) {
        let sums = self.tissue();
        let h = self.input.thickness_mm;
        let mean = |v: [f64; 3]| v.map(|x| x / sums.weight / h);
        let mut side = Side::of_tissue(mean(sums.absorption), mean(sums.scattering), h);
        side.rho_s = [self.options.rho_s[self.face]; 3];
        side.m = self.options.roughness[self.face];
        let mean_t = sums.transmittance.map(|t| t / sums.weight);
        let columns = [0, 1, 2].map(|c| SlabTable::shared().at(side.omega(c)));
        let fits: Vec<Vec<TexelFit>> = self
            .leaf
            .par_chunks(CHUNK)
            .map(|texels| {
                let fits = texels
                    .iter()
                    .map(|&i| self.texel(i, &side, &columns, mean_t))
                    .collect();
                self.progress.add(texels.len());
                fits
            })
            .collect();
        let mut maps = SideMaps::plain(self.input.size, side.rho_s[0], side.m);
        let mut residual = Residual {
            transmittance: vec![[0.0; 3]; maps.len()],
            clamped: sums.clamped,
            iteration_failures: sums.failures,
            ..Residual::default()
        };
        for (&i, fit) in self.leaf.iter().zip(fits.into_iter().flatten()) {
            let [r, g, b] = fit.gamma;
            maps.gamma_delta[i] = [r, g, b, fit.delta];
            residual.transmittance[i] = fit.error;
            residual.limited += usize::from(fit.limited);
            residual.without_thickness += usize::from(fit.without_thickness);
            let w = f64::from(self.input.mask[i]);
            for c in 0..3 {
                residual.rms[c] += w * f64::from(fit.error[c]).powi(2);
            }
        }
        residual.rms = residual.rms.map(|s| (s / sums.weight).sqrt());
        self.surface(&mut maps);
        side.maps = Some(Arc::new(maps));
        (side, residual)
    }

    /// Step 1: the slab of every texel, and the mean.
    fn tissue(&self) -> Sums {
        let parts: Vec<Sums> = self
            .leaf
            .par_chunks(CHUNK)
            .map(|texels| {
                let mut sums = Sums::default();
                for &i in texels {
                    self.add_texel(i, &mut sums);
                }
                self.progress.add(texels.len());
                sums
            })
            .collect();
        // In order, so that two runs agree in every bit.
        parts.iter().fold(Sums::default(), |mut all, part| {
            for c in 0..3 {
                all.absorption[c] += part.absorption[c];
                all.scattering[c] += part.scattering[c];
                all.transmittance[c] += part.transmittance[c];
            }
            all.weight += part.weight;
            all.clamped += part.clamped;
            (0..3).for_each(|k| all.failures[k] += part.failures[k]);
            all
        })
    }

    fn add_texel(&self, i: usize, sums: &mut Sums) {
        let w = f64::from(self.input.mask[i]);
        let mut moved = false;
        for c in 0..3 {
            let (share, outside) = clamp(
                self.reflected(i, c),
                f64::from(self.input.transmittance[i][c]),
            );
            moved |= outside;
            let slab = match self.options.mode {
                Mode::Exact => invert(share),
                Mode::Paper => paper_iteration(share, PAPER_START).map_or_else(
                    |failure| {
                        sums.failures[failure as usize] += 1;
                        invert(share)
                    },
                    |(slab, _)| slab,
                ),
            };
            sums.absorption[c] += w * (1.0 - slab.omega) * slab.delta;
            sums.scattering[c] += w * slab.omega * slab.delta;
            sums.transmittance[c] += w * share.t;
        }
        sums.weight += w;
        sums.clamped += usize::from(moved);
    }

    /// Diffusely reflected: without the surface's share.
    fn reflected(&self, i: usize, c: usize) -> f64 {
        f64::from(self.images.reflectance[i][c]) - f64::from(self.options.surface)
    }

    /// Steps 2 and 3: thickness and gamma of one texel.
    fn texel(&self, i: usize, side: &Side, columns: &[Column; 3], mean_t: [f64; 3]) -> TexelFit {
        let h = self.input.thickness_mm;
        let shares: [_; 3] = std::array::from_fn(|c| {
            clamp(
                self.reflected(i, c),
                f64::from(self.input.transmittance[i][c]),
            )
            .0
        });
        let channels: [Channel<'_>; 3] = std::array::from_fn(|c| Channel {
            column: &columns[c],
            delta: side.sigma_t(c) * h,
            mean: mean_t[c],
            measured: shares[c].t,
        });
        let paper = self.options.mode == Mode::Paper;
        let thickness = if paper {
            paper_mean(side, &channels)
        } else {
            Some(exact_thickness(&channels))
        };
        let delta = thickness.unwrap_or(0.0).clamp(-0.95, 4.0);
        let mut out = TexelFit {
            gamma: [1.0; 3],
            delta: delta as f32,
            error: [0.0; 3],
            limited: false,
            without_thickness: thickness.is_none(),
        };
        for c in 0..3 {
            let optical = channels[c].delta * (1.0 + delta);
            let omega = side.omega(c);
            let (r, t) = if paper {
                let [a, b] = side.constants[c];
                (0.5 * omega * a, (-optical).exp() + 0.5 * omega * b)
            } else {
                let share = columns[c].share(optical);
                (share.r, share.t)
            };
            let mut gamma = if r > 0.0 { shares[c].r / r } else { 1.0 };
            if !paper && gamma * r + t > 1.0 {
                gamma = ((1.0 - t) / r).max(0.0);
                out.limited = true;
            }
            out.gamma[c] = gamma as f32;
            out.error[c] = (t - f64::from(self.input.transmittance[i][c])) as f32;
        }
        out
    }

    fn surface(&self, maps: &mut SideMaps) {
        for &i in self.leaf {
            let texel = &mut maps.specular[i];
            if let Some(s) = self.images.specular.get(i) {
                texel[..3].copy_from_slice(&s.map(|v| v.clamp(0.0, 1.0)));
            }
            if let Some(m) = self.images.roughness.get(i) {
                texel[3] = if *m > 0.0 { m.clamp(0.01, 1.0) } else { 0.01 };
            }
        }
    }
}

/// The mean of the paper's closed forms of those channels that have one, weighted by how much they
/// transmit.
fn paper_mean(side: &Side, channels: &[Channel<'_>; 3]) -> Option<f64> {
    let (mut sum, mut weight) = (0.0, 0.0);
    for (c, channel) in channels.iter().enumerate() {
        let scattered = 0.5 * side.omega(c) * side.constants[c][1];
        if let Some(d) = paper_thickness(channel.delta, scattered, channel.measured) {
            sum += d * channel.mean;
            weight += channel.mean;
        }
    }
    (weight > 0.0).then(|| sum / weight)
}

/// The optics of the mean texel against the mean of the measured ones, for reports.
impl Fitted {
    /// Largest difference of the leaf's mean transmittance from what was measured, over the sides
    /// and channels.
    #[must_use]
    pub fn worst_rms(&self) -> f64 {
        self.residuals
            .iter()
            .flat_map(|r| r.rms)
            .fold(0.0, f64::max)
    }

    /// One side's residual.
    #[must_use]
    pub fn residual(&self, face: Face) -> &Residual {
        match face {
            Face::Upper => &self.residuals[0],
            Face::Lower => &self.residuals[1],
        }
    }
}
