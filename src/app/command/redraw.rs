//! `umbrage render drawing.svg`: draws again what a drawing says that it was drawn from.

use std::path::Path;

use clap::Parser as _;
use serde::Deserialize;

use crate::app::cli::{Cli, Command, RenderArgs};
use crate::ink::paper::style::PaperStyle;
use crate::{Error, Result};

/// What a drawing holds of itself; more is in it for people.
#[derive(Deserialize)]
struct Metadata {
    program: String,
    arguments: Vec<String>,
    style: String,
}

/// Options whose value is another's when a drawing is drawn again.
const OUTPUT: [&str; 2] = ["-o", "--output"];

/// The arguments of `render`, without the output; of a sequence those of one frame.
pub(super) fn arguments(all: impl Iterator<Item = String>, frame: Option<u32>) -> Vec<String> {
    let mut out = Vec::new();
    let mut all = all.skip(1);
    while let Some(argument) = all.next() {
        if OUTPUT.contains(&argument.as_str()) || argument == FRAMES {
            all.next();
        } else if !argument.starts_with("--output=") && !argument.starts_with("--frames=") {
            out.push(argument);
        }
    }
    if let Some(frame) = frame {
        out.extend([FRAMES.to_owned(), format!("{frame}..{frame}")]);
    }
    out
}

/// The option that chooses frames of a sequence.
const FRAMES: &str = "--frames";

/// The arguments and the style of the drawing `path`, to be written to the output of `args`.
///
/// # Errors
/// A file that cannot be read or that this program has not drawn, options beside it.
pub(super) fn read(path: &Path, args: &RenderArgs) -> Result<(RenderArgs, PaperStyle)> {
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
    let style =
        PaperStyle::parse(&metadata.style).map_err(|e| foreign(format!("metadata: style: {e}")))?;
    let output = args.output.to_string_lossy().into_owned();
    let line = std::iter::once("umbrage".to_owned())
        .chain(metadata.arguments)
        .chain(["--output".to_owned(), output]);
    let cli = Cli::try_parse_from(line).map_err(|e| foreign(format!("metadata: {}", e.kind())))?;
    let Command::Render(again) = cli.command else {
        return Err(foreign("metadata: another command".into()));
    };
    if again
        .inputs
        .iter()
        .any(|i| drawing(i.files(&[]).next()).is_some())
    {
        return Err(foreign(
            "it was drawn from another drawing; draw that again".into(),
        ));
    }
    Ok((*again, style))
}

/// The path if it is that of a drawing.
pub(super) fn drawing(path: Option<&Path>) -> Option<&Path> {
    path.filter(|p| p.extension().is_some_and(|e| e.eq_ignore_ascii_case("svg")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_output_is_no_part_of_what_is_drawn_again() {
        let line = [
            "umbrage",
            "render",
            "a.glb",
            "-o",
            "a.svg",
            "--style",
            "ds00-fig3a",
            "--output=b.svg",
            "--output",
            "c",
        ];
        let given = |line: &[&str]| line.iter().map(ToString::to_string).collect::<Vec<_>>();
        let kept = arguments(given(&line).into_iter(), None);
        assert_eq!(kept, ["render", "a.glb", "--style", "ds00-fig3a"]);
        let line = ["umbrage", "render", "--frames", "2..9", "-o", "f%d.svg"];
        let kept = arguments(given(&line).into_iter(), Some(4));
        assert_eq!(kept, ["render", "--frames", "4..4"]);
    }
}
