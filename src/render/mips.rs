//! Mip maps that keep alpha coverage.
//!
//! Colour is averaged in linear light, weighted by alpha, and bleeds into transparent texels, so
//! that no fringe of the hidden background shows. Alpha of every level is scaled so that the share
//! of texels that pass the alpha test stays that of the full texture (Castano 2010, Computing
//! Alpha Mipmaps); without this distant crowns grow thin.

use rayon::prelude::*;

use super::texture::{Decoded, TextureKey, edge_limit};
use crate::math::colour::{linear_to_srgb8, srgb8_to_linear};

/// One level in linear light: colour (not multiplied by alpha) and alpha.
#[derive(Debug, Clone)]
struct Level {
    extent: [usize; 2],
    texels: Vec<[f32; 4]>,
}

impl Level {
    fn halve(&self) -> Self {
        let [w, h] = self.extent;
        let extent = [(w / 2).max(1), (h / 2).max(1)];
        let columns = spans(w, extent[0]);
        let rows = spans(h, extent[1]);
        let texels = rows
            .par_iter()
            .flat_map_iter(|row| columns.iter().map(|column| self.average(column, row)))
            .collect();
        Self { extent, texels }
    }

    /// Mean over a box of texels; colour is weighted by alpha where there is any.
    fn average(&self, column: &Span, row: &Span) -> [f32; 4] {
        let (mut covered, mut plain, mut alpha, mut weight) = ([0f32; 3], [0f32; 3], 0f32, 0f32);
        for (y, wy) in row.iter() {
            for (x, wx) in column.iter() {
                let t = self.texels[y * self.extent[0] + x];
                let w = wx * wy;
                for c in 0..3 {
                    covered[c] += w * t[3] * t[c];
                    plain[c] += w * t[c];
                }
                alpha += w * t[3];
                weight += w;
            }
        }
        let [r, g, b] = if alpha > 1e-6 {
            covered.map(|c| c / alpha)
        } else {
            plain.map(|c| c / weight)
        };
        [r, g, b, alpha / weight]
    }
}

/// Source texels of one destination texel along an axis, with their weights: a box filter, so an
/// odd edge gives three texels with fractional ends (no shift of the image).
struct Span {
    first: usize,
    weights: [f32; 3],
}

impl Span {
    fn iter(&self) -> impl Iterator<Item = (usize, f32)> {
        let first = self.first;
        self.weights
            .into_iter()
            .enumerate()
            .filter(|(_, w)| *w > 0.0)
            .map(move |(i, w)| (first + i, w))
    }
}

fn spans(from: usize, to: usize) -> Vec<Span> {
    let step = from as f64 / to as f64;
    (0..to)
        .map(|i| {
            let (lo, hi) = (i as f64 * step, (i + 1) as f64 * step);
            let first = i * from / to;
            let weights = [0, 1, 2].map(|k| {
                let (a, b) = ((first + k) as f64, (first + k + 1) as f64);
                if first + k < from {
                    (hi.min(b) - lo.max(a)).max(0.0) as f32
                } else {
                    0.0
                }
            });
            Span { first, weights }
        })
        .collect()
}

/// All mip levels of a texture as bytes, largest first: RGBA8 (sRGB colour) or R8 (alpha only).
/// Levels whose longest edge exceeds `limit` are left out.
#[must_use]
pub fn mip_levels(image: &Decoded, key: TextureKey, limit: u32) -> Vec<Vec<u8>> {
    let mut pyramid = vec![first_level(image, key)];
    while pyramid.last().is_some_and(|l| l.extent != [1, 1]) {
        let next = pyramid[pyramid.len() - 1].halve();
        pyramid.push(next);
    }
    let cutoff = key.cutoff.map(f32::from_bits);
    let target = cutoff.map(|c| coverage(&pyramid[0], c, 1.0));
    let limit = edge_limit(key, limit).max(1) as usize;
    if cutoff.is_some() && !key.alpha_only {
        bleed(&mut pyramid);
    }
    pyramid
        .par_iter()
        .enumerate()
        .filter(|(_, l)| l.extent[0].max(l.extent[1]) <= limit)
        .map(|(i, level)| {
            let scale = match (cutoff, target) {
                (Some(c), Some(t)) if i > 0 => coverage_scale(level, c, t),
                _ => 1.0,
            };
            encode(level, scale, key.alpha_only)
        })
        .collect()
}

fn first_level(image: &Decoded, key: TextureKey) -> Level {
    let opaque = key.cutoff.is_none();
    Level {
        extent: image.extent.map(|e| e as usize),
        texels: image
            .rgba
            .par_chunks_exact(4)
            .map(|p| {
                let alpha = if opaque { 1.0 } else { f32::from(p[3]) / 255.0 };
                if key.alpha_only {
                    [0.0, 0.0, 0.0, alpha]
                } else {
                    [
                        srgb8_to_linear(p[0]),
                        srgb8_to_linear(p[1]),
                        srgb8_to_linear(p[2]),
                        alpha,
                    ]
                }
            })
            .collect(),
    }
}

/// Alpha below which a texel takes colour from the coarser level: what it holds was never meant
/// to be seen.
const HIDDEN_ALPHA: f32 = 0.06;

/// Fills transparent texels with the colour of the coarser level, from the coarsest down.
fn bleed(pyramid: &mut [Level]) {
    for i in (1..pyramid.len()).rev() {
        let (fine, coarse) = pyramid.split_at_mut(i);
        let (fine, coarse) = (&mut fine[i - 1], &coarse[0]);
        let [w, h] = fine.extent;
        fine.texels
            .par_chunks_exact_mut(w)
            .enumerate()
            .for_each(|(y, row)| {
                let cy = y * coarse.extent[1] / h;
                for (x, t) in row
                    .iter_mut()
                    .enumerate()
                    .filter(|(_, t)| t[3] < HIDDEN_ALPHA)
                {
                    let c = coarse.texels[cy * coarse.extent[0] + x * coarse.extent[0] / w];
                    let own = t[3] / HIDDEN_ALPHA;
                    for k in 0..3 {
                        t[k] = c[k] + (t[k] - c[k]) * own;
                    }
                }
            });
    }
}

/// Edge from which texels are counted as they are; below it, bilinear interpolation between them
/// matters.
const COUNTED_EDGE: usize = 256;
/// Bilinear samples across a texel of a small level.
const SUBSAMPLES: usize = 4;

/// Share of the level that passes the alpha test when its alpha is multiplied by `scale` (and
/// rounded to bytes, as it is when stored). Small levels are sampled as a bilinear sampler does.
fn coverage(level: &Level, cutoff: f32, scale: f32) -> f32 {
    let [w, h] = level.extent;
    let alpha = |i: usize| ((level.texels[i][3] * scale).min(1.0) * 255.0).round() / 255.0;
    if w.min(h) >= COUNTED_EDGE {
        let passing = (0..w * h).filter(|&i| alpha(i) >= cutoff).count();
        return passing as f32 / (w * h) as f32;
    }
    let at = |x: usize, y: usize| alpha((y % h) * w + x % w);
    let steps: [f32; SUBSAMPLES] = std::array::from_fn(|k| (k as f32 + 0.5) / SUBSAMPLES as f32);
    let mut passing = 0usize;
    for y in 0..h {
        for x in 0..w {
            let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x, y + 1), at(x + 1, y + 1)];
            if a.min(b).min(c).min(d) >= cutoff {
                passing += SUBSAMPLES * SUBSAMPLES;
                continue;
            }
            if a.max(b).max(c).max(d) < cutoff {
                continue;
            }
            for v in steps {
                let (left, right) = (a + (c - a) * v, b + (d - b) * v);
                let row = steps
                    .iter()
                    .filter(|u| left + (right - left) * **u >= cutoff);
                passing += row.count();
            }
        }
    }
    passing as f32 / (w * h * SUBSAMPLES * SUBSAMPLES) as f32
}

/// Factor on alpha that gives `level` the coverage `target`, by bisection (coverage rises with
/// the factor).
fn coverage_scale(level: &Level, cutoff: f32, target: f32) -> f32 {
    let (mut low, mut high) = (0.0f32, 16.0f32);
    if coverage(level, cutoff, high) < target {
        return 1.0;
    }
    for _ in 0..14 {
        let middle = 0.5 * (low + high);
        if coverage(level, cutoff, middle) < target {
            low = middle;
        } else {
            high = middle;
        }
    }
    // Coverage jumps where texels are equal: take the nearer side.
    let error = |scale| (coverage(level, cutoff, scale) - target).abs();
    if error(low) < error(high) { low } else { high }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped to a byte's range"
)]
fn encode(level: &Level, scale: f32, alpha_only: bool) -> Vec<u8> {
    let alpha = |t: &[f32; 4]| ((t[3] * scale).clamp(0.0, 1.0) * 255.0).round() as u8;
    if alpha_only {
        return level.texels.iter().map(alpha).collect();
    }
    level
        .texels
        .iter()
        .flat_map(|t| {
            [
                linear_to_srgb8(t[0]),
                linear_to_srgb8(t[1]),
                linear_to_srgb8(t[2]),
                alpha(t),
            ]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::texture::levels_within;

    /// A leaf-like mask: green discs on a black, transparent ground.
    fn leaves(edge: u32) -> Decoded {
        let mut rgba = Vec::new();
        for y in 0..edge {
            for x in 0..edge {
                let [fx, fy] = [x, y].map(|v| (v as f32 + 0.5) / edge as f32 * 4.0);
                let k = fx.floor() + 4.0 * fy.floor();
                let (dx, dy) = (
                    fx.fract() - 0.5 + 0.1 * (1.7 * k).sin(),
                    fy.fract() - 0.5 + 0.1 * (2.9 * k).cos(),
                );
                let radius = 0.3 + 0.07 * k.sin();
                let a = ((radius - dx.hypot(dy)) * edge as f32 / 4.0 + 0.5).clamp(0.0, 1.0);
                let c = if a > 0.0 { [60, 120, 30] } else { [0; 3] };
                rgba.extend([c[0], c[1], c[2], (a * 255.0) as u8]);
            }
        }
        Decoded {
            extent: [edge, edge],
            rgba: rgba.into(),
        }
    }

    fn key(cutoff: f32) -> TextureKey {
        TextureKey {
            image: 0,
            cutoff: Some(cutoff.to_bits()),
            alpha_only: false,
        }
    }

    fn decoded_level(bytes: &[u8], edge: usize) -> Level {
        Level {
            extent: [edge, edge],
            texels: bytes
                .chunks_exact(4)
                .map(|p| [0.0, 0.0, 0.0, f32::from(p[3]) / 255.0])
                .collect(),
        }
    }

    #[test]
    fn every_level_keeps_the_coverage() {
        for cutoff in [0.3, 0.5, 0.8] {
            let image = leaves(256);
            let levels = mip_levels(&image, key(cutoff), 4096);
            assert_eq!(levels.len(), 9);
            let full = coverage(&decoded_level(&levels[0], 256), cutoff, 1.0);
            // A few texels cannot express the pattern of 16 discs.
            for (i, level) in levels.iter().enumerate().take(6) {
                let c = coverage(&decoded_level(level, 256 >> i), cutoff, 1.0);
                assert!(
                    (c - full).abs() < 0.02,
                    "cutoff {cutoff} level {i}: {c} of {full}"
                );
            }
        }
    }

    #[test]
    fn hidden_black_does_not_darken_edges() {
        for level in mip_levels(&leaves(64), key(0.5), 4096) {
            for p in level.chunks_exact(4) {
                assert!(p[1] >= 118 && p[1] <= 122, "green {} alpha {}", p[1], p[3]);
            }
        }
    }

    #[test]
    fn averages_are_made_in_linear_light() {
        let image = Decoded {
            extent: [2, 1],
            rgba: vec![0, 0, 0, 255, 255, 255, 255, 255].into(),
        };
        let opaque = TextureKey {
            image: 0,
            cutoff: None,
            alpha_only: false,
        };
        let levels = mip_levels(&image, opaque, 4096);
        assert_eq!(levels[1], [188, 188, 188, 255]);
    }

    #[test]
    fn odd_edges_are_not_shifted() {
        // A ramp's mean stays at its middle whatever the edge.
        for edge in [3u32, 5, 7, 13] {
            let level = Level {
                extent: [edge as usize, 1],
                texels: (0..edge)
                    .map(|i| [(i as f32 + 0.5) / edge as f32, 0.0, 0.0, 1.0])
                    .collect(),
            };
            let mut l = level;
            while l.extent[0] > 1 {
                l = l.halve();
            }
            assert!(
                (l.texels[0][0] - 0.5).abs() < 1e-6,
                "{edge}: {}",
                l.texels[0][0]
            );
        }
    }

    #[test]
    fn limit_leaves_out_large_levels() {
        assert_eq!(levels_within([4096, 1024], 2048), ([2048, 512], 12));
        assert_eq!(levels_within([5, 3], 16), ([5, 3], 3));
        let all = mip_levels(&leaves(64), key(0.5), 4096);
        let few = mip_levels(&leaves(64), key(0.5), 16);
        assert_eq!(few, all[2..]);
    }
}
