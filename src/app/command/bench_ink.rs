//! `umbrage bench ink`: time per pass of styles, beside the photo-like picture in the same run.

use serde_json::{Value, json};

use super::render::subject;
use crate::Result;
use crate::app::cli::BenchArgs;
use crate::app::prepared::Prepared;
use crate::app::report::Table;
use crate::app::settings::picture_settings;
use crate::app::timing::Timings;
use crate::app::{Context, Report, console, drawing};
use crate::gpu::PassTime;
use crate::ink::mix::Mix;
use crate::ink::plant::Plant;
use crate::ink::renderer::InkRenderer;
use crate::math::stats::median;
use crate::render::{Plan, RenderSettings, Renderer, View};

/// Sizes that are timed where none is asked for.
const SIZES: [[u32; 2]; 2] = [[800, 600], [1920, 1080]];
/// Name of the photo-like picture in tables.
const PHOTO: &str = "photo-like";

/// What one kind of picture took at one size.
struct Row {
    name: String,
    size: [u32; 2],
    leaves: usize,
    passes: Timings,
    /// Sums over the passes of each frame, milliseconds.
    frames: Vec<f64>,
    /// The same without shadow maps, which a resting sun takes once.
    shadowless: Vec<f64>,
    /// The same without stage 1.
    stage2: Vec<f64>,
}

impl Row {
    fn add(&mut self, passes: &[PassTime]) {
        self.passes.add_passes(passes);
        let sum = |counts: &dyn Fn(&str) -> bool| -> f64 {
            let of = passes.iter().filter(|p| counts(&p.label));
            of.map(|p| p.nanoseconds as f64 * 1e-6).sum()
        };
        self.frames.push(sum(&|_| true));
        self.shadowless
            .push(sum(&|l| !["shadow map", "ink sun"].contains(&l)));
        self.stage2
            .push(sum(&|l| l.starts_with("ink") && !is_stage1(l)));
    }
}

/// Whether a pass grows with the scene.
fn is_stage1(label: &str) -> bool {
    [
        "ink stage 1",
        "ink frame",
        "ink clusters",
        "ink order",
        "ink sun",
    ]
    .iter()
    .any(|l| label.starts_with(l))
}

/// Draws frames of the photo-like picture and of every style in turn and tells what they took.
///
/// # Errors
/// Wrong input, style or settings, a failing device.
pub fn run(context: &Context, args: &BenchArgs) -> Result<Report> {
    let mixes = args
        .style
        .iter()
        .map(|name| Ok((name.clone(), Mix::named(name)?)))
        .collect::<Result<Vec<_>>>()?;
    let mut stages = Timings::default();
    let prepared = Prepared::new(
        &args.input.input,
        &args.input.model,
        &args.settings,
        &mut stages,
    )?;
    let settings = picture_settings(prepared.input.scene.as_ref(), &args.picture)?;
    let bake = prepared.bake(context, &mut stages)?.bake;
    let plants = mixes
        .iter()
        .map(|(_, mix)| drawing::plant(context, &prepared, Some(&bake), mix, &mut stages))
        .collect::<Result<Vec<Plant>>>()?;
    let chosen = args.picture.values().any(|(name, _)| name == "size");
    let sizes = if chosen {
        vec![settings.size]
    } else {
        SIZES.to_vec()
    };
    let mut rows = Vec::new();
    for size in sizes {
        let settings = RenderSettings { size, ..settings };
        let photo = subject(&prepared, Some(&bake));
        rows.extend(measure(
            context,
            args,
            (&prepared, &settings, &photo),
            (&mixes, &plants),
        )?);
    }
    report(context, args, &prepared, &rows, &stages)
}

/// Frames of all kinds at one size, one of each in every round, so that what else the machine does
/// falls on all of them.
fn measure(
    context: &Context,
    args: &BenchArgs,
    (prepared, settings, photo): (&Prepared, &RenderSettings, &crate::render::Subject<'_>),
    (mixes, plants): (&[(String, Mix)], &[Plant]),
) -> Result<Vec<Row>> {
    let gpu = context.gpu()?;
    let size = settings.size;
    let row = |name: &str, leaves| Row {
        name: name.to_owned(),
        size,
        leaves,
        passes: Timings::default(),
        frames: Vec::new(),
        shadowless: Vec::new(),
        stage2: Vec::new(),
    };
    let plan = Plan::new(photo, settings, &[View::Textured])?;
    let mut photo = Renderer::new(gpu, photo, settings, plan)?;
    let view = drawing::view(prepared, settings, None, 1);
    let mut rows = vec![row(PHOTO, plants.first().map_or(0, |p| p.leaves.len()))];
    let mut renderers = Vec::new();
    for ((name, mix), plant) in mixes.iter().zip(plants) {
        let scene = drawing::scene(prepared, plant);
        renderers.push((InkRenderer::new(gpu, &scene, mix, &view, 1)?, scene));
        rows.push(row(
            name,
            renderers
                .last()
                .map_or(0, |(r, s)| r.drawn_leaves(s, &view)),
        ));
    }
    let working = console::working("drawing");
    for round in 0..args.warm_up + args.runs {
        working.step(&format!(
            "{}x{}, frame {} of {}",
            size[0],
            size[1],
            round + 1,
            args.warm_up + args.runs
        ));
        photo.forget();
        let rendered = photo.render_view(View::Textured)?;
        let mut all = vec![rendered.passes];
        for (renderer, scene) in &renderers {
            all.push(renderer.draw(scene, &view)?.passes);
        }
        if round >= args.warm_up {
            rows.iter_mut()
                .zip(&all)
                .for_each(|(row, passes)| row.add(passes));
        }
    }
    Ok(rows)
}

fn report(
    context: &Context,
    args: &BenchArgs,
    prepared: &Prepared,
    rows: &[Row],
    stages: &Timings,
) -> Result<Report> {
    let device = context.gpu()?.info();
    let triangles = prepared.geometry.indices.len() / 3;
    let mut table = Table::new(&[
        "size",
        "picture",
        "leaves",
        "frame ms",
        "stage 2 ms",
        "to photo",
        "no shadows",
    ]);
    let mut text = format!(
        "ink of {}: {triangles} triangles, {} ({}), {} frames of each in turn after {} that do not count\n\n",
        args.input.input, device.name, device.driver, args.runs, args.warm_up
    );
    let mut found: Vec<Value> = Vec::new();
    for row in rows {
        let photo = rows.iter().find(|r| r.name == PHOTO && r.size == row.size);
        let ratio = |of: fn(&Row) -> &[f64]| {
            let pairs = photo.map_or(&[][..], of).iter().zip(of(row));
            median(&pairs.map(|(photo, own)| own / photo).collect::<Vec<_>>())
        };
        let ratios = [ratio(|r| &r.frames), ratio(|r| &r.shadowless)];
        let (frame, stage2) = (median(&row.frames), median(&row.stage2));
        let size = format!("{}x{}", row.size[0], row.size[1]);
        let second = if row.name == PHOTO {
            "-".to_owned()
        } else {
            format!("{stage2:.1}")
        };
        table.row(&[
            &size,
            &row.name,
            &row.leaves,
            &format!("{frame:.1}"),
            &second,
            &format!("{:.2}", ratios[0]),
            &format!("{:.2}", ratios[1]),
        ]);
        found.push(json!({
            "size": row.size, "picture": row.name, "leaves": row.leaves, "frame_ms": frame,
            "stage2_ms": stage2, "ratio_to_photo": ratios[0],
            "ratio_without_shadow_maps": ratios[1], "passes": row.passes.json(),
        }));
    }
    text += &table.to_string();
    for row in rows {
        let [w, h] = row.size;
        text += &format!("\n{}, {w}x{h}\n{}", row.name, row.passes.table());
    }
    text += &format!("\n{}", stages.table());
    let json = json!({
        "bench": "ink", "model": args.input.input.to_string(), "triangles": triangles,
        "device": device.name, "runs": args.runs, "rows": found, "stages": stages.json(),
        "version": env!("CARGO_PKG_VERSION"),
    });
    Ok(Report::new(text, json))
}
