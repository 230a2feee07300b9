//! `umbrage bench light`: what precomputing and drawing leaf light take, pass by pass.

use std::time::Instant;

use glam::DVec3;
use serde_json::{Value, json};

use crate::app::cli::BenchArgs;
use crate::app::cli::light::OpticsArgs;
use crate::app::lit::LitModel;
use crate::app::report::Table;
use crate::app::settings::picture_settings;
use crate::app::timing::Timings;
use crate::app::{Context, Report, console};
use crate::gpu::Gpu;
use crate::leaf::environment::{Environment, Sun};
use crate::leaf::film::{Film, LitScene};
use crate::leaf::light::{Lighting, Storage, StoredTransfer, exit_radiance};
use crate::leaf::lit::{LitRenderer, VertexLight};
use crate::leaf::lvc::{Lvc, LvcSettings, SUN_RADIUS_DEGREES};
use crate::leaf::prt::{Prt, PrtSettings, Transfer};
use crate::leaf::rays::RayScene;
use crate::leaf::runs;
use crate::leaf::shape::Shape;
use crate::leaf::storage_error::{StorageError, storage_errors};
use crate::render::RenderSettings;
use crate::render::plan::human_bytes;
use crate::scene::{Camera, Lens};
use crate::{Error, Result};

/// Paths of a side: enough to time, too few to look at.
const PATHS: u32 = 64;
/// Splits of the mesh for visibility, as by default.
const SPLITS: u32 = 2;

/// Times transfer, one map of the sun, a change of light and a frame.
///
/// # Errors
/// Wrong input or settings, a failing device.
pub fn run(context: &Context, args: &BenchArgs) -> Result<Report> {
    let settings = picture_settings(None, &args.picture)?;
    let model = &args.input.model;
    let lit = LitModel::new(
        &args.input.input,
        &model.textures,
        model.foliage.as_deref(),
        &OpticsArgs::default(),
    )?;
    let gpu = context.gpu()?;
    let _working = console::working("lighting");
    let scene = RayScene::new(gpu, &lit.occluders)?;
    let mut bench = Bench {
        gpu,
        lit: &lit,
        scene,
        settings,
        passes: Timings::default(),
        stages: Timings::default(),
        text: String::new(),
    };
    let transfer = bench.transfer()?;
    let storage = bench.storage(&transfer);
    bench.frames(args, &transfer)?;
    let device = &gpu.info().name;
    let text = format!(
        "light of {}: {} vertices, {} triangles, on {device}\n{}\n{}\n{}\n{}",
        args.input.input,
        lit.vertices(),
        lit.geometry.indices.len() / 3,
        bench.text,
        storage_table(&storage),
        bench.passes.table(),
        bench.stages.table(),
    );
    let json = json!({
        "bench": "light", "model": args.input.input.to_string(), "vertices": lit.vertices(),
        "storage": storage_rows(&storage), "device": device, "passes": bench.passes.json(), "stages": bench.stages.json(),
    });
    Ok(Report::new(text, json))
}

fn storage_table(errors: &[StorageError]) -> Table {
    let mut table = Table::new(&["storage", "bytes", "error %", "of indirect sun %"]);
    for e in errors {
        let percent = |v: f64| format!("{:.3}", 100.0 * v);
        let cells = [percent(e.all), percent(e.indirect)];
        table.row(&[
            &e.storage.name(),
            &human_bytes(e.bytes),
            &cells[0],
            &cells[1],
        ]);
    }
    table
}

fn storage_rows(errors: &[StorageError]) -> Vec<Value> {
    let row = |e: &StorageError| {
        json!({
            "storage": e.storage.name(), "bytes": e.bytes, "all": e.all, "indirect": e.indirect,
        })
    };
    errors.iter().map(row).collect()
}

struct Bench<'a> {
    gpu: &'a Gpu,
    lit: &'a LitModel,
    scene: RayScene,
    settings: RenderSettings,
    passes: Timings,
    stages: Timings,
    text: String,
}

impl Bench<'_> {
    fn transfer(&mut self) -> Result<Transfer> {
        let settings = PrtSettings {
            paths: PATHS,
            ..PrtSettings::default()
        };
        let mut prt = Prt::new(self.gpu, &self.scene, &self.lit.receivers, settings)?;
        let start = Instant::now();
        let transfer = prt.all(&mut |_| Ok(()))?;
        let seconds = start.elapsed().as_secs_f64();
        self.passes.add_passes(prt.times());
        self.text += &format!(
            "transfer: {PATHS} paths a side, {} rays, {:.2} Mrays/s\n",
            prt.traced,
            prt.traced as f64 / seconds * 1e-6
        );
        Ok(transfer)
    }

    /// What storing in fewer bits costs under the light of the frames.
    fn storage(&self, transfer: &Transfer) -> Vec<StorageError> {
        let film = self.film();
        let sun = film.sun.coefficients(0.002);
        storage_errors(transfer, &film.sky.coefficients(), &sun)
    }

    fn film(&self) -> Film {
        let g = &self.lit.geometry;
        let [width, height] = self.settings.size;
        let lens = Lens {
            fov: self.settings.fov,
            aspect: f64::from(width) / f64::from(height),
            margin: self.settings.margin,
        };
        let points = g.positions.iter().copied();
        Film {
            camera: Camera::new(&self.settings.camera, lens, g.origin, points),
            size: self.settings.size,
            sun: Sun {
                towards: self.settings.sun.direction(),
                radius_degrees: SUN_RADIUS_DEGREES,
                irradiance: DVec3::splat(3.0),
            },
            sun_shape: Shape::Disc,
            sky: Environment::Constant(DVec3::splat(0.3)),
            lamps: Vec::new(),
        }
    }

    /// A change of the sun (map, runs, light of every vertex) and a frame, again and again.
    fn frames(&mut self, args: &BenchArgs, transfer: &Transfer) -> Result<()> {
        let (refined, receivers) = self.lit.refined(SPLITS);
        let film = self.film();
        let scene = LitScene {
            model: &self.lit.model,
            geometry: &refined.geometry,
            occluders: &self.lit.occluders,
            receivers: &self.lit.receivers,
            optics: &self.lit.optics,
        };
        let renderer = LitRenderer::new(self.gpu, &scene, film.size)?;
        let mut lvc = Lvc::new(self.gpu, &self.scene, &receivers, LvcSettings::default())?;
        let (sky, sun) = (film.sky.coefficients(), film.sun.coefficients(0.002));
        let towards = film.sun.towards.as_vec3().to_array();
        let mut compressed = 0;
        for run in 0..args.warm_up + args.runs {
            // Runs that do not count are measured into the bin.
            let mut bin = Timings::default();
            let counts = run >= args.warm_up;
            let stages = if counts { &mut self.stages } else { &mut bin };
            let bytes = stages.measure("compute a map", || lvc.maps(&[towards]))?;
            let encoded = stages.measure("encode it", || runs::encode(&bytes));
            compressed = encoded.len();
            let decoded = stages.measure("decode it", || runs::decode(&encoded, bytes.len()));
            let decoded = decoded.ok_or_else(|| Error::usage("a map did not come back"))?;
            let visibility: Vec<f32> = decoded.iter().map(|&b| f32::from(b) / 255.0).collect();
            let lighting = Lighting {
                sky: &sky,
                sun: &sun,
                direct_sun: false,
                order: 5,
            };
            let coarse = stages.measure("relight", || exit_radiance(transfer, &lighting));
            let radiance = stages.measure("spread", || refined.spread(&coarse, 2));
            let light = VertexLight {
                radiance: &radiance,
                visibility: &visibility,
                lamps: None,
                shadow: None,
                gloss: None,
            };
            let (_, times) = renderer.draw(&scene, &film, &light)?;
            if counts {
                self.passes.add_passes(&times);
            }
        }
        let stored = StoredTransfer::new(transfer, Storage::F16, PATHS, 0.0);
        self.text += &format!(
            "vectors {}, a map of {} vertices {} as runs, {} for a frame of {}x{}\n",
            human_bytes(stored.bytes.len() as u64),
            receivers.points.len(),
            human_bytes(compressed as u64),
            human_bytes(renderer.bytes()),
            film.size[0],
            film.size[1],
        );
        Ok(())
    }
}
