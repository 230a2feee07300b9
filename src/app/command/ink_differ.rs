//! `umbrage ink differ`: one picture on two devices, compared stage by stage.

use serde_json::{Value, json};

use super::paper_differ;
use crate::Result;
use crate::app::cli::ink_strokes::DifferArgs;
use crate::app::differ::{self, Share};
use crate::app::prepared::Prepared;
use crate::app::report::Table;
use crate::app::settings::picture_settings;
use crate::app::timing::Timings;
use crate::app::{Context, Report, console, drawing};
use crate::gpu::{Gpu, GpuOptions};
use crate::ink::mix::Mix;
use crate::ink::paper::style::PaperStyle;
use crate::ink::plan::Attribute;
use crate::ink::renderer::{Drawing, InkRenderer};
use crate::ink::style::Style;
use crate::render::RenderSettings;

/// By how much attributes differ where that is told, in their own unit.
const APART: f32 = 1e-3;
/// Share of the picture's pixels that may differ where both devices start from the same attributes.
const MOST: f64 = 1e-3;
/// The row that this is about.
const SAME_ATTRIBUTES: &str = "picture, same attributes";

/// Draws on both devices and compares. The check fails where pictures of the same attributes, of a
/// style on paper whole pictures, differ in more than a thousandth of their pixels.
///
/// # Errors
/// Wrong input or style, a device that is not there or fails.
pub(super) fn run(context: &Context, args: &DifferArgs) -> Result<Report> {
    if let Some(style) = PaperStyle::named(&args.style)? {
        return paper_differ::run(context, args, &style);
    }
    let mix = Mix::named(&args.style)?;
    let other = other(args)?;
    let gpu = context.gpu()?;
    let mut timings = Timings::default();
    let (prepared, settings) = read(args, &mut timings)?;
    // One bake for both: drawings are compared, not bakes.
    let bake = prepared.bake(context, &mut timings)?.bake;
    let plant = drawing::plant(context, &prepared, Some(&bake), &mix, &mut timings)?;
    let scene = drawing::scene(&prepared, &plant);
    let view = drawing::view(&prepared, &settings, None, args.ink_supersample);
    let _working = console::working("drawing");
    let renderer = |gpu| InkRenderer::new(gpu, &scene, &mix, &view, args.ink_supersample);
    let (one, two) = (renderer(gpu)?, renderer(&other)?);
    let all = Attribute::ALL;
    let drawings = [
        one.draw_with(&scene, &view, &all)?,
        two.draw_with(&scene, &view, &all)?,
    ];
    let again = two.draw_again(&scene, &view, &drawings[0], &all)?;
    let reach = mix.styles.iter().map(|s| reach(s, args.ink_supersample));
    let found = compare(&drawings, &again, reach.max().unwrap_or(0));
    Ok(report(args, [gpu, &other], &found, SAME_ATTRIBUTES))
}

/// The model, and how it is drawn.
pub(super) fn read(args: &DifferArgs, timings: &mut Timings) -> Result<(Prepared, RenderSettings)> {
    let (input, model) = (&args.input.input, &args.input.model);
    let prepared = Prepared::new(input, model, &args.settings, timings)?;
    let settings = picture_settings(prepared.input.scene.as_ref(), &args.picture)?;
    Ok((prepared, settings))
}

/// The second device.
pub(super) fn other(args: &DifferArgs) -> Result<Gpu> {
    Gpu::new(&GpuOptions {
        device: Some(args.other.clone()),
        ..GpuOptions::default()
    })
}

/// Pixels that stage 2 of a style looks around itself.
fn reach(style: &Style, factor: u32) -> usize {
    let strokes = if style.silhouette.strength > 0.0 {
        style.silhouette.width
    } else {
        0.0
    };
    // Contours and their cleaning look at neighbours.
    ((strokes + 0.5 * style.contour.width) * factor as f32).ceil() as usize + 2
}

/// What differs, by name, of what.
fn compare([a, b]: &[Drawing; 2], again: &Drawing, reach: usize) -> Vec<(String, Share)> {
    let all = vec![true; (a.size[0] * a.size[1]) as usize];
    let same = differ::same_surface(a, b);
    let around = differ::within(&same, a.size, reach);
    let shown = Share {
        differing: same.iter().filter(|s| !**s).count(),
        of: same.len(),
    };
    let mut found = vec![("other leaf or branch".to_owned(), shown)];
    for ((which, a), (_, b)) in a.attributes.iter().zip(&b.attributes) {
        let label = which.label().trim_start_matches("ink ");
        let own = differ::attribute(*which, a, b, APART, &same);
        found.push((format!("{label} beyond {APART}, same leaf"), own));
    }
    for (name, a, b) in lines(a, again) {
        found.push((
            format!("{name}, same attributes"),
            differ::bits(a, b, 4, &all),
        ));
    }
    found.extend([
        (SAME_ATTRIBUTES.into(), differ::picture(a, again, &all)),
        (
            format!("picture, same leaves within {reach} pixels"),
            differ::picture(a, b, &around),
        ),
        ("picture, same leaf".into(), differ::picture(a, b, &same)),
        ("picture".into(), differ::picture(a, b, &all)),
    ]);
    found
}

/// Lines of two drawings of the same plan.
fn lines<'a>(a: &'a Drawing, b: &'a Drawing) -> Vec<(&'static str, &'a [u8], &'a [u8])> {
    let names = ["contour", "cleaned contour", "silhouette"];
    let pairs = names.into_iter().zip(a.lines.iter().zip(&b.lines));
    pairs.map(|(name, (a, b))| (name, &a[..], &b[..])).collect()
}

/// What differs as a table. The check fails where that of `held` is more than a thousandth.
pub(super) fn report(
    args: &DifferArgs,
    devices: [&Gpu; 2],
    found: &[(String, Share)],
    held: &str,
) -> Report {
    let names = devices.map(|g| g.info().name.clone());
    let mut table = Table::new(&["what differs", "pixels", "of", "%"]);
    for (name, share) in found {
        let percent = format!("{:.3}", 100.0 * share.share());
        table.row(&[name, &share.differing, &share.of, &percent]);
    }
    let text = format!(
        "{} of {}: {} and {}\n\n{table}",
        args.style, args.input.input, names[0], names[1]
    );
    let row = |(name, share): &(String, Share)| -> Value {
        json!({"what": name, "pixels": share.differing, "of": share.of, "share": share.share()})
    };
    let rows: Vec<Value> = found.iter().map(row).collect();
    let json = json!({
        "style": args.style, "model": args.input.input.to_string(), "devices": names, "rows": rows,
    });
    let report = Report::new(text, json);
    let same = found.iter().find(|(name, _)| name == held);
    if same.is_some_and(|(_, share)| share.share() > MOST) {
        return report.failed();
    }
    report
}
