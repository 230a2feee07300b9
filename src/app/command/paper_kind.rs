//! What kind of file a drawing on paper is written as, and what of the command line that file does
//! not have.

use std::path::Path;

use super::recipe::Recipe;
use crate::app::cli::RenderArgs;
use crate::gpu::Gpu;
use crate::ink::paper::presets::PRESETS;
use crate::render::RenderSettings;
use crate::scene::SceneFile;
use crate::{Error, Result};

/// What kind of files is wanted.
pub(super) struct Kind<'a> {
    /// Its name tells it.
    pub(super) output: &'a Path,
    /// Of bitmaps: pixels along each axis that become one.
    pub(super) factor: u32,
    /// Of bitmaps: pixels across and down, where they are not the sheet's.
    pub(super) size: Option<[u32; 2]>,
    /// What it holds for being drawn again.
    pub(super) recipe: Recipe,
}

impl<'a> Kind<'a> {
    /// Of a file that nobody keeps.
    pub(super) fn unnamed(output: &'a Path, factor: u32, size: [u32; 2]) -> Self {
        Self {
            output,
            factor,
            size: Some(size),
            recipe: Recipe::default(),
        }
    }

    pub(super) fn of(args: &'a RenderArgs, recipe: Recipe, size: Option<[u32; 2]>) -> Self {
        Self {
            output: &args.output,
            factor: args.ink.ink_supersample,
            size,
            recipe,
        }
    }
}

/// The size of pictures where the command line or the scene says one.
pub(super) fn chosen_size(
    scene: Option<&SceneFile>,
    args: &RenderArgs,
    settings: &RenderSettings,
) -> Option<[u32; 2]> {
    let by_scene = scene.is_some_and(|s| s.picture.iter().any(|(name, _)| name == "size"));
    let chosen = by_scene || args.picture.values().any(|(name, _)| name == "size");
    chosen.then_some(settings.size)
}

pub(super) fn ends_in(file: &Path, ending: &str) -> bool {
    file.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case(ending))
}

/// Whether lines are written, rather than pixels.
pub(super) fn is_vectors(file: &Path) -> bool {
    ends_in(file, "svg") || ends_in(file, "pdf")
}

/// Refuses vectors of what has none.
///
/// # Errors
/// Names the styles that do.
pub(super) fn no_vectors(output: &Path, style: Option<&str>) -> Result<()> {
    if !is_vectors(output) {
        return Ok(());
    }
    let all: Vec<&str> = PRESETS.iter().map(|p| p.0).collect();
    let what = style.map_or("a picture without --style".to_owned(), |s| {
        format!("style `{s}`")
    });
    Err(Error::file(
        output,
        format!(
            "output: {what} is written as .png or .jpg; vectors are those of styles on paper: {} \
             or a file with kind = \"paper\"",
            all.join(", ")
        ),
    ))
}

/// Refuses pictures that the device does not have, before anything is allocated; `factor` is that
/// of bitmaps.
///
/// # Errors
/// Names what makes them smaller.
pub(super) fn check_size(gpu: &Gpu, [w, h]: [u32; 2], factor: Option<u32>) -> Result<()> {
    let (name, side) = (&gpu.info().name, gpu.info().limits.max_image_2d);
    if w.max(h) <= side {
        return Ok(());
    }
    let less = match factor {
        Some(_) => "--size, --ink-supersample, --paper or sheet.resolution",
        None => "--paper or sheet.resolution",
    };
    Err(Error::Unsupported(format!(
        "a sheet of {w}x{h} pixels: {name} draws up to {side}x{side}; less of {less} makes it smaller"
    )))
}

/// Options that drawings on paper have, whatever they are written as.
const COMMON: [&str; 11] = [
    "style",
    "paper",
    "camera",
    "fov",
    "margin",
    "sun",
    "texture",
    "foliage",
    "camera-path",
    "frames",
    "fps",
];
/// Those of bitmaps alone.
const BITMAP: [&str; 2] = ["size", "ink-supersample"];
/// Those of vectors alone.
const VECTORS: [&str; 1] = ["profile"];

/// Tells which of the given options change nothing in a file named like `output`.
pub(super) fn tell_unused(given: &Recipe, output: &Path) {
    let vectors = is_vectors(output);
    let own: &[&str] = if vectors { &VECTORS } else { &BITMAP };
    let unused = given
        .names()
        .filter(|n| !COMMON.contains(n) && !own.contains(n));
    let kind = if vectors {
        "vectors on paper"
    } else {
        "pictures of drawings on paper"
    };
    tell(unused, kind);
}

/// Tells which of the given options are of drawings on paper alone.
pub(super) fn tell_paper_only(given: &Recipe) {
    let paper = ["paper", "profile"];
    tell(
        given.names().filter(|n| paper.contains(n)),
        "styles of pictures in real time",
    );
}

fn tell<'a>(unused: impl Iterator<Item = &'a str>, kind: &str) {
    let names: Vec<String> = unused.map(|n| format!("--{n}")).collect();
    if !names.is_empty() {
        log::warn!("{}: without effect on {kind}", names.join(", "));
    }
}

/// Tells that nothing is in a drawing.
pub(super) fn tell_blank(file: &Path) {
    log::warn!(
        "{}: is blank: the camera sees nothing of the model, or the style draws nothing of it",
        file.display()
    );
}

/// `1 stroke`, `2 strokes`.
pub(super) fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}
