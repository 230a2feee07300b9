//! Strokes as data, and the images made of them: hatching tiles (tonal art maps, Praun, Hoppe,
//! Webb, Finkelstein 2001, kept as thresholds, Webb et al. 2002) and bands of silhouette strokes.

use glam::Vec2;

use crate::abi::{INK_BAND_LENGTH, INK_BAND_WIDTH, INK_LEVELS, INK_TILE};

/// A stroke in a tile of edge 1 that repeats.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// Middle.
    pub at: Vec2,
    /// Length.
    pub length: f32,
    /// Direction, radians from u.
    pub angle: f32,
    /// Sideways bend of the middle, in lengths.
    pub bend: f32,
    /// Darkness from which on it is drawn, 0 to 1.
    pub tone: f32,
    /// Coarsest level that has it; all finer ones do.
    pub level: u32,
}

/// How a tile is filled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TileSettings {
    /// Seed.
    pub seed: u32,
    /// Width of strokes at every level, texels.
    pub width: f32,
    /// Shortest and longest stroke, in edges of the tile.
    pub lengths: [f32; 2],
    /// Directions scatter by so much, radians.
    pub scatter: f32,
    /// Darkness above which strokes cross.
    pub crossing: f32,
}

impl Default for TileSettings {
    fn default() -> Self {
        Self {
            seed: 1,
            width: 1.7,
            lengths: [0.25, 0.6],
            scatter: 0.05,
            crossing: 0.6,
        }
    }
}

/// Darkness of the darkest column.
const DARKEST: f32 = 0.9;
/// Columns in which tiles are filled, level after level.
const COLUMNS: u32 = 12;
/// Places tried for a stroke.
const CANDIDATES: u32 = 24;
/// A coverage from which a texel counts as inked.
const INKED: f32 = 0.5;
/// Value of a threshold without ink.
const PAPER: f32 = 1.0;

/// A hatching tile: its strokes and, for each level, the darkness from which a texel is ink.
#[derive(Debug, Clone, PartialEq)]
pub struct Tile {
    /// All strokes, in the order in which they were placed.
    pub strokes: Vec<Stroke>,
    /// Thresholds of each level from the finest, row by row; 255 is paper.
    pub levels: Vec<Vec<u8>>,
}

/// Numbers from a seed; the same everywhere.
#[derive(Debug, Clone)]
struct Numbers(u32);

impl Numbers {
    /// The next one in [0, 1).
    fn next(&mut self) -> f32 {
        // PCG-RXS-M-XS (O'Neill 2014).
        self.0 = self.0.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let word = ((self.0 >> ((self.0 >> 28) + 4)) ^ self.0).wrapping_mul(277_803_737);
        let word = (word >> 22) ^ word;
        (word >> 8) as f32 / 16_777_216.0
    }

    fn between(&mut self, [low, high]: [f32; 2]) -> f32 {
        low + (high - low) * self.next()
    }
}

/// Edge of a level, texels.
#[must_use]
pub fn level_size(level: u32) -> u32 {
    INK_TILE >> level
}

/// Thresholds of one level while it is filled.
struct Level {
    size: u32,
    thresholds: Vec<f32>,
    inked: usize,
}

impl Level {
    fn new(level: u32) -> Self {
        let size = level_size(level);
        Self {
            size,
            thresholds: vec![PAPER; (size * size) as usize],
            inked: 0,
        }
    }

    fn darkness(&self) -> f32 {
        self.inked as f32 / self.thresholds.len() as f32
    }

    fn draw(&mut self, stroke: &Stroke, width: f32) {
        let size = self.size;
        let mut dots = Vec::new();
        stroke_texels(stroke, size as f32, width, |x, y, coverage| {
            let (x, y) = (x.rem_euclid(size as i32), y.rem_euclid(size as i32));
            dots.push(((y * size as i32 + x) as usize, coverage));
        });
        for (i, coverage) in dots {
            let value = PAPER - (PAPER - stroke.tone) * coverage;
            if coverage >= INKED && self.thresholds[i] > DARKEST {
                self.inked += 1;
            }
            // Ink counts where it was found once: kept below the darkest tone.
            let value = if coverage >= INKED {
                stroke.tone
            } else {
                value.max(DARKEST + 0.01)
            };
            self.thresholds[i] = self.thresholds[i].min(value);
        }
    }
}

/// Calls `dot` for every texel that a stroke touches, with its coverage; texels may lie outside of
/// the tile, where it goes on.
fn stroke_texels(stroke: &Stroke, size: f32, width: f32, mut dot: impl FnMut(i32, i32, f32)) {
    let along = Vec2::from_angle(stroke.angle);
    let across = along.perp();
    let half = 0.5 * stroke.length * size;
    let reach = half + width + stroke.bend.abs() * stroke.length * size + 1.0;
    let middle = stroke.at * size;
    let low = (middle - reach).floor().as_ivec2();
    let high = (middle + reach).ceil().as_ivec2();
    for y in low.y..high.y {
        for x in low.x..high.x {
            let p = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) - middle;
            let t = p.dot(along) / half;
            if t.abs() > 1.0 {
                continue;
            }
            let off = p.dot(across) - stroke.bend * stroke.length * size * (1.0 - t * t);
            // Thinner towards its ends, as a pen is set down and lifted.
            let own = 0.5 * width * (1.0 - t * t * t * t).max(0.0).sqrt();
            let coverage = (own + 0.5 - off.abs()).clamp(0.0, 1.0);
            if coverage > 0.0 {
                dot(x, y, coverage);
            }
        }
    }
}

impl Tile {
    /// Fills the levels column by column, within a column from the coarsest level: what a coarse
    /// level or a light column shows, finer levels and darker columns show too.
    #[must_use]
    pub fn new(settings: &TileSettings) -> Self {
        let mut numbers = Numbers(settings.seed.wrapping_mul(0x9e37_79b9) ^ 0x5bd1_e995);
        let mut levels: Vec<Level> = (0..INK_LEVELS).map(Level::new).collect();
        let mut strokes: Vec<Stroke> = Vec::new();
        for column in 1..=COLUMNS {
            let target = DARKEST * column as f32 / COLUMNS as f32;
            let first = DARKEST * (column - 1) as f32 / COLUMNS as f32;
            for level in (0..INK_LEVELS).rev() {
                // Dark tiles take many strokes that mostly overlap; the bound ends hopeless ones.
                for _ in 0..4096 {
                    let darkness = levels[level as usize].darkness();
                    if darkness >= target {
                        break;
                    }
                    let mut stroke = best(&mut numbers, &strokes, settings, first);
                    stroke.tone = darkness.clamp(first, target);
                    stroke.level = level;
                    for finer in &mut levels[..=level as usize] {
                        finer.draw(&stroke, settings.width);
                    }
                    strokes.push(stroke);
                }
            }
        }
        let bytes = |l: &Level| {
            let byte = |t: &f32| (t * 255.0).round().clamp(0.0, 255.0) as u8;
            l.thresholds.iter().map(byte).collect()
        };
        Self {
            levels: levels.iter().map(bytes).collect(),
            strokes,
        }
    }

    /// Share of a level's texels that are ink at a darkness.
    #[must_use]
    pub fn darkness(&self, level: usize, at: f32) -> f32 {
        let limit = (at * 255.0).round() as u8;
        let inked = self.levels[level].iter().filter(|&&t| t <= limit);
        inked.count() as f32 / self.levels[level].len() as f32
    }
}

/// Of a few random strokes the one that keeps the most distance from those that are there.
fn best(numbers: &mut Numbers, strokes: &[Stroke], settings: &TileSettings, tone: f32) -> Stroke {
    let crossing = tone >= settings.crossing;
    let mut best: Option<(f32, Stroke)> = None;
    for _ in 0..CANDIDATES {
        let turn = settings.scatter * (2.0 * numbers.next() - 1.0);
        let second = crossing && numbers.next() < 0.6;
        let stroke = Stroke {
            at: Vec2::new(numbers.next(), numbers.next()),
            length: numbers.between(settings.lengths),
            angle: turn
                + if second {
                    std::f32::consts::FRAC_PI_2
                } else {
                    0.0
                },
            bend: 0.04 * (2.0 * numbers.next() - 1.0),
            tone,
            level: 0,
        };
        let room = strokes
            .iter()
            .filter(|s| (s.angle - stroke.angle).abs() < 0.8)
            .map(|s| apart(s, &stroke))
            .fold(f32::INFINITY, f32::min);
        if best.as_ref().is_none_or(|b| room > b.0) {
            best = Some((room, stroke));
        }
    }
    best.expect("there are candidates").1
}

/// Distance of two strokes of about one direction, across them where they pass each other, on the
/// tile that repeats.
fn apart(a: &Stroke, b: &Stroke) -> f32 {
    let d = b.at - a.at;
    let d = d - d.round();
    let along = Vec2::from_angle(a.angle);
    let (t, s) = (d.dot(along).abs(), d.perp_dot(along).abs());
    let gap = (t - 0.5 * (a.length + b.length)).max(0.0);
    (0.25 * gap).hypot(s)
}

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
    fn tiles_have_the_darkness_that_is_asked_for_at_every_level() {
        let tile = Tile::new(&TileSettings::default());
        for (level, texels) in tile.levels.iter().enumerate() {
            let mut last = 0.0;
            for column in 1..=COLUMNS {
                let at = DARKEST * column as f32 / COLUMNS as f32;
                let found = tile.darkness(level, at);
                // One stroke is the step of the coarse levels.
                let stroke = TileSettings::default().width * 0.6 / level_size(level as u32) as f32;
                assert!(
                    (found - at).abs() <= 0.015 + stroke,
                    "level {level}, darkness {at}: {found}"
                );
                assert!(found >= last, "darker never has less ink");
                last = found;
            }
            assert_eq!(texels.len(), (level_size(level as u32) as usize).pow(2));
        }
    }

    #[test]
    fn finer_levels_have_all_strokes_to_coarser_ones() {
        let tile = Tile::new(&TileSettings::default());
        let width = TileSettings::default().width;
        for level in 0..INK_LEVELS {
            let mut alone = Level::new(level);
            for stroke in tile.strokes.iter().filter(|s| s.level >= level) {
                alone.draw(stroke, width);
            }
            let bytes: Vec<u8> = alone
                .thresholds
                .iter()
                .map(|t| (t * 255.0).round() as u8)
                .collect();
            assert_eq!(
                bytes, tile.levels[level as usize],
                "level {level} from the list"
            );
        }
    }

    #[test]
    fn tiles_repeat_without_a_seam() {
        let tile = Tile::new(&TileSettings::default());
        let size = level_size(0) as usize;
        // Ink changes across the border as often as across other rows.
        let changes = |a: usize, b: usize| {
            let differs = |x: &usize| {
                (tile.levels[0][a * size + x] <= 128) != (tile.levels[0][b * size + x] <= 128)
            };
            (0..size).filter(differs).count()
        };
        let inner: usize = (0..size - 1).map(|y| changes(y, y + 1)).sum();
        let mean = inner as f64 / (size - 1) as f64;
        assert!((changes(size - 1, 0) as f64) < 2.0 * mean + 8.0, "{mean}");
    }

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
