//! What `umbrage render --style` shows beside one picture: the way between two styles, and
//! attributes.

use serde_json::json;

use super::render::encode;
use super::render_ink::reduced;
use crate::app::cli::RenderArgs;
use crate::app::cli::ink::InkArgs;
use crate::app::output::{PendingFile, check_apart, check_ending};
use crate::app::prepared::Prepared;
use crate::app::settings::picture_settings;
use crate::app::timing::Timings;
use crate::app::{Context, Report, console, drawing};
use crate::foliage::Bake;
use crate::ink::blend;
use crate::ink::mix::Mix;
use crate::ink::mix::short;
use crate::ink::paper::style::PaperStyle;
use crate::ink::plan::InkPlan;
use crate::ink::renderer::{InkRenderer, InkScene};
use crate::ink::style::Style;
use crate::ink::view::View;
use crate::render::{self, Picture};
use crate::scene::{Camera, Lens};
use crate::{Error, Result};

/// Whether [`run`] draws what is asked for.
pub(super) fn wanted(args: &InkArgs) -> bool {
    args.toward.is_some() || args.ink_view.is_some()
}

/// One picture, or a sheet of places on the way between two styles.
///
/// # Errors
/// Wrong input, style or settings, an attribute that a style has not, a failing device.
pub(super) fn run(context: &Context, args: &RenderArgs) -> Result<Report> {
    let named = args.ink.style.as_deref().unwrap_or_default();
    let styles = styles(&args.ink, named)?;
    if let Some(view) = args.ink.ink_view {
        for (_, style) in &styles {
            view.check(named, style).map_err(Error::usage)?;
        }
    }
    picture_settings(None, &args.picture)?;
    check_ending(&args.output, &["png", "jpg", "jpeg"])?;
    let [source] = args.inputs.as_slice() else {
        return Err(Error::usage("--style: takes one model"));
    };
    check_apart(&args.output, source.files(&args.model.textures))?;
    let output = PendingFile::create(&args.output)?;
    let mut timings = Timings::default();
    let prepared = Prepared::new(source, &args.model, &args.settings, &mut timings)?;
    // Without leaves there is nothing to bake; styles for leaves will say so.
    let leafy = !prepared.split_with_or_without()?.foliage_indices.is_empty();
    let baked = if leafy && styles.iter().any(|s| InkPlan::new(&s.1).crown) {
        Some(prepared.bake(context, &mut timings)?.bake)
    } else {
        None
    };
    let _working = console::working("drawing");
    let mut pictures = Vec::new();
    for (label, style) in &styles {
        let what = (&prepared, baked.as_ref(), style);
        pictures.push((label.clone(), draw(context, args, what, &mut timings)?));
    }
    let picture = match <[_; 1]>::try_from(pictures) {
        Ok([(_, picture)]) => picture,
        Err(pictures) => render::sheet(&pictures, 0),
    };
    output.commit(&encode(&picture, &args.output)?)?;
    let Picture { width, height, .. } = picture;
    let mut text = format!("{}: {width}x{height}\n", args.output.display());
    if context.timings() {
        text += &format!("\n{}", timings.table());
    }
    let json = json!({
        "output": args.output, "style": named, "toward": args.ink.toward, "share": args.ink.share,
        "view": args.ink.ink_view.map(|v| v.name()), "width": width, "height": height,
        "times": timings.json(),
    });
    Ok(Report::new(text, json))
}

/// The styles to draw, with their labels.
fn styles(args: &InkArgs, named: &str) -> Result<Vec<(String, Style)>> {
    let from = Style::named(named)?;
    let Some(toward) = &args.toward else {
        return Ok(vec![(named.to_owned(), from)]);
    };
    if PaperStyle::named(toward)?.is_some() {
        return Err(Error::usage(format!(
            "--toward {toward}: draws on paper; the way goes between styles of pictures in real time"
        )));
    }
    let to = Style::named(toward)?;
    let one = |&share: &f32| {
        if !(0.0..=1.0).contains(&share) {
            return Err(Error::usage(format!("--share {share}: expected 0 to 1")));
        }
        let style = blend::between(&from, &to, share)
            .map_err(|e| Error::usage(format!("--toward {toward}: {e}")))?;
        let label = match share {
            0.0 => short(named),
            1.0 => short(toward),
            _ => format!("{share}"),
        };
        Ok((label, style))
    };
    args.share.iter().map(one).collect()
}

fn draw(
    context: &Context,
    args: &RenderArgs,
    (prepared, baked, style): (&Prepared, Option<&Bake>, &Style),
    timings: &mut Timings,
) -> Result<Picture> {
    let settings = picture_settings(prepared.input.scene.as_ref(), &args.picture)?;
    let (model, geometry) = (&prepared.input.model, &prepared.geometry);
    let mix = Mix::single(style.clone());
    let plant = drawing::plant(context, prepared, baked, &mix, timings)?;
    // A mean of two numbers of objects is no object.
    let factor = match args.ink.ink_view {
        Some(_) => 1,
        None => args.ink.ink_supersample,
    };
    let size = settings.size.map(|s| s * factor);
    let lens = Lens {
        fov: settings.fov,
        aspect: f64::from(size[0]) / f64::from(size[1]),
        margin: settings.margin,
    };
    let points = geometry.positions.iter().copied();
    let camera = Camera::new(&settings.camera, lens, geometry.origin, points);
    let to_sun = settings.sun.direction().as_vec3();
    let view = View::new(camera, geometry.origin, size, to_sun, &geometry.positions);
    let scene = InkScene {
        model,
        geometry,
        plant: &plant,
    };
    let renderer = timings.measure("upload", || {
        InkRenderer::new(context.gpu()?, &scene, &mix, &view, factor)
    })?;
    let Some(which) = args.ink.ink_view else {
        let drawing = renderer.draw(&scene, &view)?;
        timings.add_passes(&drawing.passes);
        return Ok(reduced(&drawing, factor));
    };
    Ok(Picture {
        width: size[0],
        height: size[1],
        rgba: renderer.show(&scene, &view, which)?,
    })
}
