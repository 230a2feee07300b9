//! Tiles filled by the program: strokes where there is most room, tone after tone.

use std::f32::consts::{FRAC_PI_2, TAU};

use glam::Vec2;

use super::tile::{DARKEST, Level, Stroke, Tile, level_size};
use crate::abi::INK_LEVELS;

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
    /// Direction of those that cross, radians.
    pub cross_angle: f32,
    /// Tones in which levels are filled one after the other.
    pub tones: u32,
}

impl Default for TileSettings {
    fn default() -> Self {
        Self {
            seed: 1,
            width: 1.6,
            lengths: [0.14, 0.6],
            scatter: 0.07,
            crossing: 0.6,
            cross_angle: FRAC_PI_2,
            tones: 36,
        }
    }
}

/// Places tried for a stroke.
const CANDIDATES: u32 = 80;
/// Texels of a level over which strokes keep each other away (the deviation of a Gaussian).
const REACH: f32 = 8.0;
/// Cells over it.
const CELLS: f32 = 2.0;
/// Strokes of one tone and level at most: dark tiles take many that mostly overlap.
const MOST: u32 = 4096;
/// Sideways bend of strokes at most, lengths.
const BEND: f32 = 0.06;
/// Directions drift over the tile by this much of their scatter.
const DRIFT: f32 = 1.2;
/// Share of the crossing strokes above their darkness.
const CROSSED: f32 = 0.6;
/// Numbers from a seed; the same everywhere.
#[derive(Debug, Clone)]
pub(super) struct Numbers(pub(super) u32);

impl Numbers {
    /// The next one in [0, 1).
    pub(super) fn next(&mut self) -> f32 {
        // PCG-RXS-M-XS (O'Neill 2014).
        self.0 = self.0.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let word = ((self.0 >> ((self.0 >> 28) + 4)) ^ self.0).wrapping_mul(277_803_737);
        let word = (word >> 22) ^ word;
        (word >> 8) as f32 / 16_777_216.0
    }
}

/// How much ink lies about each place of a level: what strokes keep away from.
struct Crowd {
    /// Cells along an edge.
    cells: i32,
    ink: Vec<f32>,
}

impl Crowd {
    fn new(level: u32) -> Self {
        let cells = (level_size(level) as f32 * CELLS / REACH).round();
        Self {
            cells: cells as i32,
            ink: vec![0.0; (cells * cells) as usize],
        }
    }

    /// Places along a stroke, a cell apart, in cells.
    fn places(&self, stroke: &Stroke) -> impl Iterator<Item = Vec2> + use<> {
        let size = self.cells as f32;
        let steps = (stroke.length * size).ceil().max(1.0);
        let along = Vec2::from_angle(stroke.angle) * stroke.length * size;
        let middle = stroke.at * size;
        (0..steps as u32).map(move |k| middle + along * ((k as f32 + 0.5) / steps - 0.5))
    }

    fn at(&self, x: i32, y: i32) -> usize {
        (y.rem_euclid(self.cells) * self.cells + x.rem_euclid(self.cells)) as usize
    }

    fn add(&mut self, stroke: &Stroke) {
        let reach = (2.5 * CELLS).ceil() as i32;
        let share = stroke.length * self.cells as f32;
        let share = share / share.ceil().max(1.0);
        for place in self.places(stroke) {
            let low = place.floor().as_ivec2();
            for y in low.y - reach..=low.y + reach {
                for x in low.x - reach..=low.x + reach {
                    let d = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) - place;
                    let i = self.at(x, y);
                    self.ink[i] += share * (-0.5 * d.length_squared() / (CELLS * CELLS)).exp();
                }
            }
        }
    }

    /// Mean ink about a stroke.
    fn about(&self, stroke: &Stroke) -> f32 {
        let (mut sum, mut count) = (0.0, 0.0);
        for place in self.places(stroke) {
            let low = place.floor().as_ivec2();
            sum += self.ink[self.at(low.x, low.y)];
            count += 1.0;
        }
        sum / count
    }
}

impl Tile {
    /// Fills the levels tone by tone, within a tone from the coarsest level: what a coarse level
    /// or a light tone shows, finer levels and darker tones show too.
    #[must_use]
    pub fn new(settings: &TileSettings) -> Self {
        let mut numbers = Numbers(settings.seed.wrapping_mul(0x9e37_79b9) ^ 0x5bd1_e995);
        let mut levels: Vec<Level> = (0..INK_LEVELS).map(Level::new).collect();
        let mut strokes: Vec<Stroke> = Vec::new();
        let mut crowds: Vec<Crowd> = (0..INK_LEVELS).map(Crowd::new).collect();
        for tone in 1..=settings.tones {
            let first = DARKEST * (tone - 1) as f32 / settings.tones as f32;
            let target = DARKEST * tone as f32 / settings.tones as f32;
            for level in (0..INK_LEVELS).rev() {
                for _ in 0..MOST {
                    let own = &levels[level as usize];
                    let darkness = own.darkness();
                    let mut stroke = best(&mut numbers, &crowds, settings, (first, level));
                    let Some(gain) = fitted(own, &mut stroke, target - darkness) else {
                        break;
                    };
                    // It comes in half way to what it makes: right on both sides.
                    stroke.tone = (darkness + 0.5 * gain).clamp(first, target);
                    // With the digits that a list has, so that a list draws the same.
                    let stroke = stroke.rounded();
                    for finer in &mut levels[..=level as usize] {
                        finer.draw(&stroke);
                    }
                    for finer in &mut crowds[..=level as usize] {
                        finer.add(&stroke);
                    }
                    strokes.push(stroke);
                }
            }
        }
        Self::of_strokes(strokes)
    }
}

/// What a stroke adds to a level, shortened where it would add much more than what is left; none
/// where nothing fits any more.
fn fitted(level: &Level, stroke: &mut Stroke, left: f32) -> Option<f32> {
    if left <= 0.0 {
        return None;
    }
    for _ in 0..6 {
        let gain = level.gain(stroke);
        if gain <= 1.5 * left {
            return Some(gain);
        }
        stroke.length *= 0.6;
    }
    None
}

/// Direction in which strokes of a neighbourhood lean together, radians; it repeats with the tile.
fn drift(at: Vec2, scatter: f32) -> f32 {
    let wave = (TAU * at.y).sin();
    DRIFT * scatter * (TAU * (at.x + 0.25 * wave)).sin()
}

/// Of a few random strokes the one with the least ink about it, at its level and all finer ones.
fn best(
    numbers: &mut Numbers,
    crowds: &[Crowd],
    settings: &TileSettings,
    (tone, level): (f32, u32),
) -> Stroke {
    let crossing = tone >= settings.crossing;
    let mut best: Option<(f32, Stroke)> = None;
    for _ in 0..CANDIDATES {
        let second = crossing && numbers.next() < CROSSED;
        let at = Vec2::new(numbers.next(), numbers.next());
        // Short strokes are more than long ones; none is quite straight.
        let share = numbers.next();
        let turn = settings.scatter * (2.0 * numbers.next() - 1.0) + drift(at, settings.scatter);
        let stroke = Stroke {
            at,
            length: settings.lengths[0]
                + (settings.lengths[1] - settings.lengths[0]) * share * share,
            angle: turn + if second { settings.cross_angle } else { 0.0 },
            bend: BEND * (2.0 * numbers.next() - 1.0),
            // Light tones are drawn with a light hand.
            width: settings.width * (0.8 + 0.4 * tone + 0.4 * numbers.next()),
            tone,
            level,
        };
        let levels = crowds[..=level as usize].iter();
        let crowd: f32 = levels.map(|c| c.about(&stroke)).sum();
        if best.as_ref().is_none_or(|b| crowd < b.0) {
            best = Some((crowd, stroke));
        }
    }
    best.expect("there are candidates").1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_have_the_darkness_that_is_asked_for_at_every_level() {
        for settings in [
            TileSettings::default(),
            TileSettings {
                seed: 7,
                tones: 6,
                width: 2.5,
                ..TileSettings::default()
            },
        ] {
            let tile = Tile::new(&settings);
            for level in 0..INK_LEVELS as usize {
                let mut last = 0.0;
                for step in 1..=48 {
                    let found = tile.darkness(level, DARKEST * step as f32 / 48.0);
                    assert!(found >= last, "darker never has less ink");
                    last = found;
                }
                for tone in 1..=settings.tones {
                    let at = DARKEST * tone as f32 / settings.tones as f32;
                    let found = tile.darkness(level, at);
                    assert!((found - at).abs() <= 0.015, "level {level}, {at}: {found}");
                }
            }
        }
    }

    #[test]
    fn strokes_that_come_in_at_other_tones_are_told() {
        let tile = Tile::new(&TileSettings {
            tones: 6,
            ..TileSettings::default()
        });
        assert!(tile.tone_error(0) < 0.1);
        let late = tile.strokes.iter().map(|s| Stroke {
            tone: s.tone * s.tone,
            ..*s
        });
        let late = Tile::of_strokes(late.collect());
        assert!(late.tone_error(0) > 0.1, "{}", late.tone_error(0));
    }

    #[test]
    fn strokes_cross_above_their_tone_and_not_below() {
        let settings = TileSettings {
            crossing: 0.5,
            cross_angle: 1.0,
            ..TileSettings::default()
        };
        let tile = Tile::new(&settings);
        let crosses = |s: &&Stroke| s.angle > 0.5;
        let low = tile.strokes.iter().filter(crosses).map(|s| s.tone);
        assert!(low.fold(1.0, f32::min) >= 0.5 - 1e-6, "none below");
        assert!(
            tile.strokes.iter().filter(crosses).count() > 50,
            "some above"
        );
    }
}
