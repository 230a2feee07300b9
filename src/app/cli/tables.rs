//! Which tables of settings become arguments of which commands.

use super::chosen::{Row, SettingTable};
use crate::{foliage, render};

/// Settings of the picture.
#[derive(Debug, Clone, Copy)]
pub struct PictureTable;

impl SettingTable for PictureTable {
    const HEADING: &'static str = "Picture";

    fn rows() -> Vec<Row> {
        let defaults = render::RenderSettings::default();
        let row = |s: &render::SettingInfo| Row {
            name: s.name.to_owned(),
            value: s.unit.to_owned(),
            help: s.help.to_owned(),
            default: (s.get)(&defaults),
        };
        render::SETTINGS.iter().map(row).collect()
    }
}

/// Settings of the bake that are about what is stored in a file: the renderer has its own.
const EXPORT_ONLY: &[&str] = &["back_faces"];

/// Settings of the bake that no command takes: the renderer chooses its own encoding, and files
/// hold floats.
const NOWHERE: &[&str] = &["encoding"];

/// Settings of the foliage, where the result is drawn.
#[derive(Debug, Clone, Copy)]
pub struct FoliageTable;

impl SettingTable for FoliageTable {
    const HEADING: &'static str = "Foliage";

    fn rows() -> Vec<Row> {
        foliage_rows(|name| !EXPORT_ONLY.contains(&name))
    }
}

/// Settings of the foliage, where the result is written into a model.
#[derive(Debug, Clone, Copy)]
pub struct ExportTable;

impl SettingTable for ExportTable {
    const HEADING: &'static str = "Foliage";

    fn rows() -> Vec<Row> {
        foliage_rows(|_| true)
    }
}

/// Whether some command takes this setting.
#[must_use]
pub fn is_taken(setting: &foliage::SettingInfo) -> bool {
    !NOWHERE.contains(&setting.name)
}

fn foliage_rows(wanted: impl Fn(&str) -> bool) -> Vec<Row> {
    let row = |s: &foliage::SettingInfo| Row {
        name: s.name.replace('_', "-"),
        value: if s.unit.is_empty() { "NAME" } else { "NUMBER" }.to_owned(),
        help: match s.unit {
            "" | "number" => format!("{}: {}", s.help, s.range),
            unit => format!("{}: {} ({unit})", s.help, s.range),
        },
        default: s.default(),
    };
    let rows = foliage::SETTINGS.iter();
    rows.filter(|s| is_taken(s) && wanted(s.name))
        .map(row)
        .collect()
}
