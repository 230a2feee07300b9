//! Bands of silhouette strokes.

use super::fill::Numbers;
use crate::abi::{INK_BAND_LENGTH, INK_BAND_WIDTH};

/// Bands of strokes along a silhouette: four channels from dark to light, u along the outline
/// (repeating), v from it inwards; 255 is ink.
#[must_use]
pub fn band(seed: u32) -> Vec<u8> {
    let (length, width) = (INK_BAND_LENGTH as usize, INK_BAND_WIDTH as usize);
    let mut texels = vec![0_u8; 4 * length * width];
    // Strokes over the band's length, and how far they reach in, of the band's width.
    let channels = [(46.0, 0.95), (30.0, 0.7), (18.0, 0.42), (9.0, 0.2)];
    let mut numbers = Numbers(seed.wrapping_mul(0x85eb_ca6b) ^ 0xc2b2_ae35);
    for (channel, (count, reach)) in channels.into_iter().enumerate() {
        let count = count as usize;
        for k in 0..count {
            // Evenly set, each a little off, slanted, bent, of its own length.
            let u = (k as f32 + 0.8 * (numbers.next() - 0.5)) / count as f32;
            let depth = reach * (0.55 + 0.45 * numbers.next());
            let lean = 0.35 + 0.5 * numbers.next();
            let bend = 0.5 * (numbers.next() - 0.3);
            for step in 0..=4 * width {
                let t = step as f32 / (4 * width) as f32;
                let v = t * depth * width as f32;
                let x =
                    u * length as f32 + (lean * t + bend * t * (1.0 - t)) * depth * width as f32;
                let half = 0.95 * (1.0 - 0.75 * t);
                dab(&mut texels, channel, [x, v], half);
            }
        }
    }
    texels
}

/// Inks the texels about a point of a band.
fn dab(texels: &mut [u8], channel: usize, [x, v]: [f32; 2], half: f32) {
    let (length, width) = (INK_BAND_LENGTH as i32, INK_BAND_WIDTH as i32);
    for row in (v - 2.0).floor() as i32..=(v + 2.0).ceil() as i32 {
        for column in (x - 2.0).floor() as i32..=(x + 2.0).ceil() as i32 {
            if row < 0 || row >= width {
                continue;
            }
            let off = (column as f32 + 0.5 - x).hypot(row as f32 + 0.5 - v);
            let ink = (half + 0.5 - off).clamp(0.0, 1.0) * 255.0;
            let at = (row * length + column.rem_euclid(length)) as usize * 4 + channel;
            texels[at] = texels[at].max(ink as u8);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_are_darker_in_the_dark_and_at_the_outline() {
        let texels = band(3);
        let ink = |channel: usize, rows: std::ops::Range<usize>| {
            let length = INK_BAND_LENGTH as usize;
            let at = |(y, x): (usize, usize)| f64::from(texels[4 * (y * length + x) + channel]);
            let all = rows.flat_map(|y| (0..length).map(move |x| (y, x)));
            all.map(at).sum::<f64>()
        };
        let width = INK_BAND_WIDTH as usize;
        for channel in 0..3 {
            assert!(ink(channel, 0..width) > 1.3 * ink(channel + 1, 0..width));
            assert!(ink(channel, 0..width / 2) > ink(channel, width / 2..width));
        }
    }
}
