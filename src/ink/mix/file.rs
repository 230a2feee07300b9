//! Mix files: TOML that names styles and says where they are.
//!
//! ```toml
//! format_version = 1
//! description = "Near leaves hatched"
//! default = "outline"            # a style's name, a file beside this one, or one of [styles]
//!
//! [[part]]                       # the first part that claims a thing has it
//! style = "silhouette-hatching"
//! objects = "^oak"               # a regular expression, as --foliage takes it
//! materials = "leaf"
//! distance = [0.0, 20.0]         # metres along the direction of view; or
//! # share = [0.0, 0.5]           # of the range of what is drawn
//! mask = "mask.png"              # beside this file
//! values = [0.5, 1.0]            # brightness that is part
//! window = [0.0, 0.0, 0.5, 1.0]  # left, top, right, bottom in shares of the picture
//!
//! [styles.fine]                  # a style of this file alone: what a style file says
//! contour = { strength = 1.0 }
//! ```

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use regex::{Regex, RegexBuilder};
use serde::Deserialize;

use super::rule::{Mask, Mix, Part, Span};
use crate::ink::style::{FORMAT_VERSION, PRESETS, Style, known_version};
use crate::scene::{ImageSource, textures};
use crate::{Error, Result};

/// Built-in mixes: name and file.
/// Built-in mixes: name and file.
pub const MIXES: [(&str, &str); 1] = [("mixed", include_str!("../presets/mixed.toml"))];

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct MixFile {
    format_version: u32,
    #[expect(dead_code, reason = "for the reader of the file")]
    description: String,
    default: String,
    #[serde(default)]
    styles: BTreeMap<String, toml::Table>,
    #[serde(default)]
    part: Vec<PartFile>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct PartFile {
    style: String,
    objects: Option<String>,
    materials: Option<String>,
    distance: Option<[f32; 2]>,
    share: Option<[f32; 2]>,
    mask: Option<PathBuf>,
    values: Option<[f32; 2]>,
    window: Option<[f32; 4]>,
}

impl Mix {
    /// A built-in style or mix by its name, or a file of either (its name ends in `.toml`).
    ///
    /// # Errors
    /// No such style; a file that cannot be read, has unknown keys or numbers out of range.
    pub fn named(name: &str) -> Result<Self> {
        let path = Path::new(name);
        let is_file = path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("toml"));
        if !is_file {
            if let Some((_, text)) = MIXES.iter().find(|m| m.0 == name) {
                return Self::parse(text, Path::new(""))
                    .map_err(|e| Error::usage(format!("style `{name}`: {e}")));
            }
            if !PRESETS.iter().any(|p| p.0 == name) {
                let papers = crate::ink::paper::presets::PRESETS.iter().map(|p| p.0);
                let names: Vec<&str> = Self::presets().chain(papers).collect();
                return Err(Error::usage(format!(
                    "style `{name}`: expected {} or a file (.toml)",
                    names.join(", ")
                )));
            }
            return Style::named(name).map(|style| Self::alone(name, style));
        }
        let text = std::fs::read_to_string(path).map_err(|e| Error::file(path, e))?;
        let table: toml::Table = toml::from_str(&text).map_err(|e| Error::file(path, e))?;
        if ["default", "part", "styles"]
            .iter()
            .any(|k| table.contains_key(*k))
        {
            let folder = path.parent().unwrap_or(Path::new(""));
            return Self::parse(&text, folder).map_err(|e| Error::file(path, e));
        }
        Style::named(name).map(|style| Self::alone(name, style))
    }

    fn alone(name: &str, style: Style) -> Self {
        Self {
            names: vec![short(name)],
            ..Self::single(style)
        }
    }

    /// Names of built-in styles and mixes.
    pub fn presets() -> impl Iterator<Item = &'static str> {
        let mut names: Vec<&str> = PRESETS.iter().chain(&MIXES).map(|p| p.0).collect();
        names.sort_unstable();
        names.into_iter()
    }

    /// From the text of a file whose files are named relative to `folder`.
    ///
    /// # Errors
    /// What is wrong, and where.
    pub fn parse(text: &str, folder: &Path) -> std::result::Result<Self, String> {
        let file: MixFile = toml::from_str(text).map_err(|e| e.to_string())?;
        known_version(file.format_version, FORMAT_VERSION)?;
        let style = |name: &str| style(name, &file.styles, folder);
        let mut mix = Self {
            styles: vec![style(&file.default)?],
            names: vec![short(&file.default)],
            parts: Vec::new(),
        };
        for (number, part) in (1..).zip(&file.part) {
            let at = |e| format!("part {number}: {e}");
            let own = style(&part.style).map_err(at)?;
            let own = mix.add(&short(&part.style), own).map_err(at)?;
            mix.parts.push(part.rule(own, folder).map_err(at)?);
        }
        mix.check()?;
        Ok(mix)
    }
}

/// What passes and messages call a style: of a file, its stem.
/// A style's name on labels: a file's without its folder and ending.
#[must_use]
pub fn short(name: &str) -> String {
    let stem = Path::new(name).file_stem().unwrap_or_default();
    match name.to_ascii_lowercase().ends_with(".toml") {
        true => stem.to_string_lossy().into_owned(),
        false => name.to_owned(),
    }
}

/// A style by its name in the file, among the built-in ones or as a file.
fn style(
    name: &str,
    own: &BTreeMap<String, toml::Table>,
    folder: &Path,
) -> std::result::Result<Style, String> {
    if let Some(table) = own.get(name) {
        let mut table = table.clone();
        let version = i64::from(FORMAT_VERSION);
        table.entry("format_version").or_insert(version.into());
        table.entry("description").or_insert(name.into());
        let text = toml::to_string(&table).map_err(|e| e.to_string())?;
        let mut style = Style::parse(&text).map_err(|e| format!("styles.{name}: {e}"))?;
        style.resolve(folder);
        style.check_files().map_err(|e| e.to_string())?;
        return Ok(style);
    }
    let is_file = name.to_ascii_lowercase().ends_with(".toml");
    let place = folder.join(name);
    let found = Style::named(&if is_file {
        place.to_string_lossy()
    } else {
        name.into()
    });
    found.map_err(|e| e.to_string())
}

impl PartFile {
    fn rule(&self, style: usize, folder: &Path) -> std::result::Result<Part, String> {
        let distance = match (self.distance, self.share) {
            (Some(_), Some(_)) => return Err("distance and share: expected one of them".into()),
            (Some(range), None) => Some(Span::Metres(rising("distance", range)?)),
            (None, Some(range)) => Some(Span::Share(rising("share", range)?)),
            (None, None) => None,
        };
        if self.values.is_some() && self.mask.is_none() {
            return Err("values: there is no mask that they could be of".into());
        }
        let mask = self.mask.as_ref().map(|file| self.mask(&folder.join(file)));
        let part = Part {
            style,
            objects: pattern("objects", self.objects.as_deref())?,
            materials: pattern("materials", self.materials.as_deref())?,
            distance,
            window: self.window.map(window).transpose()?,
            mask: mask.transpose()?,
        };
        if part.objects.is_none()
            && part.materials.is_none()
            && part.distance.is_none()
            && !part.is_masked()
        {
            return Err(
                "claims everything: expected objects, materials, distance, share, \
                        window or mask (`default` is the style of the rest)"
                    .into(),
            );
        }
        Ok(part)
    }

    fn mask(&self, file: &Path) -> std::result::Result<Mask, String> {
        let name = file.display().to_string();
        let bytes = std::fs::read(file).map_err(|e| format!("mask {name}: {e}"))?;
        let source = ImageSource::Encoded {
            name: name.clone(),
            bytes: bytes.into(),
        };
        let image = textures::decode(&source).map_err(|e| format!("mask {e}"))?;
        let [low, high] = self.values.unwrap_or([0.5, 1.0]);
        // Also false for NaN.
        if !(low >= 0.0 && low <= high && high <= 1.0) {
            return Err(format!(
                "values = [{low}, {high}]: expected rising numbers from 0 to 1"
            ));
        }
        Ok(Mask {
            name,
            image,
            values: [low, high],
        })
    }
}

fn rising(key: &str, [low, high]: [f32; 2]) -> std::result::Result<[f32; 2], String> {
    if low >= 0.0 && low < high {
        return Ok([low, high]);
    }
    Err(format!(
        "{key} = [{low}, {high}]: expected rising numbers from 0"
    ))
}

fn window(w: [f32; 4]) -> std::result::Result<[f32; 4], String> {
    let [left, top, right, bottom] = w;
    // Also false for NaN.
    if w.iter().all(|v| (0.0..=1.0).contains(v)) && left < right && top < bottom {
        return Ok(w);
    }
    Err(format!(
        "window = {w:?}: expected left, top, right, bottom from 0 to 1"
    ))
}

fn pattern(key: &str, text: Option<&str>) -> std::result::Result<Option<Regex>, String> {
    let compile = |text| RegexBuilder::new(text).case_insensitive(true).build();
    let compiled = text.map(compile).transpose();
    compiled.map_err(|e| format!("{key}: no regular expression: {e}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> std::result::Result<Mix, String> {
        let head = "format_version = 1\ndescription = \"x\"\ndefault = \"outline\"\n";
        Mix::parse(&format!("{head}{text}"), Path::new(""))
    }

    #[test]
    fn every_preset_is_a_style_or_a_mix() {
        for name in Mix::presets() {
            let mix = Mix::named(name).unwrap();
            assert_eq!(mix.is_mixed(), MIXES.iter().any(|m| m.0 == name), "{name}");
        }
    }

    #[test]
    fn equal_styles_are_one_and_the_default_is_first() {
        let mix = parse(
            "[[part]]\nstyle = \"minimal\"\nobjects = \"oak\"\n\
             [[part]]\nstyle = \"outline\"\nmaterials = \"bark\"\n\
             [[part]]\nstyle = \"fine\"\ndistance = [0, 20.0]\n\
             [[part]]\nstyle = \"minimal\"\nshare = [0.5, 1]\n\
             [styles.fine.contour]\nstrength = 0.5\n",
        )
        .unwrap();
        assert_eq!(mix.names, ["outline", "minimal", "fine"]);
        let styles: Vec<usize> = mix.parts.iter().map(|p| p.style).collect();
        assert_eq!(styles, [1, 0, 2, 1]);
        assert!(mix.follows_view());
        assert!((mix.styles[2].contour.strength - 0.5).abs() < 1e-6);
        assert!(!Mix::single(mix.styles[0].clone()).is_mixed());
    }

    #[test]
    fn wrong_mixes_are_refused_with_what_is_wrong() {
        for (text, said) in [
            (
                "[[part]]\nstyle = \"nobody\"\nshare = [0, 1]",
                "part 1: style `nobody`",
            ),
            ("[[part]]\nstyle = \"minimal\"", "claims everything"),
            ("[[part]]\nstyle = \"minimal\"\nobject = \"a\"", "object"),
            (
                "[[part]]\nstyle = \"minimal\"\nobjects = \"(\"",
                "regular expression",
            ),
            (
                "[[part]]\nstyle = \"minimal\"\ndistance = [2, 1]",
                "distance = [2, 1]",
            ),
            (
                "[[part]]\nstyle = \"minimal\"\ndistance = [nan, 1]",
                "distance",
            ),
            (
                "[[part]]\nstyle = \"minimal\"\nwindow = [0.5, 0, 0.2, 1]",
                "window = [0.5",
            ),
            ("[[part]]\nstyle = \"minimal\"\nvalues = [0, 1]", "no mask"),
            (
                "[[part]]\nstyle = \"minimal\"\nmask = \"no-such.png\"",
                "no-such.png",
            ),
            (
                "[[part]]\nstyle = \"minimal\"\ndistance = [0, 2]\nshare = [0, 1]",
                "one of them",
            ),
            (
                "[[part]]\nstyle = \"minimal\"\ndistance = [0, 20]\n\
                 [[part]]\nstyle = \"full\"\ndistance = [10, 30]",
                "part 2: its distances 10 to 30 overlap those of part 1",
            ),
            (
                "[[part]]\nstyle = \"bad\"\nshare = [0, 1]\n[styles.bad.contour]\nwidht = 1.0",
                "widht",
            ),
            (
                "[[part]]\nstyle = \"bad\"\nshare = [0, 1]\n[styles.bad.leaves]\nshape = 3.0",
                "leaves.shape",
            ),
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.contains(said), "{text}: {error}");
        }
        // Distances apart, or of different objects, may be as they are.
        for apart in [
            "distance = [20, 30]",
            "objects = \"a\"\ndistance = [10, 30]",
        ] {
            parse(&format!(
                "[[part]]\nstyle = \"minimal\"\ndistance = [0, 20]\n\
                 [[part]]\nstyle = \"full\"\n{apart}"
            ))
            .unwrap();
        }
    }

    #[test]
    fn a_ninth_style_and_a_part_too_many_are_refused() {
        let part = |k: u32| {
            format!(
                "[[part]]\nstyle = \"s{k}\"\nobjects = \"o{k}\"\n\
                 [styles.s{k}.contour]\nstrength = 0.{k}\n"
            )
        };
        let parts = |n: u32| (1..=n).map(part).collect::<String>();
        assert_eq!(parse(&parts(7)).unwrap().styles.len(), 8);
        let error = parse(&parts(8)).unwrap_err();
        assert!(
            error.contains("part 8: style `s8` is one too many"),
            "{error}"
        );
        let many = "[[part]]\nstyle = \"full\"\nobjects = \"a\"\n".repeat(33);
        let error = parse(&many).unwrap_err();
        assert!(error.contains("33 parts"), "{error}");
    }
}
