//! `umbrage light`: precomputes sky, light between leaves and soft shadows of the sun.

mod matrix;
mod plan;

use std::path::PathBuf;
use std::time::{Duration, Instant};

use glam::DVec3;
use serde_json::{Value, json};

use self::plan::{How, Sizes};

use crate::app::cli::LightArgs;
use crate::app::lit::LitModel;
use crate::app::output::{PendingFile, check_ending, write_atomically};
use crate::app::report::Table;
use crate::app::timing::Timings;
use crate::app::{Context, Report, console};
use crate::gpu::Gpu;
use crate::leaf::checkpoint::{self, Checkpoint};
use crate::leaf::directions::Directions;
use crate::leaf::environment::{Coefficients, Environment, Sun as SunLight};
use crate::leaf::levels::{Level, LevelError, LevelSums};
use crate::leaf::light::{Light, Lighting, StoredTransfer, VisibilityMaps, model_key};
use crate::leaf::lvc::{Lvc, SUN_RADIUS_DEGREES};
use crate::leaf::prt::{Prt, Snapshot};
use crate::leaf::rays::RayScene;
use crate::leaf::{light_file, runs};
use crate::render::plan::human_bytes;
use crate::scene::{Geometry, Sun};
use crate::{Error, Result};

/// Window against ringing of the light that levels are compared in: the default of `render`.
const WINDOW: f64 = 0.002;
/// Levels of detail at most.
const MAX_LEVELS: usize = 8;

/// What is to be done.
struct Job {
    lit: LitModel,
    how: How,
    /// Maps of an older file.
    kept: Option<VisibilityMaps>,
    /// Levels of detail of the transfer vectors.
    levels: Vec<Level>,
    /// Light that levels are compared in: sky and sun.
    compared: [Coefficients; 2],
}

/// What was done and how long it took.
#[derive(Default)]
struct Done {
    transfer_rays: u64,
    transfer_seconds: f64,
    sun_rays: u64,
    sun_seconds: f64,
    levels: Vec<LevelError>,
    passes: Timings,
}

/// Computes the light of a model and writes it.
///
/// # Errors
/// Wrong input or settings, a light over the bound, an unwritable output, a failing device.
pub fn run(context: &Context, args: &LightArgs) -> Result<Report> {
    check_ending(&args.output, &["light"])?;
    let output = PendingFile::create(&args.output)?;
    let (job, sizes) = Job::new(args)?;
    if !context.json() {
        console::line(&sizes.text(&job.how, job.lit.occluders.bytes()));
    }
    let gpu = context.gpu()?;
    let mut run = Run::new(gpu, args, &job)?;
    let light = run.compute()?;
    let bytes = light_file::encode(&light);
    output.commit(&bytes)?;
    // Nothing to go on from any more.
    let _ = std::fs::remove_file(&run.checkpoint);
    Ok(report(context, args, &light, (bytes.len(), &run.done)))
}

impl Job {
    fn new(args: &LightArgs) -> Result<(Self, Sizes)> {
        let sun = match args.sun.sun_direction {
            Some(d) => DVec3::from(d.0).try_normalize().ok_or_else(|| {
                Error::usage("--sun-direction: a vector without length has no direction")
            })?,
            None => Sun::default().direction(),
        };
        let how = How::new(args, sun)?;
        let model = &args.input.model;
        let mut kept = None;
        let mut sized = None;
        let look = |geometry: &Geometry| {
            if let Some(path) = &args.keep {
                let (key, vertices) = (model_key(geometry), geometry.positions.len());
                kept = light_file::read(path, &key, vertices)?.visibility;
            }
            let levels = levels(&args.lod, geometry)?;
            let sizes = Sizes::new(&how, geometry, &levels, kept.is_some());
            sizes.check(args)?;
            sized = Some((levels, sizes));
            Ok(())
        };
        let told = (model.foliage.as_deref(), &args.optics);
        let lit = LitModel::looked_at(&args.input.input, &model.textures, told, look)?;
        let (levels, sizes) = sized.expect("was looked at");
        let job = Self {
            lit,
            how,
            kept,
            levels,
            compared: compared(sun),
        };
        Ok((job, sizes))
    }

    /// Hash of everything that the result depends on.
    fn hash(&self) -> [u8; 32] {
        let how = &self.how;
        let text = format!(
            "{:?} {:?} {:?} {} {:?} {:?} {:?}",
            how.prt,
            how.lvc,
            how.directions,
            how.splits,
            self.levels.iter().map(|l| l.edge).collect::<Vec<_>>(),
            how.transfer,
            how.colours,
        );
        let mut hash = blake3::Hasher::new();
        hash.update(&self.lit.key());
        hash.update(&self.lit.optics_key());
        hash.update(text.as_bytes());
        *hash.finalize().as_bytes()
    }
}

/// A computation that can be interrupted.
struct Run<'a> {
    gpu: &'a Gpu,
    job: &'a Job,
    scene: RayScene,
    checkpoint: PathBuf,
    so_far: Checkpoint,
    saved: Instant,
    /// Time between two checkpoints.
    between: Duration,
    done: Done,
}

impl<'a> Run<'a> {
    fn new(gpu: &'a Gpu, args: &LightArgs, job: &'a Job) -> Result<Self> {
        let name = args.output.file_name().unwrap_or_default();
        let checkpoint = args
            .output
            .with_file_name(format!("{}.part", name.to_string_lossy()));
        let hash = job.hash();
        let mut so_far = Checkpoint {
            job: hash,
            transfer: Snapshot::default(),
            levels: Vec::new(),
            matrices: Snapshot::default(),
            packed: Vec::new(),
            maps: Vec::new(),
        };
        if args.resume {
            match std::fs::read(&checkpoint) {
                Ok(bytes) => {
                    so_far = checkpoint::decode(&bytes, &hash)
                        .map_err(|reason| Error::file(&checkpoint, reason))?;
                }
                Err(e) => log::warn!("{}: nothing to resume: {e}", checkpoint.display()),
            }
        }
        Ok(Self {
            gpu,
            job,
            scene: RayScene::new(gpu, &job.lit.occluders)?,
            checkpoint,
            so_far,
            saved: Instant::now(),
            between: Duration::from_secs_f64(args.checkpoint),
            done: Done::default(),
        })
    }

    fn compute(&mut self) -> Result<Light> {
        let (vectors, matrices) = self.job.how.kinds();
        let transfer = if vectors {
            self.transfer()?
        } else {
            Vec::new()
        };
        let matrices = if matrices {
            Some(self.matrices()?)
        } else {
            None
        };
        let visibility = match (&self.job.kept, &self.job.how.directions) {
            (Some(kept), _) => Some(kept.clone()),
            (None, Some(directions)) => Some(self.visibility(directions)?),
            (None, None) => None,
        };
        Ok(Light {
            model: self.job.lit.key(),
            optics: self.job.lit.optics_key(),
            vertices: self.job.lit.vertices() as u32,
            transfer,
            matrices,
            visibility,
        })
    }

    /// Writes what is done, when it is time.
    fn save(&mut self, update: impl FnOnce(&mut Checkpoint) -> Result<()>) -> Result<()> {
        if self.saved.elapsed() < self.between {
            return Ok(());
        }
        let start = Instant::now();
        update(&mut self.so_far)?;
        write_atomically(&self.checkpoint, &checkpoint::encode(&self.so_far))?;
        // At most a tenth of the time goes into it, however large it is.
        if self.between > Duration::ZERO {
            self.between = self.between.max(10 * start.elapsed());
        }
        self.saved = Instant::now();
        Ok(())
    }

    fn transfer(&mut self) -> Result<Vec<StoredTransfer>> {
        let (gpu, job, scene) = (self.gpu, self.job, self.scene.clone());
        let mut prt = Prt::new(gpu, &scene, &job.lit.receivers, job.how.prt)?;
        let lighting = Lighting {
            sky: &job.compared[0],
            sun: &job.compared[1],
            direct_sun: false,
            order: 5,
        };
        let mut levels = LevelSums::new(&job.levels, job.how.prt.order);
        if self.so_far.transfer.receivers > 0 {
            levels.restore(&self.so_far.levels).map_err(Error::usage)?;
        }
        prt.restore(std::mem::take(&mut self.so_far.transfer))?;
        let working = console::working("transfer");
        let (start, before) = (Instant::now(), prt.step().done);
        prt.all(&mut |prt| {
            levels.add(prt.take(), &lighting);
            let step = prt.step();
            let rate = (step.done - before) as f64 / start.elapsed().as_secs_f64();
            working.step(&progress(("transfer", "paths"), step.done, step.all, rate));
            self.save(|so_far| {
                so_far.transfer = prt.snapshot()?;
                so_far.levels = levels.state();
                Ok(())
            })
        })?;
        self.done.passes.add_passes(prt.times());
        self.done.transfer_rays = prt.traced;
        self.done.transfer_seconds = start.elapsed().as_secs_f64();
        self.done.levels = levels.errors(&lighting);
        self.so_far.transfer = prt.snapshot()?;
        self.so_far.levels = levels.state();
        Ok(levels.stored(job.how.storage, job.how.prt.paths))
    }

    fn visibility(&mut self, directions: &Directions) -> Result<VisibilityMaps> {
        let (gpu, job, scene) = (self.gpu, self.job, self.scene.clone());
        let (_, receivers) = job.lit.refined(job.how.splits);
        let vertices = receivers.points.len();
        let mut lvc = Lvc::new(gpu, &scene, &receivers, job.how.lvc)?;
        let all: Vec<[f32; 3]> = directions
            .all()
            .iter()
            .map(|d| d.as_vec3().to_array())
            .collect();
        let mut maps = std::mem::take(&mut self.so_far.maps);
        let working = console::working("visibility");
        let (start, before) = (Instant::now(), maps.len());
        for batch in all[before.min(all.len())..].chunks(lvc.directions_per_batch()) {
            let bytes = lvc.maps(batch)?;
            maps.extend(bytes.chunks_exact(vertices).map(runs::encode));
            let rate = (maps.len() - before) as f64 / start.elapsed().as_secs_f64();
            let (done, of) = (maps.len() as u64, all.len() as u64);
            working.step(&progress(("visibility", "maps"), done, of, rate));
            self.save(|so_far| {
                so_far.maps.clone_from(&maps);
                Ok(())
            })?;
        }
        self.done.passes.add_passes(lvc.times());
        self.done.sun_rays = lvc.traced;
        self.done.sun_seconds = start.elapsed().as_secs_f64();
        Ok(VisibilityMaps {
            directions: directions.clone(),
            splits: job.how.splits,
            vertices: vertices as u32,
            radius_degrees: job.how.lvc.radius_degrees,
            samples: job.how.lvc.samples,
            maps,
        })
    }
}

/// Levels whose distances were told in diagonals.
fn levels(told: &[f32], geometry: &Geometry) -> Result<Vec<Level>> {
    let ascending = told.windows(2).all(|w| w[0] < w[1]);
    let within = told.iter().all(|e| (0.0..=1.0).contains(e));
    if !ascending || !within || told.is_empty() || told.len() > MAX_LEVELS {
        return Err(Error::usage(format!(
            "--lod: expected 1 to {MAX_LEVELS} ascending numbers from 0 to 1"
        )));
    }
    let diagonal = geometry.diagonal();
    let level = |e: &f32| Level::new(geometry, e * diagonal);
    Ok(told.iter().map(level).collect())
}

/// The light that `render` takes by default.
fn compared(sun: DVec3) -> [Coefficients; 2] {
    let sky = Environment::Linear {
        a: DVec3::new(0.24, 0.27, 0.30),
        b: DVec3::new(0.12, 0.135, 0.15),
        up: DVec3::Y,
    };
    let sun = SunLight {
        towards: sun,
        radius_degrees: SUN_RADIUS_DEGREES,
        irradiance: DVec3::new(3.0, 2.85, 2.55),
    };
    [sky.coefficients(), sun.coefficients(WINDOW)]
}

/// `transfer 43 %, 1.2 Mpaths/s, 35 s left`.
fn progress((what, unit): (&str, &str), done: u64, all: u64, rate: f64) -> String {
    let left = (all - done.min(all)) as f64 / rate.max(1e-9);
    let rate = match rate {
        r if r >= 1e6 => format!("{:.1} M", 1e-6 * r),
        r if r >= 1e4 => format!("{:.0} k", 1e-3 * r),
        r => format!("{r:.1} "),
    };
    format!(
        "{what} {} %, {rate}{unit}/s, {left:.0} s left",
        100 * done / all.max(1)
    )
}

fn report(
    context: &Context,
    args: &LightArgs,
    light: &Light,
    (bytes, done): (usize, &Done),
) -> Report {
    let rate = |rays: u64, seconds: f64| rays as f64 / seconds.max(1e-9) * 1e-6;
    let vectors = light.transfer.iter().map(|t| t.bytes.len() as u64);
    let matrices = light.matrices.as_ref().map_or(0, |m| m.bytes.len() as u64);
    let transfer = vectors.sum::<u64>() + matrices;
    let maps = light.visibility.as_ref().map_or(0, VisibilityMaps::bytes);
    let count = light.visibility.as_ref().map_or(0, |v| v.maps.len());
    let each = light.visibility.as_ref().map_or(0, |v| v.vertices);
    let raw = u64::from(each) * count as u64;
    let mut text = format!(
        "{}: {}\n\
         transfer: {}, {} rays in {:.1} s ({:.2} Mrays/s)\n\
         visibility: {count} maps, {} of {} ({:.1} x), {} rays in {:.1} s ({:.2} Mrays/s)\n",
        args.output.display(),
        human_bytes(bytes as u64),
        human_bytes(transfer),
        done.transfer_rays,
        done.transfer_seconds,
        rate(done.transfer_rays, done.transfer_seconds),
        human_bytes(maps),
        human_bytes(raw),
        raw as f64 / maps.max(1) as f64,
        done.sun_rays,
        done.sun_seconds,
        rate(done.sun_rays, done.sun_seconds),
    );
    if done.levels.len() > 1 || done.levels.iter().any(|l| l.edge > 0.0) {
        text += &format!("\n{}", level_table(light, &done.levels));
    }
    if context.timings() {
        text += &format!("\n{}", done.passes.table());
    }
    let levels = light.transfer.iter().zip(&done.levels).map(|(t, l)| {
        json!({
            "edge": l.edge, "vertices": l.vertices, "bytes": t.bytes.len(), "rmse": l.rmse,
            "bias": l.bias,
        })
    });
    let levels: Vec<Value> = levels.collect();
    let json = json!({
        "output": args.output, "bytes": bytes, "times": done.passes.json(), "vertices": light.vertices,
        "transfer": {
            "bytes": transfer, "matrix_bytes": matrices, "levels": levels, "rays": done.transfer_rays, "seconds": done.transfer_seconds,
        },
        "visibility": {
            "maps": count, "bytes": maps, "raw_bytes": raw, "rays": done.sun_rays,
            "seconds": done.sun_seconds,
        },
    });
    Report::new(text, json)
}

/// What each level of detail keeps, and how far it is from the vertices' own vectors.
fn level_table(light: &Light, errors: &[LevelError]) -> Table {
    let mut table = Table::new(&["level", "edge m", "vertices", "size", "bias %", "RMSE %"]);
    for (number, (stored, error)) in light.transfer.iter().zip(errors).enumerate() {
        let percent = |v: f64| format!("{:.2}", 100.0 * v);
        table.row(&[
            &number.to_string(),
            &format!("{:.3}", error.edge),
            &error.vertices.to_string(),
            &human_bytes(stored.bytes.len() as u64),
            &percent(error.bias),
            &percent(error.rmse),
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_tells_share_rate_and_rest() {
        let told = progress(("transfer", "paths"), 250, 1000, 25.0);
        assert_eq!(told, "transfer 25 %, 25.0 paths/s, 30 s left");
        let told = progress(("visibility", "maps"), 0, 0, 2.5e6);
        assert_eq!(told, "visibility 0 %, 2.5 Mmaps/s, 0 s left");
    }
}
