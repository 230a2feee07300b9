//! A leaf's way to a shape of the user's instead of the disc.
//!
//! Two shapes are not one inside the other as leaf and disc are, so that no single alpha does: the
//! distances to both outlines are mixed, and the mixture is cut where its area lies between theirs
//! (level sets after Cohen-Or, Levin, Solomovici 1998, whose areas may swell).

use glam::Vec2;

use super::shape::{OUTLINE, SHAPE_SIZE, Shape, distances};
use crate::scene::textures::Rgba8;

/// Texels along an edge while shapes are mixed.
const FINE: usize = 2 * SHAPE_SIZE;
/// Distance from the outline at which its alpha leaves the byte, radii.
const SPAN: f32 = 0.15;

/// A shape that a user painted: its largest distance from the middle of its box is 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// Whether each fine texel over `[-1, 1]^2` is inside; row by row from the top.
    inside: Vec<bool>,
}

fn fine_place(i: usize) -> Vec2 {
    let at = |k: usize| (k as f32 + 0.5) * 2.0 / FINE as f32 - 1.0;
    Vec2::new(at(i % FINE), -at(i / FINE))
}

impl Outline {
    /// From a picture: opaque pixels are inside, or dark ones where all are opaque; its top is the
    /// leaf's tip.
    ///
    /// # Errors
    /// Nothing is inside, or less than a hundredth of the shape's own disc.
    pub fn new(image: &Rgba8) -> Result<Self, String> {
        let [width, height] = [image.width as usize, image.height as usize];
        let opaque = image.pixels.chunks_exact(4).all(|p| p[3] == 255);
        let set = |x: usize, y: usize| {
            let p = &image.pixels[4 * (y * width + x)..][..4];
            if opaque {
                u32::from(p[0]) + u32::from(p[1]) + u32::from(p[2]) < 384
            } else {
                p[3] >= 128
            }
        };
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let places: Vec<Vec2> = pixels
            .filter(|&(x, y)| set(x, y))
            .map(|(x, y)| Vec2::new(x as f32 + 0.5, y as f32 + 0.5))
            .collect();
        let low = places.iter().copied().fold(Vec2::INFINITY, Vec2::min);
        let high = places.iter().copied().fold(-Vec2::INFINITY, Vec2::max);
        let middle = 0.5 * (low + high);
        let far = places
            .iter()
            .map(|p| p.distance(middle))
            .fold(0.0, f32::max);
        if places.is_empty() || (places.len() as f32) < 0.01 * std::f32::consts::PI * far * far {
            return Err("shows no shape: paint it black on white, or opaque on nothing".into());
        }
        let radius = far + 0.5;
        Ok(Self::of(|p| {
            let at = middle + radius * Vec2::new(p.x, -p.y);
            let (x, y) = (at.x.floor(), at.y.floor());
            let within = x >= 0.0 && y >= 0.0 && x < width as f32 && y < height as f32;
            within && set(x as usize, y as usize)
        }))
    }

    /// From a function, over `[-1, 1]^2`.
    #[must_use]
    pub fn of(covers: impl Fn(Vec2) -> bool) -> Self {
        Self {
            inside: (0..FINE * FINE).map(|i| covers(fine_place(i))).collect(),
        }
    }

    /// Whether a place is inside.
    #[must_use]
    pub fn covers(&self, at: Vec2) -> bool {
        let index = |v: f32| (((v + 1.0) * 0.5 * FINE as f32) as usize).min(FINE - 1);
        at.abs().max_element() <= 1.0 && self.inside[index(-at.y) * FINE + index(at.x)]
    }
}

/// Distances to the border of a set in radii, positive inside.
fn signed(inside: &[bool]) -> Vec<f32> {
    let outside: Vec<bool> = inside.iter().map(|i| !i).collect();
    let (to_set, to_rest) = (distances(inside, FINE), distances(&outside, FINE));
    let texel = 2.0 / FINE as f32;
    let most = 4.0;
    let one = |i: usize| {
        let away = if inside[i] {
            to_rest[i] - 0.5
        } else {
            0.5 - to_set[i]
        };
        (away * texel).clamp(-most, most)
    };
    (0..inside.len()).map(one).collect()
}

impl Shape {
    /// The shape on the way from the leaf (`tau` 1) to an outline (0); its own threshold is 1.
    #[must_use]
    pub fn towards(&self, outline: &Outline, tau: f32) -> Self {
        let leaf: Vec<bool> = (0..FINE * FINE)
            .map(|i| self.covers(fine_place(i), 1.0))
            .collect();
        let count = |set: &[bool]| set.iter().filter(|s| **s).count() as f32;
        let area = tau * count(&leaf) + (1.0 - tau) * count(&outline.inside);
        let (from, to) = (signed(&leaf), signed(&outline.inside));
        let mixed: Vec<f32> = from
            .iter()
            .zip(&to)
            .map(|(a, b)| tau * a + (1.0 - tau) * b)
            .collect();
        let mut sorted = mixed.clone();
        sorted.sort_by(|a, b| b.total_cmp(a));
        // Between the last one within and the first one outside.
        let within = (area.round() as usize).clamp(1, sorted.len() - 1);
        let cut = 0.5 * (sorted[within - 1] + sorted[within]);
        let texel = |i: usize| {
            let (x, y) = (2 * (i % SHAPE_SIZE), 2 * (i / SHAPE_SIZE));
            let four = [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)];
            let sum: f32 = four.iter().map(|&(x, y)| mixed[y * FINE + x] - cut).sum();
            let alpha = 1.0 + 0.25 * sum / SPAN;
            (f32::from(OUTLINE) * alpha).round().clamp(0.0, 255.0) as u8
        };
        Self {
            texels: (0..SHAPE_SIZE * SHAPE_SIZE).map(texel).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn leaf(p: Vec2) -> bool {
        (p.x / 0.6).powi(2) + p.y * p.y <= 1.0
    }

    /// A three-lobed leaf, neither within the other nor around it.
    fn lobes(p: Vec2) -> bool {
        p.length() <= 0.55 + 0.45 * (3.0 * p.x.atan2(p.y)).cos()
    }

    fn share(covers: impl Fn(Vec2) -> bool) -> f64 {
        let n = 500;
        let at = |i: usize| (i as f32 + 0.5) * 2.0 / n as f32 - 1.0;
        let hits = (0..n * n).filter(|i| covers(Vec2::new(at(i % n), at(i / n))));
        hits.count() as f64 / (n * n) as f64
    }

    fn overlap(a: impl Fn(Vec2) -> bool, b: impl Fn(Vec2) -> bool) -> f64 {
        share(|p| a(p) && b(p)) / share(|p| a(p) || b(p))
    }

    #[test]
    fn the_way_begins_at_the_leaf_ends_at_the_outline_and_its_area_is_monotone() {
        let (shape, outline) = (Shape::new(leaf), Outline::of(lobes));
        let ways: Vec<Shape> = (0..=10)
            .map(|i| shape.towards(&outline, 1.0 - i as f32 / 10.0))
            .collect();
        fn ways_covers(ways: &[Shape], i: usize, p: Vec2) -> bool {
            ways[i].covers(p, 1.0)
        }
        let ways = &ways;
        let at = |i: usize| move |p: Vec2| ways_covers(ways, i, p);
        let start = overlap(at(0), leaf);
        let end = overlap(at(10), lobes);
        assert!(start >= 0.99, "leaf at 1: {start}");
        assert!(end >= 0.99, "outline at 0: {end}");
        let areas: Vec<f64> = (0..=10).map(|i| share(at(i))).collect();
        let rising = areas[10] > areas[0];
        let steps = areas.windows(2).map(|w| w[1] - w[0]);
        assert!(
            steps
                .clone()
                .all(|s| (s > -1e-3) == rising || s.abs() < 1e-3),
            "{areas:?}"
        );
        let largest = steps.map(f64::abs).fold(0.0, f64::max);
        assert!(largest < 0.05, "no step leaps: {areas:?}");
    }

    #[test]
    fn pictures_are_shapes_by_alpha_or_by_darkness() {
        let picture = |value: &dyn Fn(i32, i32) -> [u8; 4]| Rgba8 {
            width: 60,
            height: 40,
            pixels: (0..2400).flat_map(|i| value(i % 60, i / 60)).collect(),
        };
        let inside = |x: i32, y: i32| (x - 30).abs() < 15 && (y - 20).abs() < 10;
        let alpha = picture(&|x, y| [90, 90, 90, if inside(x, y) { 255 } else { 0 }]);
        let dark = picture(&|x, y| [[255; 4], [0, 0, 0, 255]][usize::from(inside(x, y))]);
        let (a, b) = (Outline::new(&alpha).unwrap(), Outline::new(&dark).unwrap());
        assert_eq!(a, b, "one shape");
        assert!(
            a.covers(Vec2::ZERO) && a.covers(Vec2::new(0.8, 0.0)),
            "wide"
        );
        assert!(!a.covers(Vec2::new(0.0, 0.8)), "not high");
        let white = picture(&|_, _| [255; 4]);
        assert!(
            Outline::new(&white).unwrap_err().contains("no shape"),
            "nothing"
        );
    }
}
