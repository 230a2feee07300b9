//! Strokes and an unsteady hand that stay where they are in space while the camera moves: error
//! diffusion (Deussen and Strothotte 2000, section 3.1) gives other strokes in every frame. Space
//! is cut into cells; each has its own chance, which the visible part of its surface and the tone on
//! it are held against.

use std::collections::HashMap;

use glam::{DVec2, DVec3, IVec3};

use super::diffusion::{self, DiffusionSettings, ShortStroke, Tone, clipped};
use super::drawing::Placement;
use super::pen::noise;
use super::style::PaperStyle;
use super::vectors::{StrokePlaces, Vectors};
use crate::abi::PaperParticle;
use crate::ink::view::View;
use crate::math::hashing::WordHash;
use crate::math::sampling::{pcg, uniform};

/// Edge of a cell, pixels in the middle of what is seen: few cells have more than one stroke.
const CELL: f64 = 6.0;

/// A surface on which strokes are placed.
#[derive(Debug, Clone, Copy)]
pub struct Surface<'a> {
    /// The view.
    pub view: &'a View,
    /// Eye depth of each pixel of what is hatched.
    pub depth: &'a [f32],
    /// Where strokes go.
    pub vector: Vectors,
}

/// Edge of the cells for a view, metres.
#[must_use]
pub fn cell_of(view: &View) -> f64 {
    CELL * view.middle_distance() / view.focal()
}

/// Metres of a pixel in the middle of what is seen; in a sequence as in its first frame.
#[must_use]
pub fn metres_of_pixel(vector: &Vectors, view: &View) -> f64 {
    let edge = if vector.cell > 0.0 {
        vector.cell
    } else {
        cell_of(view)
    };
    edge / CELL
}

/// Strokes for a tone in the directions that `way` tells, by the way that the style asks for.
#[must_use]
pub fn placed(
    tone: &Tone<'_>,
    settings: &DiffusionSettings,
    surface: &Surface<'_>,
    way: impl Fn(usize, usize) -> DVec2,
) -> Vec<ShortStroke> {
    match surface.vector.strokes {
        StrokePlaces::Diffused => diffusion::strokes(tone, settings, way),
        StrokePlaces::Anchored => strokes(tone, settings, surface, way),
    }
}

/// What is seen of a cell.
#[derive(Debug, Clone, Copy, Default)]
struct Seen {
    pixels: f64,
    darkness: f64,
    /// The pixel nearest to the cell's own place, and its distance from it, pixels.
    nearest: Option<(usize, f64)>,
}

/// Strokes for a tone (negative: no part of what is hatched) in the directions that `way` tells.
/// Their ink is the tone in the mean, over all cells.
#[must_use]
pub fn strokes(
    tone: &Tone<'_>,
    settings: &DiffusionSettings,
    surface: &Surface<'_>,
    way: impl Fn(usize, usize) -> DVec2,
) -> Vec<ShortStroke> {
    let area = (settings.length * settings.width).max(1e-6);
    let edge = CELL * metres_of_pixel(&surface.vector, surface.view);
    let mut found: Vec<(usize, ShortStroke)> = Vec::new();
    for (cell, seen) in &cells(tone, surface, edge, settings.seed) {
        let Some((at, _)) = seen.nearest else {
            continue;
        };
        let mean = (seen.darkness / seen.pixels).min(0.97);
        // Strokes at random places cover 1 - exp(-density) of the paper.
        let wanted = -(1.0 - mean).ln() * seen.pixels / area;
        let seed = hash(*cell, settings.seed);
        let scatter = 0.75 + 0.5 * uniform(seed, 4);
        let (x, y) = (at % tone.size[0], at / tone.size[0]);
        let middle = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
        let half = 0.5 * scatter * settings.length * way(x, y);
        let beside = half.perp().normalize_or_zero() * settings.width;
        let count = (wanted + uniform(seed, 3)).floor().min(8.0) as u32;
        let strokes = (0..count)
            .filter_map(|k| clipped(tone, middle + f64::from(k) * beside, half, settings));
        found.extend(strokes.map(|stroke| (at, stroke)));
    }
    // The map has no order of its own.
    found.sort_by(|(a, s), (b, t)| a.cmp(b).then(s.from.x.total_cmp(&t.from.x)));
    found.into_iter().map(|(_, stroke)| stroke).collect()
}

fn cells(
    tone: &Tone<'_>,
    surface: &Surface<'_>,
    edge: f64,
    seed: u32,
) -> HashMap<IVec3, Seen, WordHash> {
    let width = tone.size[0];
    let mut cells: HashMap<IVec3, Seen, WordHash> = HashMap::default();
    for (i, &darkness) in tone.darkness.iter().enumerate() {
        let depth = f64::from(surface.depth[i]);
        if darkness < 0.0 || depth <= 0.0 {
            continue;
        }
        let pixel = DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
        let cell = (surface.view.point(pixel, depth) / edge).floor().as_ivec3();
        let random = hash(cell, seed);
        let jitter = DVec3::new(uniform(random, 0), uniform(random, 1), uniform(random, 2));
        let own = surface.view.pixel(edge * (cell.as_dvec3() + jitter)).0;
        let seen = cells.entry(cell).or_default();
        seen.pixels += 1.0;
        seen.darkness += f64::from(darkness);
        let off = pixel.distance(own);
        if seen.nearest.is_none_or(|(_, least)| off < least) {
            seen.nearest = Some((i, off));
        }
    }
    cells
}

fn hash(cell: IVec3, seed: u32) -> u32 {
    let [x, y, z] = cell.to_array().map(i32::cast_unsigned);
    pcg(x ^ pcg(y ^ pcg(z ^ pcg(seed))))
}

/// Smooth noise of a place in space, -1 to 1, over `wavelength`: the hand's for lines on surfaces.
#[must_use]
pub fn noise_at(point: DVec3, wavelength: f64, seed: u32) -> f64 {
    // Three waves across one another: no plane of space is without noise, and none repeats.
    let axes = [
        DVec3::new(0.62, 0.54, 0.57),
        DVec3::new(-0.71, 0.66, 0.25),
        DVec3::new(0.33, -0.28, 0.90),
    ];
    let one = |(k, axis): (u32, &DVec3)| {
        // Far from zero all the time: whole numbers below it are others after rounding to u32.
        noise(point.dot(*axis) / wavelength + 1e6, None, pcg(seed ^ k))
    };
    (0..).zip(&axes).map(one).sum::<f64>() / 3.0
}

/// Unsteadiness of the hand at places of a primitive's outline, by the direction from its middle:
/// whatever parts of it are seen, they are those of one line.
pub(super) fn hand_round(
    outline: &[DVec2],
    particle: &PaperParticle,
    (style, view): (&PaperStyle, &View),
    placement: &Placement,
) -> impl Fn(DVec2) -> f64 + use<> {
    let count = outline.len().max(1) as f64;
    let middle = outline.iter().copied().sum::<DVec2>() / count;
    // In the middle of what is seen: a whole number that does not change on the way there.
    let reach = f64::from(particle.radius) / metres_of_pixel(&style.vector, view);
    let length = std::f64::consts::TAU * reach * placement.scale;
    let waves = (length / style.foliage.pen.wavelength).round().max(1.0);
    // What is random of a particle, whatever its number among those that are drawn.
    let seed = pcg(particle.waves[0].to_bits() ^ pcg(particle.waves[1].to_bits() ^ style.seed));
    let placement = *placement;
    move |p| {
        let turn = (placement.pixel(p) - middle).to_angle() / std::f64::consts::TAU;
        noise(waves * turn.rem_euclid(1.0), Some(waves as u32), seed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Camera;

    const SIZE: [u32; 2] = [240, 180];

    /// A wall at z = -10.05, seen from `x` to its side.
    fn wall(x: f64) -> (View, Vec<f32>) {
        let camera = Camera {
            eye: DVec3::new(x, 0.0, 0.0),
            forward: DVec3::NEG_Z,
            fov: 40.0,
            aspect: f64::from(SIZE[0]) / f64::from(SIZE[1]),
            near: 0.01,
            roll: 0.0,
        };
        let ends = [
            glam::Vec3::new(0.0, 0.0, -9.0),
            glam::Vec3::new(0.0, 0.0, -11.0),
        ];
        let view = View::new(camera, DVec3::ZERO, SIZE, glam::Vec3::Y, &ends);
        (view, vec![10.05; (SIZE[0] * SIZE[1]) as usize])
    }

    fn placed(x: f64, darkness: f32) -> (View, Vec<ShortStroke>) {
        let (view, depth) = wall(x);
        let darkness = vec![darkness; depth.len()];
        let tone = Tone {
            size: SIZE.map(|s| s as usize),
            darkness: &darkness,
        };
        let surface = Surface {
            view: &view,
            depth: &depth,
            vector: Vectors {
                cell: 0.25,
                ..Vectors::default()
            },
        };
        let settings = DiffusionSettings {
            length: 10.0,
            width: 3.0,
            threshold: 0.5,
            seed: 3,
            stub: 0.0,
            inset: 0.0,
        };
        let found = strokes(&tone, &settings, &surface, |_, _| DVec2::X);
        (view, found)
    }

    #[test]
    fn strokes_stay_on_their_places_while_the_camera_moves() {
        let (view, before) = placed(0.0, 0.3);
        let (moved, after) = placed(0.3, 0.3);
        let world = |view: &View, s: &ShortStroke| view.point(0.5 * (s.from + s.to), 10.05);
        let places: Vec<DVec3> = after.iter().map(|s| world(&moved, s)).collect();
        let pixel = 10.05 / view.focal();
        let kept = before
            .iter()
            .filter(|s| {
                let here = world(&view, s);
                places.iter().any(|p| p.distance(here) < 1.5 * pixel)
            })
            .count();
        let share = kept as f64 / before.len() as f64;
        assert!(
            before.len() > 100 && share > 0.9,
            "{share} of {}",
            before.len()
        );
    }

    #[test]
    fn the_ink_is_the_tone_in_the_mean() {
        for darkness in [0.1, 0.3, 0.6] {
            let (_, found) = placed(0.0, darkness);
            let [w, h] = SIZE.map(|s| s as usize);
            let mut ink = vec![false; w * h];
            for s in &found {
                for y in (s.from.y - 1.5).round() as i64..(s.from.y + 1.5).round() as i64 {
                    for x in s.from.x.round() as i64..s.to.x.round() as i64 {
                        if (0..w as i64).contains(&x) && (0..h as i64).contains(&y) {
                            ink[y as usize * w + x as usize] = true;
                        }
                    }
                }
            }
            let covered = ink.iter().filter(|&&i| i).count() as f64 / ink.len() as f64;
            let ratio = covered / f64::from(darkness);
            assert!((0.8..1.2).contains(&ratio), "{darkness}: {ratio}");
        }
    }

    #[test]
    fn noise_in_space_is_smooth_bounded_and_not_the_same_everywhere() {
        let at = |x: f64| noise_at(DVec3::new(x, -3.0, 2.0), 0.5, 7);
        let all: Vec<f64> = (0..400).map(|k| at(-2.0 + 0.01 * f64::from(k))).collect();
        assert!(all.iter().all(|v| v.abs() <= 1.0));
        assert!(all.windows(2).all(|w| (w[0] - w[1]).abs() < 0.08), "smooth");
        let high = all.iter().copied().fold(f64::MIN, f64::max);
        let low = all.iter().copied().fold(f64::MAX, f64::min);
        assert!(high - low > 0.5, "{low} to {high}");
    }
}
