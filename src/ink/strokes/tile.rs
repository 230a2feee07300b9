//! A tile of strokes and the thresholds drawn from it.

use glam::Vec2;

use crate::abi::{INK_LEVELS, INK_TILE};

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
    /// Width at every level that has it, texels.
    pub width: f32,
    /// Darkness from which on it is drawn, 0 to 1.
    pub tone: f32,
    /// Coarsest level that has it; all finer ones do.
    pub level: u32,
}

/// Numbers of a stroke in a list: u, v, length, angle (degrees), bend, width, tone, level.
pub type Listed = [f32; 8];

impl Stroke {
    /// From the numbers of a list.
    ///
    /// # Errors
    /// The first number out of its range.
    pub fn listed(numbers: Listed) -> Result<Self, String> {
        let [u, v, length, angle, bend, width, tone, level] = numbers;
        let ranges = [
            ("u", u, 0.0, 1.0),
            ("v", v, 0.0, 1.0),
            ("length", length, 0.001, 2.0),
            ("angle", angle, -360.0, 360.0),
            ("bend", bend, -1.0, 1.0),
            ("width", width, 0.25, 64.0),
            ("tone", tone, 0.0, 1.0),
            ("level", level, 0.0, (INK_LEVELS - 1) as f32),
        ];
        for (name, value, low, high) in ranges {
            // Also false for NaN.
            if !(value >= low && value <= high) {
                return Err(format!("{name} {value}: expected {low} to {high}"));
            }
        }
        Ok(Self::of(numbers))
    }

    fn of([u, v, length, angle, bend, width, tone, level]: Listed) -> Self {
        Self {
            at: Vec2::new(u, v),
            length,
            angle: angle.to_radians(),
            bend,
            width,
            tone,
            level: level.round() as u32,
        }
    }

    /// What a list says of it.
    pub(super) fn rounded(&self) -> Self {
        Self::of(self.to_listed())
    }

    /// As in a list, rounded to what a picture can show.
    #[must_use]
    pub fn to_listed(&self) -> Listed {
        let round = |v: f32, digits: f32| (v * digits).round() / digits;
        [
            round(self.at.x, 1e4),
            round(self.at.y, 1e4),
            round(self.length, 1e4),
            round(self.angle.to_degrees(), 1e2),
            round(self.bend, 1e4),
            round(self.width, 1e2),
            round(self.tone, 1e4),
            self.level as f32,
        ]
    }
}

/// Darkness of the darkest column of tiles made here.
pub(super) const DARKEST: f32 = 0.9;
/// A coverage from which a texel counts as inked.
const INKED: f32 = 0.5;
/// Value of a threshold without ink.
const PAPER: f32 = 1.0;

/// A hatching tile: its strokes and, for each level, the darkness from which a texel is ink.
#[derive(Debug, Clone, PartialEq)]
pub struct Tile {
    /// All strokes, in the order in which they were placed; none of a painted tile.
    pub strokes: Vec<Stroke>,
    /// Thresholds of each level from the finest, row by row; 255 is paper.
    pub levels: Vec<Vec<u8>>,
}

/// Edge of a level, texels.
#[must_use]
pub fn level_size(level: u32) -> u32 {
    INK_TILE >> level
}

/// Thresholds of one level while it is filled.
pub(super) struct Level {
    size: u32,
    thresholds: Vec<f32>,
    inked: usize,
}

impl Level {
    pub(super) fn new(level: u32) -> Self {
        let size = level_size(level);
        Self {
            size,
            thresholds: vec![PAPER; (size * size) as usize],
            inked: 0,
        }
    }

    /// Share of the texels that any stroke inks.
    pub(super) fn darkness(&self) -> f32 {
        self.inked as f32 / self.thresholds.len() as f32
    }

    /// What a stroke would add to the darkness.
    pub(super) fn gain(&self, stroke: &Stroke) -> f32 {
        let mut added = 0;
        self.texels(stroke, |i, coverage| {
            added += u32::from(coverage >= INKED && self.thresholds[i] > DARKEST);
        });
        added as f32 / self.thresholds.len() as f32
    }

    pub(super) fn draw(&mut self, stroke: &Stroke) {
        let mut dots = Vec::new();
        self.texels(stroke, |i, coverage| {
            if coverage >= INKED {
                dots.push(i);
            }
        });
        for i in dots {
            self.inked += usize::from(self.thresholds[i] > DARKEST);
            self.thresholds[i] = self.thresholds[i].min(stroke.tone);
        }
    }

    fn texels(&self, stroke: &Stroke, mut dot: impl FnMut(usize, f32)) {
        let size = self.size as i32;
        stroke_texels(stroke, self.size as f32, |x, y, coverage| {
            dot(
                (y.rem_euclid(size) * size + x.rem_euclid(size)) as usize,
                coverage,
            );
        });
    }

    fn bytes(&self) -> Vec<u8> {
        let byte = |t: &f32| (t * 255.0).round().clamp(0.0, 255.0) as u8;
        self.thresholds.iter().map(byte).collect()
    }
}

/// Calls `dot` for every texel that a stroke touches, with its coverage; texels may lie outside of
/// the tile, where it goes on.
fn stroke_texels(stroke: &Stroke, size: f32, mut dot: impl FnMut(i32, i32, f32)) {
    let along = Vec2::from_angle(stroke.angle);
    let across = along.perp();
    let half = 0.5 * stroke.length * size;
    let sag = stroke.bend * stroke.length * size;
    let reach = half * along.abs() + (sag.abs() + stroke.width + 1.0) * Vec2::ONE;
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
            let off = p.dot(across) - sag * (1.0 - t * t);
            // Set down quickly, lifted slowly.
            let press = (1.0 - t * t).max(0.0).powf(0.6) * (1.1 - 0.35 * t);
            let own = 0.5 * stroke.width * press;
            let coverage = (own + 0.5 - off.abs()).clamp(0.0, 1.0);
            if coverage > 0.0 {
                dot(x, y, coverage);
            }
        }
    }
}

impl Tile {
    /// Draws strokes of any source, each on its level and all finer ones.
    #[must_use]
    pub fn of_strokes(strokes: Vec<Stroke>) -> Self {
        let level = |number: u32| {
            let mut level = Level::new(number);
            for stroke in strokes.iter().filter(|s| s.level >= number) {
                level.draw(stroke);
            }
            level.bytes()
        };
        let levels = (0..INK_LEVELS).map(level).collect();
        Self { strokes, levels }
    }

    /// Share of a level's texels that are ink at a darkness.
    #[must_use]
    pub fn darkness(&self, level: usize, at: f32) -> f32 {
        let limit = (at * 255.0).round() as u8;
        let inked = self.levels[level].iter().filter(|&&t| t <= limit);
        inked.count() as f32 / self.levels[level].len() as f32
    }

    /// Largest difference of darkness and tone at a level, over 48 tones up to the darkest that
    /// the finest level has.
    #[must_use]
    pub fn tone_error(&self, level: usize) -> f32 {
        let most = self.darkness(0, 254.0 / 255.0).min(DARKEST);
        let tones = (1..=48).map(|k| most * k as f32 / 48.0);
        tones
            .map(|t| (self.darkness(level, t) - t).abs())
            .fold(0.0, f32::max)
    }

    /// How much rougher the tile is across its border than within, along u and v: about 1 where
    /// it repeats.
    #[must_use]
    pub fn seams(&self) -> [f32; 2] {
        let size = INK_TILE as usize;
        let at = |x: usize, y: usize| f32::from(self.levels[0][y * size + x]);
        let leap = |k: usize, along_u: bool| {
            let of = |j: usize| {
                let next = (k + 1) % size;
                if along_u {
                    (at(k, j) - at(next, j)).abs()
                } else {
                    (at(j, k) - at(j, next)).abs()
                }
            };
            (0..size).map(of).sum::<f32>()
        };
        [true, false].map(|along_u| {
            let inner: f32 = (0..size - 1).map(|k| leap(k, along_u)).sum();
            let mean = inner / (size - 1) as f32;
            (leap(size - 1, along_u) + 1.0) / (mean + 1.0)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::TileSettings;
    use super::*;

    #[test]
    fn finer_levels_and_darker_tones_have_all_ink_of_the_others() {
        let tile = Tile::new(&TileSettings::default());
        assert_eq!(
            Tile::of_strokes(tile.strokes.clone()),
            tile,
            "the list is the tile"
        );
        for level in 0..INK_LEVELS {
            let alone: Vec<Stroke> = tile
                .strokes
                .iter()
                .filter(|s| s.level >= level)
                .copied()
                .collect();
            let alone = Tile::of_strokes(alone);
            assert_eq!(
                alone.levels[level as usize], tile.levels[level as usize],
                "level {level} from its own strokes"
            );
            // The strokes of a level are strokes of the finer one, in its texels too.
            let fine = &tile.levels[0];
            if level == 0 {
                assert!(alone.levels[0].iter().zip(fine).all(|(a, b)| b <= a));
            } else {
                assert!(
                    alone.levels[0].iter().zip(fine).all(|(a, b)| b <= a),
                    "{level}"
                );
                assert!(
                    alone.strokes.len() < tile.strokes.len(),
                    "coarser has fewer"
                );
            }
        }
        // Strokes of the finest level alone would lack those of coarser ones.
        let own = tile.strokes.iter().filter(|s| s.level == 0).copied();
        let own = Tile::of_strokes(own.collect());
        let coarse = tile.strokes.iter().filter(|s| s.level > 0).copied();
        let coarse = Tile::of_strokes(coarse.collect());
        let within = coarse.levels[0].iter().zip(&own.levels[0]);
        assert!(!within.clone().all(|(a, b)| b <= a), "nesting is told");
        // Tones are nested since a texel has one threshold: what is ink at a darkness is at more.
        let inked = |at: u8| tile.levels[0].iter().map(move |&t| t <= at);
        assert!(inked(90).zip(inked(140)).all(|(a, b)| b || !a), "nested");
    }

    #[test]
    fn tiles_repeat_without_a_seam_and_a_cut_one_does_not() {
        let tile = Tile::new(&TileSettings::default());
        let [u, v] = tile.seams();
        assert!(u < 1.6 && v < 1.6, "{u} {v}");
        // Without the wrap: strokes cut off at the border.
        let size = INK_TILE as usize;
        let mut cut = tile.clone();
        for (i, t) in cut.levels[0].iter_mut().enumerate() {
            let (x, y) = (i % size, i / size);
            if x > size - 40 || y > size - 40 {
                *t = 255;
            }
        }
        let [u, v] = cut.seams();
        assert!(u > 1.6 && v > 1.6, "the measure tells: {u} {v}");
    }

    #[test]
    fn lists_go_and_come() {
        let tile = Tile::new(&TileSettings::default());
        let listed: Vec<Listed> = tile.strokes.iter().map(Stroke::to_listed).collect();
        let again: Vec<Stroke> = listed.iter().map(|&n| Stroke::listed(n).unwrap()).collect();
        let again = Tile::of_strokes(again);
        assert_eq!(again, tile, "the list draws the same");
        let wrong = Stroke::listed([0.5, 0.5, 0.2, 0.0, 0.0, 1.0, 1.5, 0.0]);
        assert_eq!(wrong.unwrap_err(), "tone 1.5: expected 0 to 1");
    }
}
