//! Strokes that carry a tone by error diffusion (Deussen and Strothotte 2000, section 3.1; Floyd
//! and Steinberg 1976): where darkness adds up to a threshold a stroke is placed, and the area that
//! it newly covers is taken from what its neighbours still have to carry.

use glam::DVec2;

use crate::math::sampling::uniform;

/// Steps of a tone from 0 to 1.
const STEPS: f64 = 8.0;
/// Makes other numbers of a seed than those of lengths.
const SALT: u32 = 0x9e37_79b9;

/// A tone to be carried by strokes.
#[derive(Debug, Clone, Copy)]
pub struct Tone<'a> {
    /// Pixels across and down.
    pub size: [usize; 2],
    /// Darkness, 0 paper to 1 ink, row by row; negative: not to be drawn on.
    pub darkness: &'a [f32],
}

/// How strokes are placed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiffusionSettings {
    /// Length, pixels.
    pub length: f64,
    /// Width, pixels.
    pub width: f64,
    /// Darkness from which a stroke is placed.
    pub threshold: f64,
    /// Seed of the lengths' scatter.
    pub seed: u32,
    /// Strokes that are cut to less than this share of their length are not drawn, 0 (all are) to 1.
    pub stub: f64,
    /// Way that strokes which are cut stay within where drawing is allowed, pixels.
    pub inset: f64,
}

/// A straight stroke, pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShortStroke {
    /// One end.
    pub from: DVec2,
    /// The other.
    pub to: DVec2,
}

/// Strokes whose ink is the tone's, in the order of rows. `direction` gives the unit direction of
/// a stroke in a pixel.
#[must_use]
pub fn strokes(
    tone: &Tone<'_>,
    settings: &DiffusionSettings,
    direction: impl Fn(usize, usize) -> DVec2,
) -> Vec<ShortStroke> {
    let [w, h] = tone.size;
    let mut field = Field {
        tone,
        covered: vec![false; w * h],
    };
    // What is left to carry in this row and the next.
    let mut rest = [vec![0.0_f64; w + 2], vec![0.0; w + 2]];
    let mut out = Vec::new();
    for y in 0..h {
        let forth = y % 2 == 0;
        for k in 0..w {
            let x = if forth { k } else { w - 1 - k };
            let darkness = tone.darkness[y * w + x];
            if darkness < 0.0 || darkness.is_nan() {
                continue;
            }
            let place = (y * w + x) as u32;
            let mut error =
                stepped(f64::from(darkness.min(1.0)), settings.seed, place) + rest[0][x + 1];
            if error > settings.threshold {
                // By the place: one stroke more or less leaves the lengths of all others alone.
                let scatter = 0.75 + 0.5 * uniform(settings.seed, place);
                let middle = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                let half = 0.5 * settings.length * scatter * direction(x, y);
                if let Some(stroke) = clipped(tone, middle, half, settings) {
                    error -= field.draw(&stroke, settings.width);
                    out.push(stroke);
                } else {
                    // Left for its neighbours; where none is ever drawn little of it is kept.
                    error = error.min(0.25 * settings.length * settings.width);
                }
            }
            let (ahead, behind) = if forth { (x + 2, x) } else { (x, x + 2) };
            let open = |row: usize, column: usize| {
                let inside = row < h && (1..=w).contains(&column);
                inside && tone.darkness[row * w + column - 1] >= 0.0
            };
            let ways = [
                (0, ahead, 7.0),
                (1, behind, 3.0),
                (1, x + 1, 5.0),
                (1, ahead, 1.0),
            ];
            // All of it goes to where it can be drawn.
            let ways =
                ways.map(|(k, to, share)| (k, to, if open(y + k, to) { share } else { 0.0 }));
            let whole: f64 = ways.iter().map(|w| w.2).sum();
            for (k, to, share) in ways.into_iter().filter(|w| w.2 > 0.0) {
                rest[k][to] += error * share / whole;
            }
        }
        rest.swap(0, 1);
        rest[1].fill(0.0);
    }
    out
}

/// A tone on one of few steps, by chance on the one above or below so that its mean remains. What
/// differs in the last places of a tone, as between devices, would otherwise move every stroke that
/// comes after it.
fn stepped(darkness: f64, seed: u32, place: u32) -> f64 {
    (STEPS * darkness + uniform(seed ^ SALT, place)).floor() / STEPS
}

/// The stroke about `middle` as far as it stays where drawing is allowed; none where that is a stub.
pub(super) fn clipped(
    tone: &Tone<'_>,
    middle: DVec2,
    half: DVec2,
    settings: &DiffusionSettings,
) -> Option<ShortStroke> {
    let length = half.length();
    if length <= 0.0 || length.is_nan() {
        return None;
    }
    let [w, h] = tone.size;
    let open = |p: DVec2| {
        let inside = p.x >= 0.0 && p.y >= 0.0 && p.x < w as f64 && p.y < h as f64;
        inside && tone.darkness[p.y as usize * w + p.x as usize] >= 0.0
    };
    let end = |way: DVec2| {
        let steps = (length * 2.0).ceil() as u32;
        let at = |k: u32| middle + way * f64::from(k) / f64::from(steps);
        let last = (1..=steps).take_while(|&k| open(at(k))).last().unwrap_or(0);
        let back = if last < steps { settings.inset } else { 0.0 };
        // Also beyond the middle where that is nearer to the border.
        at(last) - back * way.normalize_or_zero()
    };
    let (from, to) = (end(-half), end(half));
    let left = (to - from).dot(half) / length;
    (left > 0.0 && left >= settings.stub * 2.0 * length).then_some(ShortStroke { from, to })
}

struct Field<'a> {
    tone: &'a Tone<'a>,
    covered: Vec<bool>,
}

impl Field<'_> {
    /// Inks the stroke; pixels that were paper before.
    fn draw(&mut self, stroke: &ShortStroke, width: f64) -> f64 {
        let [w, h] = self.tone.size;
        let low = stroke.from.min(stroke.to) - 0.5 * width;
        let high = stroke.from.max(stroke.to) + 0.5 * width;
        let clamp = |v: f64, most: usize| v.clamp(0.0, most as f64) as usize;
        let way = stroke.to - stroke.from;
        let square = way.length_squared();
        let mut fresh = 0;
        for y in clamp(low.y.floor(), h)..clamp(high.y.ceil(), h) {
            for x in clamp(low.x.floor(), w)..clamp(high.x.ceil(), w) {
                let p = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                let t = if square > 0.0 {
                    (p - stroke.from).dot(way) / square
                } else {
                    0.5
                };
                // Butt ends: the area is length times width.
                let near =
                    (0.0..=1.0).contains(&t) && (p - stroke.from - t * way).length() <= 0.5 * width;
                let here = y * w + x;
                if near && !self.covered[here] && self.tone.darkness[here] >= 0.0 {
                    self.covered[here] = true;
                    fresh += 1;
                }
            }
        }
        f64::from(fresh)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETTINGS: DiffusionSettings = DiffusionSettings {
        length: 12.0,
        width: 1.0,
        threshold: 0.5,
        seed: 1,
        stub: 0.0,
        inset: 0.0,
    };

    /// Ink of the strokes on a picture, as shares of its pixels.
    fn ink(size: [usize; 2], darkness: &[f32], found: &[ShortStroke]) -> Vec<bool> {
        let tone = Tone { size, darkness };
        let mut field = Field {
            tone: &tone,
            covered: vec![false; size[0] * size[1]],
        };
        for s in found {
            field.draw(s, 1.0);
        }
        field.covered
    }

    fn turning(x: usize, y: usize) -> DVec2 {
        DVec2::from_angle((x * 7 + y * 13) as f64 * 0.37)
    }

    #[test]
    fn the_ink_is_the_darkness_that_is_asked_for() {
        let size = [256, 256];
        for darkness in [0.1_f32, 0.25, 0.5, 0.75] {
            let field = vec![darkness; size[0] * size[1]];
            let tone = Tone {
                size,
                darkness: &field,
            };
            let found = strokes(&tone, &SETTINGS, turning);
            let covered = ink(size, &field, &found).iter().filter(|&&c| c).count();
            let ratio = covered as f64 / (f64::from(darkness) * field.len() as f64);
            println!("{darkness}: {ratio:.3}");
            assert!((0.97..=1.05).contains(&ratio), "{darkness}: {ratio}");
        }
    }

    #[test]
    fn steps_keep_the_mean_of_a_tone_and_hardly_ever_tell_the_last_places_of_it() {
        for darkness in [0.0, 0.05, 0.3, 0.5, 0.9, 1.0] {
            let all: Vec<f64> = (0..20_000).map(|k| stepped(darkness, 7, k)).collect();
            let mean = all.iter().sum::<f64>() / all.len() as f64;
            assert!((mean - darkness).abs() < 2e-3, "{darkness}: {mean}");
            assert!(all.iter().all(|t| (t * STEPS).fract() == 0.0));
            let moved = (0..20_000).filter(|&k| stepped(darkness + 1e-6, 7, k) != all[k as usize]);
            assert!(moved.count() <= 2, "{darkness}");
        }
    }

    #[test]
    fn a_change_of_the_last_places_of_a_tone_leaves_its_strokes_alone() {
        let size = [200, 160];
        let tone = |off: f32| -> Vec<ShortStroke> {
            let ramp = |i: usize| 0.1 + 0.6 * (i % 200) as f32 / 200.0;
            let field: Vec<f32> = (0..200 * 160).map(|i| ramp(i) + off).collect();
            let tone = Tone {
                size,
                darkness: &field,
            };
            strokes(&tone, &SETTINGS, turning)
        };
        let (one, other) = (tone(0.0), tone(1e-7));
        assert!(one.len() > 100);
        assert!(one == other, "{} and {}", one.len(), other.len());
    }

    #[test]
    fn without_stubs_the_ink_is_the_same_and_no_stroke_is_one() {
        // A stem two strokes wide; strokes stay half a pen within its borders.
        let (size, sides) = ([64, 400], 20..44);
        for darkness in [0.2_f32, 0.4, 0.6] {
            let inside = |i: usize| sides.contains(&(i % size[0]));
            let field: Vec<f32> = (0..size[0] * size[1])
                .map(|i| if inside(i) { darkness } else { -1.0 })
                .collect();
            let tone = Tone {
                size,
                darkness: &field,
            };
            let settings = DiffusionSettings {
                stub: 0.5,
                inset: 0.8,
                ..SETTINGS
            };
            let across = |x: usize, y: usize| DVec2::from_angle(0.02 * (x * 3 + y * 7) as f64);
            let found = strokes(&tone, &settings, across);
            let covered = ink(size, &field, &found).iter().filter(|&&c| c).count();
            let wanted = f64::from(darkness) * (sides.len() * size[1]) as f64;
            let ratio = covered as f64 / wanted;
            println!("{darkness}: {ratio:.3}");
            assert!((0.97..=1.05).contains(&ratio), "{darkness}: {ratio}");
            let least = found.iter().map(|s| s.from.distance(s.to));
            let least = least.fold(f64::INFINITY, f64::min);
            assert!(least >= 0.5 * 0.75 * SETTINGS.length, "{least}");
        }
    }

    #[test]
    fn a_ramp_is_followed_bin_by_bin() {
        let size = [256, 256];
        let field: Vec<f32> = (0..size[0] * size[1])
            .map(|i| 0.9 * (i % 256) as f32 / 255.0)
            .collect();
        let tone = Tone {
            size,
            darkness: &field,
        };
        let covered = ink(size, &field, &strokes(&tone, &SETTINGS, turning));
        let mut sum = 0.0;
        for bin in 0..16 {
            let inside = (0..field.len()).filter(|i| i % 256 / 16 == bin);
            let (mut wanted, mut got, mut count) = (0.0, 0.0, 0.0);
            for i in inside {
                wanted += f64::from(field[i]);
                got += f64::from(u8::from(covered[i]));
                count += 1.0;
            }
            sum += ((got - wanted) / count).powi(2);
        }
        let rms = (sum / 16.0).sqrt();
        println!("rms {rms:.4}");
        assert!(rms < 0.02, "{rms}");
    }

    #[test]
    fn nothing_is_drawn_where_drawing_is_not_allowed() {
        let size = [64, 40];
        let field: Vec<f32> = (0..64 * 40)
            .map(|i| if (i % 64) < 20 { -1.0 } else { 0.6 })
            .collect();
        let tone = Tone {
            size,
            darkness: &field,
        };
        let found = strokes(&tone, &SETTINGS, |_, _| DVec2::X);
        assert!(found.iter().all(|s| s.from.x >= 19.9 && s.to.x >= 19.9));
        assert!(!found.is_empty());
        let none = strokes(
            &Tone {
                size: [0, 0],
                darkness: &[],
            },
            &SETTINGS,
            |_, _| DVec2::X,
        );
        assert!(none.is_empty());
        let nan = vec![f32::NAN; 12];
        assert!(
            strokes(
                &Tone {
                    size: [4, 3],
                    darkness: &nan
                },
                &SETTINGS,
                |_, _| DVec2::NAN
            )
            .is_empty()
        );
    }
}
