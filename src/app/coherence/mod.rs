//! `umbrage bench coherence`: how well hatching stays on what it is drawn on, and how evenly it lies
//! on the screen, beside the two plain ways of hatching.

pub mod cooccurrence;
pub mod frames;
pub mod spectrum;

use glam::DVec2;
use serde_json::{Value, json};

use self::cooccurrence::Matrices;
use self::frames::{Frame, Moved, RINGS, compare};
use super::cli::BenchArgs;
use super::prepared::Prepared;
use super::report::Table;
use super::settings::picture_settings;
use super::timing::Timings;
use super::{Context, Report, console, drawing};
use crate::abi::InkCluster;
use crate::ink::mix::Mix;
use crate::ink::motion::{HatchMode, Track};
use crate::ink::plan::Attribute;
use crate::ink::plant::Plant;
use crate::ink::renderer::{Drawing, InkRenderer, InkScene};
use crate::ink::strokes::{Stroke, tile_of};
use crate::ink::style::{HatchSpace, Style};
use crate::ink::view::View;
use crate::math::colour::srgb_to_linear;
use crate::math::packing::f16_to_f32;
use crate::render::RenderSettings;
use crate::scene::camera_path::PathSpec;
use crate::scene::{CameraPath, CameraSpec};
use crate::{Error, Result};

/// Ways along which frames are compared: a degree a frame, rising and rolling; and towards the
/// plant by 3 % a frame.
const WAYS: [(&str, &str); 2] = [
    ("orbit", "orbit:turns=0.0611,rise=10,roll=15,frames=23"),
    ("dolly", "dolly:from=1.4,to=0.7,frames=23"),
];
/// Distances at which strokes are measured on the screen.
const FAR_TO_NEAR: &str = "dolly:from=2,to=0.5,frames=9";

/// A way of hatching that is measured.
struct Variant {
    name: &'static str,
    space: HatchSpace,
    levels: bool,
    mode: HatchMode,
}

/// Which of them hatches the screen.
const SCREEN: usize = 2;
const VARIANTS: [Variant; 5] = [
    Variant {
        name: "clusters",
        space: HatchSpace::Cluster,
        levels: true,
        mode: HatchMode::Replay,
    },
    Variant {
        name: "clusters, stateless",
        space: HatchSpace::Cluster,
        levels: true,
        mode: HatchMode::Stateless,
    },
    Variant {
        name: "screen",
        space: HatchSpace::Screen,
        levels: true,
        mode: HatchMode::Stateless,
    },
    Variant {
        name: "object",
        space: HatchSpace::Object,
        levels: false,
        mode: HatchMode::Stateless,
    },
    Variant {
        name: "object with levels",
        space: HatchSpace::Object,
        levels: true,
        mode: HatchMode::Stateless,
    },
];

/// What was measured of a variant.
struct Measured {
    name: &'static str,
    moved: Vec<(&'static str, Moved)>,
    /// Strokes on the screen, from far to near.
    strokes: Vec<Strokes>,
}

/// A number of them.
type Measure = fn(&Strokes) -> Option<f64>;

/// Strokes at one distance.
struct Strokes {
    /// Factor on the framing distance.
    away: f64,
    /// Pixels between them.
    spacing: Option<f64>,
    /// Their width, pixels.
    width: Option<f64>,
    /// Greys beside each other, within clusters.
    texture: Matrices,
}

/// Parts of the tile by which the screen's strokes are moved, to see what the same texture elsewhere
/// differs by.
const MOVED: [f32; 2] = [0.37, 0.61];

/// Largest over smallest of what was found.
fn change(found: impl Iterator<Item = Option<f64>>) -> f64 {
    let ends = |(l, h): (f64, f64), s: f64| (l.min(s), h.max(s));
    let (low, high) = found.flatten().fold((f64::INFINITY, 0.0), ends);
    high / low
}

/// The hatching of a style alone.
fn hatching_alone(mut style: Style, variant: &Variant) -> Style {
    // Ids are written for contours; so faint a line does not show.
    style.contour.strength = 1e-6;
    style.silhouette.strength = 0.0;
    style.shading.strength = 0.0;
    style.shading.colour = 0.0;
    style.hatching.strength = 1.0;
    style.hatching.space = variant.space;
    style.hatching.levels = variant.levels;
    style
}

/// With the strokes of its tile moved.
fn moved(mut style: Style) -> Result<Style> {
    let strokes = tile_of(&style)?.strokes;
    if strokes.is_empty() {
        return Err(Error::usage(
            "bench coherence: a painted tile has no strokes that could be moved",
        ));
    }
    let elsewhere = |s: &Stroke| {
        let mut listed = s.to_listed();
        for (at, by) in listed.iter_mut().zip(MOVED) {
            *at = (*at + by).fract();
        }
        listed
    };
    style.hatching.strokes = strokes.iter().map(elsewhere).collect();
    Ok(style)
}

/// Measures every way of hatching with the first style that is named.
///
/// # Errors
/// Wrong input, style or settings, a failing device.
pub fn run(context: &Context, args: &BenchArgs) -> Result<Report> {
    let named = args.style.first().map_or("silhouette-hatching", |s| s);
    let style = Style::named(named)?;
    if style.hatching.strength == 0.0 {
        return Err(Error::usage(format!("style `{named}`: does not hatch")));
    }
    let mut stages = Timings::default();
    let prepared = Prepared::new(
        &args.input.input,
        &args.input.model,
        &args.settings,
        &mut stages,
    )?;
    let settings = picture_settings(prepared.input.scene.as_ref(), &args.picture)?;
    let bake = prepared.bake(context, &mut stages)?.bake;
    let mix = Mix::single(style.clone());
    let plant = drawing::plant(context, &prepared, Some(&bake), &mix, &mut stages)?;
    let working = console::working("drawing");
    let mut found = Vec::new();
    for variant in &VARIANTS {
        working.step(variant.name);
        let style = hatching_alone(style.clone(), variant);
        let camera = Shots {
            context,
            prepared: &prepared,
            settings: &settings,
            plant: &plant,
            style: &style,
            mode: variant.mode,
        };
        found.push(camera.measure(variant.name)?);
    }
    // Nothing distorts what lies on the screen: it is the texture itself.
    working.step("texture");
    let variant = &VARIANTS[SCREEN];
    let style = moved(hatching_alone(style, variant))?;
    let camera = Shots {
        context,
        prepared: &prepared,
        settings: &settings,
        plant: &plant,
        style: &style,
        mode: variant.mode,
    };
    let elsewhere = camera.strokes()?;
    Ok(report(args, named, &settings, (&found, &elsewhere)))
}

/// Frames of one variant.
struct Shots<'a> {
    context: &'a Context,
    prepared: &'a Prepared,
    settings: &'a RenderSettings,
    plant: &'a Plant,
    style: &'a Style,
    mode: HatchMode,
}

impl Shots<'_> {
    fn measure(&self, name: &'static str) -> Result<Measured> {
        let mut moved = Vec::new();
        for (way, text) in WAYS {
            let mut sum = Moved::default();
            let mut before: Option<Frame> = None;
            self.along(text, |frame| {
                if let Some(before) = &before {
                    sum.add(&compare(before, &frame));
                }
                before = Some(frame);
            })?;
            moved.push((way, sum));
        }
        let strokes = self.strokes()?;
        Ok(Measured {
            name,
            moved,
            strokes,
        })
    }

    /// Strokes on the screen, from far to near.
    fn strokes(&self) -> Result<Vec<Strokes>> {
        let mut strokes = Vec::new();
        let last = f64::from(self.path(FAR_TO_NEAR)?.last());
        let mut number = 0.0;
        self.along(FAR_TO_NEAR, |frame| {
            let size = frame.view.size;
            let filled = |i: usize| frame.cluster[i] > 0;
            let spacing = spectrum::spacing(&frame.ink, filled, size);
            let width = spectrum::width(&frame.ink, filled, size);
            strokes.push(Strokes {
                away: 2.0 * 0.25_f64.powf(number / last),
                spacing,
                width,
                texture: {
                    let own = |a: usize, b: usize| {
                        frame.cluster[a] > 0 && frame.cluster[a] == frame.cluster[b]
                    };
                    Matrices::new(&frame.ink, own, size)
                },
            });
            number += 1.0;
        })?;
        Ok(strokes)
    }

    fn path(&self, text: &str) -> Result<CameraPath> {
        let (geometry, settings) = (&self.prepared.geometry, self.settings);
        let points = geometry.positions.iter().copied();
        let spec = PathSpec::named(text, None)?;
        Ok(spec.resolve(
            &settings.camera,
            drawing::lens(settings),
            geometry.origin,
            points,
        ))
    }

    /// Calls `take` with every frame of a way.
    fn along(&self, text: &str, mut take: impl FnMut(Frame)) -> Result<()> {
        let path = self.path(text)?;
        let geometry = &self.prepared.geometry;
        let scene = drawing::scene(self.prepared, self.plant);
        let aspect = drawing::lens(self.settings).aspect;
        let view = |frame: u32| {
            let points = geometry.positions.iter().copied();
            let camera = path.camera(f64::from(frame), aspect, geometry.origin, points);
            drawing::view(self.prepared, self.settings, Some(camera), 1)
        };
        // Strokes have the style's size where the plant fills the picture, in all ways.
        let framed = drawing::view(self.prepared, self.settings, None, 1);
        let mix = Mix::single(self.style.clone());
        let gpu = self.context.gpu()?;
        let mut renderer = InkRenderer::new(gpu, &scene, &mix, &framed, 1)?;
        let mut track = Track::new(self.mode, drawing::centres(self.plant, &mix));
        for number in 0..=path.last() {
            let view = view(number);
            renderer.follow(track.at(number, &view, |f| path.pose(f)));
            take(self.frame(&renderer, &scene, view)?);
        }
        Ok(())
    }

    fn frame(&self, renderer: &InkRenderer, scene: &InkScene<'_>, view: View) -> Result<Frame> {
        let wanted = [Attribute::Depth, Attribute::Ids, Attribute::Hatch];
        let drawing = renderer.draw_with(scene, &view, &wanted)?;
        let outline = |c: &InkCluster| {
            let centre = DVec2::from(c.pixel.map(f64::from));
            (centre, f64::from(c.pixel_radius))
        };
        let ids: Vec<[f32; 2]> = bytemuck::pod_collect_to_vec(attribute(&drawing, wanted[1]));
        Ok(Frame {
            ink: ink(&drawing, self.style),
            depth: bytemuck::pod_collect_to_vec(attribute(&drawing, wanted[0])),
            cluster: ids.iter().map(|i| i[1] as u32).collect(),
            hatch: bytemuck::pod_collect_to_vec::<_, [f32; 4]>(attribute(&drawing, wanted[2]))
                .iter()
                .map(|h| [h[0], h[1], h[2]])
                .collect(),
            outlines: renderer
                .cluster_records(scene, &view)
                .iter()
                .map(outline)
                .collect(),
            view,
        })
    }
}

fn attribute(drawing: &Drawing, wanted: Attribute) -> &[u8] {
    let found = drawing.attributes.iter().find(|a| a.0 == wanted);
    found.map_or(&[], |a| &a.1)
}

/// Texels of four 16-bit floats.
fn halves(bytes: &[u8]) -> impl Iterator<Item = [f32; 4]> {
    bytes
        .chunks_exact(8)
        .map(|texel| [0, 2, 4, 6].map(|k| f16_to_f32(u16::from_le_bytes([texel[k], texel[k + 1]]))))
}

/// Share of ink in every pixel: where it lies between paper and ink.
fn ink(drawing: &Drawing, style: &Style) -> Vec<f32> {
    let green = |c: [f32; 3]| srgb_to_linear(c[1]);
    let (paper, ink) = (green(style.paper.colour), green(style.paper.ink));
    let share = |v: f32| ((paper - v) / (paper - ink)).clamp(0.0, 1.0);
    halves(&drawing.pixels).map(|p| share(p[1])).collect()
}

/// Errors of texture of every way of hatching, and of the screen's own elsewhere.
fn textures(found: &[Measured], elsewhere: &[Strokes]) -> (Table, Vec<Value>) {
    let mut table = Table::new(&["hatching", "2", "1.41", "1", "0.71", "0.5", "mean"]);
    let mut json = Vec::new();
    let plain = &found[SCREEN].strokes;
    let all = found.iter().map(|m| (m.name, m.strokes.as_slice()));
    for (name, strokes) in all.chain([("screen, moved", elsewhere)]) {
        let pairs = strokes.iter().zip(plain);
        let errors: Vec<Option<f64>> = pairs.map(|(a, b)| a.texture.error(&b.texture)).collect();
        let known: Vec<f64> = errors.iter().flatten().copied().collect();
        let mean = known.iter().sum::<f64>() / known.len() as f64;
        let last = errors.len().saturating_sub(1);
        let at = |k: usize| errors[k].map_or("-".to_owned(), |e| format!("{e:.3}"));
        let [a, b, c, d, e] = [0, last / 4, last / 2, 3 * last / 4, last].map(at);
        table.row(&[&name, &a, &b, &c, &d, &e, &format!("{mean:.3}")]);
        json.push(json!({
            "hatching": name, "way": "far to near", "co_occurrence_error": errors, "mean": mean,
        }));
    }
    (table, json)
}

fn report(
    args: &BenchArgs,
    named: &str,
    settings: &RenderSettings,
    (found, elsewhere): (&[Measured], &[Strokes]),
) -> Report {
    let mut table = Table::new(&[
        "hatching",
        "way",
        "ink",
        "E_warp",
        "popping",
        "slip 0-1/4",
        "1/4-1/2",
        "1/2-3/4",
        "3/4-1",
    ]);
    let mut flat = Table::new(&[
        "hatching", "strokes'", "2", "1.41", "1", "0.71", "0.5", "max/min",
    ]);
    let mut json: Vec<Value> = Vec::new();
    for m in found {
        for (way, moved) in &m.moved {
            let slips: [String; RINGS] = moved.slips().map(|s| format!("{s:.3}"));
            table.row(&[
                &m.name,
                way,
                &format!("{:.3}", moved.coverage()),
                &format!("{:.4}", moved.warp_error()),
                &format!("{:.4}", moved.popping()),
                &slips[0],
                &slips[1],
                &slips[2],
                &slips[3],
            ]);
            json.push(json!({
                "hatching": m.name, "way": way, "ink": moved.coverage(),
                "e_warp": moved.warp_error(), "popping": moved.popping(),
                "slip_pixels": moved.slips(), "pixels": moved.pixels,
            }));
        }
        let last = m.strokes.len().saturating_sub(1);
        let rows: [(&str, Measure); 2] = [("width", |s| s.width), ("distance", |s| s.spacing)];
        for (what, of) in rows {
            let at = |k: usize| {
                let found = m.strokes.get(k).and_then(of);
                found.map_or("-".to_owned(), |s| format!("{s:.2}"))
            };
            let change = change(m.strokes.iter().map(of));
            flat.row(&[
                &m.name,
                &what,
                &at(0),
                &at(last / 4),
                &at(last / 2),
                &at(3 * last / 4),
                &at(last),
                &format!("{change:.2}"),
            ]);
            json.push(json!({
                "hatching": m.name, "way": "far to near", "of_strokes": what, "change": change,
                "pixels": m.strokes.iter().map(|s| (s.away, of(s))).collect::<Vec<_>>(),
            }));
        }
    }
    let (texture, errors) = textures(found, elsewhere);
    json.extend(errors);
    let [w, h] = settings.size;
    let camera: &CameraSpec = &settings.camera;
    let text = format!(
        "coherence of {} in {named}, {w}x{h}, camera {camera}, hatching alone\n\n\
         ink: share of what two frames show; E_warp: mean difference of ink after the warp;\n\
         popping: share of ink that had none within 1.5 pixels; slip: of hatch coordinates, pixels\n\
         a frame, by distance from the cluster's centre in its radii\n\n{table}\n\
         strokes on the screen, pixels, from twice the framing distance to half of it; distance by\n\
         the middle of the spectrum\n\n{flat}\n\
         average co-occurrence error against the screen's strokes, which nothing distorts (0 to 2)\n\n\
         {texture}",
        args.input.input
    );
    Report::new(
        text,
        json!({
            "bench": "coherence", "model": args.input.input.to_string(), "style": named,
            "size": settings.size, "rows": json, "version": env!("CARGO_PKG_VERSION"),
        }),
    )
}
