//! Keys, and what lies between them.

use glam::{DVec3, Vec3};

use crate::scene::camera::{Camera, Lens, Pose};
use crate::scene::light::spherical;

/// Directions in which the distance is sought from which everything fits.
pub(super) const FITTED: u32 = 48;
/// Values of a key: place and direction of the eye, opening, roll.
pub(super) const VALUES: usize = 8;

/// A moment of a way. What its values mean is told by the way's [`Frame`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Key {
    /// Number of the frame, need not be whole.
    pub(super) frame: f64,
    pub(super) values: [f64; VALUES],
}

/// What the values of keys mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Frame {
    /// Azimuth, elevation (degrees), logarithm of the distance in `reach`, 0, 0, 0, logarithm of
    /// the opening's tangent, roll (degrees): about a point that is looked at.
    Around {
        /// World metres.
        target: DVec3,
        /// Metres.
        reach: f64,
    },
    /// Eye, target (world metres), logarithm of the opening's tangent, roll (degrees).
    Free,
}

/// A way of the camera: where it is at every frame.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraPath {
    pub(super) frame: Frame,
    pub(super) keys: Vec<Key>,
    pub(super) smooth: bool,
}

impl CameraPath {
    /// Number of the last frame; the first is 0.
    #[must_use]
    pub fn last(&self) -> u32 {
        self.keys.last().map_or(0, |k| k.frame.floor() as u32)
    }

    /// Where the camera is at `frame`, which need not be whole; before the first and after the
    /// last key it stands still.
    #[must_use]
    pub fn pose(&self, frame: f64) -> Pose {
        let v = self.values(frame);
        let fov = 2.0 * v[6].exp().atan().to_degrees();
        let (eye, target) = match self.frame {
            Frame::Around { target, reach } => {
                let elevation = v[1].clamp(-90.0, 90.0);
                let away = spherical(v[0], elevation) * (reach * v[2].exp());
                (target + away, target)
            }
            Frame::Free => (DVec3::new(v[0], v[1], v[2]), DVec3::new(v[3], v[4], v[5])),
        };
        Pose {
            eye,
            forward: (target - eye).normalize_or(DVec3::NEG_Z),
            fov,
            roll: v[7],
        }
    }

    /// The camera of a frame, for a subject given by `points` (relative to `origin`).
    #[must_use]
    pub fn camera(
        &self,
        frame: f64,
        aspect: f64,
        origin: DVec3,
        points: impl Iterator<Item = Vec3>,
    ) -> Camera {
        Camera::posed(&self.pose(frame), aspect, origin, points)
    }

    pub(super) fn values(&self, frame: f64) -> [f64; VALUES] {
        let keys = &self.keys;
        let after = keys.partition_point(|k| k.frame <= frame);
        if after == 0 || after == keys.len() {
            return keys[after.saturating_sub(1)].values;
        }
        let (a, b) = (&keys[after - 1], &keys[after]);
        let span = b.frame - a.frame;
        let t = (frame - a.frame) / span;
        let mut out = [0.0; VALUES];
        for (i, value) in out.iter_mut().enumerate() {
            let (p, q) = (a.values[i], b.values[i]);
            *value = if self.smooth {
                let (u, v) = (self.slope(after - 1, i), self.slope(after, i));
                hermite(t, (p, span * u), (q, span * v))
            } else {
                p + t * (q - p)
            };
        }
        out
    }

    /// Change per frame at a key: of the parabola through it and its neighbours; at rest at both
    /// ends.
    fn slope(&self, key: usize, value: usize) -> f64 {
        if key == 0 || key + 1 == self.keys.len() {
            return 0.0;
        }
        let [a, b, c] = [key - 1, key, key + 1].map(|k| &self.keys[k]);
        let (before, after) = (b.frame - a.frame, c.frame - b.frame);
        let left = (b.values[value] - a.values[value]) / before;
        let right = (c.values[value] - b.values[value]) / after;
        (after * left + before * right) / (before + after)
    }
}

/// The cubic with given values and slopes at 0 and 1.
fn hermite(t: f64, (p, u): (f64, f64), (q, v): (f64, f64)) -> f64 {
    let (t2, t3) = (t * t, t * t * t);
    p * (2.0 * t3 - 3.0 * t2 + 1.0)
        + u * (t3 - 2.0 * t2 + t)
        + q * (3.0 * t2 - 2.0 * t3)
        + v * (t3 - t2)
}

/// Logarithm of the tangent of half an opening in degrees.
pub(super) fn opening(fov: f64) -> f64 {
    (0.5 * fov.to_radians()).tan().ln()
}

/// Middle of the box around `points`, world metres.
pub(super) fn middle(origin: DVec3, points: impl Iterator<Item = Vec3>) -> DVec3 {
    let (low, high) = points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| {
        (l.min(p.as_dvec3()), h.max(p.as_dvec3()))
    });
    if low.is_finite() && high.is_finite() {
        origin + 0.5 * (low + high)
    } else {
        origin
    }
}

/// Least distance from `target` at which all `points` are in the picture from every one of
/// `directions` (unit, from the target to the eye).
pub(super) fn reach(
    target: DVec3,
    lens: Lens,
    origin: DVec3,
    points: impl Iterator<Item = Vec3> + Clone,
    directions: impl Iterator<Item = DVec3>,
) -> f64 {
    let tan_y = (0.5 * lens.fov.to_radians()).tan() * (1.0 - 2.0 * lens.margin);
    let tan_x = tan_y * lens.aspect;
    let from = target - origin;
    let mut least = 0.0_f64;
    for back in directions {
        let level = Camera {
            eye: DVec3::ZERO,
            forward: -back,
            fov: lens.fov,
            aspect: lens.aspect,
            near: 1.0,
            roll: 0.0,
        };
        let [right, up, _] = level.basis();
        for p in points.clone() {
            let p = p.as_dvec3() - from;
            let across = f64::max(right.dot(p).abs() / tan_x, up.dot(p).abs() / tan_y);
            least = least.max(back.dot(p) + across);
        }
    }
    if least > 0.0 { least } else { 1.0 }
}
