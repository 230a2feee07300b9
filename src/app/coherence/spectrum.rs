//! Size of strokes on the screen: the middle of the spectrum of ink, and the mean width of strokes.

use std::f64::consts::TAU;

/// Edge of the windows whose spectra are added up, pixels.
const WINDOW: usize = 48;
/// Least share of a window that must be foliage.
const FILLED: f64 = 0.97;
/// Longest and shortest distance of strokes that is looked for, pixels.
const PERIODS: [f64; 2] = [16.0, 2.2];

/// Pixels between strokes, by the middle of the spectra of all windows that foliage fills; none where
/// there is no such window, or no ink.
#[must_use]
pub fn spacing(ink: &[f32], filled: impl Fn(usize) -> bool, [w, h]: [u32; 2]) -> Option<f64> {
    let (w, h) = (w as usize, h as usize);
    let mut rings = vec![0.0; WINDOW / 2];
    for y in (0..h.saturating_sub(WINDOW - 1)).step_by(WINDOW / 2) {
        for x in (0..w.saturating_sub(WINDOW - 1)).step_by(WINDOW / 2) {
            let places = (0..WINDOW * WINDOW).map(|i| (y + i / WINDOW) * w + x + i % WINDOW);
            let full = places.clone().filter(|&i| filled(i)).count();
            if full as f64 >= FILLED * (WINDOW * WINDOW) as f64 {
                let values: Vec<f64> = places.map(|i| f64::from(ink[i])).collect();
                add_spectrum(&values, &mut rings);
            }
        }
    }
    middle(&rings)
}

/// Mean width of strokes, pixels: twice the area of ink over the length of its outline, by the
/// crossings of rows and columns (Crofton's formula); none where there is no ink.
#[must_use]
pub fn width(ink: &[f32], filled: impl Fn(usize) -> bool, [w, h]: [u32; 2]) -> Option<f64> {
    let (w, h) = (w as usize, h as usize);
    let inked = |i: usize| ink[i] > 0.5;
    let (mut area, mut crossings) = (0.0, 0.0);
    for i in 0..w * h {
        if !filled(i) {
            continue;
        }
        area += f64::from(u8::from(inked(i)));
        let right = (i % w + 1 < w).then_some(i + 1);
        let below = (i / w + 1 < h).then_some(i + w);
        for j in [right, below].into_iter().flatten().filter(|&j| filled(j)) {
            crossings += f64::from(u8::from(inked(i) != inked(j)));
        }
    }
    let outline = 0.25 * std::f64::consts::PI * crossings;
    (outline > 0.0).then(|| 2.0 * area / outline)
}

/// Adds the power of a window by the length of its waves' number.
fn add_spectrum(values: &[f64], rings: &mut [f64]) {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let waves: [(f64, f64); WINDOW] =
        std::array::from_fn(|i| (TAU * i as f64 / WINDOW as f64).sin_cos());
    let wave = |i: usize, k: usize| waves[(i * k) % WINDOW];
    let hann = |i: usize| 0.5 - 0.5 * (TAU * (i as f64 + 0.5) / WINDOW as f64).cos();
    let windowed: Vec<f64> = values
        .iter()
        .enumerate()
        .map(|(i, v)| (v - mean) * hann(i % WINDOW) * hann(i / WINDOW))
        .collect();
    // Rows first: [row][wave] of real and imaginary parts.
    let mut rows = vec![(0.0, 0.0); WINDOW * WINDOW];
    for y in 0..WINDOW {
        for k in 0..WINDOW {
            let mut sum = (0.0, 0.0);
            for x in 0..WINDOW {
                let v = windowed[y * WINDOW + x];
                let (s, c) = wave(x, k);
                sum = (sum.0 + v * c, sum.1 - v * s);
            }
            rows[y * WINDOW + k] = sum;
        }
    }
    for kx in 0..WINDOW {
        for ky in 0..WINDOW {
            let mut sum = (0.0, 0.0);
            for y in 0..WINDOW {
                let (re, im) = rows[y * WINDOW + kx];
                let (s, c) = wave(y, ky);
                sum = (sum.0 + re * c + im * s, sum.1 + im * c - re * s);
            }
            let signed = |k: usize| k.min(WINDOW - k) as f64;
            let ring = signed(kx).hypot(signed(ky)).round() as usize;
            if ring < rings.len() {
                rings[ring] += sum.0 * sum.0 + sum.1 * sum.1;
            }
        }
    }
}

/// Pixels of the spectrum's middle: the mean of the waves' numbers by power, on a logarithmic scale.
/// (Its peak leaps between strokes and what they shade.)
fn middle(rings: &[f64]) -> Option<f64> {
    let n = WINDOW as f64;
    let low = (n / PERIODS[0]).ceil() as usize;
    let high = ((n / PERIODS[1]).floor() as usize).min(rings.len() - 1);
    let powers = (low..=high).map(|k| (rings[k], (k as f64).ln()));
    let (power, sum) = powers.fold((0.0, 0.0), |(p, s), (r, k)| (p + r, s + r * k));
    (power > 0.0).then(|| n / (sum / power).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_distance_of_stripes_is_found_whatever_their_direction() {
        let size = [120, 96];
        for period in [4.0_f64, 5.5, 8.0] {
            for turn in [0.0_f64, 0.6, 1.4] {
                let ink: Vec<f32> = (0..120 * 96)
                    .map(|i| {
                        let (x, y) = (f64::from(i % 120), f64::from(i / 120));
                        let phase = (x * turn.cos() + y * turn.sin()) / period;
                        (0.5 + 0.5 * (TAU * phase).sin()) as f32
                    })
                    .collect();
                let found = spacing(&ink, |_| true, size).unwrap_or(0.0);
                assert!(
                    (found / period - 1.0).abs() < 0.05,
                    "{period} {turn}: {found}"
                );
            }
        }
        let bands: Vec<f32> = (0..120 * 96)
            .map(|i| if (i / 120) % 12 < 4 { 1.0 } else { 0.0 })
            .collect();
        // Crossings of one direction only: pi / 4 of them are taken for the mean of all.
        let wide = width(&bands, |_| true, size).unwrap_or(0.0) * 0.25 * std::f64::consts::PI;
        assert!((wide / 4.0 - 1.0).abs() < 0.1, "{wide}");
        let blank = vec![0.0; 120 * 96];
        assert_eq!(width(&blank, |_| true, size), None, "no ink");
        assert_eq!(spacing(&blank, |_| true, size), None, "no ink");
        assert_eq!(spacing(&bands, |_| false, size), None, "no foliage");
    }
}
