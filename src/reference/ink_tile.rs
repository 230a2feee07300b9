//! Twin of `ink_tile.glsl`: the ink of a hatching tile at a place, a level and a darkness.

use glam::DVec2;

use crate::abi::{INK_LEVELS, INK_TILE};

/// Tones over which a stroke comes in, on both sides of its own.
const SOFT: f64 = 0.03;

fn of_texel(levels: &[Vec<u8>], (x, y): (i64, i64), level: usize, darkness: f64) -> f64 {
    let size = i64::from(INK_TILE >> level);
    let at = (y.rem_euclid(size) * size + x.rem_euclid(size)) as usize;
    let threshold = f64::from(levels[level][at]) / 255.0;
    if threshold >= 0.999 {
        return 0.0;
    }
    let soft = SOFT.min(darkness);
    let t = ((darkness - threshold + soft) / (2.0 * soft)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

fn of_level(levels: &[Vec<u8>], place: DVec2, level: usize, darkness: f64) -> f64 {
    let at = place * f64::from(INK_TILE >> level) - 0.5;
    let low = at.floor();
    let f = at - low;
    let (x, y) = (low.x as i64, low.y as i64);
    let texel = |dx, dy| of_texel(levels, (x + dx, y + dy), level, darkness);
    let top = texel(0, 0) + f.x * (texel(1, 0) - texel(0, 0));
    let bottom = texel(0, 1) + f.x * (texel(1, 1) - texel(0, 1));
    top + f.y * (bottom - top)
}

/// Ink at `place` (tiles, not necessarily wrapped) where a pixel spans two to the power of `level`
/// texels of the finest of `levels`.
#[must_use]
pub fn ink_of_tile(levels: &[Vec<u8>], place: DVec2, level: f64, darkness: f64) -> f64 {
    if darkness <= 0.0 {
        return 0.0;
    }
    let clamped = level.clamp(0.0, f64::from(INK_LEVELS) - 1.0);
    let fine = clamped.floor() as usize;
    let coarse = (fine + 1).min(INK_LEVELS as usize - 1);
    let own = of_level(levels, place, fine, darkness);
    let next = of_level(levels, place, coarse, darkness);
    let ink = own + (clamped - fine as f64) * (next - own);
    let sharp = (-level).exp2().clamp(1.0, 8.0);
    ((ink - 0.5) * sharp + 0.5).clamp(0.0, 1.0)
}

/// With the next octave, which takes over where strokes would grow: `ink_of_octaves`.
#[must_use]
pub fn ink_of_octaves(levels: &[Vec<u8>], place: DVec2, level: f64, darkness: f64) -> f64 {
    let ink = ink_of_tile(levels, place, level, darkness);
    let next = (-level).clamp(0.0, 1.0);
    ink + next * (ink_of_tile(levels, 2.0 * place, level + 1.0, darkness) - ink)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every level inked in every other column from darkness 1/2 on.
    fn columns() -> Vec<Vec<u8>> {
        let level = |l: u32| {
            let size = INK_TILE >> l;
            let texel = |i: u32| {
                if (i % size).is_multiple_of(2) {
                    127
                } else {
                    255
                }
            };
            (0..size * size).map(texel).collect()
        };
        (0..INK_LEVELS).map(level).collect()
    }

    #[test]
    fn half_the_texels_make_half_the_ink_at_any_darkness_above() {
        let levels = columns();
        for (level, darkness) in [(0.0, 0.6), (0.5, 0.95), (2.3, 0.7)] {
            let places = (0..4096).map(|i| DVec2::new(f64::from(i) / 4096.0, 0.3));
            let sum: f64 = places
                .map(|p| ink_of_tile(&levels, p, level, darkness))
                .sum();
            assert!(
                (sum / 4096.0 - 0.5).abs() < 1e-3,
                "{level}, {darkness}: {}",
                sum / 4096.0
            );
        }
        assert!(
            ink_of_tile(&levels, DVec2::new(0.3, 0.3), 0.0, 0.4) == 0.0,
            "below it"
        );
        assert!(ink_of_tile(&levels, DVec2::ZERO, -3.0, 0.0) == 0.0, "white");
    }
}
