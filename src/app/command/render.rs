//! `umbrage render`: a picture, or a sheet of views side by side and models below each other.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::recipe::Recipe;
use super::redraw;
use crate::app::animation::Animation;
use crate::app::cli::RenderArgs;
use crate::app::input::Source;
use crate::app::output::{PendingFile, check_apart, check_ending};
use crate::app::prepared::Prepared;
use crate::app::settings::picture_settings;
use crate::app::timing::Timings;
use crate::app::{Context, Report, console};
use crate::foliage::{Bake, Surface, Surfaced};
use crate::gpu::Gpu;
use crate::render::plan::human_bytes;
use crate::render::planned::PlannedImage;
use crate::render::{
    self, Baked, FieldGrid, Picture, Plan, RenderSettings, Renderer, Subject, SurfaceMesh, View,
};
use crate::{Error, Result};

/// Draws the picture.
///
/// # Errors
/// Wrong input or settings, an unwritable output, a failing device.
pub fn run(context: &Context, args: &RenderArgs) -> Result<Report> {
    let mut files = args.inputs.iter().flat_map(|source| source.files(&[]));
    if let Some(path) = files.find(|path| redraw::drawing(path)) {
        if args.inputs.len() > 1 {
            return Err(Error::file(path, "a drawing is drawn again by itself"));
        }
        let again = redraw::read(path, &Recipe::given(), &args.output)?;
        return super::render_paper::run(context, &again.args, again.style, again.recipe);
    }
    args.ink.check_style()?;
    if !args.lit.lighting.is_empty() {
        return super::render_lit::run(context, args);
    }
    if args.ink.style.is_some() {
        return super::render_ink::run(context, args);
    }
    super::paper_kind::no_vectors(&args.output, None)?;
    if let Some(animation) = Animation::new(&args.motion, &args.output)? {
        return frames(context, args, animation);
    }
    picture_settings(None, &args.picture)?;
    check_ending(&args.output, &["png", "jpg", "jpeg"])?;
    for source in &args.inputs {
        check_apart(&args.output, source.files(&args.model.textures))?;
    }
    let output = PendingFile::create(&args.output)?;
    let views: &[View] = if args.compare.is_empty() {
        std::slice::from_ref(&args.view)
    } else {
        &args.compare
    };
    let mut timings = Timings::default();
    let mut pictures = Vec::new();
    let mut models = Vec::new();
    for source in &args.inputs {
        let drawn = draw(context, args, source, views, &mut timings)?;
        models.push(json!({ "model": drawn.name, "device_bytes": drawn.device_bytes }));
        for (view, picture) in views.iter().zip(drawn.pictures) {
            let label = if args.inputs.len() > 1 {
                format!("{}, {view}", drawn.name)
            } else {
                view.to_string()
            };
            pictures.push((label, picture));
        }
    }
    let picture = match <[_; 1]>::try_from(pictures) {
        Ok([(_, picture)]) => picture,
        Err(pictures) => render::sheet(&pictures, views.len()),
    };
    let bytes = timings.measure("encode", || encode(&picture, output.path()))?;
    output.commit(&bytes)?;
    Ok(report(context, args, &picture, models, &timings))
}

/// Draws a view from every place on a way.
fn frames(context: &Context, args: &RenderArgs, animation: Animation) -> Result<Report> {
    let [source] = args.inputs.as_slice() else {
        return Err(Error::usage("--camera-path: takes one model"));
    };
    let mut timings = Timings::default();
    let view = args.view;
    let prepared = Prepared::new(source, &args.model, &args.settings, &mut timings)?;
    let settings = picture_settings(prepared.input.scene.as_ref(), &args.picture)?;
    let path = animation.path(&prepared.geometry, &settings)?;
    let baked = if view.needs_bake() {
        Some(prepared.bake(context, &mut timings)?.bake)
    } else {
        None
    };
    let found = field(context, &prepared, &[view], &mut timings)?;
    let mut subject = subject(&prepared, baked.as_ref());
    if let Some(found) = &found {
        show_field(&mut subject, found);
    }
    let gpu = context.gpu()?;
    let files = animation.write(&path, |frame| {
        let settings = RenderSettings {
            pose: Some(path.pose(f64::from(frame))),
            ..settings
        };
        let plan = Plan::new(&subject, &settings, &[view])?;
        check_size(gpu, &settings, &plan)?;
        let mut renderer = Renderer::new(gpu, &subject, &settings, plan)?;
        let rendered = timings.measure("draw", || renderer.render_view(view))?;
        timings.add_passes(&rendered.passes);
        Ok(rendered.picture)
    })?;
    Ok(frames_report(
        context,
        &files,
        Drawn::Pixels(settings.size),
        &timings,
    ))
}

/// Size of what was drawn.
#[derive(Clone, Copy)]
pub(super) enum Drawn {
    /// Across and down.
    Pixels([u32; 2]),
    /// Width and height, millimetres.
    Paper([f64; 2]),
}

/// What was written of a way.
pub(super) fn frames_report(
    context: &Context,
    files: &[PathBuf],
    drawn: Drawn,
    timings: &Timings,
) -> Report {
    let said = match drawn {
        Drawn::Pixels([w, h]) => format!("{w}x{h}"),
        Drawn::Paper([w, h]) => format!("{w} x {h} mm"),
    };
    let mut text = match files {
        [] => String::new(),
        [one] => format!("{}: {said}\n", one.display()),
        [first, .., last] => format!(
            "{} to {}: {} frames, {said}\n",
            first.display(),
            last.display(),
            files.len()
        ),
    };
    if context.timings() {
        text += &format!("\n{}", timings.table());
    }
    let times = timings.json();
    let json = match drawn {
        Drawn::Pixels([w, h]) => {
            json!({ "frames": files, "width": w, "height": h, "times": times })
        }
        Drawn::Paper(paper) => json!({ "frames": files, "paper_mm": paper, "times": times }),
    };
    Report::new(text, json)
}

/// All views of one input.
struct Views {
    name: String,
    pictures: Vec<Picture>,
    device_bytes: u64,
}

fn draw(
    context: &Context,
    args: &RenderArgs,
    source: &Source,
    views: &[View],
    timings: &mut Timings,
) -> Result<Views> {
    let prepared = Prepared::new(source, &args.model, &args.settings, timings)?;
    let settings = picture_settings(prepared.input.scene.as_ref(), &args.picture)?;
    let baked = if views.iter().any(|v| v.needs_bake()) {
        Some(prepared.bake(context, timings)?.bake)
    } else {
        None
    };
    let found = field(context, &prepared, views, timings)?;
    let mut subject = subject(&prepared, baked.as_ref());
    if let Some(found) = &found {
        show_field(&mut subject, found);
    }
    let plan = Plan::new(&subject, &settings, views)?;
    let device_bytes = plan.bytes();
    let gpu = context.gpu()?;
    check_size(gpu, &settings, &plan)?;
    let _working = console::working("drawing");
    let mut renderer =
        timings.measure("upload", || Renderer::new(gpu, &subject, &settings, plan))?;
    let mut pictures = Vec::new();
    for &view in views {
        let rendered = timings.measure("draw", || renderer.render_view(view))?;
        timings.add_passes(&rendered.passes);
        pictures.push(rendered.picture);
    }
    Ok(Views {
        name: prepared.input.model.name.clone(),
        pictures,
        device_bytes,
    })
}

/// Says which option asks for more than the device has, before anything is allocated.
fn check_size(gpu: &Gpu, settings: &RenderSettings, plan: &Plan) -> Result<()> {
    let (name, limits) = (&gpu.info().name, &gpu.info().limits);
    let [w, h] = settings.size;
    let side = limits.max_image_2d;
    if w.max(h) > side {
        return Err(Error::Unsupported(format!(
            "--size {w}x{h}: {name} draws pictures of up to {side}x{side} pixels"
        )));
    }
    let most = limits.max_allocation.min(limits.device_memory);
    let targets = plan.images.iter().filter(|i| i.extent == settings.size);
    match targets.map(PlannedImage::bytes).max() {
        Some(bytes) if bytes > most => Err(Error::Unsupported(format!(
            "--size {w}x{h} with --samples {}: one target takes {}, {name} allocates at most {}",
            settings.samples,
            human_bytes(bytes),
            human_bytes(most)
        ))),
        _ => Ok(()),
    }
}

/// The surface and its grid, where a view shows them.
pub(super) fn field(
    context: &Context,
    prepared: &Prepared,
    views: &[View],
    timings: &mut Timings,
) -> Result<Option<Surfaced>> {
    let wants = |test: fn(View) -> bool| views.iter().any(|&v| test(v));
    if !wants(View::needs_field) && !wants(View::needs_surface) {
        return Ok(None);
    }
    let gpu = context.gpu()?;
    let split = prepared.split()?;
    let (geometry, settings) = (&prepared.geometry, &prepared.settings);
    let find = if wants(View::needs_field) {
        Surface::compute_with_density
    } else {
        Surface::compute
    };
    let found = timings.measure("surface", || {
        find(gpu, geometry, &split, settings, &mut |_, _| {})
    })?;
    timings.add_passes(&found.times);
    Ok(Some(found))
}

/// Gives the renderer a surface and its grid.
pub(super) fn show_field<'a>(subject: &mut Subject<'a>, found: &'a Surfaced) {
    let surface = &found.surface;
    subject.surface = Some(SurfaceMesh {
        positions: &surface.positions,
        normals: &surface.normals,
        indices: &surface.indices,
    });
    subject.field = found.density.as_ref().map(|grid| FieldGrid {
        min: grid.min,
        cell: grid.cell,
        nodes: grid.nodes,
        values: &grid.values,
        tau: found.stats.tau,
    });
}

/// What the renderer is given: the model and, if there is one, its bake.
pub(super) fn subject<'a>(prepared: &'a Prepared, bake: Option<&'a Bake>) -> Subject<'a> {
    Subject {
        baked: bake.map(|bake| Baked {
            normals: &bake.normals,
            ambient: &bake.ambient,
            foliage_parts: &bake.foliage_parts,
        }),
        ..Subject::new(&prepared.input.model, &prepared.geometry)
    }
}

/// PNG, or JPEG where the name says so.
pub(in crate::app) fn encode(picture: &Picture, path: &Path) -> Result<Vec<u8>> {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    if extension == "jpg" || extension == "jpeg" {
        picture.to_jpeg()
    } else {
        picture.to_png()
    }
}

fn report(
    context: &Context,
    args: &RenderArgs,
    picture: &Picture,
    models: Vec<Value>,
    timings: &Timings,
) -> Report {
    let Picture { width, height, .. } = picture;
    let mut text = format!("{}: {width}x{height}\n", args.output.display());
    if context.timings() {
        text += &format!("\n{}", timings.table());
    }
    let json = json!({
        "output": args.output, "width": width, "height": height, "models": models,
        "times": timings.json(),
    });
    Report::new(text, json)
}
