//! Several pictures side by side with labels: figures 1, 5, 9-15 of the paper at one go.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

use super::image::Picture;
use crate::math::colour::{linear_to_srgb8, srgb8_to_linear};

/// Pixels between and around the pictures.
const GAP: u32 = 8;
/// Height of the band under a picture that holds its label, pixels.
const LABEL: u32 = 28;
/// Paper, sRGB.
const PAPER: [u8; 4] = [250, 250, 249, 255];
/// Ink of the labels, sRGB.
const INK: [u8; 3] = [40, 42, 46];

/// Puts pictures on one sheet, `columns` in a row (0 = all), each above its label. Pictures of
/// different sizes stand in equal cells.
#[must_use]
pub fn sheet(pictures: &[(String, Picture)], columns: usize) -> Picture {
    let columns = if columns == 0 {
        pictures.len()
    } else {
        columns
    };
    let columns = columns.min(pictures.len()).max(1);
    let rows = pictures.len().div_ceil(columns);
    let widest = |f: fn(&Picture) -> u32| pictures.iter().map(|p| f(&p.1)).max().unwrap_or(0);
    let (w, h) = (widest(|p| p.width), widest(|p| p.height));
    let count = |n: usize| u32::try_from(n).expect("a sheet has few pictures");
    let mut out = Picture::filled(
        GAP + count(columns) * (w + GAP),
        GAP + count(rows) * (h + LABEL),
        PAPER,
    );
    for (i, (label, picture)) in pictures.iter().enumerate() {
        let x = GAP + count(i % columns) * (w + GAP);
        let y = GAP + count(i / columns) * (h + LABEL);
        blit(&mut out, picture, x, y);
        write(&mut out, label, [x, y + picture.height + 4], w);
    }
    out
}

fn blit(out: &mut Picture, picture: &Picture, x: u32, y: u32) {
    let row = picture.width as usize * 4;
    for line in 0..picture.height {
        let to = ((y + line) as usize * out.width as usize + x as usize) * 4;
        let from = line as usize * row;
        out.rgba[to..to + row].copy_from_slice(&picture.rgba[from..from + row]);
    }
}

/// Writes `text` centred in `width` pixels, cut off where it does not fit. Characters that the
/// font lacks become `?`.
fn write(out: &mut Picture, text: &str, at: [u32; 2], width: u32) {
    let advance = get_raster_width(FontWeight::Regular, RasterHeight::Size16);
    let fits = width as usize / advance;
    let letters: Vec<char> = text.chars().take(fits).collect();
    let indent = (width as usize - letters.len() * advance) / 2;
    for (i, c) in letters.into_iter().enumerate() {
        let glyph = get_raster(c, FontWeight::Regular, RasterHeight::Size16)
            .or_else(|| get_raster('?', FontWeight::Regular, RasterHeight::Size16));
        let Some(glyph) = glyph else { continue };
        let x0 = at[0] as usize + indent + i * advance;
        for (dy, row) in glyph.rows().enumerate() {
            for (dx, &cover) in row.iter().enumerate() {
                let (x, y) = (x0 + dx, at[1] as usize + dy);
                if x >= out.width as usize || y >= out.height as usize {
                    continue;
                }
                let t = f32::from(cover) / 255.0;
                let pixel = &mut out.rgba[(y * out.width as usize + x) * 4..][..3];
                for (p, ink) in pixel.iter_mut().zip(INK) {
                    let (a, b) = (srgb8_to_linear(*p), srgb8_to_linear(ink));
                    *p = linear_to_srgb8(a + (b - a) * t);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_keep_their_pixels_and_labels_leave_ink() {
        let red = Picture::filled(40, 30, [255, 0, 0, 255]);
        let blue = Picture::filled(20, 30, [0, 0, 255, 255]);
        let s = sheet(&[("red".into(), red), ("blue and long".into(), blue)], 0);
        assert_eq!((s.width, s.height), (8 + 2 * 48, 8 + 30 + 28));
        assert_eq!(s.pixel(8, 8), [255, 0, 0, 255]);
        assert_eq!(s.pixel(56, 37), [0, 0, 255, 255]);
        let dark = s
            .rgba
            .chunks_exact(4)
            .filter(|p| p[0] < 80 && p[2] < 80)
            .count();
        assert!(dark > 20, "{dark}");
    }

    #[test]
    fn an_empty_sheet_is_still_a_picture() {
        let s = sheet(&[], 3);
        assert!(s.width > 0 && s.height > 0);
    }
}
