//! `umbrage settings`: the table that command line, scene files and sweeps are made from.

use std::fmt::Write as _;

use serde_json::{Value, json};

use crate::app::cli::{SettingsArgs, tables};
use crate::app::{Context, Report};
use crate::{Error, Result, foliage, render};

/// Prints the settings whose name contains the filter.
///
/// # Errors
/// None has such a name.
pub fn run(_context: &Context, args: &SettingsArgs) -> Result<Report> {
    let filter = args.filter.as_deref().unwrap_or("").replace('_', "-");
    let rows: Vec<Row> = all()
        .into_iter()
        .filter(|row| row.name.contains(&filter))
        .collect();
    if rows.is_empty() {
        return Err(Error::usage(format!(
            "settings: no setting has a name that contains {filter:?}"
        )));
    }
    let json: Value = rows.iter().map(Row::json).collect();
    Ok(Report::new(text(&rows), json!({ "settings": json })))
}

/// A setting of either table.
struct Row {
    table: &'static str,
    name: String,
    default: String,
    unit: &'static str,
    range: &'static str,
    help: &'static str,
    trades: &'static str,
    exact_end: &'static str,
}

impl Row {
    fn json(&self) -> Value {
        json!({
            "table": self.table, "name": self.name, "default": self.default,
            "unit": self.unit, "range": self.range, "help": self.help,
            "trades": self.trades, "exact_end": self.exact_end,
        })
    }
}

fn all() -> Vec<Row> {
    let picture = render::RenderSettings::default();
    let taken = foliage::SETTINGS.iter().filter(|s| tables::is_taken(s));
    let of_foliage = taken.map(|s| Row {
        table: "foliage",
        name: s.name.replace('_', "-"),
        default: s.default(),
        unit: s.unit,
        range: s.range,
        help: s.help,
        trades: s.trades,
        exact_end: s.exact_end,
    });
    let of_picture = render::SETTINGS.iter().map(|s| Row {
        table: "picture",
        name: s.name.to_owned(),
        default: (s.get)(&picture),
        unit: s.unit,
        range: s.range,
        help: s.help,
        trades: s.trades,
        exact_end: s.exact_end,
    });
    of_foliage.chain(of_picture).collect()
}

fn text(rows: &[Row]) -> String {
    let mut out = String::new();
    let mut table = "";
    for row in rows {
        if row.table != table {
            table = row.table;
            let _ = writeln!(out, "[{table}]");
        }
        let _ = writeln!(out, "{} = {}", row.name, row.default);
        let mut line = |label: &str, value: &str| {
            if !value.is_empty() {
                let _ = writeln!(out, "    {label}{value}");
            }
        };
        line("", row.help);
        line("unit: ", row.unit);
        line("range: ", row.range);
        line("trades: ", row.trades);
        line("exact end: ", row.exact_end);
    }
    out
}
