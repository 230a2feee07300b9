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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::CameraSpec;
    use crate::scene::camera_path::{PathSpec, file, spec};

    const LENS: Lens = Lens {
        fov: 40.0,
        aspect: 1.5,
        margin: 0.05,
    };

    fn cloud() -> Vec<Vec3> {
        (0..300)
            .map(|i| {
                let f = |k: f32| (i as f32 * k).sin();
                Vec3::new(3.0 * f(1.1), 1.0 + 5.0 * f(1.7), 2.0 * f(2.3))
            })
            .collect()
    }

    fn path(text: &str, start: &str) -> CameraPath {
        let start: CameraSpec = start.parse().unwrap();
        let spec = PathSpec::named(text, None).unwrap();
        spec.resolve(&start, LENS, DVec3::new(1e5, 0.0, 0.0), cloud().into_iter())
    }

    #[test]
    fn an_orbit_stays_at_its_distance_and_sees_everything() {
        let path = path("orbit:frames=24,turns=1", "25,12");
        assert_eq!(path.last(), 23);
        let origin = DVec3::new(1e5, 0.0, 0.0);
        let first = path.pose(0.0);
        let target = middle(origin, cloud().into_iter());
        for frame in 0..24 {
            let camera = path.camera(f64::from(frame), 1.5, origin, cloud().into_iter());
            let away = camera.eye - target;
            assert!((away.length() - (first.eye - target).length()).abs() < 1e-6);
            for p in cloud() {
                let (at, _) = camera.project(origin + p.as_dvec3());
                assert!(
                    at.min_element() > -1e-9 && at.truncate().max_element() < 1.0,
                    "{at}"
                );
            }
        }
        // One step more than the last frame is the first again.
        let step = path.pose(0.0).forward.angle_between(path.pose(1.0).forward);
        let close = path
            .pose(23.0)
            .forward
            .angle_between(path.pose(0.0).forward);
        assert!((step - close).abs() < 1e-9, "{step} {close}");
    }

    #[test]
    fn dolly_and_walk_go_where_they_say() {
        let dolly = path("dolly:frames=11,from=2,to=0.5,roll=30", "25,7");
        let target = middle(DVec3::new(1e5, 0.0, 0.0), cloud().into_iter());
        let away = |frame: f64| (dolly.pose(frame).eye - target).length();
        assert!((away(0.0) / away(10.0) - 4.0).abs() < 1e-9);
        // By equal factors.
        assert!((away(0.0) / away(5.0) - 2.0).abs() < 1e-9);
        assert!((dolly.pose(5.0).roll - 15.0).abs() < 1e-9);
        let walk = path("walk:frames=5,height=0.5", "0,20");
        let heights: Vec<f64> = (0..5).map(|f| walk.pose(f64::from(f)).eye.y).collect();
        assert!(
            heights.iter().all(|h| (h - heights[0]).abs() < 1e-9),
            "level"
        );
        assert!(walk.pose(0.0).eye.z > walk.pose(4.0).eye.z + 1.0, "nearer");
    }

    #[test]
    fn smooth_ways_meet_their_keys_without_kinks() {
        let text = "format_version = 1\n[[keys]]\nframe = 0\ncamera = '0,0,2'\n\
                [[keys]]\nframe = 10\ncamera = '90,20,1'\nroll = 10\n\
                [[keys]]\ntime = 1.25\ncamera = '120,10,1.5'\nfov = 20\n";
        let file = file::PathFile::parse(text, false, None).unwrap();
        let start = CameraSpec::default();
        let scene = spec::Framed {
            start: &start,
            lens: LENS,
            origin: DVec3::ZERO,
            middle: DVec3::ZERO,
            points: cloud().into_iter(),
        };
        let path = file.resolve(&scene);
        assert_eq!(path.last(), 30, "1.25 seconds of 24 frames");
        let at = |f: f64| path.values(f);
        assert!((at(10.0)[0] - 90.0).abs() < 1e-9 && (at(10.0)[7] - 10.0).abs() < 1e-9);
        assert!((path.pose(30.0).fov - 20.0).abs() < 1e-9);
        assert!((path.pose(0.0).fov - 40.0).abs() < 1e-9);
        let h = 1e-4;
        for value in [0, 1, 2, 7] {
            let slope = |f: f64| (at(f + h)[value] - at(f - h)[value]) / (2.0 * h);
            let kink = slope(10.0 + 2.0 * h) - slope(10.0 - 2.0 * h);
            assert!(kink.abs() < 1e-3, "{value}: {kink}");
            assert!(slope(h).abs() < 1e-2, "starts from rest");
        }
        assert_eq!(path.pose(-5.0), path.pose(0.0));
        assert_eq!(path.pose(99.0), path.pose(30.0));
    }

    #[test]
    fn places_keep_their_up_and_json_says_the_same() {
        let toml = "format_version = 1\ninterpolation = 'linear'\n[[keys]]\nframe = 0\n\
                eye = [0.0, 1.0, 9.0]\ntarget = [0.0, 1.0, 0.0]\nup = [1.0, 1.0, 0.0]\n";
        let json = r#"{"format_version": 1, "interpolation": "linear", "keys": [{"frame": 0,
        "eye": [0, 1, 9], "target": [0, 1, 0], "up": [1, 1, 0]}]}"#;
        let a = file::PathFile::parse(toml, false, None).unwrap();
        assert_eq!(a, file::PathFile::parse(json, true, None).unwrap());
        let start = CameraSpec::default();
        let scene = spec::Framed {
            start: &start,
            lens: LENS,
            origin: DVec3::ZERO,
            middle: DVec3::ZERO,
            points: cloud().into_iter(),
        };
        let camera = a
            .resolve(&scene)
            .camera(0.0, 1.5, DVec3::ZERO, cloud().into_iter());
        let [_, up, _] = camera.basis();
        assert!(
            up.distance(DVec3::new(1.0, 1.0, 0.0).normalize()) < 1e-12,
            "{up}"
        );
    }

    #[test]
    fn wrong_paths_are_refused_with_what_is_wrong() {
        let head = "format_version = 1\n";
        for (text, said) in [
            ("", "keys"),
            ("keys = []", "at least one"),
            ("[[keys]]\ncamera = '1,2'", "key 1: expected either `frame`"),
            ("[[keys]]\nframe = 0\ncamera = '1,95'", "elevation 95"),
            ("[[keys]]\nframe = 0\neye = [0, 0, 0]", "`target`"),
            ("[[keys]]\nframe = 0\ncamera = '1,2'\nfov = 0", "fov = 0"),
            ("[[keys]]\nframe = nan\ncamera = '1,2'", "frame NaN"),
            (
                "[[keys]]\nframe = 0\ncamera = '1,2'\nroll = 1\nup = [0, 1, 0]",
                "only one",
            ),
            (
                "[[keys]]\nframe = 1\ncamera = '1,2'\n[[keys]]\nframe = 1\ncamera = '2,2'",
                "after 1",
            ),
            ("colour = 1\n[[keys]]\nframe = 0\ncamera = '1,2'", "colour"),
        ] {
            let error = file::PathFile::parse(&format!("{head}{text}"), false, None).unwrap_err();
            assert!(error.contains(said), "{text}: {error}");
        }
        let old = file::PathFile::parse("format_version = 7\nkeys = []", false, None).unwrap_err();
        assert!(old.contains("format_version 7"), "{old}");
        for (text, said) in [
            ("spiral", "orbit, dolly, walk"),
            ("orbit:speed=1", "turns"),
            ("orbit:turns", "NAME=NUMBER"),
            ("dolly:from=0", "from=0"),
            ("missing.toml", "missing.toml"),
        ] {
            let error = PathSpec::named(text, None).unwrap_err().to_string();
            assert!(error.contains(said), "{text}: {error}");
        }
    }
}
