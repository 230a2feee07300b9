//! How a way is chosen: a built-in one with parameters, or a file.

use std::path::{Path, PathBuf};

use glam::{DVec3, Vec3};

use super::file::PathFile;
use super::way::{CameraPath, FITTED, Frame, Key, VALUES, middle, opening, reach};
use crate::scene::camera::Lens;
use crate::scene::camera_spec::CameraSpec;
use crate::scene::light::spherical;
use crate::{Error, Result};

/// Frames of a built-in way, unless it says another number.
const FRAMES: f64 = 120.0;

/// A way as it is chosen; what `--camera-path` says.
#[derive(Debug, Clone, PartialEq)]
pub struct PathSpec {
    text: String,
    way: Way,
}

#[derive(Debug, Clone, PartialEq)]
enum Way {
    Built(Built),
    File(PathBuf, PathFile),
}

/// A built-in way: all parameters that it has, with their values.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Built {
    name: &'static str,
    values: [f64; 6],
}

/// A parameter: name, default, smallest and largest value.
type Parameter = (&'static str, f64, f64, f64);

/// Built-in ways and their parameters. Distances are factors on the one that frames the subject.
const WAYS: [(&str, &[Parameter]); 3] = [
    (
        "orbit",
        &[
            ("frames", FRAMES, 2.0, 1e6),
            ("turns", 1.0, -100.0, 100.0),
            ("rise", 0.0, -180.0, 180.0),
            ("roll", 0.0, -3600.0, 3600.0),
        ],
    ),
    (
        "dolly",
        &[
            ("frames", FRAMES, 2.0, 1e6),
            ("from", 1.6, 1e-3, 1e3),
            ("to", 0.5, 1e-3, 1e3),
            ("roll", 0.0, -3600.0, 3600.0),
        ],
    ),
    (
        "walk",
        &[
            ("frames", FRAMES, 2.0, 1e6),
            ("from", 1.6, 1e-3, 1e3),
            ("to", 0.5, -1e3, 1e3),
            ("side", 0.25, -1e3, 1e3),
            ("height", 0.2, -10.0, 10.0),
        ],
    ),
];

impl Built {
    fn get(&self, name: &str) -> f64 {
        let parameters = WAYS
            .iter()
            .find(|w| w.0 == self.name)
            .map_or(&[][..], |w| w.1);
        let at = parameters.iter().position(|p| p.0 == name);
        at.map_or(0.0, |i| self.values[i])
    }

    fn parse(name: &str, rest: &str) -> Result<Option<Self>, String> {
        let Some((name, parameters)) = WAYS.iter().find(|w| w.0 == name) else {
            return Ok(None);
        };
        let mut values = [0.0; 6];
        for (value, parameter) in values.iter_mut().zip(*parameters) {
            *value = parameter.1;
        }
        for part in rest.split(',').filter(|p| !p.trim().is_empty()) {
            let Some((key, text)) = part.split_once('=') else {
                return Err(format!("`{part}`: expected NAME=NUMBER"));
            };
            let key = key.trim();
            let Some(at) = parameters.iter().position(|p| p.0 == key) else {
                let names: Vec<&str> = parameters.iter().map(|p| p.0).collect();
                return Err(format!(
                    "{name} has no `{key}`; it has {}",
                    names.join(", ")
                ));
            };
            let (_, _, low, high) = parameters[at];
            let value: Option<f64> = text.trim().parse().ok();
            values[at] = value
                .filter(|v| (low..=high).contains(v))
                .ok_or_else(|| format!("{key}={text}: expected a number from {low} to {high}"))?;
        }
        Ok(Some(Self { name, values }))
    }
}

impl PathSpec {
    /// `orbit`, `dolly` or `walk`, with parameters as `orbit:turns=2,frames=48`, or a file (its
    /// name ends in `.toml` or `.json`). `fps` stands for the file's own.
    ///
    /// # Errors
    /// No such way or parameter; a file that cannot be read or is no path.
    pub fn named(text: &str, fps: Option<f64>) -> Result<Self> {
        let path = Path::new(text);
        let ending = path.extension().unwrap_or_default();
        let way = if ending.eq_ignore_ascii_case("toml") || ending.eq_ignore_ascii_case("json") {
            let read = std::fs::read_to_string(path).map_err(|e| Error::file(path, e))?;
            let json = ending.eq_ignore_ascii_case("json");
            let file = PathFile::parse(&read, json, fps).map_err(|e| Error::file(path, e))?;
            Way::File(path.to_owned(), file)
        } else {
            let (name, rest) = text.split_once(':').unwrap_or((text, ""));
            let wrong = |reason: String| Error::usage(format!("--camera-path {text}: {reason}"));
            let built = Built::parse(name, rest).map_err(wrong)?;
            Way::Built(built.ok_or_else(|| {
                let names: Vec<&str> = WAYS.iter().map(|w| w.0).collect();
                wrong(format!(
                    "expected {} or a file (.toml, .json)",
                    names.join(", ")
                ))
            })?)
        };
        Ok(Self {
            text: text.to_owned(),
            way,
        })
    }

    /// The file that it is read from, if there is one.
    #[must_use]
    pub fn file(&self) -> Option<&Path> {
        match &self.way {
            Way::File(path, _) => Some(path),
            Way::Built(_) => None,
        }
    }

    /// The way about a subject given by `points` (relative to `origin`). Built-in ways begin where
    /// `start` says.
    #[must_use]
    pub fn resolve(
        &self,
        start: &CameraSpec,
        lens: Lens,
        origin: DVec3,
        points: impl Iterator<Item = Vec3> + Clone,
    ) -> CameraPath {
        let scene = Framed {
            start,
            lens,
            origin,
            middle: middle(origin, points.clone()),
            points,
        };
        match &self.way {
            Way::File(_, file) => file.resolve(&scene),
            Way::Built(built) if built.name == "walk" => scene.walk(built),
            Way::Built(built) => scene.around(built),
        }
    }
}

impl std::fmt::Display for PathSpec {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.text)
    }
}

/// What a way is laid about.
pub(super) struct Framed<'a, P> {
    pub(super) start: &'a CameraSpec,
    pub(super) lens: Lens,
    pub(super) origin: DVec3,
    pub(super) middle: DVec3,
    pub(super) points: P,
}

impl<P: Iterator<Item = Vec3> + Clone> Framed<'_, P> {
    /// Metres from the middle from where all is seen from every direction of `angles`.
    pub(super) fn reach(&self, angles: impl Iterator<Item = (f64, f64)>) -> f64 {
        let directions = angles.map(|(a, e)| spherical(a, e.clamp(-90.0, 90.0)));
        let points = self.points.clone();
        reach(self.middle, self.lens, self.origin, points, directions)
    }

    /// Azimuth, elevation, distance factor of the start, target, and metres that are the factor 1;
    /// these are none where they follow from the framing.
    fn begin(&self) -> ([f64; 3], Option<(DVec3, f64)>) {
        match *self.start {
            CameraSpec::Orbit {
                azimuth,
                elevation,
                distance,
            } => ([azimuth, elevation, distance], None),
            CameraSpec::LookAt { eye, target } => {
                let away = eye - target;
                let azimuth = away.x.atan2(away.z).to_degrees();
                let elevation = away.y.atan2(away.x.hypot(away.z)).to_degrees();
                ([azimuth, elevation, 1.0], Some((target, away.length())))
            }
        }
    }

    /// Orbit and dolly.
    fn around(&self, built: &Built) -> CameraPath {
        let ([azimuth, elevation, distance], fixed) = self.begin();
        let orbit = built.name == "orbit";
        let [from, to] = if orbit {
            [1.0; 2]
        } else {
            [built.get("from"), built.get("to")]
        };
        let turn = if orbit {
            360.0 * built.get("turns")
        } else {
            0.0
        };
        let rise = if orbit { built.get("rise") } else { 0.0 };
        let key = |frame: f64, t: f64, factor: f64| {
            let mut values = [0.0; VALUES];
            values[0] = azimuth + t * turn;
            values[1] = elevation + t * rise;
            values[2] = (distance * factor).ln();
            values[6] = opening(self.lens.fov);
            values[7] = t * built.get("roll");
            Key { frame, values }
        };
        let last = built.get("frames").floor() - 1.0;
        // The frame after an orbit's last would be its first again.
        let end = if orbit { last / (last + 1.0) } else { 1.0 };
        let keys = vec![key(0.0, 0.0, from), key(last, end, to)];
        let (target, reach) = fixed.unwrap_or_else(|| {
            let angles = (0..if orbit { FITTED } else { 1 }).map(|k| {
                let t = f64::from(k) / f64::from(FITTED);
                (azimuth + t * turn, elevation + t * rise)
            });
            (self.middle, self.reach(angles))
        });
        CameraPath {
            frame: Frame::Around { target, reach },
            keys,
            smooth: false,
        }
    }

    /// A straight level way past the subject, looking at its middle.
    fn walk(&self, built: &Built) -> CameraPath {
        let ([azimuth, _, distance], fixed) = self.begin();
        let (target, reach) = fixed.unwrap_or_else(|| {
            let reach = self.reach(std::iter::once((azimuth, 0.0)));
            (self.middle, reach)
        });
        let (low, high) = self
            .points
            .clone()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| {
                (l.min(f64::from(p.y)), h.max(f64::from(p.y)))
            });
        let (low, high) = if low <= high { (low, high) } else { (0.0, 0.0) };
        let height = self.origin.y + low + built.get("height") * (high - low);
        let away = spherical(azimuth, 0.0) * reach * distance;
        let side = spherical(azimuth + 90.0, 0.0) * reach * distance * built.get("side");
        let key = |frame: f64, factor: f64| {
            let eye = (target + factor * away + side).with_y(height);
            let mut values = [0.0; VALUES];
            values[..3].copy_from_slice(&eye.to_array());
            values[3..6].copy_from_slice(&target.to_array());
            values[6] = opening(self.lens.fov);
            Key { frame, values }
        };
        let last = built.get("frames").floor() - 1.0;
        CameraPath {
            frame: Frame::Free,
            keys: vec![key(0.0, built.get("from")), key(last, built.get("to"))],
            smooth: false,
        }
    }
}
