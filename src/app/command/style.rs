//! `umbrage style`: the styles, and each as a file to be changed.

use std::path::Path;

use serde_json::{Value, json};

use super::recipe::from_within;
use crate::app::cli::StyleArgs;
use crate::app::output::{check_apart, check_ending, write_atomically};
use crate::app::report::Table;
use crate::app::{Context, Report};
use crate::ink::paper::style::PaperStyle;
use crate::ink::paper::style_table::{keys, markdown, text};
use crate::ink::style::{PRESETS, Style};
use crate::ink::{mix, paper};
use crate::{Error, Result};

/// Lists the styles, or writes one.
///
/// # Errors
/// No such style, a wrong file, an unwritable output.
pub fn run(_context: &Context, args: &StyleArgs) -> Result<Report> {
    if args.keys {
        let all = keys().into_iter().map(|k| {
            json!({
                "key": k.name, "unit": k.unit, "values": k.range, "default": k.default,
                "meaning": k.meaning,
            })
        });
        let all: Value = all.collect();
        return Ok(Report::new(markdown(), json!({ "keys": all })));
    }
    let Some(name) = &args.name else {
        return list();
    };
    let folder = args.output.as_deref().and_then(Path::parent);
    let text = written(name, folder.unwrap_or(Path::new("")))?;
    let Some(output) = &args.output else {
        return Ok(Report::new(
            text.clone(),
            json!({ "style": name, "toml": text }),
        ));
    };
    check_ending(output, &["toml"])?;
    check_apart(output, [Path::new(name)])?;
    write_atomically(output, text.as_bytes())?;
    let said = format!("{}: {name}\n", output.display());
    Ok(Report::new(
        said,
        json!({ "style": name, "output": output }),
    ))
}

/// The file of a style, in `folder`.
fn written(name: &str, folder: &Path) -> Result<String> {
    let wrong = |e: toml::ser::Error| Error::usage(format!("style `{name}`: {e}"));
    if let Some(mut style) = PaperStyle::named(name)? {
        style.try_masks(|mask| Ok::<_, Error>(from_within(folder, mask)))?;
        return text(&style).map_err(wrong);
    }
    if let Some((_, file)) = mix::MIXES.iter().find(|p| p.0 == name) {
        return Ok((*file).to_owned());
    }
    if Path::new(name).extension().is_some_and(|e| e == "toml") {
        return Err(Error::file(
            name,
            "style: is no style on paper; of pictures in real time those that are built in are written",
        ));
    }
    toml::to_string(&Style::named(name)?).map_err(wrong)
}

fn list() -> Result<Report> {
    let mut table = Table::new(&["style", "draws", "what it looks like"]);
    let mut rows = Vec::new();
    let mut add = |name: &str, kind: &str, description: &str| {
        table.row(&[&name, &kind, &description]);
        rows.push(json!({ "style": name, "draws": kind, "description": description }));
    };
    for (name, _) in PRESETS {
        add(name, "pictures", &Style::named(name)?.description);
    }
    for (name, _) in mix::MIXES {
        add(name, "pictures", "several styles in one picture");
    }
    for (name, _) in paper::presets::PRESETS {
        let style = PaperStyle::named(name)?;
        add(
            name,
            "on paper",
            &style.map_or_else(String::new, |s| s.description),
        );
    }
    Ok(Report::new(table.to_string(), json!({ "styles": rows })))
}
