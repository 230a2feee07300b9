//! `umbrage render --lighting`: leaves under sun and sky.

mod gloss;
mod matrix;

use serde_json::{Value, json};

use super::lit_sheet::{Compared, Drawn, compare, reference_path, sheet};
use super::render::encode;
use crate::app::cli::RenderArgs;
use crate::app::cli::light::{Lighting, LitArgs};
use crate::app::film::film;
use crate::app::lit::LitModel;
use crate::app::output::{PendingFile, check_apart, check_ending};
use crate::app::relight::{Relight, Relighting};
use crate::app::report::Table;
use crate::app::settings::picture_settings;
use crate::app::timing::Timings;
use crate::app::{Context, Report, console};
use crate::gpu::Gpu;
use crate::leaf::directional;
use crate::leaf::film::{Film, LitScene};
use crate::leaf::gloss_rays::{GlossLight, GlossRays};
use crate::leaf::lamp_maps::{LampMaps, LampSettings};
use crate::leaf::lit::{LitRenderer, VertexLight};
use crate::leaf::lit_lamps::LampLight;
use crate::leaf::lvc::{Lvc, LvcSettings};
use crate::leaf::radiance_map::RadianceMap;
use crate::leaf::rays::RayScene;
use crate::leaf::receivers::Receivers;
use crate::leaf::refine::Refined;
use crate::leaf::shadow_map::ShadowSettings;
use crate::leaf::shape::Shape;
use crate::leaf::truth;
use crate::render::Picture;
use crate::{Error, Result};

/// Draws the model under each lighting.
///
/// # Errors
/// Wrong input or settings, a light file of another model, a failing device.
pub fn run(context: &Context, args: &RenderArgs) -> Result<Report> {
    // Wrong settings are told before the model is read.
    picture_settings(None, &args.picture)?;
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
    let mut lit = timings.measure("read", || {
        LitModel::new(
            source,
            &model.textures,
            model.foliage.as_deref(),
            &args.lit.optics,
        )
    })?;
    if args.lit.directional {
        lit.receivers.turns = directional::table(&lit.optics)?;
    }
    let settings = picture_settings(lit.scene.as_ref(), &args.picture)?;
    let film = film(&lit.geometry, &args.lit, &settings)?;
    let relight = match args.lit.light.as_slice() {
        [] => None,
        paths => Some(timings.measure("light files", || Relight::read(&lit, paths))?),
    };
    let stored = relight.as_ref().and_then(Relight::splits);
    let splits = args.lit.splits.or(stored).unwrap_or(2);
    let (refined, receivers) = timings.measure("refine", || lit.refined(splits));
    let mut job = Job {
        splits,
        refined,
        receivers,
        gpu: context.gpu()?,
        args: &args.lit,
        lit: &lit,
        film,
        shadow: ShadowSettings {
            size: settings.shadow_size,
            radius: settings.shadow_radius,
        },
        relight,
        renderer: None,
        gloss: None,
        timings,
    };
    let mut drawn = Vec::new();
    for &lighting in &args.lit.lighting {
        drawn.push(job.draw(lighting)?);
    }
    let table = compare(&drawn, &args.lit)?;
    output_picture(output, &sheet(&drawn, &table, &args.lit))?;
    let bytes = job.bytes();
    Ok(report(context, args, &table, &job.timings, &bytes))
}

fn output_picture(output: PendingFile, picture: &Picture) -> Result<()> {
    let bytes = encode(picture, output.path())?;
    output.commit(&bytes)
}

/// Whether the sun comes by a shadow map.
fn shadow_map(lighting: Lighting) -> bool {
    matches!(lighting, Lighting::Shadow | Lighting::ShadowPrt)
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
    shadow: ShadowSettings,
    relight: Option<Relight<'a>>,
    renderer: Option<LitRenderer>,
    /// Made when the first picture needs it.
    gloss: Option<GlossRays>,
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
            Lighting::Shadow => "shadow",
            Lighting::ShadowPrt => "shadow-prt",
            Lighting::Truth => "truth",
        };
        let working = console::working(name);
        let mut direct = None;
        let map = if lighting == Lighting::Truth {
            let samples = self.args.truth_samples;
            let truth = truth::trace(
                self.gpu,
                &self.traced(),
                &self.film,
                (samples, 1),
                &mut |share| {
                    working.step(&format!("path tracing {:.0} %", 100.0 * share));
                    Ok(())
                },
            )?;
            let full = truth.full();
            direct = Some(truth.direct);
            full
        } else {
            let coarse = self.radiance(lighting)?;
            let radiance = self.refined.spread(&coarse, 2);
            let visibility = self.visibility(lighting)?;
            let lamps = self.lamp_visibility(lighting)?;
            let leaving = self.leaving(lighting, coarse, (&visibility, &lamps))?;
            let shadow = shadow_map(lighting).then_some(self.shadow);
            self.two_passes((&radiance, &visibility, &leaving), &lamps, shadow)?
        };
        Ok(Drawn {
            name: name.to_owned(),
            lighting,
            map,
            direct,
        })
    }

    /// What the picture rests on, bytes: transfer vectors and maps on the host, a frame's buffers
    /// and targets on the device.
    fn bytes(&self) -> Value {
        let [transfer, maps] = self.relight.as_ref().map_or([[0; 2]; 2], Relight::bytes);
        json!({
            "transfer": transfer[0],
            "maps": maps[0],
            "transfer_if_not_shared": transfer[1],
            "maps_if_not_shared": maps[1],
            "frame": self.renderer.as_ref().map_or(0, LitRenderer::bytes),
            "gloss_rays": self.gloss.as_ref().map_or(0, GlossRays::bytes),
        })
    }

    fn two_passes(
        &mut self,
        (radiance, visibility, leaving): (&[[f32; 3]], &[f32], &[[f32; 3]]),
        lamps: &[Vec<f32>],
        shadow: Option<ShadowSettings>,
    ) -> Result<RadianceMap> {
        let factor = self.args.supersample;
        if self.renderer.is_none() {
            let size = self.film.size.map(|s| factor * s);
            let mut renderer = LitRenderer::new(self.gpu, &self.scene(), size)?;
            if self.lit.leaves.iter().any(Option::is_some) {
                renderer.wear(&self.lit.model, &self.lit.leaves)?;
            }
            self.renderer = Some(renderer);
        }
        let renderer = self.renderer.as_ref().expect("just made");
        let light = VertexLight {
            radiance,
            visibility,
            lamps: (!lamps.is_empty()).then_some(LampLight {
                lamps: &self.film.lamps,
                visibility: lamps,
                points: self.args.lamp_points,
            }),
            shadow,
            gloss: self
                .gloss
                .as_ref()
                .filter(|_| !leaving.is_empty())
                .map(|rays| GlossLight {
                    rays,
                    leaving,
                    samples: self.args.gloss_rays,
                    seed: 1,
                }),
        };
        let (mut map, times) = renderer.draw(&self.scene(), &self.film, &light)?;
        self.timings.add_passes(&times);
        for _ in 1..self.args.repeat {
            let again = renderer.draw(&self.scene(), &self.film, &light)?;
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
            Lighting::Ambient | Lighting::Shadow => return Ok(self.ambient()),
            _ => {}
        }
        if let Some(radiance) = self.by_matrices(lighting)? {
            return Ok(radiance);
        }
        self.by_vectors(lighting)
    }

    /// Whether transfer was computed for the leaves as they are now.
    fn same_leaves(&self) -> Result<()> {
        let light = self.relight.as_ref().and_then(Relight::whole);
        if light.map(|l| l.optics) != Some(self.lit.optics_key()) {
            return Err(Error::usage(
                "--light: its transfer is that of other leaves; `umbrage light --keep` \
                 computes them again and keeps the sun's maps",
            ));
        }
        Ok(())
    }

    /// The same by transfer vectors.
    fn by_vectors(&mut self, lighting: Lighting) -> Result<Vec<[f32; 3]>> {
        let relight = self.relight.as_mut().ok_or_else(|| {
            Error::usage(
                "--lighting: needs --light FILE with transfer vectors; `umbrage light` makes it",
            )
        })?;
        let how = Relighting {
            window: self.args.window,
            direct_sun: lighting == Lighting::Prt,
            order: self.args.order as usize,
            lod_pixels: self.args.lod_pixels,
        };
        let (film, vertices) = (&self.film, self.lit.vertices());
        self.timings
            .measure("relight", || relight.radiance(film, &how, vertices))
    }

    /// The share of each lamp that each vertex sees.
    fn lamp_visibility(&mut self, lighting: Lighting) -> Result<Vec<Vec<f32>>> {
        if self.film.lamps.is_empty() || lighting == Lighting::Prt {
            return Ok(Vec::new());
        }
        let settings = LampSettings {
            // Hard shadows look at the middle of the lamp alone.
            points: if matches!(lighting, Lighting::Ambient | Lighting::Shadow) {
                1
            } else {
                self.args.lamp_samples
            },
            ..LampSettings::default()
        };
        let (gpu, lit, receivers, lamps) = (self.gpu, self.lit, &self.receivers, &self.film.lamps);
        self.timings.measure("lamp maps", || {
            let scene = RayScene::new(gpu, &lit.occluders)?;
            let from = (&lit.occluders, lit.geometry.origin);
            let mut maps = LampMaps::new(gpu, &scene, from, receivers, settings)?;
            lamps.iter().map(|lamp| maps.map(lamp)).collect()
        })
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
        if shadow_map(lighting) || lighting == Lighting::Prt {
            return Ok(vec![0.0; self.receivers.points.len()]);
        }
        let towards = self.film.sun.towards;
        let wanted = self.args.stored || self.args.blended;
        if wanted && lighting != Lighting::Ambient {
            if self.film.sun_shape != Shape::Disc {
                return Err(Error::usage(
                    "--sun-shape: stored maps are those of a disc; leave --stored out",
                ));
            }
            let relight = self
                .relight
                .as_ref()
                .ok_or_else(|| Error::usage("--stored: needs --light FILE with visibility maps"))?;
            let refined = (&self.refined.geometry, self.splits);
            let blend = self.args.blended;
            return self
                .timings
                .measure("decode map", || relight.visibility(towards, blend, refined));
        }
        let settings = LvcSettings {
            radius_degrees: self.film.sun.radius_degrees,
            // Hard shadows look at the middle of the sun alone.
            samples: if lighting == Lighting::Ambient { 1 } else { 16 },
            ..LvcSettings::default()
        };
        let (gpu, lit, receivers) = (self.gpu, self.lit, &self.receivers);
        let shape = &self.film.sun_shape;
        let bytes = self.timings.measure("sun map", || {
            let scene = RayScene::new(gpu, &lit.occluders)?;
            Lvc::new(gpu, &scene, receivers, settings)?
                .shaped(shape)?
                .maps(&[towards.as_vec3().to_array()])
        })?;
        Ok(bytes.iter().map(|&b| f32::from(b) / 255.0).collect())
    }
}

fn report(
    context: &Context,
    args: &RenderArgs,
    errors: &[Compared],
    timings: &Timings,
    bytes: &Value,
) -> Report {
    let mut text = format!("{}\n", args.output.display());
    if !errors.is_empty() {
        let mut table = Table::new(&["lighting", "bias %", "RMSE %", "blocks %", "p99 %"]);
        let percent = |v: f64| format!("{:.2}", 100.0 * v);
        for Compared {
            name,
            difference: d,
            ..
        } in errors
        {
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
        .map(
            |Compared {
                 name,
                 difference: d,
                 ..
             }| {
                json!({
                    "lighting": name, "mean": d.mean, "bias": d.bias, "rmse": d.rmse,
                    "block_rmse": d.block_rmse, "p99": d.p99, "coverage": d.coverage,
                })
            },
        )
        .collect();
    let json =
        json!({ "output": args.output, "errors": rows, "times": timings.json(), "bytes": bytes });
    Report::new(text, json)
}
