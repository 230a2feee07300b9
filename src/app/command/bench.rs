//! `umbrage bench`: time per pass on the device and per stage on the CPU.

use std::time::Instant;

use serde_json::{Value, json};

use crate::Result;
use crate::app::cli::{BenchArgs, BenchWhat};
use crate::app::prepared::Prepared;
use crate::app::settings::picture_settings;
use crate::app::timing::Timings;
use crate::app::{Context, Report, console};
use crate::foliage::bake::Bake;
use crate::gpu::{DeviceInfo, PassTime};
use crate::render::plan::human_bytes;
use crate::render::{Plan, Renderer};

/// Times the bake or a frame.
///
/// # Errors
/// Wrong input or settings, a failing device.
pub fn run(context: &Context, args: &BenchArgs) -> Result<Report> {
    match args.what {
        BenchWhat::Light => return super::bench_light::run(context, args),
        BenchWhat::Rays => return super::bench_rays::run(context, args),
        BenchWhat::Ink => return super::bench_ink::run(context, args),
        BenchWhat::Paper => return super::bench_paper::run(context, args),
        BenchWhat::Coherence => return crate::app::coherence::run(context, args),
        BenchWhat::Bake | BenchWhat::Render => {}
    }
    let mut stages = Timings::default();
    let prepared = Prepared::new(
        &args.input.input,
        &args.input.model,
        &args.settings,
        &mut stages,
    )?;
    let measured = match args.what {
        BenchWhat::Bake => bench_bake(context, args, &prepared, &mut stages)?,
        BenchWhat::Render => bench_render(context, args, &prepared, &mut stages)?,
        _ => unreachable!("have commands of their own"),
    };
    Ok(report(
        args,
        &prepared,
        &stages,
        &measured,
        context.gpu()?.info(),
    ))
}

/// What the runs took.
#[derive(Debug, Default)]
struct Measured {
    /// Per pass, one sample a run.
    passes: Timings,
    /// Sum over the passes of a run, and wall time of a run.
    totals: Timings,
    /// What is allocated on the device.
    bytes: u64,
}

impl Measured {
    /// Adds a run: passes of one label count as one.
    fn add(&mut self, passes: &[PassTime], wall_ms: f64) {
        let mut sums: Vec<(&PassTime, u64)> = Vec::new();
        for pass in passes {
            let same = |s: &&mut (&PassTime, u64)| s.0.label == pass.label;
            match sums.iter_mut().find(same) {
                Some(sum) => sum.1 += pass.nanoseconds,
                None => sums.push((pass, pass.nanoseconds)),
            }
        }
        for (pass, nanoseconds) in &sums {
            let ms = *nanoseconds as f64 * 1e-6;
            self.passes.add(&pass.label, pass.queue, ms);
        }
        let device: u64 = sums.iter().map(|s| s.1).sum();
        self.totals
            .add("all passes", "device", device as f64 * 1e-6);
        self.totals.add("wall", "cpu", wall_ms);
    }
}

fn bench_bake(
    context: &Context,
    args: &BenchArgs,
    prepared: &Prepared,
    stages: &mut Timings,
) -> Result<Measured> {
    let gpu = context.gpu()?;
    let split = stages.measure("split", || prepared.split())?;
    let mut measured = Measured::default();
    let working = console::working("baking");
    for run in 0..args.warm_up + args.runs {
        working.step(&format!("bake {} of {}", run + 1, args.warm_up + args.runs));
        let start = Instant::now();
        let geometry = &prepared.geometry;
        let model = &prepared.input.model;
        let settings = &prepared.settings;
        let baked = Bake::compute(gpu, model, geometry, &split, settings, &mut |_, _| {})?;
        if run >= args.warm_up {
            measured.add(&baked.times, start.elapsed().as_secs_f64() * 1e3);
        }
        measured.bytes = baked.recipe.bytes();
    }
    Ok(measured)
}

fn bench_render(
    context: &Context,
    args: &BenchArgs,
    prepared: &Prepared,
    stages: &mut Timings,
) -> Result<Measured> {
    let gpu = context.gpu()?;
    let settings = picture_settings(prepared.input.scene.as_ref(), &args.picture)?;
    let baked = if args.view.needs_bake() {
        Some(prepared.bake(context, &mut Timings::default())?.bake)
    } else {
        None
    };
    let found = super::render::field(context, prepared, &[args.view], stages)?;
    let mut subject = super::render::subject(prepared, baked.as_ref());
    if let Some(found) = &found {
        super::render::show_field(&mut subject, found);
    }
    let plan = stages.measure("plan", || Plan::new(&subject, &settings, &[args.view]))?;
    let mut measured = Measured {
        bytes: plan.bytes(),
        ..Measured::default()
    };
    let mut renderer =
        stages.measure("upload", || Renderer::new(gpu, &subject, &settings, plan))?;
    let working = console::working("drawing");
    for run in 0..args.warm_up + args.runs {
        working.step(&format!(
            "frame {} of {}",
            run + 1,
            args.warm_up + args.runs
        ));
        renderer.forget();
        let start = Instant::now();
        let rendered = renderer.render_view(args.view)?;
        if run >= args.warm_up {
            measured.add(&rendered.passes, start.elapsed().as_secs_f64() * 1e3);
        }
    }
    Ok(measured)
}

fn report(
    args: &BenchArgs,
    prepared: &Prepared,
    stages: &Timings,
    measured: &Measured,
    device: &DeviceInfo,
) -> Report {
    let geometry = &prepared.geometry;
    let (vertices, triangles) = (geometry.positions.len(), geometry.indices.len() / 3);
    let what = match args.what {
        BenchWhat::Bake => "bake",
        _ => "render",
    };
    let text = format!(
        "{what} of {}: {vertices} vertices, {triangles} triangles, {} on the device\n\
         {} ({} {}), vector width {}, {} runs after {} that do not count\n\n{}\n{}\n{}",
        args.input.input,
        human_bytes(measured.bytes),
        device.name,
        device.driver,
        device.driver_info,
        device.subgroup_size,
        args.runs,
        args.warm_up,
        measured.passes.table(),
        measured.totals.table(),
        stages.table(),
    );
    let device: Value = json!({
        "name": device.name, "driver": device.driver, "driver_info": device.driver_info,
        "vulkan": device.api_version, "vector_width": device.subgroup_size,
    });
    let json = json!({
        "bench": what, "model": args.input.input.to_string(), "vertices": vertices,
        "triangles": triangles, "device": device, "device_bytes": measured.bytes,
        "runs": args.runs, "warm_up": args.warm_up, "passes": measured.passes.json(),
        "totals": measured.totals.json(), "stages": stages.json(),
        "version": env!("CARGO_PKG_VERSION"),
    });
    Report::new(text, json)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_of_one_label_are_one_sample_a_run() {
        let pass = |label: &str, nanoseconds| PassTime {
            label: label.into(),
            queue: "compute",
            nanoseconds,
        };
        let mut measured = Measured::default();
        for _ in 0..3 {
            let passes = [
                pass("scan", 1_000_000),
                pass("emit", 500_000),
                pass("scan", 2_000_000),
            ];
            measured.add(&passes, 9.0);
        }
        let json = measured.passes.json();
        assert_eq!(json[0]["median_ms"], 3.0, "both scans together");
        assert_eq!(json[0]["samples"], 3, "one sample a run");
        assert_eq!(measured.totals.json()[0]["median_ms"], 3.5, "sum");
    }
}
