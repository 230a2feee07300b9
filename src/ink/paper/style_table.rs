//! Every key of styles on paper with unit, range, default and meaning: the table of the
//! documentation, and the comments of written styles.

use std::fmt::Write as _;

use super::ranges::shown;
use super::style::PaperStyle;

/// A key of style files.
#[derive(Debug, Clone, PartialEq)]
pub struct Key {
    /// With its tables: `foliage.pen.width`.
    pub name: String,
    /// Unit; empty: none.
    pub unit: &'static str,
    /// Values that it may have.
    pub range: String,
    /// Value where files say none; none: the key is left out.
    pub default: Option<String>,
    /// What it is, in a few words.
    pub meaning: &'static str,
}

/// Key, unit, values where they are no range of numbers, meaning: a line each.
const ROWS: &str = include_str!("style_keys.txt");

/// Pens, which have the keys that the rows begin with `PEN.`.
const PENS: [&str; 4] = ["foliage.pen", "stem.pen", "stem.hatching_pen", "shadow.pen"];

/// All keys, table by table.
#[must_use]
pub fn keys() -> Vec<Key> {
    let bare = PaperStyle::parse("format_version = 1\nkind = \"paper\"\ndescription = \"\"");
    let bare = bare.ok();
    let numbers = bare.as_ref().map(PaperStyle::numbers).unwrap_or_default();
    let values = bare.and_then(|style| toml::Value::try_from(style).ok());
    let key = |name: String, row: [&'static str; 3]| {
        let [unit, range, meaning] = row;
        let parts = name.split('.');
        let value = parts.fold(values.as_ref(), |at, part| at?.get(part));
        let limits = numbers.iter().find(|n| n.0 == name);
        let range = match (limits, value) {
            _ if !range.is_empty() => range.to_owned(),
            (Some((_, _, low, high)), Some(toml::Value::Array(_))) => {
                format!("two of {} to {}", shown(*low), shown(*high))
            }
            (Some((_, _, low, high)), _) => format!("{} to {}", shown(*low), shown(*high)),
            (None, _) => "true, false".to_owned(),
        };
        let default = value.map(written).filter(|v| v != "\"\"");
        Key {
            name,
            unit,
            range,
            default,
            meaning,
        }
    };
    let mut out = Vec::new();
    // The first line says what stands where.
    for line in ROWS.lines().skip(1) {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let &[name, unit, range, meaning] = cells.as_slice() else {
            continue;
        };
        let row = [unit, range, meaning];
        match name.strip_prefix("PEN.") {
            Some(own) => out.extend(PENS.map(|pen| key(format!("{pen}.{own}"), row))),
            None => out.push(key(name.to_owned(), row)),
        }
    }
    // Keys of a pen beside each other.
    out.sort_by_key(|k| {
        PENS.iter()
            .position(|pen| k.name.starts_with(&format!("{pen}.")))
    });
    out
}

/// A default as files have it; colours have as many digits as they need.
fn written(value: &toml::Value) -> String {
    let short = |v: &toml::Value| match v.as_float() {
        Some(v) => format!("{:?}", v as f32),
        None => v.to_string(),
    };
    match value {
        toml::Value::Array(list) => {
            let list: Vec<String> = list.iter().map(short).collect();
            format!("[{}]", list.join(", "))
        }
        other => other.to_string(),
    }
}

/// The keys as a Markdown table.
#[must_use]
pub fn markdown() -> String {
    let mut out = "| key | unit | values | default | |\n|---|---|---|---|---|\n".to_owned();
    for key in keys() {
        let default = key.default.map(|d| format!("`{d}`")).unwrap_or_default();
        let Key {
            name,
            unit,
            range,
            meaning,
            ..
        } = key;
        let _ = writeln!(
            out,
            "| `{name}` | {unit} | {range} | {default} | {meaning} |"
        );
    }
    out
}

/// The text of a style file with every key, its unit, its values and its meaning; keys that the
/// style leaves out stand there as comments.
///
/// # Errors
/// The style cannot be written as TOML.
pub fn text(style: &PaperStyle) -> Result<String, toml::ser::Error> {
    let plain = toml::to_string(style)?;
    let keys = keys();
    let said = |key: &Key| {
        let unit = if key.unit.is_empty() { "" } else { ", " };
        format!("# {}{unit}{}: {}", key.range, key.unit, key.meaning)
    };
    let mut out = String::new();
    let mut lines = plain.lines().peekable();
    let mut table = String::new();
    let mut written = Vec::new();
    while let Some(line) = lines.next() {
        if let Some(name) = line.strip_prefix('[').and_then(|l| l.strip_suffix(']')) {
            table = format!("{name}.");
        }
        let name = line.split(" = ").next().unwrap_or_default();
        let name = format!("{table}{name}");
        match keys.iter().find(|k| k.name == name) {
            Some(key) if line.contains(" = ") => {
                let _ = writeln!(out, "{line:<30} {}", said(key));
                written.push(name);
            }
            _ => {
                let _ = writeln!(out, "{line}");
            }
        }
        // What the table leaves out stands at its end.
        if lines.peek().is_none_or(|next| next.is_empty()) {
            let of_table = |k: &&Key| {
                k.name
                    .strip_prefix(&table)
                    .is_some_and(|own| !own.contains('.'))
                    && !written.contains(&k.name)
                    && !plain.contains(&format!("[{}]", k.name))
            };
            for key in keys.iter().filter(of_table) {
                let left_out = format!("# {} =", &key.name[table.len()..]);
                let _ = writeln!(out, "{left_out:<30} {}", said(key));
            }
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::ink::paper::presets::PRESETS;

    /// Keys of a table, as the reader names them where one is unknown.
    fn read_keys(table: &str) -> BTreeSet<String> {
        let head = "format_version = 1\nkind = \"paper\"\ndescription = \"x\"\n";
        let text = if table.is_empty() {
            format!("{head}zzz = 1")
        } else {
            format!("{head}[{table}]\nzzz = 1")
        };
        let said = PaperStyle::parse(&text).unwrap_err();
        let (_, list) = said.split_once("expected one of ").expect(&said);
        let list = list.lines().next().unwrap_or_default();
        let names = list.split(", ").map(|n| n.trim_matches('`').to_owned());
        names.collect()
    }

    #[test]
    fn the_table_has_every_key_that_is_read_and_no_other() {
        let all: Vec<Key> = keys();
        let mut tables = vec![String::new()];
        let mut count = 0;
        while let Some(table) = tables.pop() {
            for name in read_keys(&table) {
                let name = if table.is_empty() {
                    name
                } else {
                    format!("{table}.{name}")
                };
                if all.iter().any(|k| k.name.starts_with(&format!("{name}."))) {
                    tables.push(name);
                } else {
                    assert!(all.iter().any(|k| k.name == name), "{name} is not told");
                    count += 1;
                }
            }
        }
        assert_eq!(count, all.len(), "keys that are not read");
    }

    #[test]
    fn presets_written_with_every_key_are_the_same_styles() {
        for (name, _) in PRESETS {
            let style = PaperStyle::named(name).unwrap().unwrap();
            let text = text(&style).unwrap();
            assert_eq!(PaperStyle::parse(&text).unwrap(), style, "{name}: {text}");
            for key in keys() {
                let last = key.name.rsplit('.').next().unwrap();
                assert!(
                    text.contains(&format!("{last} =")) || text.contains("[primitive.form"),
                    "{name}: {}",
                    key.name
                );
            }
        }
    }
}
