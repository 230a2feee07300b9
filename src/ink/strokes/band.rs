//! Bands of silhouette strokes.

use super::fill::Numbers;
use crate::abi::{INK_BAND_LENGTH, INK_BAND_WIDTH};

/// Strokes of one tone: how many lines follow the outline, their greatest width, how many more
/// lie beside them, how many ticks go inwards and how far (of the band's width).
struct Hand {
    lines: u32,
    width: f32,
    doubles: u32,
    ticks: u32,
    reach: f32,
}

/// From dark to light.
const HANDS: [Hand; 4] = [
    Hand {
        lines: 4,
        width: 9.0,
        doubles: 4,
        ticks: 20,
        reach: 0.8,
    },
    Hand {
        lines: 4,
        width: 6.5,
        doubles: 3,
        ticks: 9,
        reach: 0.55,
    },
    Hand {
        lines: 3,
        width: 4.6,
        doubles: 1,
        ticks: 3,
        reach: 0.35,
    },
    Hand {
        lines: 2,
        width: 3.2,
        doubles: 0,
        ticks: 0,
        reach: 0.0,
    },
];

/// Bands of strokes along a silhouette: four channels from dark to light, u along the outline
/// (repeating), v from it inwards; 255 is ink. Lines swell and thin, begin before the one before
/// them ends and leave the outline there, as a pen that is put down anew.
#[must_use]
pub fn band(seed: u32) -> Vec<u8> {
    let (length, width) = (INK_BAND_LENGTH as f32, INK_BAND_WIDTH as f32);
    let mut texels = vec![0_u8; 4 * (INK_BAND_LENGTH * INK_BAND_WIDTH) as usize];
    let mut numbers = Numbers(seed.wrapping_mul(0x85eb_ca6b) ^ 0xc2b2_ae35);
    for (channel, hand) in HANDS.iter().enumerate() {
        for k in 0..hand.lines {
            let start = (k as f32 + 0.5 * numbers.next()) / hand.lines as f32 * length;
            // The lightest tone leaves gaps, the others overlap.
            let over = if hand.doubles == 0 { 0.7 } else { 1.2 };
            let own = length / hand.lines as f32 * (over + 0.2 * numbers.next());
            let swell = hand.width * (0.75 + 0.25 * numbers.next());
            line(&mut texels, channel, [start, own, 0.6], swell, &mut numbers);
        }
        for _ in 0..hand.doubles {
            let start = numbers.next() * length;
            let own = length * (0.12 + 0.2 * numbers.next());
            let off = hand.width * (0.9 + 0.5 * numbers.next());
            line(
                &mut texels,
                channel,
                [start, own, off],
                0.35 * hand.width,
                &mut numbers,
            );
        }
        for k in 0..hand.ticks {
            let u = (k as f32 + 0.8 * (numbers.next() - 0.5)) / hand.ticks as f32 * length;
            let depth = hand.reach * (0.4 + 0.6 * numbers.next()) * width;
            let lean = 0.5 + 0.6 * numbers.next();
            let bend = 0.6 * (numbers.next() - 0.3);
            let half = 0.7 + 0.6 * numbers.next();
            for step in 0..=96 {
                let t = step as f32 / 96.0;
                let x = u + (lean * t + bend * t * (1.0 - t)) * depth;
                dab(&mut texels, channel, [x, t * depth], half * (1.0 - 0.8 * t));
            }
        }
    }
    texels
}

/// A line along the outline from `start` over `own` texels, `off` texels from it.
fn line(
    texels: &mut [u8],
    channel: usize,
    [start, own, off]: [f32; 3],
    swell: f32,
    numbers: &mut Numbers,
) {
    let middle = 0.35 + 0.3 * numbers.next();
    let (enter, leave) = (3.0 * numbers.next(), 2.0 + 5.0 * numbers.next());
    let steps = (2.0 * own) as u32;
    for step in 0..=steps {
        let t = step as f32 / steps as f32;
        // Thickest at its middle, a hair at its ends.
        let s = if t < middle {
            t / middle
        } else {
            (1.0 - t) / (1.0 - middle)
        };
        let half = 0.5 * swell * (s * s * (3.0 - 2.0 * s)).powf(0.8);
        let (begin, end) = ((1.0 - t / 0.12).max(0.0), ((t - 0.86) / 0.14).max(0.0));
        let v = off + 0.5 * half + enter * begin * begin + leave * end * end;
        dab(texels, channel, [start + t * own, v], half.max(0.25));
    }
}

/// Inks the texels about a point of a band.
fn dab(texels: &mut [u8], channel: usize, [x, v]: [f32; 2], half: f32) {
    let (length, width) = (INK_BAND_LENGTH as i32, INK_BAND_WIDTH as i32);
    let reach = half + 1.0;
    for row in (v - reach).floor() as i32..=(v + reach).ceil() as i32 {
        for column in (x - reach).floor() as i32..=(x + reach).ceil() as i32 {
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
