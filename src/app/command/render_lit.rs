//! `umbrage render --lighting`: leaves under sun and sky.

use std::path::{Path, PathBuf};

use glam::DVec3;
use serde_json::{Value, json};

use super::render::encode;
use crate::app::cli::RenderArgs;
use crate::app::cli::light::{Lighting, LitArgs, Triple};
use crate::app::lit::LitModel;
use crate::app::output::{PendingFile, check_apart, check_ending};
use crate::app::report::Table;
use crate::app::settings::picture_settings;
use crate::app::timing::Timings;
use crate::app::{Context, Report, console};
use crate::gpu::Gpu;
use crate::leaf::environment::{Environment, Panorama, Sun};
use crate::leaf::film::{Film, LitScene};
use crate::leaf::light::{Light, Lighting as Lights, exit_radiance};
use crate::leaf::light_file;
use crate::leaf::lit::LitRenderer;
use crate::leaf::lod::Lod;
use crate::leaf::lvc::{Lvc, LvcSettings};
use crate::leaf::radiance_map::{Difference, RadianceMap};
use crate::leaf::rays::RayScene;
use crate::leaf::receivers::Receivers;
use crate::leaf::refine::Refined;
use crate::leaf::sky::ClearSky;
use crate::leaf::truth;
use crate::render::{self, Picture, RenderSettings};
use crate::scene::float_image::{FloatImage, Transfer};
use crate::scene::{Camera, Lens};
use crate::{Error, Result};

/// Background of lit pictures, linear.
const BEHIND: [f32; 3] = [0.80, 0.82, 0.84];
/// Share of the leaves that may be brighter than white.
const WHITE: f64 = 0.995;
/// Up is +y in every lit model.
const UP: DVec3 = DVec3::Y;

/// A picture with the name of what lit it.
struct Drawn {
    name: String,
    lighting: Lighting,
    map: RadianceMap,
}

/// Draws the model under each lighting.
///
/// # Errors
/// Wrong input or settings, a light file of another model, a failing device.
pub fn run(context: &Context, args: &RenderArgs) -> Result<Report> {
    let settings = picture_settings(None, &args.picture)?;
    check_ending(&args.output, &["png", "jpg", "jpeg"])?;
    let [source] = args.inputs.as_slice() else {
        return Err(Error::usage("--lighting: takes one model"));
    };
    check_apart(&args.output, source.files(&args.model.textures))?;
    for &lighting in &args.lit.lighting {
        if let Some(prefix) = &args.lit.reference {
            // Told before the work.
            let path = reference_path(prefix, lighting);
            std::fs::File::open(&path).map_err(|e| Error::file(&path, e))?;
        }
    }
    let output = PendingFile::create(&args.output)?;
    let mut timings = Timings::default();
    let model = &args.model;
    let lit = timings.measure("read", || {
        LitModel::new(
            source,
            &model.textures,
            model.foliage.as_deref(),
            &args.lit.optics,
        )
    })?;
    let film = film(&lit, &args.lit, &settings)?;
    let light = match &args.lit.light {
        Some(path) => Some(light_file::read(path, &lit.key(), lit.vertices())?),
        None => None,
    };
    let stored = light.as_ref().and_then(|l| l.visibility.as_ref());
    let splits = args.lit.splits.or(stored.map(|v| v.splits)).unwrap_or(2);
    let (refined, receivers) = timings.measure("refine", || lit.refined(splits));
    let mut job = Job {
        splits,
        refined,
        receivers,
        gpu: context.gpu()?,
        args: &args.lit,
        lit: &lit,
        film,
        light,
        renderer: None,
        timings,
    };
    let mut drawn = Vec::new();
    for &lighting in &args.lit.lighting {
        drawn.push(job.draw(lighting)?);
    }
    let exposure = args.lit.light_exposure.unwrap_or_else(|| {
        let brightest = drawn
            .iter()
            .map(|d| d.map.quantile(WHITE))
            .fold(0.0, f32::max);
        0.95 / brightest.max(1e-9)
    });
    let picture = sheet(&drawn, exposure);
    output_picture(output, &picture)?;
    let table = errors(&drawn, args.lit.reference.as_deref())?;
    let bytes = job.bytes();
    Ok(report(context, args, &table, &job.timings, &bytes))
}

fn output_picture(output: PendingFile, picture: &Picture) -> Result<()> {
    let bytes = encode(picture, output.path())?;
    output.commit(&bytes)
}

fn sheet(drawn: &[Drawn], exposure: f32) -> Picture {
    let picture = |d: &Drawn| Picture {
        width: d.map.width as u32,
        height: d.map.height as u32,
        rgba: d.map.to_rgba8(exposure, BEHIND),
    };
    match drawn {
        [one] => picture(one),
        _ => {
            let all: Vec<_> = drawn.iter().map(|d| (d.name.clone(), picture(d))).collect();
            render::sheet(&all, all.len())
        }
    }
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

fn film(lit: &LitModel, args: &LitArgs, settings: &RenderSettings) -> Result<Film> {
    let g = &lit.geometry;
    let lens = Lens {
        fov: settings.fov,
        aspect: f64::from(settings.size[0]) / f64::from(settings.size[1]),
        margin: settings.margin,
    };
    let sun = sun(args, settings)?;
    Ok(Film {
        camera: Camera::new(
            &settings.camera,
            lens,
            g.origin,
            g.positions.iter().copied(),
        ),
        size: settings.size,
        sky: environment(&args.environment, &sun)?,
        sun,
    })
}

struct Job<'a> {
    gpu: &'a Gpu,
    args: &'a LitArgs,
    lit: &'a LitModel,
    /// The mesh that is drawn, and where it sees the sun from.
    splits: u32,
    refined: Refined,
    receivers: Receivers,
    film: Film,
    light: Option<Light>,
    renderer: Option<LitRenderer>,
    timings: Timings,
}

impl Job<'_> {
    /// What is drawn: the finer mesh.
    fn scene(&self) -> LitScene<'_> {
        LitScene {
            geometry: &self.refined.geometry,
            ..self.traced()
        }
    }

    /// What is traced: the model's own triangles.
    fn traced(&self) -> LitScene<'_> {
        LitScene {
            model: &self.lit.model,
            geometry: &self.lit.geometry,
            occluders: &self.lit.occluders,
            receivers: &self.lit.receivers,
            optics: &self.lit.optics,
        }
    }

    fn draw(&mut self, lighting: Lighting) -> Result<Drawn> {
        let name = match lighting {
            Lighting::Leaf => "leaf",
            Lighting::Prt => "prt",
            Lighting::Lvc => "lvc",
            Lighting::Ambient => "ambient",
            Lighting::Truth => "truth",
        };
        let working = console::working(name);
        let map = if lighting == Lighting::Truth {
            let samples = self.args.truth_samples;
            truth::trace(
                self.gpu,
                &self.traced(),
                &self.film,
                (samples, 1),
                &mut |share| {
                    working.step(&format!("path tracing {:.0} %", 100.0 * share));
                    Ok(())
                },
            )?
            .full()
        } else {
            let coarse = self.radiance(lighting)?;
            let radiance = self.refined.spread(&coarse, 2);
            let visibility = self.visibility(lighting)?;
            self.two_passes(&radiance, &visibility)?
        };
        Ok(Drawn {
            name: name.to_owned(),
            lighting,
            map,
        })
    }

    /// What the picture rests on, bytes: transfer vectors and maps on the host, a frame's buffers
    /// and targets on the device.
    fn bytes(&self) -> Value {
        let levels = self.light.iter().flat_map(|l| &l.transfer);
        let maps = self.light.as_ref().and_then(|l| l.visibility.as_ref());
        json!({
            "transfer": levels.map(|t| t.bytes.len()).sum::<usize>(),
            "maps": maps.map_or(0, |v| v.maps.iter().map(Vec::len).sum()),
            "frame": self.renderer.as_ref().map_or(0, LitRenderer::bytes),
        })
    }

    fn two_passes(&mut self, radiance: &[[f32; 3]], visibility: &[f32]) -> Result<RadianceMap> {
        let factor = self.args.supersample;
        if self.renderer.is_none() {
            let size = self.film.size.map(|s| factor * s);
            self.renderer = Some(LitRenderer::new(self.gpu, &self.scene(), size)?);
        }
        let renderer = self.renderer.as_ref().expect("just made");
        let (mut map, times) = renderer.draw(&self.scene(), &self.film, radiance, visibility)?;
        self.timings.add_passes(&times);
        for _ in 1..self.args.repeat {
            let again = renderer.draw(&self.scene(), &self.film, radiance, visibility)?;
            self.timings.add_passes(&again.1);
            map = again.0;
        }
        Ok(map.reduced(factor as usize))
    }

    /// What leaves each side of each vertex besides the sun's direct light.
    fn radiance(&mut self, lighting: Lighting) -> Result<Vec<[f32; 3]>> {
        let sides = 2 * self.lit.vertices();
        match lighting {
            Lighting::Lvc => return Ok(vec![[0.0; 3]; sides]),
            Lighting::Ambient => return Ok(self.ambient()),
            _ => {}
        }
        let stored = self.light.as_ref().and_then(|l| l.transfer.first());
        let Some(stored) = stored else {
            return Err(Error::usage(
                "--lighting: needs --light FILE with transfer vectors; `umbrage light` makes it",
            ));
        };
        let made_for = self.light.as_ref().map(|l| l.optics);
        if made_for != Some(self.lit.optics_key()) {
            return Err(Error::usage(
                "--light: its transfer vectors are those of other leaves; `umbrage light --keep` \
                 computes them again and keeps the sun's maps",
            ));
        }
        let transfer = self
            .timings
            .measure("unpack transfer", || stored.transfer());
        let sky = self
            .timings
            .measure("project sky", || self.film.sky.coefficients());
        let lights = Lights {
            sky: &sky,
            sun: &self.film.sun.coefficients(self.args.window),
            direct_sun: lighting == Lighting::Prt,
            order: self.args.order as usize,
        };
        let radiance = self
            .timings
            .measure("relight", || exit_radiance(&transfer, &lights));
        if stored.edge == 0.0 {
            return Ok(radiance);
        }
        let lod = Lod::new(&self.lit.geometry, stored.edge);
        if lod.coarse.len() != stored.receivers() {
            return Err(Error::usage(
                "--light: has another level of detail than the model gives",
            ));
        }
        Ok(self.timings.measure("spread", || lod.spread(&radiance)))
    }

    /// A constant: the mean of the sky, on leaves that nothing hides.
    fn ambient(&self) -> Vec<[f32; 3]> {
        let mean = self.film.sky.coefficients()[0] / (4.0 * std::f64::consts::PI).sqrt();
        let materials = &self.lit.receivers.materials;
        let points = self.lit.receivers.points.iter();
        points
            .flat_map(|p| {
                let m = &materials[p.material as usize];
                [m.rho_d_front, m.rho_d_back]
                    .map(|rho| [0, 1, 2].map(|c| (rho[c] + m.rho_t[c]) * mean[c] as f32))
            })
            .collect()
    }

    /// The share of the sun's disc that each vertex sees.
    fn visibility(&mut self, lighting: Lighting) -> Result<Vec<f32>> {
        if lighting == Lighting::Prt {
            return Ok(vec![0.0; self.receivers.points.len()]);
        }
        let towards = self.film.sun.towards;
        let wanted = self.args.stored || self.args.blended;
        if wanted && lighting != Lighting::Ambient {
            let maps = self.light.as_ref().and_then(|l| l.visibility.as_ref());
            let maps = maps
                .ok_or_else(|| Error::usage("--stored: needs --light FILE with visibility maps"))?;
            if maps.splits != self.splits {
                return Err(Error::usage(format!(
                    "--splits {}: the light file has maps for {}",
                    self.splits, maps.splits
                )));
            }
            let blend = self.args.blended;
            return Ok(self
                .timings
                .measure("decode map", || maps.towards(towards, blend)));
        }
        let settings = LvcSettings {
            radius_degrees: self.film.sun.radius_degrees,
            // Hard shadows look at the middle of the sun alone.
            samples: if lighting == Lighting::Ambient { 1 } else { 16 },
            ..LvcSettings::default()
        };
        let (gpu, lit, receivers) = (self.gpu, self.lit, &self.receivers);
        let bytes = self.timings.measure("sun map", || {
            let scene = RayScene::new(gpu, &lit.occluders)?;
            Lvc::new(gpu, &scene, receivers, settings)?.maps(&[towards.as_vec3().to_array()])
        })?;
        Ok(bytes.iter().map(|&b| f32::from(b) / 255.0).collect())
    }
}

/// Errors of each picture against the truth among them, or against pictures of a file.
fn errors(drawn: &[Drawn], reference: Option<&Path>) -> Result<Vec<(String, Difference)>> {
    let mut out = Vec::new();
    let truth = drawn.iter().find(|d| d.lighting == Lighting::Truth);
    if let Some(truth) = truth {
        for d in drawn.iter().filter(|d| d.lighting != Lighting::Truth) {
            out.push((d.name.clone(), d.map.difference(&truth.map)?));
        }
    }
    if let Some(prefix) = reference {
        for d in drawn {
            let path = reference_path(prefix, d.lighting);
            let map = read_map(&path)?;
            let difference = d.map.difference(&map).map_err(|e| Error::file(&path, e))?;
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            out.push((format!("{} to {name}", d.name), difference));
        }
    }
    Ok(out)
}

/// The picture that one lighting is compared with.
fn reference_path(prefix: &Path, lighting: Lighting) -> PathBuf {
    let part = if lighting == Lighting::Lvc {
        "sun_direct"
    } else {
        "full"
    };
    let name = prefix.file_name().unwrap_or_default().to_string_lossy();
    prefix.with_file_name(format!("{name}_{part}.exr"))
}

/// A picture of linear light.
fn read_map(path: &Path) -> Result<RadianceMap> {
    let bytes = std::fs::read(path).map_err(|e| Error::file(path, e))?;
    let image = FloatImage::decode(&path.to_string_lossy(), &bytes, Transfer::Srgb)?;
    let pixels = image.pixels.iter().map(|p| [p[0], p[1], p[2], 1.0]);
    Ok(RadianceMap {
        width: image.width as usize,
        height: image.height as usize,
        pixels: pixels.collect(),
    })
}

fn report(
    context: &Context,
    args: &RenderArgs,
    errors: &[(String, Difference)],
    timings: &Timings,
    bytes: &Value,
) -> Report {
    let mut text = format!("{}\n", args.output.display());
    if !errors.is_empty() {
        let mut table = Table::new(&["lighting", "bias %", "RMSE %", "blocks %", "p99 %"]);
        let percent = |v: f64| format!("{:.2}", 100.0 * v);
        for (name, d) in errors {
            let cells = [d.bias, d.rmse, d.block_rmse, d.p99].map(percent);
            table.row(&[name, &cells[0], &cells[1], &cells[2], &cells[3]]);
        }
        text += &format!("\n{table}");
    }
    if context.timings() {
        text += &format!("\n{}", timings.table());
    }
    let rows: Vec<Value> = errors
        .iter()
        .map(|(name, d)| {
            json!({
                "lighting": name, "mean": d.mean, "bias": d.bias, "rmse": d.rmse,
                "block_rmse": d.block_rmse, "p99": d.p99, "coverage": d.coverage,
            })
        })
        .collect();
    let json =
        json!({ "output": args.output, "errors": rows, "times": timings.json(), "bytes": bytes });
    Report::new(text, json)
}
