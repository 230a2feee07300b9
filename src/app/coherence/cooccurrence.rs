//! How far a texture is distorted: the average co-occurrence error (Copeland, Ravichandran, Trivedi
//! 2001; used for stylised textures by Benard, Thollot, Sillion 2009).
//!
//! For each of a set of offsets, a co-occurrence matrix says how often grey `i` has grey `j` that
//! far away, over all pairs of pixels that count. The error of two pictures is the mean over the
//! offsets of the sum of absolute differences of their matrices, each of which sums to one: 0 for
//! the same texture, 2 for two that have no pair of greys in common.

/// Greys that are told apart.
const GREYS: usize = 8;
/// Farthest offset along both axes, pixels: somewhat more than the distance of strokes.
const REACH: i64 = 6;

/// Co-occurrence matrices of a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Matrices {
    /// One after the other; their pairs are counted.
    counts: Vec<f64>,
}

/// Offsets of one half plane: pairs count in both orders.
fn offsets() -> impl Iterator<Item = (i64, i64)> {
    let rows = |y: i64| (-REACH..=REACH).map(move |x| (x, y));
    (0..=REACH).flat_map(rows).filter(|&(x, y)| y > 0 || x > 0)
}

impl Matrices {
    /// Of `ink` (0 to 1) over all pairs of pixels for which `pair` holds, which is asked with two
    /// indices.
    #[must_use]
    pub fn new(ink: &[f32], pair: impl Fn(usize, usize) -> bool, [w, h]: [u32; 2]) -> Self {
        let (w, h) = (i64::from(w), i64::from(h));
        let grey = |i: usize| ((ink[i] * GREYS as f32) as usize).min(GREYS - 1);
        let greys: Vec<usize> = (0..ink.len()).map(grey).collect();
        let mut counts = Vec::new();
        for (dx, dy) in offsets() {
            let mut matrix = [0.0; GREYS * GREYS];
            for y in 0..h - dy {
                for x in (-dx).max(0)..w.min(w - dx) {
                    let (a, b) = ((y * w + x) as usize, ((y + dy) * w + x + dx) as usize);
                    if pair(a, b) {
                        matrix[greys[a] * GREYS + greys[b]] += 1.0;
                        matrix[greys[b] * GREYS + greys[a]] += 1.0;
                    }
                }
            }
            counts.extend(matrix);
        }
        Self { counts }
    }

    /// The average co-occurrence error against another picture, 0 to 2; none where one of them has
    /// no pairs.
    #[must_use]
    pub fn error(&self, other: &Self) -> Option<f64> {
        let own = self.counts.chunks_exact(GREYS * GREYS);
        let others = other.counts.chunks_exact(GREYS * GREYS);
        let (mut sum, mut matrices) = (0.0, 0.0);
        for (a, b) in own.zip(others) {
            let [n, m] = [a, b].map(|c| c.iter().sum::<f64>());
            if n <= 0.0 || m <= 0.0 {
                return None;
            }
            sum += a
                .iter()
                .zip(b)
                .map(|(a, b)| (a / n - b / m).abs())
                .sum::<f64>();
            matrices += 1.0;
        }
        Some(sum / matrices)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ink::strokes::{Tile, TileSettings};

    /// A tile of strokes at a darkness of 0.3, seen through a map of the picture.
    fn seen(tile: &Tile, map: impl Fn(f32, f32) -> (f32, f32)) -> Matrices {
        let ink = |i: u32| {
            let (u, v) = map((i % 128) as f32, (i / 128) as f32);
            let at = |t: f32| (t.rem_euclid(512.0)) as usize % 512;
            if tile.levels[0][at(v) * 512 + at(u)] < 77 {
                1.0
            } else {
                0.0
            }
        };
        let picture: Vec<f32> = (0..128 * 128).map(ink).collect();
        Matrices::new(&picture, |_, _| true, [128, 128])
    }

    #[test]
    fn the_same_is_0_and_a_texture_is_the_worse_the_more_it_is_stretched() {
        let tile = &Tile::new(&TileSettings {
            tones: 6,
            ..TileSettings::default()
        });
        let plain = seen(tile, |x, y| (x, y));
        assert_eq!(plain.error(&plain), Some(0.0));
        let against = |stretch: f32| {
            let along = seen(tile, |x, y| (x, y / stretch));
            plain.error(&along).unwrap_or(0.0)
        };
        let moved = plain.error(&seen(tile, |x, y| (x + 150.0, y + 230.0)));
        let moved = moved.unwrap_or(9.0);
        let errors = [1.25, 1.5, 2.0, 3.0, 5.0].map(against);
        assert!(errors.windows(2).all(|e| e[0] < e[1]), "{errors:?}");
        assert!(
            moved < errors[1],
            "elsewhere in the tile: {moved}, {errors:?}"
        );
        let turned = plain.error(&seen(tile, |x, y| (y, x))).unwrap_or(0.0);
        assert!(turned > errors[1], "turned by a right angle: {turned}");
        let none = Matrices::new(&[0.0; 16], |_, _| false, [4, 4]);
        assert_eq!(none.error(&none), None, "no pairs");
    }
}
