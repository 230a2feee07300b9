//! Where strokes run on stems, and which of them cross.

use glam::{DMat2, DVec2};

use super::diffusion::DiffusionSettings;
use super::drawing::Visible;
use super::renderer::Maps;

/// Half the width of the window that gives strokes on stems their direction, pixels.
const WINDOW: usize = 6;

/// Turn of the strokes that cross others, radians.
const TURN: f64 = 1.2;

/// Darkness that a first layer of strokes carries, up to `crossing`, and what is left for a second
/// one, each with its turn. Negative darkness (not to be drawn on) stays.
pub(super) fn layers(darkness: &[f32], crossing: f64) -> [(Vec<f32>, f64); 2] {
    let crossing = crossing as f32;
    let first = darkness.iter().map(|&d| d.min(crossing)).collect();
    let rest = |&d: &f32| {
        if d < 0.0 {
            d
        } else {
            (d - crossing).max(0.0) / (1.0 - crossing).max(1e-3)
        }
    };
    [(first, 0.0), (darkness.iter().map(rest).collect(), TURN)]
}

/// The direction across branches: the normals' projections turn about the branch's axis, so that
/// their common direction over a few pixels is the one across it.
pub(super) struct Across {
    size: [usize; 2],
    /// Sums of products of the projections from the upper left corner: xx, xy, yy.
    sums: Vec<[f64; 3]>,
}

impl Across {
    pub(super) fn new(maps: &Maps, visible: &Visible) -> Self {
        let [w, h] = maps.size;
        let mut sums = vec![[0.0; 3]; (w + 1) * (h + 1)];
        for y in 0..h {
            let mut row = [0.0; 3];
            for x in 0..w {
                if visible.stems[y * w + x] {
                    let n = maps.stem_normal[y * w + x];
                    let (nx, ny) = (f64::from(n[0]), -f64::from(n[1]));
                    for (r, v) in row.iter_mut().zip([nx * nx, nx * ny, ny * ny]) {
                        *r += v;
                    }
                }
                let above = sums[y * (w + 1) + x + 1];
                let here = &mut sums[(y + 1) * (w + 1) + x + 1];
                for k in 0..3 {
                    here[k] = above[k] + row[k];
                }
            }
        }
        Self {
            size: maps.size,
            sums,
        }
    }

    pub(super) fn at(&self, x: usize, y: usize) -> DVec2 {
        let [w, h] = self.size;
        let (x0, y0) = (x.saturating_sub(WINDOW), y.saturating_sub(WINDOW));
        let (x1, y1) = ((x + WINDOW + 1).min(w), (y + WINDOW + 1).min(h));
        let sum = |x: usize, y: usize| self.sums[y * (w + 1) + x];
        let [a, b, c, d] = [sum(x1, y1), sum(x0, y1), sum(x1, y0), sum(x0, y0)];
        let [xx, xy, yy] = [0, 1, 2].map(|k| a[k] - b[k] - c[k] + d[k]);
        // Direction of the larger eigenvalue of the symmetric matrix.
        let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
        DMat2::from_angle(angle) * DVec2::X
    }
}

/// About how many strokes carry the tones.
pub(super) fn expected(tones: &[(Vec<f32>, f64)], settings: &DiffusionSettings) -> usize {
    let dark = tones
        .iter()
        .flat_map(|t| &t.0)
        .map(|d| f64::from(d.max(0.0)));
    (dark.sum::<f64>() / (settings.length * settings.width).max(1e-6)) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_layer_carries_what_is_darker_than_the_crossing() {
        let [first, second] = layers(&[-1.0, 0.0, 0.4, 0.6, 0.8, 1.0], 0.6);
        assert_eq!(first, (vec![-1.0, 0.0, 0.4, 0.6, 0.6, 0.6], 0.0));
        for (found, want) in second.0.iter().zip([-1.0, 0.0, 0.0, 0.0, 0.5, 1.0]) {
            assert!((found - want).abs() < 1e-6, "{found} for {want}");
        }
        let [first, second] = layers(&[0.3, 1.0], 1.0);
        assert_eq!((first.0, second.0), (vec![0.3, 1.0], vec![0.0, 0.0]));
    }
}
