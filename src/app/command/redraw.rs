//! `umbrage render drawing.svg`: draws again what a drawing says that it was drawn from, with the
//! options that are given beside it in place of its own.

use std::path::{Path, PathBuf};

use clap::Parser as _;
use serde::Deserialize;

use super::recipe::{Recipe, from_within, relative};
use crate::app::cli::{Cli, Command, RenderArgs};
use crate::app::entry::message;
use crate::ink::paper::modulation::embedded;
use crate::ink::paper::presets::PRESETS;
use crate::ink::paper::style::PaperStyle;
use crate::{Error, Result};

/// What a drawing holds of itself; more is in it for people.
#[derive(Deserialize)]
struct Metadata {
    program: String,
    arguments: Vec<String>,
    style: String,
}

/// A drawing to draw again.
pub(super) struct Again {
    /// Its arguments, changed.
    pub(super) args: RenderArgs,
    /// Its style, or the one that is given.
    pub(super) style: PaperStyle,
    /// What the next drawing will hold.
    pub(super) recipe: Recipe,
}

/// The arguments and the style of the drawing `path`, changed by `given` and written to `output`.
///
/// # Errors
/// A file that cannot be read or that this program has not drawn, options that drawings do not
/// have, a model that is not found.
pub(super) fn read(path: &Path, given: &Recipe, output: &Path) -> Result<Again> {
    let foreign = |why: String| Error::file(path, format!("is no drawing of umbrage: {why}"));
    let metadata = metadata(path)?;
    let old = Recipe::of(metadata.arguments.into_iter());
    if old.inputs.iter().any(|i| drawing(Path::new(i))) {
        return Err(foreign(
            "it was drawn from another drawing; draw that again".into(),
        ));
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let found = |file: &Path, needed: bool| find(folder, file, needed, path);
    let mut style =
        PaperStyle::parse(&metadata.style).map_err(|e| foreign(format!("metadata: style: {e}")))?;
    match given.value("style") {
        Some(name) => style = named(name)?,
        None => style.try_masks(|mask| found(mask, true))?,
    }
    let recipe = old.with_files(found)?.changed(given);
    let line = std::iter::once("umbrage".to_owned())
        .chain(recipe.arguments())
        .chain(["--output".to_owned(), output.to_string_lossy().into_owned()]);
    let cli = Cli::try_parse_from(line)
        .map_err(|e| Error::file(path, format!("cannot be drawn again: {}", message(&e))))?;
    let Command::Render(args) = cli.command else {
        return Err(foreign("metadata: another command".into()));
    };
    Ok(Again {
        args: *args,
        style,
        recipe,
    })
}

fn metadata(path: &Path) -> Result<Metadata> {
    let text = std::fs::read_to_string(path)
        .map_err(|e| Error::file(path, format!("cannot read: {e}")))?;
    let foreign = |why: String| Error::file(path, format!("is no drawing of umbrage: {why}"));
    let document = roxmltree::Document::parse(&text).map_err(|e| foreign(e.to_string()))?;
    let metadata = document
        .descendants()
        .find(|n| n.has_tag_name(("http://www.w3.org/2000/svg", "metadata")));
    let metadata = metadata
        .and_then(|n| n.text())
        .ok_or_else(|| foreign("it has no metadata".into()))?;
    let metadata: Metadata =
        serde_json::from_str(metadata).map_err(|e| foreign(format!("metadata: {e}")))?;
    if metadata.program != "umbrage" {
        return Err(foreign(format!(
            "metadata: written by `{}`",
            metadata.program
        )));
    }
    Ok(metadata)
}

/// Another style on paper.
fn named(name: &str) -> Result<PaperStyle> {
    PaperStyle::named(name)?.ok_or_else(|| {
        let all: Vec<&str> = PRESETS.iter().map(|p| p.0).collect();
        Error::usage(format!(
            "--style {name}: a drawing is drawn again on paper: {} or a file with kind = \"paper\"",
            all.join(", ")
        ))
    })
}

/// Where a file is that a drawing in `folder` names: its name is told from there; drawings of
/// earlier versions told it from where the program ran.
fn find(folder: &Path, file: &Path, needed: bool, drawing: &Path) -> Result<PathBuf> {
    let mut places = vec![folder.join(file)];
    if !file.is_absolute() {
        places.push(file.to_owned());
    }
    places.extend(file.file_name().map(|name| folder.join(name)));
    let mut seen = std::collections::BTreeSet::new();
    places.retain(|p| seen.insert(p.clone()));
    match places.iter().find(|p| p.exists()) {
        // So that a drawing that moves about with its model goes on naming it from where it lies.
        Some(place) if !file.is_absolute() && place.is_absolute() => {
            Ok(relative(Path::new(""), place).unwrap_or_else(|| place.clone()))
        }
        Some(place) => Ok(place.clone()),
        None if needed => {
            let places: Vec<String> = places.iter().map(|p| p.display().to_string()).collect();
            Err(Error::file(
                drawing,
                format!(
                    "is drawn from {}, which is not found: looked for {}; put it beside the drawing",
                    file.display(),
                    places.join(" and ")
                ),
            ))
        }
        None => Ok(places.swap_remove(0)),
    }
}

/// What a drawing in `folder` holds of its recipe and its style: files are named from there, and
/// small masks are in it themselves.
pub(super) fn held(
    recipe: Recipe,
    mut style: PaperStyle,
    folder: &Path,
) -> Result<(Vec<String>, String)> {
    let recipe = recipe.with_files(|file, _| Ok::<_, Error>(from_within(folder, file)))?;
    style.try_masks(|mask| {
        Ok::<_, Error>(match embedded(mask)? {
            Some(data) => data,
            None => from_within(folder, mask),
        })
    })?;
    let style = toml::to_string(&style).map_err(|e| Error::usage(format!("style: {e}")))?;
    Ok((recipe.arguments(), style))
}

/// Whether a path is that of a drawing.
pub(super) fn drawing(path: &Path) -> bool {
    path.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("svg"))
}
