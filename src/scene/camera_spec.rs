//! How the camera is chosen, and how that is written.

use glam::DVec3;

use crate::{Error, Result};

/// How the camera is chosen; what `--camera` says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CameraSpec {
    /// Frames the whole subject as seen from a direction: azimuth and elevation of the camera in
    /// degrees (as [`super::light::spherical`]) and a factor on the framed distance (1 = tight).
    Orbit {
        /// Degrees from +z towards +x.
        azimuth: f64,
        /// Degrees above the horizon.
        elevation: f64,
        /// Factor on the distance that frames the subject.
        distance: f64,
    },
    /// Eye and point looked at, world metres.
    LookAt {
        /// World position of the eye.
        eye: DVec3,
        /// World position that appears at the centre of the picture.
        target: DVec3,
    },
}

impl Default for CameraSpec {
    /// A slightly low three-quarter view.
    fn default() -> Self {
        Self::Orbit {
            azimuth: 25.0,
            elevation: 7.0,
            distance: 1.0,
        }
    }
}

impl std::str::FromStr for CameraSpec {
    type Err = Error;

    /// `azimuth,elevation[,distance]` in degrees, or `ex,ey,ez/tx,ty,tz` in metres.
    fn from_str(text: &str) -> Result<Self> {
        let wrong = || {
            Error::usage(format!(
                "camera `{text}`: expected AZIMUTH,ELEVATION[,DISTANCE] in degrees or EX,EY,EZ/TX,TY,TZ in metres"
            ))
        };
        let numbers = |part: &str| -> Result<Vec<f64>> {
            part.split(',')
                .map(|n| n.trim().parse::<f64>().ok().filter(|v| v.is_finite()))
                .collect::<Option<_>>()
                .ok_or_else(wrong)
        };
        let because = |reason: String| Error::usage(format!("camera `{text}`: {reason}"));
        if let Some((eye, target)) = text.split_once('/') {
            let [eye, target] = [numbers(eye)?, numbers(target)?]
                .map(|n| <[f64; 3]>::try_from(n).map(DVec3::from_array));
            let (Ok(eye), Ok(target)) = (eye, target) else {
                return Err(wrong());
            };
            if eye == target {
                return Err(because("eye and target are the same point".into()));
            }
            return Ok(Self::LookAt { eye, target });
        }
        let (azimuth, elevation, distance) = match numbers(text)?[..] {
            [a, e] => (a, e, 1.0),
            [a, e, d] => (a, e, d),
            _ => return Err(wrong()),
        };
        if !(-90.0..=90.0).contains(&elevation) {
            return Err(because(format!("elevation {elevation} is not in -90..90")));
        }
        if distance <= 0.0 {
            return Err(because(format!("distance {distance} is not above 0")));
        }
        Ok(Self::Orbit {
            azimuth,
            elevation,
            distance,
        })
    }
}

impl std::fmt::Display for CameraSpec {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Orbit {
                azimuth,
                elevation,
                distance,
            } => write!(f, "{azimuth},{elevation},{distance}"),
            Self::LookAt { eye: e, target: t } => {
                write!(f, "{},{},{}/{},{},{}", e.x, e.y, e.z, t.x, t.y, t.z)
            }
        }
    }
}
