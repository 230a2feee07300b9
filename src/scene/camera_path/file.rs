//! Files of keyframes.

use glam::{DVec3, Vec3};
use serde::Deserialize;

use super::spec::Framed;
use super::way::{CameraPath, FITTED, Frame, Key, VALUES, opening};
use crate::scene::camera::Camera;
use crate::scene::camera_spec::CameraSpec;

/// Version of path files.
pub(super) const FORMAT_VERSION: u32 = 1;
/// Frames a second, where neither file nor command line say it.
const FPS: f64 = 24.0;
/// Largest number of a frame.
const MOST: f64 = 1e6;

/// How values go from key to key.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Interpolation {
    /// Cubic, without kinks.
    #[default]
    Smooth,
    /// Straight.
    Linear,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Raw {
    format_version: u32,
    fps: Option<f64>,
    #[serde(default)]
    interpolation: Interpolation,
    keys: Vec<RawKey>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawKey {
    frame: Option<f64>,
    time: Option<f64>,
    camera: Option<String>,
    eye: Option<[f64; 3]>,
    target: Option<[f64; 3]>,
    fov: Option<f64>,
    roll: Option<f64>,
    up: Option<[f64; 3]>,
}

/// A file of keys, checked.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PathFile {
    smooth: bool,
    keys: Vec<FileKey>,
}

#[derive(Debug, Clone, PartialEq)]
struct FileKey {
    frame: f64,
    camera: CameraSpec,
    fov: Option<f64>,
    roll: Roll,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Roll {
    Degrees(f64),
    Up(DVec3),
}

impl PathFile {
    /// From TOML, or from JSON.
    ///
    /// # Errors
    /// What is wrong, and in which key.
    pub(super) fn parse(text: &str, json: bool, fps: Option<f64>) -> Result<Self, String> {
        let raw: Raw = if json {
            serde_json::from_str(text).map_err(|e| e.to_string())?
        } else {
            toml::from_str(text).map_err(|e| e.to_string())?
        };
        if raw.format_version != FORMAT_VERSION {
            return Err(format!(
                "format_version {}: this program reads {FORMAT_VERSION}",
                raw.format_version
            ));
        }
        let fps = fps.or(raw.fps).unwrap_or(FPS);
        if !(fps > 0.0 && fps <= 1e4) {
            return Err(format!("fps = {fps}: expected more than 0, up to 10000"));
        }
        let mut keys: Vec<FileKey> = Vec::new();
        for (number, key) in raw.keys.iter().enumerate() {
            let key = key
                .check(fps)
                .map_err(|e| format!("key {}: {e}", number + 1))?;
            if let Some(before) = keys.last()
                && key.frame <= before.frame
            {
                return Err(format!(
                    "key {}: frame {} does not come after {}",
                    number + 1,
                    key.frame,
                    before.frame
                ));
            }
            keys.push(key);
        }
        if keys.is_empty() {
            return Err("keys: a path has at least one".into());
        }
        Ok(Self {
            smooth: raw.interpolation == Interpolation::Smooth,
            keys,
        })
    }

    /// The way about a subject.
    pub(super) fn resolve<P: Iterator<Item = Vec3> + Clone>(
        &self,
        scene: &Framed<'_, P>,
    ) -> CameraPath {
        let angles: Option<Vec<[f64; 3]>> = self.keys.iter().map(|k| k.angles()).collect();
        let (frame, values): (Frame, Vec<[f64; 6]>) = match angles {
            Some(angles) => {
                // Between two keys all directions between their angles are passed.
                let pairs = angles.windows(2).flat_map(|w| {
                    let (a, b) = (w[0], w[1]);
                    (0..FITTED / 4).map(move |k| {
                        let t = f64::from(k) / f64::from(FITTED / 4);
                        (a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]))
                    })
                });
                let ends = angles.last().map(|a| (a[0], a[1]));
                let reach = scene.reach(pairs.chain(ends));
                let around = Frame::Around {
                    target: scene.middle,
                    reach,
                };
                let one = |a: &[f64; 3]| [a[0], a[1], a[2].ln(), 0.0, 0.0, 0.0];
                (around, angles.iter().map(one).collect())
            }
            None => (
                Frame::Free,
                self.keys.iter().map(|k| k.places(scene)).collect(),
            ),
        };
        let keys = self.keys.iter().zip(values).map(|(key, place)| {
            let mut values = [0.0; VALUES];
            values[..6].copy_from_slice(&place);
            values[6] = opening(key.fov.unwrap_or(scene.lens.fov));
            values[7] = key.roll(scene);
            Key {
                frame: key.frame,
                values,
            }
        });
        CameraPath {
            frame,
            keys: keys.collect(),
            smooth: self.smooth,
        }
    }
}

impl RawKey {
    fn check(&self, fps: f64) -> Result<FileKey, String> {
        let frame = match (self.frame, self.time) {
            (Some(frame), None) => frame,
            (None, Some(time)) => time * fps,
            _ => return Err("expected either `frame` or `time`".into()),
        };
        if !(0.0..=MOST).contains(&frame) {
            return Err(format!("frame {frame}: expected 0 to {MOST}"));
        }
        let camera = match (&self.camera, self.eye, self.target) {
            (Some(text), None, None) => text.parse().map_err(|e: crate::Error| e.to_string())?,
            (None, Some(eye), Some(target)) => {
                let finite = |v: &[f64; 3]| v.iter().all(|x| x.is_finite());
                if !finite(&eye) || !finite(&target) || eye == target {
                    return Err("eye and target: expected two different points".into());
                }
                CameraSpec::LookAt {
                    eye: eye.into(),
                    target: target.into(),
                }
            }
            _ => return Err("expected either `camera`, or `eye` and `target`".into()),
        };
        if let Some(fov) = self.fov
            && !(0.1..=170.0).contains(&fov)
        {
            return Err(format!("fov = {fov}: expected 0.1 to 170 degrees"));
        }
        let roll = match (self.roll, self.up) {
            (Some(_), Some(_)) => return Err("expected only one of `roll` and `up`".into()),
            (None, Some(up)) => {
                let up = DVec3::from(up);
                if !(up.is_finite() && up.length() > 0.0) {
                    return Err("up: expected a direction".into());
                }
                Roll::Up(up)
            }
            (roll, None) => {
                let roll = roll.unwrap_or(0.0);
                if !(-MOST..=MOST).contains(&roll) {
                    return Err(format!("roll = {roll}: expected degrees"));
                }
                Roll::Degrees(roll)
            }
        };
        Ok(FileKey {
            frame,
            camera,
            fov: self.fov,
            roll,
        })
    }
}

impl FileKey {
    fn angles(&self) -> Option<[f64; 3]> {
        match self.camera {
            CameraSpec::Orbit {
                azimuth,
                elevation,
                distance,
            } => Some([azimuth, elevation, distance]),
            CameraSpec::LookAt { .. } => None,
        }
    }

    /// Eye and point looked at.
    fn places<P: Iterator<Item = Vec3> + Clone>(&self, scene: &Framed<'_, P>) -> [f64; 6] {
        let (eye, target) = match self.camera {
            CameraSpec::LookAt { eye, target } => (eye, target),
            CameraSpec::Orbit { .. } => {
                let camera = self.level(scene);
                let depth = (scene.middle - camera.eye).dot(camera.forward);
                (camera.eye, camera.eye + depth.max(1e-9) * camera.forward)
            }
        };
        let mut out = [0.0; 6];
        out[..3].copy_from_slice(&eye.to_array());
        out[3..].copy_from_slice(&target.to_array());
        out
    }

    fn level<P: Iterator<Item = Vec3> + Clone>(&self, scene: &Framed<'_, P>) -> Camera {
        Camera::new(&self.camera, scene.lens, scene.origin, scene.points.clone())
    }

    /// Degrees.
    fn roll<P: Iterator<Item = Vec3> + Clone>(&self, scene: &Framed<'_, P>) -> f64 {
        match self.roll {
            Roll::Degrees(roll) => roll,
            Roll::Up(direction) => {
                let [right, up, _] = self.level(scene).basis();
                direction.dot(right).atan2(direction.dot(up)).to_degrees()
            }
        }
    }
}
