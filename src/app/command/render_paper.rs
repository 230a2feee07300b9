//! `umbrage render --style` with a style of drawings on paper: a bitmap at once, or vectors (SVG).

use std::path::Path;

use glam::Vec3;
use serde_json::json;

use super::paper_kind::{
    self, Kind, chosen_size, counted, ends_in, is_vectors, tell_blank, tell_unused,
};
use super::recipe::Recipe;
use super::redraw;
use super::render::{Drawn, encode, frames_report};
use super::render_ink::reduced_pixels;
use crate::app::animation::Animation;
use crate::app::cli::RenderArgs;
use crate::app::output::{PendingFile, check_apart, check_ending};
use crate::app::prepared::Prepared;
use crate::app::settings::picture_settings;
use crate::app::timing::Timings;
use crate::app::{Context, Report, console};
use crate::foliage::{Leaves, Primitive, Split};
use crate::gpu::Gpu;
use crate::ink::leaves::{LeafTriangles, leaves};
use crate::ink::paper::anchored::cell_of;
use crate::ink::paper::drawing::{Order, sort, traced};
use crate::ink::paper::fit::FitSettings;
use crate::ink::paper::laid::{lay, strokes_of};
use crate::ink::paper::particles::{Particle, ground, particles, shadows_on_ground};
use crate::ink::paper::pdf::pdf;
use crate::ink::paper::progress::{Tell, quiet};
use crate::ink::paper::renderer::{Bitmap, Maps, PaperRenderer, PaperScene};
use crate::ink::paper::stems::{Told, drawn_stems, known_orders};
use crate::ink::paper::style::{PaperStyle, ShadowForm};
use crate::ink::paper::svg::{Drawing, Layer};
use crate::ink::paper::vectors::StrokePlaces;
use crate::ink::view::View;
use crate::render::RenderSettings;
use crate::scene::{Camera, Lens};
use crate::{Error, Result};

/// Files that drawings are written as.
const ENDINGS: [&str; 5] = ["svg", "pdf", "png", "jpg", "jpeg"];

/// What is drawn, ready for the device.
pub(super) struct Subject {
    prepared: Prepared,
    stems: Vec<u32>,
    told: Told,
    particles: Vec<Particle>,
    leaves: usize,
    /// Places of the ground that are to be seen.
    shadows: Vec<Vec3>,
}

/// Leaves or cards of foliage that make no crown.
const FEW: usize = 100;

/// Draws the model on paper; vectors hold the `recipe`.
///
/// # Errors
/// Wrong input, style or settings, a failing device.
pub(super) fn run(
    context: &Context,
    args: &RenderArgs,
    mut style: PaperStyle,
    recipe: Recipe,
) -> Result<Report> {
    args.ink.check_paper()?;
    tell_unused(&Recipe::given(), &args.output);
    args.ink.change(&mut style)?;
    picture_settings(None, &args.picture)?;
    check_ending(&args.output, &ENDINGS)?;
    let [source] = args.inputs.as_slice() else {
        return Err(Error::usage("--style: takes one model"));
    };
    check_apart(&args.output, source.files(&args.model.textures))?;
    let animation = Animation::of_files(&args.motion, &args.output, &ENDINGS)?;
    let output = match animation {
        Some(_) => None,
        None => Some(PendingFile::create(&args.output)?),
    };
    let mut timings = Timings::default();
    let prepared = Prepared::new(source, &args.model, &args.settings, &mut timings)?;
    let settings = picture_settings(prepared.input.scene.as_ref(), &args.picture)?;
    let size = chosen_size(prepared.input.scene.as_ref(), args, &settings);
    if settings.sun.direction().y <= 0.0 && style.shadow.form != ShadowForm::None {
        log::warn!("the sun is below the horizon: no shadow is drawn");
        style.shadow.form = ShadowForm::None;
    }
    let subject = subject(prepared, (&style, &settings), &mut timings)?;
    if let Some(animation) = animation {
        let kind = Kind::of(args, recipe, size);
        return frames(
            context,
            kind,
            style,
            (&subject, &settings),
            animation,
            timings,
        );
    }
    let _working = console::working(format!("drawing {} particles", subject.particles.len()));
    let kind = Kind::of(args, recipe, size);
    let board = Board::new(context, kind, style, &subject, &mut timings)?;
    let view = subject.view(&settings, board.size, None);
    let (bytes, report) = board.draw(&view, None, &args.output, &mut timings)?;
    if let Some(output) = output {
        output.commit(&bytes)?;
    }
    let mut text = format!(
        "{}: {}, {}, branches by {}\n",
        args.output.display(),
        report.0,
        counted(subject.particles.len(), "primitive"),
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

/// Particles of the foliage; what the style wants and the model has not is told.
fn foliage(prepared: &Prepared, split: &Split, style: &PaperStyle) -> Result<Vec<Particle>> {
    let (model, geometry) = (&prepared.input.model, &prepared.geometry);
    let indices = &split.foliage_indices;
    if indices.is_empty() {
        if style.foliage.draw || style.foliage.hides {
            log::warn!(
                "{}: no foliage was found: branches alone are drawn (--foliage REGEX tells what is \
                 foliage)",
                model.name
            );
        }
        return Ok(Vec::new());
    }
    let found = Leaves::new(&geometry.positions, indices, Primitive::Leaf);
    let triangles = LeafTriangles {
        indices,
        first: &found.first,
        triangles: &found.triangles,
    };
    let (found, _) = leaves(model, geometry, triangles);
    let particles = particles(&found, style.primitive.count, style.seed)?;
    // A count of 0 is as many as there are.
    let wanted = style.primitive.count as usize;
    if particles.len() < FEW && (wanted == 0 || particles.len() < wanted) {
        log::warn!(
            "{}: its foliage is {}, each drawn as one primitive: too few for a crown",
            model.name,
            counted(particles.len(), "piece")
        );
    }
    Ok(particles)
}

/// What is drawn of a model: its wood up to the style's order, its foliage as particles, the ground.
///
/// # Errors
/// A pattern that no foliage has, a leaf whose place is no number.
pub(super) fn subject(
    prepared: Prepared,
    (style, settings): (&PaperStyle, &RenderSettings),
    timings: &mut Timings,
) -> Result<Subject> {
    let split = prepared.split_or_bare()?;
    let geometry = &prepared.geometry;
    let particles = timings.measure("particles", || foliage(&prepared, &split, style))?;
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
    let mut particles = particles;
    if !style.foliage.draw && !style.foliage.hides {
        particles.clear();
    }
    let leaves = particles.len();
    particles.extend(ground(&geometry.positions, &style.ground, style.seed));
    let to_sun = settings.sun.direction().as_vec3();
    let shadows = shadows_on_ground(&geometry.positions, &style.ground, to_sun);
    Ok(Subject {
        prepared,
        stems,
        told,
        particles,
        leaves,
        shadows,
    })
}

impl Subject {
    /// How many particles are drawn.
    pub(super) fn primitives(&self) -> usize {
        self.particles.len()
    }

    fn scene(&self) -> PaperScene<'_> {
        PaperScene {
            geometry: &self.prepared.geometry,
            stems: &self.stems,
            particles: &self.particles,
            leaves: self.leaves,
        }
    }

    /// Everything that is seen whole: the plants, and what lies in their shadow.
    fn points(&self) -> impl Iterator<Item = Vec3> + Clone {
        let plants = self.prepared.geometry.positions.iter();
        plants.chain(&self.shadows).copied()
    }

    /// From `camera`, or from where the settings say.
    pub(super) fn view(
        &self,
        settings: &RenderSettings,
        size: [u32; 2],
        camera: Option<Camera>,
    ) -> View {
        let geometry = &self.prepared.geometry;
        let camera = camera.unwrap_or_else(|| {
            let lens = lens(settings, size);
            Camera::new(&settings.camera, lens, geometry.origin, self.points())
        });
        let to_sun = settings.sun.direction().as_vec3();
        View::new(camera, geometry.origin, size, to_sun, &geometry.positions)
    }
}

fn lens(settings: &RenderSettings, size: [u32; 2]) -> Lens {
    Lens {
        fov: settings.fov,
        aspect: f64::from(size[0]) / f64::from(size[1]),
        margin: settings.margin,
    }
}

/// Draws and writes the frames along the camera's way. Primitives keep the size that they have
/// where the way begins, and strokes of hatching the places on what they lie on.
fn frames(
    context: &Context,
    kind: Kind<'_>,
    mut style: PaperStyle,
    (subject, settings): (&Subject, &RenderSettings),
    animation: Animation,
    mut timings: Timings,
) -> Result<Report> {
    style.vector.strokes = StrokePlaces::Anchored;
    let mut board = Board::new(context, kind, style, subject, &mut timings)?;
    let (lens, origin) = (lens(settings, board.size), subject.prepared.geometry.origin);
    let path = animation.path_about(&settings.camera, lens, origin, subject.points())?;
    let size = board.size;
    let at = |frame: u32| {
        let camera = path.camera(f64::from(frame), lens.aspect, origin, subject.points());
        subject.view(settings, size, Some(camera))
    };
    let start = at(0);
    let [nearest, farthest] = start.depths;
    if board.style.vector.cell <= 0.0 {
        board.style.vector.cell = cell_of(&start);
    }
    let files = animation.write_bytes(&path, |frame, file| {
        let mut view = at(frame);
        view.depths[1] = view.depths[0] + (farthest - nearest);
        Ok(board.draw(&view, Some(frame), file, &mut timings)?.0)
    })?;
    let drawn = match board.factor {
        Some(factor) => Drawn::Pixels(board.size.map(|s| s / factor)),
        None => Drawn::Paper(board.style.sheet.paper),
    };
    Ok(frames_report(context, &files, drawn, &timings))
}

/// The bytes of a file, and what to say of it in words and as JSON.
type Written = (Vec<u8>, (String, serde_json::Value));

/// What draws views of one subject into files of one kind.
pub(super) struct Board<'a> {
    renderer: PaperRenderer,
    style: PaperStyle,
    scene: PaperScene<'a>,
    /// Pixels in which lines are found.
    pub(super) size: [u32; 2],
    /// Of bitmaps: pixels for one of the picture.
    factor: Option<u32>,
    recipe: Recipe,
}

impl<'a> Board<'a> {
    /// For files of one kind.
    pub(super) fn new(
        context: &Context,
        kind: Kind<'_>,
        style: PaperStyle,
        subject: &'a Subject,
        timings: &mut Timings,
    ) -> Result<Self> {
        Self::on(context.gpu()?, kind, style, subject, timings)
    }

    /// On a device of one's own.
    pub(super) fn on(
        gpu: &Gpu,
        kind: Kind<'_>,
        mut style: PaperStyle,
        subject: &'a Subject,
        timings: &mut Timings,
    ) -> Result<Self> {
        // The whole picture is the part of the paper within the margins.
        let free = style.sheet.paper.map(|s| s - 2.0 * style.sheet.margin);
        let pixels = |s: f64| (s * style.sheet.resolution).round().max(1.0) as u32;
        let (size, factor) = if is_vectors(kind.output) {
            (free.map(pixels), None)
        } else {
            let size = kind.size.unwrap_or_else(|| free.map(pixels));
            if kind.size.is_some() {
                style.sheet.resolution = f64::from(size[0]) / free[0];
            }
            (size.map(|s| s * kind.factor), Some(kind.factor))
        };
        paper_kind::check_size(gpu, size, factor)?;
        let scene = subject.scene();
        let renderer =
            timings.measure("upload", || PaperRenderer::new(gpu, &scene, &style, size))?;
        Ok(Self {
            renderer,
            style,
            scene,
            size,
            factor,
            recipe: kind.recipe,
        })
    }

    /// The file of a view, which is `frame` of a sequence.
    ///
    /// # Errors
    /// Memory runs out or the device is lost.
    pub(super) fn draw(
        &self,
        view: &View,
        frame: Option<u32>,
        file: &Path,
        timings: &mut Timings,
    ) -> Result<Written> {
        match self.factor {
            Some(factor) => self.bitmap(view, (factor, frame), file, timings),
            None => self.vector(view, frame, file, timings),
        }
    }

    fn vector(
        &self,
        view: &View,
        frame: Option<u32>,
        file: &Path,
        timings: &mut Timings,
    ) -> Result<Written> {
        let style = &self.style;
        let maps = timings.measure("geometry and filter", || {
            self.renderer.maps(&self.scene, view)
        })?;
        timings.add_passes(&maps.passes);
        let mut found = timings.measure("trace", || traced(&maps, style, view, tell(frame)));
        let order = timings.measure("sort", || sort(&mut found, style));
        found.metadata = self.metadata(view, frame, file)?;
        let curves = FitSettings::within(style.sheet.tolerance);
        let fitted = timings.measure("fit", || {
            found.fitted_told(style.sheet.profile, &curves, tell(frame))
        });
        let bytes = timings.measure("write", || {
            if ends_in(file, "pdf") {
                pdf(&fitted)
            } else {
                fitted.text().into_bytes()
            }
        });
        let drawn = |l: &Layer| !l.strokes.is_empty() || !l.areas.is_empty();
        if !found.layers.iter().any(drawn) {
            tell_blank(file);
        }
        let told = told(&found, order);
        Ok((bytes, told))
    }

    /// What drew the file, for people and for drawing it again: the command line without the
    /// output, and the style in full; of a sequence the frame.
    fn metadata(&self, view: &View, frame: Option<u32>, file: &Path) -> Result<String> {
        let folder = file.parent().unwrap_or(Path::new(""));
        let recipe = self.recipe.clone().of_frame(frame);
        let (arguments, style) = redraw::held(recipe, self.style.clone(), folder)?;
        let c = &view.camera;
        let json = json!({
            "program": "umbrage", "version": env!("CARGO_PKG_VERSION"),
            "arguments": arguments,
            "style": style,
            "camera": { "eye": c.eye.to_array(), "forward": c.forward.to_array(), "fov": c.fov },
            "sun": view.to_sun.to_array(),
        });
        Ok(json.to_string())
    }

    fn bitmap(
        &self,
        view: &View,
        (factor, frame): (u32, Option<u32>),
        file: &Path,
        timings: &mut Timings,
    ) -> Result<Written> {
        let pixels = self.pixels(view, (factor, frame), timings)?;
        let picture = timings.measure("reduce", || reduced_pixels(self.size, &pixels, factor));
        if picture
            .rgba
            .chunks_exact(4)
            .all(|p| p == &picture.rgba[..4])
        {
            tell_blank(file);
        }
        let said = format!("{}x{}", picture.width, picture.height);
        let json = json!({ "width": picture.width, "height": picture.height });
        let bytes = if ends_in(file, "png") {
            let of_a_metre = (1000.0 * self.style.sheet.resolution).round() as u32;
            let metadata = self.metadata(view, frame, file)?;
            picture.to_png_with(of_a_metre, ("umbrage", &metadata))?
        } else {
            encode(&picture, file)?
        };
        Ok((bytes, (said, json)))
    }

    /// What lines are found in.
    pub(super) fn maps(&self, view: &View) -> Result<Maps> {
        self.renderer.maps(&self.scene, view)
    }

    /// Lines and strokes as pixels (RGBA, 16-bit floats, linear), `factor` for one of the picture.
    pub(super) fn pixels(
        &self,
        view: &View,
        (factor, frame): (u32, Option<u32>),
        timings: &mut Timings,
    ) -> Result<Vec<u8>> {
        let Bitmap {
            mut pixels,
            maps,
            passes,
        } = self.renderer.bitmap(&self.scene, view, factor)?;
        timings.add_passes(&passes);
        if let Some(maps) = maps {
            timings.measure("strokes", || {
                let style = &self.style;
                let scale = 1.0 / (style.sheet.resolution * f64::from(factor));
                let strokes = strokes_of(&maps, style, view, scale, tell(frame));
                for (ink, strokes) in strokes {
                    lay(&mut pixels, maps.size, &strokes, ink);
                }
            });
        }
        Ok(pixels)
    }
}

/// Who is told how far a drawing is: of a sequence its frames are told.
fn tell(frame: Option<u32>) -> Tell<'static> {
    if frame.is_some() {
        return &quiet;
    }
    &|stage, done, all| console::part(stage.words(), done, all)
}

fn told(drawing: &Drawing, order: Order) -> (String, serde_json::Value) {
    let content = drawing.content();
    let [w, h] = drawing.paper;
    let mut text = format!(
        "{w} x {h} mm, {} ({} closed), {:.1} m of line",
        counted(content.strokes, "stroke"),
        content.closed,
        content.length / 1000.0
    );
    if order.pen_up[0] > 0.0 {
        text += &format!(", {:.1} m with the pen up", order.pen_up[1] / 1000.0);
    }
    let layer =
        |l: &Layer| json!({ "number": l.number, "name": l.name, "strokes": l.strokes.len() });
    let json = json!({
        "paper_mm": drawing.paper, "strokes": content.strokes, "closed": content.closed,
        "length_mm": content.length, "pen_up_mm": { "before": order.pen_up[0], "after": order.pen_up[1] },
        "layers": drawing.layers.iter().map(layer).collect::<Vec<_>>(),
    });
    (text, json)
}
