//! Pictures of linear light, and how far one is from another.

use crate::math::colour::linear_to_srgb8;
use crate::{Error, Result};

/// Edge of the blocks in which pictures are compared, pixels: single pixels differ by what
/// sampling leaves at silhouettes.
const BLOCK: usize = 8;

/// Linear RGB and coverage of each pixel, from the top left; black where nothing is.
#[derive(Debug, Clone, PartialEq)]
pub struct RadianceMap {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// One a pixel.
    pub pixels: Vec<[f32; 4]>,
}

/// Differences of a picture from a reference, over where the reference is not black, in shares of
/// the reference's mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Mean of the reference.
    pub mean: f64,
    /// Mean difference.
    pub bias: f64,
    /// Root mean square difference of pixels.
    pub rmse: f64,
    /// Root mean square difference of 8 x 8 blocks of which more than half is covered.
    pub block_rmse: f64,
    /// 99th percentile of the absolute difference.
    pub p99: f64,
    /// Share of pixels that only one of the two covers.
    pub coverage: f64,
}

impl RadianceMap {
    /// A black picture.
    #[must_use]
    pub fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            pixels: vec![[0.0; 4]; width * height],
        }
    }

    /// Mean of `factor` x `factor` pixels.
    #[must_use]
    pub fn reduced(&self, factor: usize) -> Self {
        let mut out = Self::new(self.width / factor, self.height / factor);
        let share = 1.0 / (factor * factor) as f32;
        for y in 0..out.height * factor {
            for x in 0..out.width * factor {
                let target = &mut out.pixels[y / factor * out.width + x / factor];
                for (sum, v) in target.iter_mut().zip(self.pixels[y * self.width + x]) {
                    *sum += share * v;
                }
            }
        }
        out
    }

    /// This plus `other`, of the same size; coverage is that of this.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        let mut out = self.clone();
        for (a, b) in out.pixels.iter_mut().zip(&other.pixels) {
            for c in 0..3 {
                a[c] += b[c];
            }
        }
        out
    }

    /// sRGB bytes with exposure, over a background of linear `behind`.
    #[must_use]
    pub fn to_rgba8(&self, exposure: f32, behind: [f32; 3]) -> Vec<u8> {
        let byte = |p: &[f32; 4], c: usize| {
            let open = (1.0 - p[3]).clamp(0.0, 1.0);
            linear_to_srgb8((exposure * p[c] + open * behind[c]).clamp(0.0, 1.0))
        };
        self.pixels
            .iter()
            .flat_map(|p| [byte(p, 0), byte(p, 1), byte(p, 2), 255])
            .collect()
    }

    /// Quantile `q` of the brightest channel over covered pixels.
    #[must_use]
    pub fn quantile(&self, q: f64) -> f32 {
        let lit = self.pixels.iter().filter(|p| p[3] > 0.5);
        let values: Vec<f64> = lit.map(|p| f64::from(p[0].max(p[1]).max(p[2]))).collect();
        if values.is_empty() {
            return 0.0;
        }
        crate::math::stats::quantile(&values, q) as f32
    }

    fn grey(&self, i: usize) -> f32 {
        let p = self.pixels[i];
        (p[0] + p[1] + p[2]) / 3.0
    }

    /// How far `self` is from `reference`.
    ///
    /// # Errors
    /// Pictures of different sizes, or a reference that is black all over.
    pub fn difference(&self, reference: &Self) -> Result<Difference> {
        if (self.width, self.height) != (reference.width, reference.height) {
            return Err(Error::usage(format!(
                "compare: {}x{} pixels and {}x{}",
                self.width, self.height, reference.width, reference.height
            )));
        }
        let seen: Vec<bool> = (0..self.pixels.len())
            .map(|i| reference.grey(i) > 1e-6)
            .collect();
        let count = seen.iter().filter(|&&s| s).count() as f64;
        if count == 0.0 {
            return Err(Error::usage("compare: the reference is black"));
        }
        let (mut sum, mut bias, mut squares, mut sizes) = (0.0, 0.0, 0.0, Vec::new());
        for i in (0..seen.len()).filter(|&i| seen[i]) {
            for c in 0..3 {
                let r = f64::from(reference.pixels[i][c]);
                let d = f64::from(self.pixels[i][c]) - r;
                sum += r;
                bias += d;
                squares += d * d;
                sizes.push(d.abs());
            }
        }
        let n = 3.0 * count;
        let mean = sum / n;
        let unlike = (0..seen.len()).filter(|&i| (self.grey(i) > 1e-6) != seen[i]);
        Ok(Difference {
            mean,
            bias: bias / n / mean,
            rmse: (squares / n).sqrt() / mean,
            block_rmse: self.block_rmse(reference, &seen) / mean,
            p99: crate::math::stats::quantile(&sizes, 0.99) / mean,
            coverage: unlike.count() as f64 / seen.len() as f64,
        })
    }

    fn block_rmse(&self, reference: &Self, seen: &[bool]) -> f64 {
        let (mut squares, mut blocks) = (0.0, 0.0_f64);
        for by in 0..self.height / BLOCK {
            for bx in 0..self.width / BLOCK {
                let pixels = (0..BLOCK * BLOCK)
                    .map(|k| (by * BLOCK + k / BLOCK) * self.width + bx * BLOCK + k % BLOCK);
                let covered = pixels.clone().filter(|&i| seen[i]).count();
                if 2 * covered <= BLOCK * BLOCK {
                    continue;
                }
                for c in 0..3 {
                    let d: f64 = pixels
                        .clone()
                        .map(|i| f64::from(self.pixels[i][c]) - f64::from(reference.pixels[i][c]))
                        .sum();
                    squares += (d / (BLOCK * BLOCK) as f64).powi(2);
                }
                blocks += 3.0;
            }
        }
        if blocks > 0.0 {
            (squares / blocks).sqrt()
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_what_they_say() {
        let mut a = RadianceMap::new(16, 16);
        for p in &mut a.pixels {
            *p = [1.0, 1.0, 1.0, 1.0];
        }
        let mut b = a.clone();
        // Noise of +-0.5 that cancels within blocks, and a bias of 0.1.
        for (i, p) in b.pixels.iter_mut().enumerate() {
            let noise = if i % 2 == 0 { 0.5 } else { -0.5 };
            *p = [1.1 + noise, 1.1 + noise, 1.1 + noise, 1.0];
        }
        let d = b.difference(&a).unwrap();
        assert!((d.bias - 0.1).abs() < 1e-6, "{d:?}");
        assert!((d.block_rmse - 0.1).abs() < 1e-6, "{d:?}");
        assert!((d.rmse - 0.26_f64.sqrt()).abs() < 1e-6, "{d:?}");
        assert_eq!(d.coverage, 0.0);
        assert!(b.difference(&RadianceMap::new(8, 8)).is_err());
        assert_eq!(a.reduced(4).pixels, vec![[1.0; 4]; 16]);
    }
}
