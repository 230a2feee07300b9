//! Tiles, bands and shapes that a user painted, from the pixels of images.
//!
//! Black is ink and white is paper in every picture but a band of four channels, whose bytes are
//! ink. What does not fit is told by its reason; the caller knows the file.

use super::fill::Numbers;
use super::tile::{Tile, level_size};
use crate::abi::{INK_LEVELS, INK_TILE};
use crate::scene::textures::Rgba8;

/// Share of a lighter picture's ink that a darker one may lack: a soft edge, not a stroke.
const LACKING: f64 = 0.02;
/// Largest side of a band or shape, texels.
const LARGEST: u32 = 4096;

/// Ink of every pixel, 0 to 1, on white paper.
fn ink(image: &Rgba8) -> Vec<f32> {
    let one = |p: &[u8]| {
        let grey = (f32::from(p[0]) + f32::from(p[1]) + f32::from(p[2])) / 765.0;
        (1.0 - grey) * f32::from(p[3]) / 255.0
    };
    image.pixels.chunks_exact(4).map(one).collect()
}

fn mean(values: &[f32]) -> f64 {
    values.iter().map(|&v| f64::from(v)).sum::<f64>() / values.len().max(1) as f64
}

fn check_tile(image: &Rgba8) -> Result<(), String> {
    if [image.width, image.height] != [INK_TILE; 2] {
        return Err(format!(
            "{} x {} pixels: a tile has {INK_TILE} x {INK_TILE}",
            image.width, image.height
        ));
    }
    Ok(())
}

/// A tile from a picture of thresholds: the darker a pixel, the lighter the tone from which on it
/// is ink; white never is.
///
/// # Errors
/// Another size; a picture without ink.
pub fn thresholds(image: &Rgba8) -> Result<Tile, String> {
    check_tile(image)?;
    let finest: Vec<u8> = ink(image)
        .iter()
        .map(|v| ((1.0 - v) * 255.0).round() as u8)
        .collect();
    if finest.iter().all(|&t| t == 255) {
        return Err("has no ink".into());
    }
    Ok(of_finest(finest))
}

/// A tile from black and white pictures of one tone each, from light to dark.
///
/// # Errors
/// The number of the picture that is wrong, and why: its size, less ink than the one before, ink
/// of the one before that it lacks.
pub fn tones(images: &[Rgba8]) -> Result<Tile, (usize, String)> {
    let mut before = vec![0.0; (INK_TILE * INK_TILE) as usize];
    let mut darkness = 0.0;
    let mut finest = vec![255_u8; before.len()];
    for (number, image) in images.iter().enumerate() {
        let wrong = |reason: String| (number, reason);
        check_tile(image).map_err(wrong)?;
        let own = ink(image);
        let own_darkness = mean(&own);
        if own_darkness <= darkness {
            return Err(wrong(format!(
                "darkness {own_darkness:.3} after {darkness:.3}: tones go from light to dark"
            )));
        }
        let had = before.iter().filter(|v| **v >= 0.5).count();
        let lacks = |(a, b): &(&f32, &f32)| **a >= 0.5 && **b < 0.5;
        let lacking = before.iter().zip(&own).filter(lacks).count();
        if lacking as f64 > LACKING * had as f64 {
            let share = 100.0 * lacking as f64 / had as f64;
            return Err(wrong(format!(
                "lacks {share:.1} % of the ink of the lighter tone: tones are nested"
            )));
        }
        let new: Vec<bool> = (0..own.len())
            .map(|i| own[i] >= 0.5 && finest[i] == 255)
            .collect();
        in_turn(&new, [darkness, own_darkness], &mut finest);
        (before, darkness) = (own, own_darkness);
    }
    Ok(of_finest(finest))
}

/// Gives the strokes (connected pieces) of `new` thresholds between two tones, one after the
/// other in a fixed random order, by what they add: the tone is right in between, too.
fn in_turn(new: &[bool], [low, high]: [f64; 2], finest: &mut [u8]) {
    let pieces = pieces(new);
    let total: usize = pieces.iter().map(Vec::len).sum();
    let mut numbers = Numbers(0x51ed_270b);
    let mut order: Vec<(f32, usize)> = (0..pieces.len()).map(|i| (numbers.next(), i)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut done = 0;
    for (_, piece) in order {
        let piece = &pieces[piece];
        let middle = (done as f64 + 0.5 * piece.len() as f64) / total as f64;
        let tone = low + (high - low) * middle;
        done += piece.len();
        for &i in piece {
            finest[i] = (tone * 255.0).round().min(254.0) as u8;
        }
    }
}

/// Pieces of what is set, four neighbours each, on the tile that repeats.
fn pieces(set: &[bool]) -> Vec<Vec<usize>> {
    let size = INK_TILE as usize;
    let mut seen = vec![false; set.len()];
    let mut out = Vec::new();
    for start in 0..set.len() {
        if !set[start] || seen[start] {
            continue;
        }
        seen[start] = true;
        let mut piece = vec![start];
        let mut next = 0;
        while next < piece.len() {
            let (x, y) = (piece[next] % size, piece[next] / size);
            next += 1;
            let beside = [(x + 1, y), (x + size - 1, y), (x, y + 1), (x, y + size - 1)];
            for (x, y) in beside {
                let i = (y % size) * size + x % size;
                if set[i] && !seen[i] {
                    seen[i] = true;
                    piece.push(i);
                }
            }
        }
        out.push(piece);
    }
    out
}

/// A tile from its finest level. Coarser ones keep strokes one texel wide (the least of four),
/// and take thresholds by rank, so that each darkness has as much ink at every level.
fn of_finest(finest: Vec<u8>) -> Tile {
    let mut sorted = finest.clone();
    sorted.sort_unstable();
    let mut levels = vec![finest];
    for level in 1..INK_LEVELS {
        let fine = &levels[level as usize - 1];
        let (size, wide) = (level_size(level) as usize, level_size(level - 1) as usize);
        let key = |i: usize| {
            let (x, y) = (2 * (i % size), 2 * (i / size));
            let four = [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)]
                .map(|(x, y)| u32::from(fine[y * wide + x]));
            // Of pieces with the same least value those come first that have more of it.
            (
                four.iter().min().copied().unwrap_or(255),
                four.iter().sum::<u32>(),
                i,
            )
        };
        let mut keys: Vec<(u32, u32, usize)> = (0..size * size).map(key).collect();
        keys.sort_unstable();
        let mut coarse = vec![0; keys.len()];
        let ratio = sorted.len() / keys.len();
        for (rank, &(_, _, i)) in keys.iter().enumerate() {
            coarse[i] = sorted[rank * ratio + ratio / 2];
        }
        levels.push(coarse);
    }
    Tile {
        strokes: Vec::new(),
        levels,
    }
}

/// A band of silhouette strokes: four channels, dark to light; 255 is ink.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Band {
    /// Texels along and across.
    pub extent: [u32; 2],
    /// Four bytes of each texel, rows from the outline inwards.
    pub texels: Vec<u8>,
}

impl Band {
    /// From a picture of four channels (eight times as wide as high; bytes are ink), or of four
    /// rows below each other (twice as wide as high; black is ink), the darkest first.
    ///
    /// # Errors
    /// Another shape; rows that do not go from dark to light; no ink.
    pub fn new(image: &Rgba8) -> Result<Self, String> {
        let [width, height] = [image.width, image.height];
        if width > LARGEST || !(width >= 32 && (width == 8 * height || width == 2 * height)) {
            return Err(format!(
                "{width} x {height} pixels: a band is 8 times as wide as high (four channels) or \
                 twice (four rows), and 32 to {LARGEST} pixels long"
            ));
        }
        let rows = width / 8;
        let texels = if height == rows {
            image.pixels.clone()
        } else {
            let ink = ink(image);
            let plane = (width * rows) as usize;
            let byte = |i: usize, channel: usize| (255.0 * ink[channel * plane + i]).round() as u8;
            (0..plane)
                .flat_map(|i| [0, 1, 2, 3].map(|channel| byte(i, channel)))
                .collect()
        };
        let extent = [width, rows];
        Self { extent, texels }.checked()
    }

    /// With its rows from dark to light.
    ///
    /// # Errors
    /// They are not, or have no ink.
    pub(super) fn checked(self) -> Result<Self, String> {
        let darkness = [0, 1, 2, 3].map(|channel| self.darkness(channel));
        if darkness[0] <= 0.0 {
            return Err("has no ink".into());
        }
        if let Some(k) = (0..3).find(|&k| darkness[k + 1] > darkness[k]) {
            return Err(format!(
                "row or channel {} has darkness {:.3}, the one before it {:.3}: they go from dark to light",
                k + 2,
                darkness[k + 1],
                darkness[k]
            ));
        }
        Ok(self)
    }

    /// Mean ink of a channel, 0 to 1.
    #[must_use]
    pub fn darkness(&self, channel: usize) -> f64 {
        let bytes = self.texels.iter().skip(channel).step_by(4);
        let (sum, count) = bytes.fold((0.0, 0.0), |(s, n), &b| (s + f64::from(b), n + 1.0));
        sum / (255.0 * count)
    }

    /// How much rougher the band is across its ends than within: about 1 where it repeats.
    #[must_use]
    pub fn seam(&self) -> f32 {
        let [width, rows] = self.extent.map(|v| v as usize);
        let leap = |x: usize| {
            let of = |k: usize| {
                let (y, c) = (k / 4, k % 4);
                let at = |x: usize| f32::from(self.texels[4 * (y * width + x) + c]);
                (at(x) - at((x + 1) % width)).abs()
            };
            (0..4 * rows).map(of).sum::<f32>()
        };
        let inner: f32 = (0..width - 1).map(leap).sum();
        (leap(width - 1) + 1.0) / (inner / (width - 1) as f32 + 1.0)
    }

    /// The picture of four rows, black on white: what a user paints over.
    #[must_use]
    pub fn rows(&self) -> Rgba8 {
        let [width, rows] = self.extent;
        let plane = (width * rows) as usize;
        let pixel = |k: usize| {
            let v = 255 - self.texels[4 * (k % plane) + k / plane];
            [v, v, v, 255]
        };
        Rgba8 {
            width,
            height: 4 * rows,
            pixels: (0..4 * plane).flat_map(pixel).collect(),
        }
    }
}

/// The picture of a tile's finest level: black comes first, white never.
#[must_use]
pub fn picture(tile: &Tile) -> Rgba8 {
    Rgba8 {
        width: INK_TILE,
        height: INK_TILE,
        pixels: tile.levels[0]
            .iter()
            .flat_map(|&t| [t, t, t, 255])
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::TileSettings;
    use super::super::band;
    use super::*;
    use crate::abi::{INK_BAND_LENGTH, INK_BAND_WIDTH};

    fn grey(width: u32, height: u32, value: impl Fn(u32, u32) -> u8) -> Rgba8 {
        let pixel = |i: u32| {
            let v = value(i % width, i / width);
            [v, v, v, 255]
        };
        Rgba8 {
            width,
            height,
            pixels: (0..width * height).flat_map(pixel).collect(),
        }
    }

    #[test]
    fn a_picture_of_a_tile_makes_the_tile_again_and_keeps_its_tones() {
        let tile = Tile::new(&TileSettings::default());
        let again = thresholds(&picture(&tile)).unwrap();
        assert_eq!(again.levels[0], tile.levels[0], "as it was");
        for level in 1..INK_LEVELS as usize {
            let error = again.tone_error(level);
            assert!(error < 0.03, "level {level}: {error}");
        }
    }

    #[test]
    fn tones_become_thresholds_between_them() {
        let tile = Tile::new(&TileSettings::default());
        let at = |limit: u8| {
            grey(INK_TILE, INK_TILE, |x, y| {
                if tile.levels[0][(y * INK_TILE + x) as usize] <= limit {
                    0
                } else {
                    255
                }
            })
        };
        let images = [at(40), at(100), at(180)];
        let made = tones(&images).unwrap();
        for limit in [40_u8, 100, 180] {
            let want = tile.darkness(0, f32::from(limit) / 255.0);
            let found = made.darkness(0, want);
            assert!((found - want).abs() < 0.015, "{limit}: {found} for {want}");
        }
        let want = 0.28;
        let between = made.darkness(0, want);
        assert!((between - want).abs() < 0.05, "in between: {between}");
        let (number, reason) = tones(&[at(100), at(40)]).unwrap_err();
        assert!(number == 1 && reason.contains("light to dark"), "{reason}");
        let other = grey(INK_TILE, INK_TILE, |x, _| if x < 300 { 0 } else { 255 });
        let (_, reason) = tones(&[at(40), other]).unwrap_err();
        assert!(reason.contains("nested"), "{reason}");
        let small = grey(64, 64, |_, _| 0);
        assert!(thresholds(&small).unwrap_err().contains("512"), "size");
        let white = grey(INK_TILE, INK_TILE, |_, _| 255);
        assert!(thresholds(&white).unwrap_err().contains("no ink"), "white");
    }

    #[test]
    fn bands_come_as_channels_or_rows() {
        let made = Band {
            extent: [INK_BAND_LENGTH, INK_BAND_WIDTH],
            texels: band(3),
        };
        let rows = Band::new(&made.rows()).unwrap();
        assert_eq!(rows, made, "four rows");
        let channels = Rgba8 {
            width: INK_BAND_LENGTH,
            height: INK_BAND_WIDTH,
            pixels: made.texels.clone(),
        };
        assert_eq!(Band::new(&channels).unwrap(), made, "four channels");
        assert!(made.seam() < 2.0, "{}", made.seam());
        let wrong = Band::new(&grey(100, 90, |_, _| 0)).unwrap_err();
        assert!(wrong.contains("100 x 90"), "{wrong}");
        let rising = grey(64, 32, |_, y| 255 - (y / 8 * 60) as u8);
        let wrong = Band::new(&rising).unwrap_err();
        assert!(
            wrong.contains("dark to light") || wrong.contains("no ink"),
            "{wrong}"
        );
    }
}
