//! `umbrage render --style`: plants in pen and ink.

use serde_json::json;

use super::paper_kind::{no_vectors, tell_paper_only};
use super::recipe::Recipe;
use super::render::{Drawn, encode, frames_report};
use crate::app::animation::Animation;
use crate::app::cli::RenderArgs;
use crate::app::output::{PendingFile, check_apart, check_ending};
use crate::app::prepared::Prepared;
use crate::app::settings::picture_settings;
use crate::app::timing::Timings;
use crate::app::{Context, Report, console, drawing};
use crate::ink::mix::{Mix, MixPlan};
use crate::ink::motion::Track;
use crate::ink::paper::style::PaperStyle;
use crate::ink::renderer::{Drawing, InkRenderer, InkScene};
use crate::ink::view::View;
use crate::math::colour::linear_to_srgb8;
use crate::math::packing::f16_to_f32;
use crate::render::Picture;
use crate::scene::{Camera, Lens};
use crate::{Error, Result};

/// Draws the model in a style.
///
/// # Errors
/// Wrong input, style or settings, a model without leaves, a failing device.
pub fn run(context: &Context, args: &RenderArgs) -> Result<Report> {
    let named = args.ink.style.as_deref().unwrap_or_default();
    if let Some(paper) = PaperStyle::named(named)? {
        return super::render_paper::run(context, args, paper, Recipe::given());
    }
    no_vectors(&args.output, Some(named))?;
    tell_paper_only(&Recipe::given());
    if super::render_looks::wanted(&args.ink) {
        return super::render_looks::run(context, args);
    }
    let mut mix = Mix::named(named)?;
    picture_settings(None, &args.picture)?;
    check_ending(&args.output, &["png", "jpg", "jpeg"])?;
    let [source] = args.inputs.as_slice() else {
        return Err(Error::usage("--style: takes one model"));
    };
    check_apart(&args.output, source.files(&args.model.textures))?;
    let animation = Animation::new(&args.motion, &args.output)?;
    let output = match animation {
        Some(_) => None,
        None => Some(PendingFile::create(&args.output)?),
    };
    if animation.is_some() {
        // The eye may come nearer: the sun's map has all its texels in every frame.
        for style in &mut mix.styles {
            style.shading.shadow_pixels = 0.0;
        }
    }
    let mut timings = Timings::default();
    let prepared = Prepared::new(source, &args.model, &args.settings, &mut timings)?;
    let settings = picture_settings(prepared.input.scene.as_ref(), &args.picture)?;
    let plan = MixPlan::new(&mix);
    let split = if mix.styles[0].bodies.smooth {
        prepared.split_with_or_without()?
    } else {
        prepared.split()?
    };
    let baked = if plan.any(|s| s.crown) && !split.foliage_indices.is_empty() {
        Some(prepared.bake(context, &mut timings)?.bake)
    } else {
        None
    };
    let (model, geometry) = (&prepared.input.model, &prepared.geometry);
    let plant = drawing::plant(context, &prepared, baked.as_ref(), &mix, &mut timings)?;
    let factor = args.ink.ink_supersample;
    let size = settings.size.map(|s| s * factor);
    let lens = Lens {
        fov: settings.fov,
        aspect: f64::from(size[0]) / f64::from(size[1]),
        margin: settings.margin,
    };
    let points = geometry.positions.iter().copied();
    let path = match &animation {
        Some(animation) => Some(animation.path(geometry, &settings)?),
        None => None,
    };
    let camera = match &path {
        // Strokes have the style's size where a way begins, whichever frames are drawn.
        Some(path) => path.camera(0.0, lens.aspect, geometry.origin, points),
        None => Camera::new(&settings.camera, lens, geometry.origin, points),
    };
    let to_sun = settings.sun.direction().as_vec3();
    let view = View::new(camera, geometry.origin, size, to_sun, &geometry.positions);
    let scene = InkScene {
        model,
        geometry,
        plant: &plant,
    };
    let _working = console::working("drawing");
    let mut renderer = timings.measure("upload", || {
        InkRenderer::new(context.gpu()?, &scene, &mix, &view, factor)
    })?;
    if let (Some(animation), Some(path)) = (animation, path) {
        let mut track = Track::new(
            args.motion.hatch_mode.into(),
            drawing::centres(&plant, &mix),
        );
        let files = animation.write(&path, |frame| {
            let points = geometry.positions.iter().copied();
            let camera = path.camera(f64::from(frame), lens.aspect, geometry.origin, points);
            let view = View::new(camera, geometry.origin, size, to_sun, &geometry.positions);
            renderer.follow(track.at(frame, &view, |f| path.pose(f)));
            let drawing = renderer.draw(&scene, &view)?;
            timings.add_passes(&drawing.passes);
            Ok(reduced(&drawing, factor))
        })?;
        return Ok(frames_report(
            context,
            &files,
            Drawn::Pixels(settings.size),
            &timings,
        ));
    }
    let drawing = renderer.draw(&scene, &view)?;
    timings.add_passes(&drawing.passes);
    let picture = timings.measure("reduce", || reduced(&drawing, factor));
    if let Some(output) = output {
        output.commit(&encode(&picture, &args.output)?)?;
    }
    let cluster_count: usize = plant.clusters.iter().map(|set| set.len()).sum();
    let mut text = format!(
        "{}: {}x{}, {} leaves in {} clusters\n",
        args.output.display(),
        picture.width,
        picture.height,
        plant.leaves.len(),
        cluster_count
    );
    if context.timings() {
        text += &format!("\n{}", timings.table());
    }
    let json = json!({
        "output": args.output, "style": named, "styles": mix.names,
        "width": picture.width, "height": picture.height,
        "leaves": plant.leaves.len(), "clusters": cluster_count,
        "passes": plan.passes(), "image_bytes": plan.bytes(size), "times": timings.json(),
    });
    Ok(Report::new(text, json))
}

/// Means of `factor` x `factor` pixels, as sRGB.
pub(super) fn reduced(drawing: &Drawing, factor: u32) -> Picture {
    reduced_pixels(drawing.size, &drawing.pixels, factor)
}

/// Means of `factor` x `factor` pixels, as sRGB.
pub(super) fn reduced_pixels(size: [u32; 2], pixels: &[u8], factor: u32) -> Picture {
    let [width, height] = size.map(|s| s / factor);
    let row = size[0] as usize;
    let half = |at: usize| {
        let bytes = &pixels[2 * at..2 * at + 2];
        f16_to_f32(u16::from_le_bytes([bytes[0], bytes[1]]))
    };
    let mut rgba = Vec::with_capacity((width * height * 4) as usize);
    let samples = (factor * factor) as f32;
    for y in 0..height as usize {
        for x in 0..width as usize {
            let mut sum = [0.0_f32; 3];
            for k in 0..(factor * factor) as usize {
                let (fx, fy) = (k % factor as usize, k / factor as usize);
                let at = (y * factor as usize + fy) * row + x * factor as usize + fx;
                for (c, s) in sum.iter_mut().enumerate() {
                    *s += half(4 * at + c);
                }
            }
            rgba.extend(sum.map(|s| linear_to_srgb8(s / samples)));
            rgba.push(255);
        }
    }
    Picture {
        width,
        height,
        rgba,
    }
}
