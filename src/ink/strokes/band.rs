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

/// A line along the outline, as in a list: channel (0 the darkest to 3), u of its start, length, v,
/// width, where along it is thickest, how far in it begins and ends. Along in lengths of the band
/// (0 to 1), across and widths in texels of a band [`INK_BAND_WIDTH`] wide.
pub type ListedLine = [f32; 8];
/// A tick inwards, as in a list: channel, u, depth (texels), how it leans and bends (shares of its
/// depth), half its width (texels).
pub type ListedTick = [f32; 6];

/// What the numbers of a list are called, least, most.
type Range = (&'static str, f32, f32);

const LINE: [Range; 8] = [
    ("channel", 0.0, 3.0),
    ("u", 0.0, 1.0),
    ("length", 0.001, 2.0),
    ("v", 0.0, INK_BAND_WIDTH as f32),
    ("width", 0.0, INK_BAND_WIDTH as f32),
    ("middle", 0.01, 0.99),
    ("enter", 0.0, INK_BAND_WIDTH as f32),
    ("leave", 0.0, INK_BAND_WIDTH as f32),
];
const TICK: [Range; 6] = [
    ("channel", 0.0, 3.0),
    ("u", 0.0, 1.0),
    ("depth", 0.0, INK_BAND_WIDTH as f32),
    ("lean", -8.0, 8.0),
    ("bend", -8.0, 8.0),
    ("half_width", 0.0, INK_BAND_WIDTH as f32),
];

/// Strokes of a band: what its picture is drawn from.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BandStrokes {
    /// Along the outline.
    pub lines: Vec<ListedLine>,
    /// Inwards.
    pub ticks: Vec<ListedTick>,
}

fn check<const N: usize>(numbers: &[f32; N], ranges: &[Range; N]) -> Result<(), String> {
    for (value, (name, low, high)) in numbers.iter().zip(ranges) {
        // Also false for NaN.
        if !(value >= low && value <= high) {
            return Err(format!("{name} {value}: expected {low} to {high}"));
        }
    }
    if numbers[0].fract() != 0.0 {
        return Err(format!("channel {}: expected 0, 1, 2 or 3", numbers[0]));
    }
    Ok(())
}

/// Strokes are made with the digits that a list has, so that a list draws the same.
fn rounded<const N: usize>(numbers: [f32; N]) -> [f32; N] {
    numbers.map(|v| (v * 1e4).round() / 1e4)
}

impl BandStrokes {
    /// The program's own. Lines swell and thin, begin before the one before them ends and leave the
    /// outline there, as a pen that is put down anew.
    #[must_use]
    pub fn new(seed: u32) -> Self {
        let mut out = Self::default();
        let mut numbers = Numbers(seed.wrapping_mul(0x85eb_ca6b) ^ 0xc2b2_ae35);
        for (channel, hand) in HANDS.iter().enumerate() {
            let channel = channel as f32;
            for k in 0..hand.lines {
                let start = (k as f32 + 0.5 * numbers.next()) / hand.lines as f32;
                // The lightest tone leaves gaps, the others overlap.
                let over = if hand.doubles == 0 { 0.7 } else { 1.2 };
                let own = (over + 0.2 * numbers.next()) / hand.lines as f32;
                let swell = hand.width * (0.75 + 0.25 * numbers.next());
                out.line([channel, start, own, 0.6, swell], &mut numbers);
            }
            for _ in 0..hand.doubles {
                let start = numbers.next();
                let own = 0.12 + 0.2 * numbers.next();
                let off = hand.width * (0.9 + 0.5 * numbers.next());
                out.line([channel, start, own, off, 0.35 * hand.width], &mut numbers);
            }
            for k in 0..hand.ticks {
                let u = (k as f32 + 0.8 * (numbers.next() - 0.5)) / hand.ticks as f32;
                let depth = hand.reach * (0.4 + 0.6 * numbers.next()) * INK_BAND_WIDTH as f32;
                let lean = 0.5 + 0.6 * numbers.next();
                let bend = 0.6 * (numbers.next() - 0.3);
                let half = 0.7 + 0.6 * numbers.next();
                let u = u.rem_euclid(1.0);
                out.ticks
                    .push(rounded([channel, u, depth, lean, bend, half]));
            }
        }
        out
    }

    fn line(&mut self, [channel, start, own, off, swell]: [f32; 5], numbers: &mut Numbers) {
        let middle = 0.35 + 0.3 * numbers.next();
        let (enter, leave) = (3.0 * numbers.next(), 2.0 + 5.0 * numbers.next());
        let u = start.rem_euclid(1.0);
        let listed = [channel, u, own, off, swell, middle, enter, leave];
        self.lines.push(rounded(listed));
    }

    /// Whether every number lies in its range.
    ///
    /// # Errors
    /// The first that does not, with its list and place there.
    pub fn check(&self) -> Result<(), String> {
        for (i, line) in self.lines.iter().enumerate() {
            check(line, &LINE).map_err(|e| format!("silhouette.strokes[{i}]: {e}"))?;
        }
        for (i, tick) in self.ticks.iter().enumerate() {
            check(tick, &TICK).map_err(|e| format!("silhouette.ticks[{i}]: {e}"))?;
        }
        Ok(())
    }

    /// The band: four channels from dark to light, u along the outline (repeating), v from it
    /// inwards; 255 is ink.
    #[must_use]
    pub fn texels(&self) -> Vec<u8> {
        let mut texels = vec![0_u8; 4 * (INK_BAND_LENGTH * INK_BAND_WIDTH) as usize];
        for line in &self.lines {
            draw_line(&mut texels, *line);
        }
        for &[channel, u, depth, lean, bend, half] in &self.ticks {
            for step in 0..=96 {
                let t = step as f32 / 96.0;
                let x = u * INK_BAND_LENGTH as f32 + (lean * t + bend * t * (1.0 - t)) * depth;
                let at = [x, t * depth];
                dab(&mut texels, channel as usize, at, half * (1.0 - 0.8 * t));
            }
        }
        texels
    }
}

/// Bands of strokes along a silhouette, of the program's own strokes.
#[must_use]
pub fn band(seed: u32) -> Vec<u8> {
    BandStrokes::new(seed).texels()
}

fn draw_line(texels: &mut [u8], [channel, u, own, off, swell, middle, enter, leave]: ListedLine) {
    let (start, own) = (u * INK_BAND_LENGTH as f32, own * INK_BAND_LENGTH as f32);
    let steps = ((2.0 * own) as u32).max(1);
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
        let at = [start + t * own, v];
        dab(texels, channel as usize, at, half.max(0.25));
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
    #[test]
    fn a_list_draws_the_band_and_wrong_numbers_are_named() {
        let strokes = BandStrokes::new(3);
        strokes.check().unwrap();
        assert!(strokes.lines.len() > 10 && strokes.ticks.len() > 20);
        assert_eq!(strokes.texels(), band(3));
        let mut wrong = strokes.clone();
        wrong.lines[4][4] = 99.0;
        let said = "silhouette.strokes[4]: width 99: expected 0 to 32";
        assert_eq!(wrong.check().unwrap_err(), said);
        wrong = strokes.clone();
        wrong.ticks[2][0] = 1.5;
        assert!(wrong.check().unwrap_err().contains("ticks[2]: channel 1.5"));
        wrong.ticks[2][0] = f32::NAN;
        assert!(wrong.check().is_err(), "no number");
    }
}
