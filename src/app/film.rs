//! Camera, sun, sky and lamps of a lit picture, from the command line.

use std::path::Path;
use std::sync::Arc;

use glam::DVec3;

use super::cli::light::{LitArgs, Triple};
use crate::leaf::environment::{Environment, Panorama, Sun};
use crate::leaf::film::Film;
use crate::leaf::lamp::Lamp;
use crate::leaf::shape::{Mask, Shape};
use crate::leaf::sky::ClearSky;
use crate::render::RenderSettings;
use crate::scene::{Camera, Geometry, Lens};
use crate::{Error, Result};

/// Up is +y in every lit model.
const UP: DVec3 = DVec3::Y;

/// The film that the arguments describe for `geometry`.
///
/// # Errors
/// What is wrong with one of them, or with a file that it names.
pub fn film(geometry: &Geometry, args: &LitArgs, settings: &RenderSettings) -> Result<Film> {
    let lens = Lens {
        fov: settings.fov,
        aspect: f64::from(settings.size[0]) / f64::from(settings.size[1]),
        margin: settings.margin,
    };
    let sun = sun(args, settings)?;
    let points = geometry.positions.iter().copied();
    Ok(Film {
        camera: Camera::new(&settings.camera, lens, geometry.origin, points),
        size: settings.size,
        sky: environment(&args.environment, &sun)?,
        sun,
        sun_shape: match &args.sun_shape {
            Some(file) => Shape::Mask(Arc::new(Mask::read(file)?)),
            None => Shape::Disc,
        },
        lamps: args
            .lamp
            .iter()
            .map(|text| Lamp::parse(text))
            .collect::<Result<_>>()?,
    })
}

/// The light that stands for the sun in a light file's or the command's terms.
fn sun(args: &LitArgs, settings: &RenderSettings) -> Result<Sun> {
    let towards = match args.sun.sun_direction {
        Some(Triple(d)) => DVec3::from(d).try_normalize().ok_or_else(|| {
            Error::usage("--sun-direction: a vector without length has no direction")
        })?,
        None => settings.sun.direction(),
    };
    let up = towards.dot(UP);
    if up < 0.0 {
        log::warn!("the sun stands below the horizon: it lights leaves from below");
    }
    let irradiance = DVec3::from(args.sun_irradiance.0);
    if irradiance.min_element() < 0.0 {
        return Err(Error::usage("--sun-irradiance: is below 0"));
    }
    Ok(Sun {
        towards,
        radius_degrees: args.sun.sun_radius,
        irradiance,
    })
}

fn environment(text: &str, sun: &Sun) -> Result<Environment> {
    let triple = |t: &str| -> Result<DVec3> {
        let Triple(v) = t
            .parse()
            .map_err(|e| Error::usage(format!("--environment {text}: {e}")))?;
        Ok(DVec3::from(v))
    };
    let sky = match text.split_once(':') {
        Some(("constant", rgb)) => Environment::Constant(triple(rgb)?),
        Some(("linear", both)) => {
            let (a, b) = both.split_once('/').ok_or_else(|| {
                Error::usage(format!("--environment {text}: expected linear:R,G,B/R,G,B"))
            })?;
            Environment::Linear {
                a: triple(a)?,
                b: triple(b)?,
                up: UP,
            }
        }
        Some(("clear", turbidity)) => {
            let t = turbidity.parse().ok();
            let t = t
                .filter(|t| ClearSky::TURBIDITY.contains(t))
                .ok_or_else(|| {
                    Error::usage(format!(
                        "--environment {text}: expected clear:TURBIDITY from {} to {}",
                        ClearSky::TURBIDITY.start(),
                        ClearSky::TURBIDITY.end()
                    ))
                })?;
            Environment::Clear(ClearSky::new(UP, sun.towards, t))
        }
        _ => Environment::Panorama(Panorama::read(Path::new(text), UP)?),
    };
    let least = match &sky {
        Environment::Constant(a) => a.min_element(),
        // At the zenith or at the nadir.
        Environment::Linear { a, b, .. } => (*a - b.abs()).min_element(),
        _ => 0.0,
    };
    if least < 0.0 {
        return Err(Error::usage(format!(
            "--environment {text}: is below 0 somewhere ({least})"
        )));
    }
    Ok(sky)
}
