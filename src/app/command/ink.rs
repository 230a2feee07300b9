//! `umbrage ink`: the strokes of a style as pictures that can be painted over; two devices compared.

use serde_json::json;

use crate::abi::INK_LEVELS;
use crate::app::cli::ink_strokes::{InkCommandArgs, InkPart, StrokesArgs, StrokesWhat};
use crate::app::output::{PendingFile, check_ending};
use crate::app::{Context, Report};
use crate::ink::paper::style::PaperStyle;
use crate::ink::strokes::painted::picture;
use crate::ink::strokes::{Stroke, Tile, band_of, band_strokes, level_size, tile_of};
use crate::ink::style::Style;
use crate::scene::textures::{Rgba8, encode_png};
use crate::{Error, Result};

/// Tones of the picture of tones.
const TONES: u32 = 6;
/// Its levels, from the second finest.
const LEVELS: std::ops::RangeInclusive<u32> = 1..=3;
/// Pixels between tiles of it.
const GAP: u32 = 12;

/// Writes strokes, or compares devices.
///
/// # Errors
/// A style or file of it that is wrong, an unwritable output.
pub fn run(context: &Context, args: &InkCommandArgs) -> Result<Report> {
    match &args.part {
        InkPart::Strokes(args) => strokes(args),
        InkPart::Differ(args) => super::ink_differ::run(context, args),
    }
}

fn strokes(args: &StrokesArgs) -> Result<Report> {
    if PaperStyle::named(&args.style)?.is_some() {
        return Err(Error::usage(format!(
            "ink strokes: `{0}` draws on paper and has no painted strokes; `umbrage style {0} -o own.toml` writes the style",
            args.style
        )));
    }
    let style = Style::named(&args.style)?;
    check_ending(&args.output, &["png", "toml"])?;
    let output = PendingFile::create(&args.output)?;
    let tile = tile_of(&style)?;
    let band = band_of(&style)?;
    let listed = args
        .output
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("toml"));
    let bytes = if listed {
        list(&style, &tile, args.what)?.into_bytes()
    } else {
        let shown = match args.what {
            StrokesWhat::Tile => picture(&tile),
            StrokesWhat::Band => band.rows(),
            StrokesWhat::Tones => sheet(&tile),
        };
        encode_png(shown.width, shown.height, &shown.pixels)?
    };
    output.commit(&bytes)?;
    let errors: Vec<f32> = (0..INK_LEVELS as usize)
        .map(|l| tile.tone_error(l))
        .collect();
    let seams = tile.seams();
    let darkness = [0, 1, 2, 3].map(|c| band.darkness(c));
    let said: Vec<String> = errors.iter().map(|e| format!("{e:.4}")).collect();
    let text = format!(
        "{}: {} strokes; largest error of tone by level {}; roughness across borders {:.2}, {:.2} \
         of that within; band {:.2} {:.2} {:.2} {:.2} of ink\n",
        args.output.display(),
        tile.strokes.len(),
        said.join(" "),
        seams[0],
        seams[1],
        darkness[0],
        darkness[1],
        darkness[2],
        darkness[3],
    );
    let json = json!({
        "output": args.output, "style": args.style, "strokes": tile.strokes.len(),
        "tone_errors": errors, "seams": seams, "band_darkness": darkness,
        "band_seam": band.seam(),
    });
    Ok(Report::new(text, json))
}

/// The style with the strokes of its tile and band in it; of the band alone where that is asked for.
fn list(style: &Style, tile: &Tile, what: StrokesWhat) -> Result<String> {
    let mut listed = style.clone();
    if what != StrokesWhat::Band {
        if tile.strokes.is_empty() {
            return Err(Error::usage(
                "ink strokes: a painted tile has no list of strokes; write a .png, or the band \
                 alone (--what band)",
            ));
        }
        listed.hatching.strokes = tile.strokes.iter().map(Stroke::to_listed).collect();
    } else if style.silhouette.band.is_some() {
        return Err(Error::usage(
            "ink strokes: a painted band has no list of strokes; write a .png",
        ));
    }
    if style.silhouette.band.is_none() {
        let band = band_strokes(style);
        (listed.silhouette.strokes, listed.silhouette.ticks) = (band.lines, band.ticks);
    }
    let text = toml::to_string(&listed).map_err(|e| Error::usage(format!("style: {e}")))?;
    Ok(text.replace("], [", "],\n  [").replace("[[", "[\n  ["))
}

/// Tones side by side, levels below each other.
fn sheet(tile: &Tile) -> Rgba8 {
    let wide = level_size(*LEVELS.start()) + GAP;
    let width = TONES * wide + GAP;
    let height = LEVELS.map(|l| level_size(l) + GAP).sum::<u32>() + GAP;
    let mut grey = vec![255_u8; (width * height) as usize];
    let mut top = GAP;
    for level in LEVELS {
        let size = level_size(level);
        for tone in 0..TONES {
            let limit = (230.0 * (tone + 1) as f32 / TONES as f32).round() as u8;
            for i in 0..size * size {
                if tile.levels[level as usize][i as usize] <= limit {
                    let (x, y) = (GAP + tone * wide + i % size, top + i / size);
                    grey[(y * width + x) as usize] = 0;
                }
            }
        }
        top += size + GAP;
    }
    Rgba8 {
        width,
        height,
        pixels: grey.iter().flat_map(|&v| [v, v, v, 255]).collect(),
    }
}
