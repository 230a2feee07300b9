//! `umbrage bench paper`: time per stage of drawings on paper, as bitmaps and as vectors.

use std::path::Path;
use std::time::Instant;

use serde_json::json;

use super::paper_kind::Kind;
use super::render_paper::{Board, subject};
use crate::app::cli::BenchArgs;
use crate::app::prepared::Prepared;
use crate::app::report::Table;
use crate::app::settings::picture_settings;
use crate::app::timing::Timings;
use crate::app::{Context, Report, console};
use crate::ink::paper::style::PaperStyle;
use crate::math::stats::median;
use crate::{Error, Result};

/// What is drawn: name, and an output that says so.
const KINDS: [(&str, &str); 2] = [("bitmap", "x.png"), ("vectors", "x.svg")];
/// Style where none is asked for.
const STYLE: &str = "ds00-fig6a";

/// Draws bitmaps and vectors of every style in turn and tells what their stages took.
///
/// # Errors
/// Wrong input, style or settings, a failing device.
pub fn run(context: &Context, args: &BenchArgs) -> Result<Report> {
    let model = &args.input.model;
    let mut table = Table::new(&[
        "style",
        "as",
        "primitives",
        "frame ms",
        "a second",
        "geometry ms",
        "filter ms",
    ]);
    let (mut rows, mut details) = (Vec::new(), String::new());
    for name in &args.style {
        // The default is that of the pictures in real time.
        let named = if name == "silhouette-hatching" {
            STYLE
        } else {
            name
        };
        let style = PaperStyle::named(named)?
            .ok_or_else(|| Error::usage(format!("--style {named}: is no style on paper")))?;
        let prepared = Prepared::new(
            &args.input.input,
            model,
            &args.settings,
            &mut Timings::default(),
        )?;
        let settings = picture_settings(prepared.input.scene.as_ref(), &args.picture)?;
        let subject = subject(prepared, (&style, &settings), &mut Timings::default())?;
        for (kind, file) in KINDS {
            let file = Path::new(file);
            let mut once = Timings::default();
            let what = Kind::unnamed(file, 1, settings.size);
            let board = Board::new(context, what, style.clone(), &subject, &mut once)?;
            let view = subject.view(&settings, board.size, None);
            let (mut stages, mut frames) = (Timings::default(), Vec::new());
            let working = console::working("drawing");
            for run in 0..args.warm_up + args.runs {
                working.step(&format!("{named}, {kind}, {}", run + 1));
                let mut own = Timings::default();
                let start = Instant::now();
                board.draw(&view, None, file, &mut own)?;
                if run >= args.warm_up {
                    frames.push(start.elapsed().as_secs_f64() * 1e3);
                    stages.append(own);
                }
            }
            let frame = median(&frames);
            let [geometry, filter] = [true, false]
                .map(|geometry| stages.device_sum(|label| is_geometry(label) == geometry));
            let [w, h] = board.size;
            table.row(&[
                &named,
                &format!("{kind} {w}x{h}"),
                &subject.primitives(),
                &format!("{frame:.1}"),
                &format!("{:.2}", 1e3 / frame),
                &format!("{geometry:.1}"),
                &format!("{filter:.1}"),
            ]);
            details += &format!("\n{named}, {kind}\n{}", stages.table());
            rows.push(json!({
                "style": named, "as": kind, "size": board.size, "primitives": subject.primitives(),
                "frame_ms": frame, "geometry_ms": geometry, "filter_ms": filter,
                "stages": stages.json(),
            }));
        }
    }
    let device = context.gpu()?.info();
    let text = format!(
        "paper of {}: {} ({}), {} drawings of each after {} that do not count\n\n{table}{details}",
        args.input.input, device.name, device.driver, args.runs, args.warm_up
    );
    let json = json!({
        "bench": "paper", "model": args.input.input.to_string(), "device": device.name,
        "runs": args.runs, "rows": rows, "version": env!("CARGO_PKG_VERSION"),
    });
    Ok(Report::new(text, json))
}

/// Whether a pass draws primitives and stems, rather than finds lines in pictures of them.
fn is_geometry(label: &str) -> bool {
    ["paper foliage", "paper stems", "sun foliage", "sun stems"].contains(&label)
}
