//! The drawn bark; repeats in both directions.

use std::f32::consts::TAU;

use super::noise::{blend, draw, fractal, value};
use super::parameters::BarkStyle;

/// Width (once round a repeat) and height in pixels.
pub(super) const SIZE: [u32; 2] = [256, 512];

/// sRGB pixels of a bark.
pub(super) fn pixels(style: BarkStyle) -> Vec<u8> {
    match style {
        BarkStyle::Furrowed => draw(SIZE, |u, v| {
            ridges(u, v, 9.0, 0.55, [0.20, 0.16, 0.13], [0.55, 0.49, 0.42])
        }),
        BarkStyle::Fissured => draw(SIZE, |u, v| {
            ridges(u, v, 14.0, 0.30, [0.30, 0.26, 0.22], [0.58, 0.54, 0.47])
        }),
        BarkStyle::Scaly => draw(SIZE, scales),
        BarkStyle::Smooth => draw(SIZE, smooth),
    }
}

/// Ridges that run up the trunk, wander and merge, with dark furrows between them.
fn ridges(u: f32, v: f32, count: f32, depth: f32, dark: [f32; 3], light: [f32; 3]) -> [f32; 3] {
    let wander = fractal(u, v, [4, 6], 3) - 0.5;
    let phase = u * count + 1.7 * wander;
    let ridge = 0.5 + 0.5 * (phase * TAU).cos();
    // cross cracks break the ridges into blocks
    let crack = value(u * 18.0, v * 24.0, [18, 24], 41);
    let grain = fractal(u, v, [32, 16], 17);
    let height = (ridge.sqrt() - depth * (crack - 0.55).max(0.0) * 1.6).clamp(0.0, 1.0);
    let tone = height * (0.72 + 0.42 * grain);
    let lichen = (fractal(u, v, [5, 7], 57) - 0.62).max(0.0) * 2.2;
    let c = blend(dark, light, tone);
    blend(c, [0.52, 0.55, 0.44], lichen * height)
}

/// Overlapping round scales (cells of the nearest of jittered points).
fn scales(u: f32, v: f32) -> [f32; 3] {
    let cells = [10, 14];
    let (x, y) = (u * cells[0] as f32, v * cells[1] as f32);
    let (mut first, mut second, mut tone) = (9.0f32, 9.0f32, 0.0);
    for dy in -1..=1 {
        for dx in -1..=1 {
            let (cx, cy) = (x.floor() as i32 + dx, y.floor() as i32 + dy);
            let at = |seed| value(cx as f32, cy as f32, cells, seed);
            let (px, py) = (cx as f32 + at(5), cy as f32 + at(6));
            let d = ((x - px).powi(2) + 0.6 * (y - py).powi(2)).sqrt();
            if d < first {
                second = first;
                first = d;
                tone = at(7);
            } else if d < second {
                second = d;
            }
        }
    }
    let edge = ((second - first) * 4.0).clamp(0.0, 1.0);
    let grain = fractal(u, v, [24, 24], 19);
    let scale = blend(
        [0.42, 0.29, 0.22],
        [0.56, 0.45, 0.37],
        0.6 * tone + 0.5 * grain,
    );
    blend([0.21, 0.15, 0.12], scale, edge)
}

/// Smooth bark with short cross lines (lenticels).
fn smooth(u: f32, v: f32) -> [f32; 3] {
    let tone = fractal(u, v, [5, 10], 9);
    let c = blend([0.34, 0.29, 0.23], [0.52, 0.46, 0.38], tone);
    let dash = value(u * 12.0, v * 60.0, [12, 60], 29);
    blend(c, [0.62, 0.56, 0.46], ((dash - 0.82) * 6.0).clamp(0.0, 0.7))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bark_has_contrast_and_the_right_size() {
        for style in [
            BarkStyle::Furrowed,
            BarkStyle::Fissured,
            BarkStyle::Scaly,
            BarkStyle::Smooth,
        ] {
            let pixels = pixels(style);
            assert_eq!(pixels.len(), (SIZE[0] * SIZE[1] * 4) as usize);
            let red = || pixels.chunks_exact(4).map(|p| p[0]);
            let (low, high) = (red().min().unwrap(), red().max().unwrap());
            assert!(high - low > 40, "{style:?}: {low}..{high}");
        }
    }
}
