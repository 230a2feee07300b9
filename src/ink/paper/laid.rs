//! Strokes on bitmaps: those that vectors have on stems and in shadow, laid as pixels on the device's
//! lines. Where they lie is found one after the other (error diffusion), so they are the host's work.

use glam::DVec2;
use rayon::prelude::*;

use super::drawing::{Placement, Shade, Visible};
use super::inks::{Inks, on_ground};
use super::pen::Stroke;
use super::progress::{Stage, Tell};
use super::renderer::Maps;
use super::single::single_lines;
use super::stem_strokes::stem_hatching;
use super::style::{PaperStyle, ShadowForm};
use super::vectors::tile_hatching;
use crate::ink::view::View;
use crate::math::packing::{f16_to_f32, f32_to_f16};

/// Rows of the picture that one task lays.
const BAND: usize = 32;

/// Whether bitmaps of this style have strokes that the device does not draw.
#[must_use]
pub fn has_strokes(style: &PaperStyle) -> bool {
    let single = style.stem.draw && style.stem.single > 0.0;
    single
        || hatches_stems(style)
        || style.shadow.form == ShadowForm::Hatch
        || style.tiles.strength > 0.0
}

fn hatches_stems(style: &PaperStyle) -> bool {
    style.stem.draw && style.stem.hatching > 0.0
}

/// Strokes of one ink (linear).
pub type Inked = ([f32; 3], Vec<Stroke>);

/// The strokes on stems and in shadow, in pixels of the maps; `scale` is a pixel's size in
/// millimetres. With the sheet's own resolution they are the strokes of the vectors. Those of one
/// ink are together. `tell` is told how far it is.
#[must_use]
pub fn strokes_of(
    maps: &Maps,
    style: &PaperStyle,
    view: &View,
    scale: f64,
    tell: Tell<'_>,
) -> Vec<Inked> {
    let placement = Placement {
        scale,
        corner: DVec2::ZERO,
    };
    let visible = Visible::new(maps);
    let inks = Inks::of(style).linear();
    let mut out: Vec<Inked> = Vec::new();
    let mut add = |ink: [f32; 3], strokes: Vec<Stroke>| match out.iter_mut().find(|o| o.0 == ink) {
        Some((_, own)) => own.extend(strokes),
        None => out.push((ink, strokes)),
    };
    if hatches_stems(style) {
        add(
            inks.stem_hatch,
            stem_hatching((maps, &visible), style, view, &placement, tell),
        );
    }
    add(inks.stem, single_lines(maps, style, view, &placement));
    if style.shadow.form == ShadowForm::Hatch {
        let found = Shade::new(maps, style).hatching(&visible.foliage, view, &placement, tell);
        let (ground, plants) = on_ground(maps, style, &placement, found);
        add(inks.shadow, plants);
        add(inks.ground, ground);
    }
    if style.tiles.strength > 0.0 {
        tell(Stage::Strokes, 0, 0);
        add(
            inks.foliage_hatch,
            tile_hatching(maps, &visible, style, view, &placement),
        );
    }
    for stroke in out.iter_mut().flat_map(|o| &mut o.1) {
        stroke.line.points.iter_mut().for_each(|p| *p /= scale);
        stroke.widths.iter_mut().for_each(|w| *w /= scale);
    }
    out
}

/// Lays strokes (in pixels) on a picture of `size` (RGBA, 16-bit floats, linear), in the colour of the
/// ink. A pixel is covered as the device covers those of its lines: by the way from the line's
/// middle to the pixel's, the last pixel in part.
pub fn lay(pixels: &mut [u8], size: [usize; 2], strokes: &[Stroke], ink: [f32; 3]) {
    let row_bytes = 8 * size[0];
    if row_bytes == 0 {
        return;
    }
    pixels
        .par_chunks_mut(BAND * row_bytes)
        .enumerate()
        .for_each(|(band, pixels)| {
            let rows = pixels.len() / row_bytes;
            let mut cover = vec![0.0_f32; size[0] * rows];
            let mut any = false;
            for stroke in strokes {
                any |= cover_by(&mut cover, [size[0], rows], band * BAND, stroke);
            }
            if any {
                for (pixel, &share) in pixels.chunks_exact_mut(8).zip(&cover) {
                    blend(pixel, share, ink);
                }
            }
        });
}

/// Raises the coverage of a band that begins at row `top`; whether there was anything to raise.
fn cover_by(cover: &mut [f32], size: [usize; 2], top: usize, stroke: &Stroke) -> bool {
    let [w, h] = size.map(|s| s as f64);
    let mut any = false;
    let points = &stroke.line.points;
    for (i, pair) in points.windows(2).enumerate() {
        let offset = DVec2::new(0.0, top as f64);
        let (from, to) = (pair[0] - offset, pair[1] - offset);
        let widths = [stroke.widths[i], stroke.widths[i + 1]];
        let reach = 0.5 * widths[0].max(widths[1]) + 0.5;
        let low = (from.min(to) - reach - 0.5).ceil().max(DVec2::ZERO);
        let high = (from.max(to) + reach - 0.5)
            .floor()
            .min(DVec2::new(w, h) - 1.0);
        if !(low.x <= high.x && low.y <= high.y) {
            continue;
        }
        any = true;
        for y in low.y as usize..=high.y as usize {
            for x in low.x as usize..=high.x as usize {
                let p = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                let way = to - from;
                let t = ((p - from).dot(way) / way.length_squared().max(1e-12)).clamp(0.0, 1.0);
                let width = widths[0] + (widths[1] - widths[0]) * t;
                let share = 0.5 * width + 0.5 - p.distance(from + way * t);
                let at = &mut cover[y * size[0] + x];
                // Thinner lines than a pixel are paler, not longer steps.
                *at = at.max(share.min(width).clamp(0.0, 1.0) as f32);
            }
        }
    }
    any
}

fn blend(pixel: &mut [u8], share: f32, ink: [f32; 3]) {
    if share <= 0.0 {
        return;
    }
    for (bytes, ink) in pixel.chunks_exact_mut(2).zip(ink) {
        let old = f16_to_f32(u16::from_le_bytes([bytes[0], bytes[1]]));
        let new = f32_to_f16(old + (ink - old) * share);
        bytes.copy_from_slice(&new.to_le_bytes());
    }
}

#[cfg(test)]
mod tests {
    use super::super::curve::Polyline;
    use super::*;

    fn laid(points: &[[f64; 2]], width: f64, size: [usize; 2]) -> Vec<f32> {
        let one = f32_to_f16(1.0).to_le_bytes();
        let mut pixels: Vec<u8> = one.repeat(4 * size[0] * size[1]);
        let stroke = Stroke {
            line: Polyline {
                points: points.iter().map(|&p| p.into()).collect(),
                closed: false,
            },
            widths: vec![width; points.len()],
            primitive: None,
        };
        lay(&mut pixels, size, &[stroke], [0.0; 3]);
        let first = |p: &[u8]| 1.0 - f16_to_f32(u16::from_le_bytes([p[0], p[1]]));
        pixels.chunks_exact(8).map(first).collect()
    }

    #[test]
    fn a_stroke_lays_its_length_times_its_width_of_ink() {
        for width in [0.5, 1.0, 2.0, 3.5] {
            let ink: f32 = laid(&[[10.0, 20.0], [90.0, 61.0]], width, [100, 100])
                .iter()
                .sum();
            let length = 80.0_f64.hypot(41.0);
            let want = length * width;
            let share = f64::from(ink) / want;
            assert!((0.8..1.15).contains(&share), "width {width}: {share}");
        }
    }

    #[test]
    fn bands_of_rows_leave_no_seam() {
        let upright = laid(&[[8.0, 0.0], [8.0, 128.0]], 2.0, [16, 128]);
        let rows: Vec<&[f32]> = upright.chunks(16).collect();
        assert!(rows.windows(2).skip(2).take(120).all(|r| r[0] == r[1]));
        assert!((rows[40].iter().sum::<f32>() - 2.0).abs() < 0.01);
    }

    #[test]
    fn what_lies_outside_and_what_is_no_number_lays_nothing() {
        for far in [-1e9, 1e9, f64::NAN, f64::INFINITY] {
            let ink = laid(&[[far, far], [far, 5.0]], 2.0, [16, 16]);
            assert!(ink.iter().all(|&v| v == 0.0), "{far}");
        }
        assert!(laid(&[[0.0, 0.0], [9.0, 9.0]], 1.0, [0, 0]).is_empty());
    }
}
