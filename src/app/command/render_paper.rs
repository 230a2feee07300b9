//! `umbrage render --style` with a style of drawings on paper: a bitmap at once, or vectors (SVG).

use serde_json::json;

use super::redraw;
use super::render::encode;
use super::render_ink::reduced_pixels;
use crate::app::cli::RenderArgs;
use crate::app::output::{PendingFile, check_apart, check_ending};
use crate::app::prepared::Prepared;
use crate::app::settings::picture_settings;
use crate::app::timing::Timings;
use crate::app::{Context, Report, console};
use crate::foliage::{Leaves, Primitive};
use crate::ink::leaves::{LeafTriangles, leaves};
use crate::ink::paper::drawing::{Order, drawing};
use crate::ink::paper::fit::FitSettings;
use crate::ink::paper::laid::{lay, strokes_of};
use crate::ink::paper::particles::{Particle, ground, particles};
use crate::ink::paper::renderer::{Bitmap, PaperRenderer, PaperScene};
use crate::ink::paper::stems::{Told, drawn_stems, known_orders};
use crate::ink::paper::style::PaperStyle;
use crate::ink::paper::svg::Drawing;
use crate::ink::view::View;
use crate::math::colour::srgb_to_linear;
use crate::render::RenderSettings;
use crate::scene::{Camera, Lens};
use crate::{Error, Result};

/// Turns sharper than this stay corners in curves, radians.
const CORNER: f64 = 1.2;

/// What is drawn, ready for the device.
struct Subject {
    prepared: Prepared,
    stems: Vec<u32>,
    told: Told,
    particles: Vec<Particle>,
    leaves: usize,
}

/// Draws the model on paper.
///
/// # Errors
/// Wrong input, style or settings, a model without leaves, a failing device.
pub fn run(context: &Context, args: &RenderArgs, mut style: PaperStyle) -> Result<Report> {
    if args.motion.camera_path.is_some() {
        return Err(Error::usage(
            "--camera-path: styles on paper draw one picture; give a --camera",
        ));
    }
    args.ink.change(&mut style)?;
    picture_settings(None, &args.picture)?;
    check_ending(&args.output, &["svg", "png", "jpg", "jpeg"])?;
    let [source] = args.inputs.as_slice() else {
        return Err(Error::usage("--style: takes one model"));
    };
    check_apart(&args.output, source.files(&args.model.textures))?;
    let output = PendingFile::create(&args.output)?;
    let mut timings = Timings::default();
    let pattern = args.model.foliage.as_deref();
    let prepared = Prepared::new(
        source,
        &args.model.textures,
        pattern,
        &args.settings,
        &mut timings,
    )?;
    let settings = picture_settings(prepared.input.scene.as_ref(), &args.picture)?;
    let subject = subject(prepared, &style, &mut timings)?;
    let _working = console::working("drawing");
    let vectors = args
        .output
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("svg"));
    let (bytes, report) = if vectors {
        vector(context, &style, &subject, &settings, &mut timings)?
    } else {
        bitmap(context, args, style, &subject, &settings, &mut timings)?
    };
    output.commit(&bytes)?;
    let mut text = format!(
        "{}: {}, {} primitives, branches by {}\n",
        args.output.display(),
        report.0,
        subject.particles.len(),
        subject.told.words()
    );
    if context.timings() {
        text += &format!("\n{}", timings.table());
    }
    let mut json = report.1;
    json["output"] = json!(args.output);
    json["style"] = json!(args.ink.style);
    json["primitives"] = json!(subject.particles.len());
    json["branches"] = json!(subject.told.words());
    json["times"] = timings.json();
    Ok(Report::new(text, json))
}

fn subject(prepared: Prepared, style: &PaperStyle, timings: &mut Timings) -> Result<Subject> {
    let split = prepared.split()?;
    let geometry = &prepared.geometry;
    let particles = timings.measure("particles", || {
        let indices = &split.foliage_indices;
        let found = Leaves::new(&geometry.positions, indices, Primitive::Leaf);
        let triangles = LeafTriangles {
            indices,
            first: &found.first,
            triangles: &found.triangles,
        };
        let (found, _) = leaves(&prepared.input.model, geometry, triangles);
        particles(&found, style.primitive.count, style.seed)
    })?;
    let parts = geometry.parts.iter().enumerate();
    let wood: Vec<u32> = parts
        .filter(|(i, _)| !split.foliage_parts.get(*i).copied().unwrap_or(false))
        .flat_map(|(_, p)| &geometry.indices[p.index_range()])
        .copied()
        .collect();
    let (stems, told) = timings.measure("branches", || {
        let known = known_orders(&prepared.input.model, geometry, &split.foliage_parts);
        drawn_stems(&geometry.positions, wood, known, &style.stem)
    });
    let leaves = particles.len();
    let mut particles = particles;
    particles.extend(ground(&geometry.positions, &style.ground, style.seed));
    Ok(Subject {
        prepared,
        stems,
        told,
        particles,
        leaves,
    })
}

impl Subject {
    fn scene(&self) -> PaperScene<'_> {
        PaperScene {
            geometry: &self.prepared.geometry,
            stems: &self.stems,
            particles: &self.particles,
            leaves: self.leaves,
        }
    }

    fn view(&self, settings: &RenderSettings, size: [u32; 2]) -> View {
        let geometry = &self.prepared.geometry;
        let lens = Lens {
            fov: settings.fov,
            aspect: f64::from(size[0]) / f64::from(size[1]),
            margin: settings.margin,
        };
        // The ground is seen whole too.
        let ground = self.particles[self.leaves..].iter().map(|p| p.centre);
        let points = geometry.positions.iter().copied().chain(ground);
        let camera = Camera::new(&settings.camera, lens, geometry.origin, points);
        let to_sun = settings.sun.direction().as_vec3();
        View::new(camera, geometry.origin, size, to_sun, &geometry.positions)
    }
}

/// The bytes of the file, and what to say of it in words and as JSON.
type Written = (Vec<u8>, (String, serde_json::Value));

fn vector(
    context: &Context,
    style: &PaperStyle,
    subject: &Subject,
    settings: &RenderSettings,
    timings: &mut Timings,
) -> Result<Written> {
    let free = style.sheet.paper.map(|s| s - 2.0 * style.sheet.margin);
    let size = free.map(|s| (s * style.sheet.resolution).round().max(1.0) as u32);
    let view = subject.view(settings, size);
    let scene = subject.scene();
    let renderer = timings.measure("upload", || {
        PaperRenderer::new(context.gpu()?, &scene, style, size)
    })?;
    let maps = timings.measure("geometry and filter", || renderer.maps(&scene, &view))?;
    timings.add_passes(&maps.passes);
    let (mut found, order) = timings.measure("lines", || drawing(&maps, style, &view));
    found.metadata = metadata(style, &view)?;
    let curves = FitSettings {
        tolerance: style.sheet.tolerance,
        corner: CORNER,
    };
    let text = timings.measure("curves and file", || {
        found.text(style.sheet.profile, &curves)
    });
    Ok((text.into_bytes(), told(&found, order)))
}

fn told(drawing: &Drawing, order: Order) -> (String, serde_json::Value) {
    let content = drawing.content();
    let [w, h] = drawing.paper;
    let mut text = format!(
        "{w} x {h} mm, {} strokes ({} closed), {:.1} m of line",
        content.strokes,
        content.closed,
        content.length / 1000.0
    );
    if order.pen_up[0] > 0.0 {
        text += &format!(", {:.1} m with the pen up", order.pen_up[1] / 1000.0);
    }
    let layer = |l: &crate::ink::paper::svg::Layer| json!({ "number": l.number, "name": l.name, "strokes": l.strokes.len() });
    let json = json!({
        "paper_mm": drawing.paper, "strokes": content.strokes, "closed": content.closed,
        "length_mm": content.length, "pen_up_mm": { "before": order.pen_up[0], "after": order.pen_up[1] },
        "layers": drawing.layers.iter().map(layer).collect::<Vec<_>>(),
    });
    (text, json)
}

/// What drew the file, for people and for drawing it again: the command line without the output,
/// and the style in full.
fn metadata(style: &PaperStyle, view: &View) -> Result<String> {
    let style = toml::to_string(style).map_err(|e| Error::usage(format!("style: {e}")))?;
    let c = &view.camera;
    let json = json!({
        "program": "umbrage", "version": env!("CARGO_PKG_VERSION"),
        "arguments": redraw::arguments(std::env::args()),
        "style": style,
        "camera": { "eye": c.eye.to_array(), "forward": c.forward.to_array(), "fov": c.fov },
        "sun": view.to_sun.to_array(),
    });
    Ok(json.to_string())
}

fn bitmap(
    context: &Context,
    args: &RenderArgs,
    mut style: PaperStyle,
    subject: &Subject,
    settings: &RenderSettings,
    timings: &mut Timings,
) -> Result<Written> {
    // The whole picture is the part of the paper within the margins.
    let free = style.sheet.paper[0] - 2.0 * style.sheet.margin;
    style.sheet.resolution = f64::from(settings.size[0]) / free;
    let factor = args.ink.ink_supersample;
    let size = settings.size.map(|s| s * factor);
    let view = subject.view(settings, size);
    let scene = subject.scene();
    let renderer = timings.measure("upload", || {
        PaperRenderer::new(context.gpu()?, &scene, &style, size)
    })?;
    let Bitmap {
        mut pixels,
        maps,
        passes,
    } = renderer.bitmap(&scene, &view, factor)?;
    timings.add_passes(&passes);
    if let Some(maps) = maps {
        timings.measure("strokes", || {
            let scale = 1.0 / (style.sheet.resolution * f64::from(factor));
            let strokes = strokes_of(&maps, &style, scale);
            let ink = style.sheet.ink.map(srgb_to_linear);
            lay(&mut pixels, maps.size, &strokes, ink);
        });
    }
    let picture = timings.measure("reduce", || reduced_pixels(size, &pixels, factor));
    let said = format!("{}x{}", picture.width, picture.height);
    let json = json!({ "width": picture.width, "height": picture.height });
    Ok((encode(&picture, &args.output)?, (said, json)))
}
