//! One frame against the next by exact motion: what is seen in both, and how its ink changes.

use glam::{DVec2, DVec3};

use crate::ink::view::View;

/// Rings about the clusters' centres in which slip is told apart.
pub const RINGS: usize = 4;
/// Depths in two frames are of one surface if they differ by less than this share.
const SAME_DEPTH: f64 = 0.004;
/// Farthest ink that is still the same ink, pixels.
const NEAR: f64 = 1.5;
/// Ink from which on a pixel is inked.
const INKED: f32 = 0.5;

/// A frame with what its pixels show.
#[derive(Debug, Clone)]
pub struct Frame {
    /// The view.
    pub view: View,
    /// Ink, 0 to 1.
    pub ink: Vec<f32>,
    /// Linear eye depth, metres; 0 where nothing is.
    pub depth: Vec<f32>,
    /// Cluster plus 1; 0 where none is.
    pub cluster: Vec<u32>,
    /// Place in the hatching tile and binary logarithm of texels per pixel.
    pub hatch: Vec<[f32; 3]>,
    /// Centre and radius of each cluster in the picture, pixels.
    pub outlines: Vec<(DVec2, f64)>,
}

/// How a frame follows from the one before it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Moved {
    /// Sum of the differences of ink over pixels seen in both frames.
    pub error: f64,
    /// Pixels seen in both.
    pub pixels: f64,
    /// Inked ones of them.
    pub inked: f64,
    /// Inked ones that had no ink nearby.
    pub popped: f64,
    /// Sum of the hatching's slip by ring, pixels, and pixels in it.
    pub slip: [(f64, f64); RINGS],
}

impl Moved {
    /// Adds another pair of frames.
    pub fn add(&mut self, other: &Self) {
        self.error += other.error;
        self.pixels += other.pixels;
        self.inked += other.inked;
        self.popped += other.popped;
        for (own, new) in self.slip.iter_mut().zip(&other.slip) {
            *own = (own.0 + new.0, own.1 + new.1);
        }
    }

    /// `E_warp`: mean difference of ink after the warp.
    #[must_use]
    pub fn warp_error(&self) -> f64 {
        self.error / self.pixels
    }

    /// Share of ink that appears where none was within 1.5 pixels.
    #[must_use]
    pub fn popping(&self) -> f64 {
        self.popped / self.inked
    }

    /// Share of what is seen in both frames that is ink: 0 would make all else 0.
    #[must_use]
    pub fn coverage(&self) -> f64 {
        self.inked / self.pixels
    }

    /// Mean slip of the hatching in each ring, pixels a frame.
    #[must_use]
    pub fn slips(&self) -> [f64; RINGS] {
        self.slip.map(|(sum, count)| sum / count)
    }
}

impl Frame {
    fn size(&self) -> [i64; 2] {
        self.view.size.map(i64::from)
    }

    /// Middle of the surface in a pixel, in the geometry's frame.
    fn point(&self, x: i64, y: i64) -> DVec3 {
        let [w, h] = self.view.size.map(f64::from);
        let [right, up, _] = self.view.camera.basis();
        let depth = f64::from(self.depth[(y * self.size()[0] + x) as usize]);
        let across = (x as f64 + 0.5 - 0.5 * w) * right + (0.5 * h - y as f64 - 0.5) * up;
        self.view.eye() + depth * (self.view.camera.forward + across / self.view.focal())
    }

    /// The four pixels about a place, with their weights, if all of them show `cluster` at `depth`.
    fn around(&self, at: DVec2, depth: f64, cluster: u32) -> Option<[(usize, f64); 4]> {
        let [w, h] = self.size();
        let low = (at - 0.5).floor();
        let part = at - 0.5 - low;
        let (x, y) = (low.x as i64, low.y as i64);
        if x < 0 || y < 0 || x + 1 >= w || y + 1 >= h {
            return None;
        }
        let corners = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| {
            let weight = |t: f64, k: i64| if k == 0 { 1.0 - t } else { t };
            let index = ((y + j) * w + x + i) as usize;
            (index, weight(part.x, i) * weight(part.y, j))
        });
        let same = |&(i, _): &(usize, f64)| {
            self.cluster[i] == cluster
                && (f64::from(self.depth[i]) - depth).abs() < SAME_DEPTH * depth
        };
        corners.iter().all(same).then_some(corners)
    }

    /// Whether a pixel within [`NEAR`] of a place is inked.
    fn inked_near(&self, at: DVec2) -> bool {
        let [w, h] = self.size();
        let reach = NEAR.ceil() as i64;
        let (x, y) = (at.x.floor() as i64, at.y.floor() as i64);
        (y - reach..=y + reach)
            .flat_map(|y| (x - reach..=x + reach).map(move |x| (x, y)))
            .filter(|&(x, y)| x >= 0 && y >= 0 && x < w && y < h)
            .any(|(x, y)| {
                let place = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                place.distance(at) <= NEAR && self.ink[(y * w + x) as usize] > INKED
            })
    }
}

/// Pixels of `after` that `before` shows too, and what became of their ink.
#[must_use]
pub fn compare(before: &Frame, after: &Frame) -> Moved {
    let [w, h] = after.size();
    let mut out = Moved::default();
    for i in 0..w * h {
        let (x, y, here) = (i % w, i / w, i as usize);
        let cluster = after.cluster[here];
        if cluster == 0 {
            continue;
        }
        let (at, depth) = before.view.pixel(after.point(x, y));
        let Some(around) = before.around(at, depth, cluster) else {
            continue;
        };
        let was: f64 = around
            .iter()
            .map(|&(i, w)| w * f64::from(before.ink[i]))
            .sum();
        out.pixels += 1.0;
        out.error += (f64::from(after.ink[here]) - was).abs();
        if after.ink[here] > INKED {
            out.inked += 1.0;
            out.popped += f64::from(u8::from(!before.inked_near(at)));
        }
        let (centre, radius) = after.outlines[cluster as usize - 1];
        let ring = DVec2::new(x as f64 + 0.5, y as f64 + 0.5).distance(centre) / radius;
        if let Some(slip) = slip(before, &around, after.hatch[here])
            && ring < 1.0
        {
            let sum = &mut out.slip[(ring * RINGS as f64) as usize];
            *sum = (sum.0 + slip, sum.1 + 1.0);
        }
    }
    out
}

/// Pixels between where a place of the tile is and where it was; none from octave to octave.
fn slip(before: &Frame, around: &[(usize, f64); 4], [u, v, level]: [f32; 3]) -> Option<f64> {
    let here = DVec2::new(f64::from(u), f64::from(v));
    let mut off = DVec2::ZERO;
    for &(i, weight) in around {
        let [u, v, was] = before.hatch[i].map(f64::from);
        if (was - f64::from(level)).abs() > 0.5 {
            // Another octave of tiles.
            return None;
        }
        // Tiles repeat: the nearest of all places that look alike.
        let step = DVec2::new(u, v) - here;
        off += weight * (step - step.round());
    }
    let texels = f64::from(crate::abi::INK_TILE) * off.length();
    Some(texels / f64::from(level).exp2()).filter(|s| s.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Camera;
    use glam::Vec3;

    const SIZE: [u32; 2] = [96, 64];

    /// A wall at depth 5 seen from `x`, with ink by `ink(place on the wall)`.
    fn wall(x: f64, ink: impl Fn(DVec2) -> f32) -> Frame {
        let camera = Camera {
            eye: DVec3::new(x, 0.0, 0.0),
            forward: DVec3::NEG_Z,
            fov: 40.0,
            aspect: 1.5,
            near: 0.01,
            roll: 0.0,
        };
        let view = View::new(camera, DVec3::ZERO, SIZE, Vec3::Y, &[Vec3::NEG_Z]);
        let count = (SIZE[0] * SIZE[1]) as usize;
        let mut frame = Frame {
            view,
            ink: vec![0.0; count],
            depth: vec![5.0; count],
            cluster: vec![1; count],
            hatch: vec![[0.0; 3]; count],
            outlines: vec![(DVec2::new(48.0, 32.0), 100.0)],
        };
        for i in 0..count as i64 {
            let p = frame.point(i % 96, i / 96);
            frame.ink[i as usize] = ink(p.truncate());
            let pixel = 5.0 / view.focal();
            let tile = p.truncate() / (pixel * f64::from(crate::abi::INK_TILE));
            frame.hatch[i as usize] = [tile.x as f32, tile.y as f32, 0.0];
        }
        frame
    }

    #[test]
    fn ink_on_the_wall_stays_and_ink_on_the_screen_does_not() {
        let stripes = |p: DVec2| if (8.0 * p.x).sin() > 0.5 { 1.0 } else { 0.0 };
        let fixed = compare(&wall(0.0, stripes), &wall(0.21, stripes));
        assert!(fixed.pixels > 4000.0, "{fixed:?}");
        assert!(fixed.popping() < 1e-9, "{fixed:?}");
        assert!(fixed.slips()[0] < 1e-3, "{fixed:?}");
        // The same picture again although the camera moved.
        let moved = wall(0.21, |p| stripes(p - DVec2::new(0.21, 0.0)));
        let swims = compare(&wall(0.0, stripes), &moved);
        assert!(swims.warp_error() > 3.0 * fixed.warp_error(), "{swims:?}");
        assert!(swims.popping() > 0.3, "{swims:?}");
        let none = compare(&wall(0.0, |_| 0.0), &wall(0.2, |_| 0.0));
        assert_eq!((none.error, none.coverage()), (0.0, 0.0), "a blank page");
    }

    #[test]
    fn what_was_hidden_is_left_out() {
        let mut before = wall(0.0, |_| 0.0);
        for i in 0..before.depth.len() {
            if i % 96 < 48 {
                before.depth[i] = 3.0;
            }
        }
        let seen = compare(&before, &wall(0.0, |_| 1.0));
        assert!((seen.pixels / (96.0 * 64.0) - 0.5).abs() < 0.03, "{seen:?}");
    }
}
