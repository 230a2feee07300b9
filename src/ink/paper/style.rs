//! How a drawing on paper is made: particles, primitives, thresholds and pens, in a file.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::modulation::{Modulation, resolve};
use super::pen::Pen;
pub use super::sizes::paper_size;
use super::svg::Profile;
use super::tiles::Tiles;
use super::vectors::Vectors;
use crate::ink::style::known_version;
use crate::{Error, Result};

/// Version of style files.
pub const FORMAT_VERSION: u32 = 1;

/// A style of drawings on paper. Unknown keys of a file are errors, numbers have ranges
/// ([`PaperStyle::check`]).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PaperStyle {
    /// [`FORMAT_VERSION`].
    pub format_version: u32,
    /// Says that this is a style of drawings on paper.
    pub kind: Kind,
    /// What it looks like, in a sentence.
    pub description: String,
    /// Seed of everything that is drawn by chance: by primitive, never by frame.
    #[serde(default)]
    pub seed: u32,
    /// What leaves are drawn as.
    #[serde(default)]
    pub primitive: Primitive,
    /// How depths are compared.
    #[serde(default)]
    pub depth: Depth,
    /// Lines of foliage.
    #[serde(default)]
    pub foliage: Foliage,
    /// Lines of trunk and branches.
    #[serde(default)]
    pub stem: Stem,
    /// The sun's shadow.
    #[serde(default)]
    pub shadow: Shadow,
    /// Vegetation of the ground.
    #[serde(default)]
    pub ground: Ground,
    /// Hatching tiles on clusters of leaves.
    #[serde(default)]
    pub tiles: Tiles,
    /// How vectors are found.
    #[serde(default)]
    pub vector: Vectors,
    /// Paper and ink.
    #[serde(default)]
    pub sheet: Sheet,
}

/// The kind of a style file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// A drawing on paper.
    Paper,
}

/// Outline of a primitive.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Form {
    /// A disc that faces the viewer.
    Disc,
    /// An ellipse, turned at random.
    Ellipse,
    /// A pointed leaf in nine views.
    Leaf,
    /// A lobed leaf in nine views.
    Maple,
    /// An outline of one's own: points in a disc of radius 1 about its middle, the first where the
    /// leaf is fixed; y upwards.
    Polygon(Vec<[f64; 2]>),
    /// Nine of them, row by row of a grid: the leaf's normal to the left, ahead, to the right;
    /// down, ahead, up.
    Views(Vec<Vec<[f64; 2]>>),
    /// One or nine of them in a file (SVG, TOML) beside the style's
    /// ([`outlines`](super::polygon_file::outlines)); with the style they become one of the two above.
    File(PathBuf),
}

/// What leaves are drawn as.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Primitive {
    /// Outline.
    pub form: Form,
    /// Particles that are drawn; leaves are thinned twig by twig until so many are left. 0: all.
    pub count: u32,
    /// Radius where the tree's range of depths is 10 (the paper's unit), 0.001 to 10.
    pub size: f64,
    /// Width of ellipses in shares of their length, 0.05 to 1.
    pub aspect: f64,
    /// Share by which outlines are deformed, 0 to 0.5.
    pub deformation: f64,
    /// Only the lower part of outlines is drawn.
    pub lower: bool,
    /// Share of the nine views that is used: 0 all leaves look alike, 1 full impression of space.
    pub views: f64,
    /// Weight of constant size on screen against perspective, 0 to 4 (w).
    pub constant_size: f64,
    /// Largest factor on the size by it, 1 to 100.
    pub largest: f64,
}

impl Default for Primitive {
    fn default() -> Self {
        Self {
            form: Form::Disc,
            count: 0,
            size: 0.15,
            aspect: 0.5,
            deformation: 0.0,
            lower: false,
            views: 1.0,
            constant_size: 0.0,
            largest: 2.0,
        }
    }
}

/// How depths are compared (equation 1).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Depth {
    /// As a depth buffer has them, rather than linear.
    pub mapped: bool,
    /// z0, above 0: the ratio of the two is the strength of abstraction.
    pub near: f64,
    /// z1, more than z0.
    pub far: f64,
    /// The plants' nearest and farthest become z0 and z1; otherwise these are metres, and sizes of
    /// primitives those at z0.
    pub fitted: bool,
    /// Where they are not fitted: z0 and z1 are tenths of the range of the plants' depths (the unit
    /// of sizes), whatever the model, rather than metres.
    pub relative: bool,
    /// What shows nothing is as far as z1, rather than infinitely far: outlines against the sky
    /// vanish at the back.
    pub sky_at_far: bool,
}

impl Default for Depth {
    fn default() -> Self {
        Self {
            mapped: true,
            near: 1.0,
            far: 11.0,
            fitted: true,
            relative: false,
            sky_at_far: false,
        }
    }
}

/// Lines of foliage.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Foliage {
    /// Whether they are drawn.
    pub draw: bool,
    /// Whether foliage that is not drawn hides what is behind it and throws shadows all the same;
    /// without it the tree is bare.
    pub hides: bool,
    /// Threshold, units of 1/65535 of the range, 0 to 65535.
    pub threshold: f64,
    /// What it is multiplied by from place to place.
    pub threshold_by: Option<Modulation>,
    /// The same of the pen's width.
    pub width_by: Option<Modulation>,
    /// Shorter pieces of outlines, and those under three pixels, are not drawn, millimetres, 0 (all are)
    /// to 50.
    pub shortest: f64,
    /// Their pen.
    pub pen: Pen,
}

impl Default for Foliage {
    fn default() -> Self {
        Self {
            draw: true,
            hides: true,
            threshold: 1000.0,
            threshold_by: None,
            width_by: None,
            shortest: 0.5,
            pen: Pen::default(),
        }
    }
}

/// Lines of trunk and branches.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Stem {
    /// Whether they are drawn.
    pub draw: bool,
    /// Highest branching order that is drawn, 0 (the trunk alone) to 255 (all).
    pub order: u32,
    /// Where orders cannot be told: radius of the thinnest branch that is drawn, shares of the
    /// trunk's, 0 (all) to 1.
    pub thinnest: f64,
    /// Threshold of outlines, units of 1/65535 of the range, 0 to 65535.
    pub threshold: f64,
    /// What it is multiplied by from place to place.
    pub threshold_by: Option<Modulation>,
    /// The same of the width of outlines.
    pub width_by: Option<Modulation>,
    /// Share of the surface's own slope that is no difference, 0 to 10.
    pub slope: f64,
    /// Branches narrower than so many widths of the pen are one line, without hatching; 0 (none) to 100.
    pub single: f64,
    /// Shorter pieces of outlines, and those under three pixels, are not drawn, millimetres, 0 (all are)
    /// to 50.
    pub shortest: f64,
    /// Pen of outlines.
    pub pen: Pen,
    /// Darkness that white to black surfaces get by strokes, 0 (none) to 1.
    pub hatching: f64,
    /// Light above which nothing is hatched, 0 to 1.
    pub white: f64,
    /// Darkness from which strokes cross, 0 to 1.
    pub crossing: f64,
    /// Whether strokes run along the branch rather than across it.
    pub along: bool,
    /// Length of strokes, millimetres, 0.2 to 50.
    pub stroke: f64,
    /// Strokes that are cut to less than this share of their length are not drawn, nor any on branches
    /// narrower than that; 0 (all are) to 1.
    pub stub: f64,
    /// Angle by which strokes stray at most, degrees, 0 to 90.
    pub stray: f64,
    /// Pen of strokes.
    pub hatching_pen: Pen,
}

impl Default for Stem {
    fn default() -> Self {
        Self {
            draw: true,
            order: 2,
            thinnest: 0.12,
            threshold: 300.0,
            threshold_by: None,
            width_by: None,
            slope: 3.0,
            single: 2.0,
            shortest: 1.0,
            pen: Pen::default(),
            hatching: 0.8,
            white: 0.75,
            crossing: 0.6,
            along: false,
            stroke: 2.5,
            stub: 0.5,
            stray: 6.0,
            hatching_pen: Pen {
                width: 0.2,
                ends: 0.4,
                taper: 1.0,
                ..Pen::default()
            },
        }
    }
}

/// How the sun's shadow is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ShadowForm {
    /// Not at all.
    None,
    /// As black areas.
    Black,
    /// As more detail and wider lines.
    Detail,
    /// As strokes.
    Hatch,
}

/// The sun's shadow.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Shadow {
    /// How it is drawn.
    pub form: ShadowForm,
    /// Way behind what the sun sees first that is still lit, in the paper's unit, 0 to 10.
    pub bias: f64,
    /// Way from there to the deepest shadow, in the paper's unit, 0.001 to 10.
    pub softness: f64,
    /// Texels on each side over which shadows are averaged, 0 to 8.
    pub reach: u32,
    /// Shadow (0 to 1) from which areas are black.
    pub black: f64,
    /// Growth of the foliage's threshold in shadow, -1 (none is left) to 1.
    pub detail: f64,
    /// Growth of the lines' width in shadow, 0 to 10.
    pub pressure: f64,
    /// Darkness of the deepest shadow when it is hatched, 0 to 1.
    pub hatching: f64,
    /// Darkness from which its strokes cross, 0 to 1 (nowhere).
    pub crossing: f64,
    /// Direction of its strokes, degrees from the right upwards, -180 to 180.
    pub angle: f64,
    /// Length of its strokes, millimetres, 0.2 to 50.
    pub stroke: f64,
    /// Those that are cut to less than this share of it are not drawn, 0 (all are) to 1.
    pub stub: f64,
    /// Pen of strokes, and of areas where a plotter fills them.
    pub pen: Pen,
}

impl Default for Shadow {
    fn default() -> Self {
        Self {
            form: ShadowForm::None,
            bias: 0.6,
            softness: 2.0,
            reach: 2,
            black: 0.6,
            detail: -0.9,
            pressure: 1.0,
            hatching: 0.6,
            crossing: 1.0,
            angle: 50.0,
            stroke: 4.0,
            stub: 0.35,
            pen: Pen {
                width: 0.25,
                ..Pen::default()
            },
        }
    }
}

/// Vegetation of the ground, of which only the shadow on it is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Ground {
    /// Particles; 0: no ground.
    pub count: u32,
    /// Their radius in the paper's unit, 0.001 to 10.
    pub size: f64,
    /// Radius of the ground in half widths of the plants, 0.1 to 20.
    pub extent: f64,
    /// Way behind what the sun sees first that is still lit, in the paper's unit, 0 to 10. Ground hides
    /// nothing of itself: at 0 shadows begin at the foot of what throws them.
    pub bias: f64,
    /// Way from there to the deepest shadow, in the paper's unit, 0.001 to 10.
    pub softness: f64,
    /// Colour of the shadow's ink on it, sRGB, 0 to 1; none: that of the shadow's pen.
    pub colour: Option<[f32; 3]>,
}

impl Default for Ground {
    fn default() -> Self {
        Self {
            count: 0,
            size: 0.2,
            extent: 1.6,
            bias: 0.05,
            softness: 0.2,
            colour: None,
        }
    }
}

/// Paper and ink.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Sheet {
    /// Width and height of the paper, millimetres, 10 to 5000.
    pub paper: [f64; 2],
    /// Free on every side, millimetres, 0 to 500.
    pub margin: f64,
    /// Pixels for a millimetre in which depths are compared, 1 to 40.
    pub resolution: f64,
    /// Largest distance of curves from the lines they stand for, millimetres, 0 (none: polylines)
    /// to 1.
    pub tolerance: f64,
    /// How lines are written.
    pub profile: Profile,
    /// Colour of the ink, sRGB, 0 to 1.
    pub ink: [f32; 3],
    /// Colour of the paper in pictures, sRGB, 0 to 1.
    pub colour: [f32; 3],
}

impl Default for Sheet {
    fn default() -> Self {
        Self {
            paper: [210.0, 297.0],
            margin: 12.0,
            resolution: 6.0,
            tolerance: 0.05,
            profile: Profile::Print,
            ink: [0.07, 0.065, 0.06],
            colour: [0.99, 0.985, 0.965],
        }
    }
}

impl PaperStyle {
    /// A built-in style by its name, or a file that says `kind = "paper"`; none where the name or
    /// the file is of another kind.
    ///
    /// # Errors
    /// A file that cannot be read, has unknown keys or numbers out of range.
    pub fn named(name: &str) -> Result<Option<Self>> {
        let path = Path::new(name);
        let is_file = path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("toml"));
        if is_file {
            let text = std::fs::read_to_string(path).map_err(|e| Error::file(path, e))?;
            let table: toml::Table = toml::from_str(&text).map_err(|e| Error::file(path, e))?;
            if !table.contains_key("kind") {
                return Ok(None);
            }
            let mut style: Self =
                toml::from_str(&text).map_err(|e| Error::file(path, e.to_string()))?;
            let folder = path.parent().unwrap_or(Path::new(""));
            if let Form::File(file) = &style.primitive.form {
                style.primitive.form = super::polygon_file::outlines(&folder.join(file))?;
            }
            let mut style = style.checked().map_err(|e| Error::file(path, e))?;
            resolve(&mut style, folder)?;
            return Ok(Some(style));
        }
        let Some((_, text)) = super::presets::PRESETS.iter().find(|p| p.0 == name) else {
            return Ok(None);
        };
        Self::parse(text)
            .map(Some)
            .map_err(|e| Error::usage(format!("style `{name}`: {e}")))
    }

    /// From the text of a file.
    ///
    /// # Errors
    /// What is wrong, and where.
    pub fn parse(text: &str) -> std::result::Result<Self, String> {
        let style: Self = toml::from_str(text).map_err(|e| e.to_string())?;
        style.checked()
    }

    /// Itself, if its version is known and its numbers are in range.
    fn checked(self) -> std::result::Result<Self, String> {
        let style = self;
        known_version(style.format_version, FORMAT_VERSION)?;
        style.check()?;
        Ok(style)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_preset_is_a_style_and_comes_back_from_its_own_text() {
        for (name, _) in super::super::presets::PRESETS {
            let style = PaperStyle::named(name).unwrap().unwrap();
            let text = toml::to_string(&style).unwrap();
            assert_eq!(PaperStyle::parse(&text).unwrap(), style, "{name}");
        }
    }

    #[test]
    fn wrong_styles_are_refused_with_what_is_wrong() {
        let base = "format_version = 1\nkind = \"paper\"\ndescription = \"x\"\n";
        for (text, said) in [
            ("[primitive]\ncolour = 1", "colour"),
            ("[primitive]\nsize = nan", "primitive.size = NaN"),
            ("[foliage]\nthreshold = 70000.0", "foliage.threshold"),
            ("[depth]\nfar = 0.5", "depth.far"),
            ("[sheet]\nmargin = 105.0", "sheet.margin"),
            ("[sheet]\npaper = [0.0, 297.0]", "sheet.paper"),
            ("[stem.pen]\nwidth = 0.0", "stem.pen.width"),
            (
                "[stem.pen]\ncolour = [0.1, 1.2, 0.0]",
                "stem.pen.colour = 1.2",
            ),
            ("[ground]\ncolour = [nan, 0.0, 0.0]", "ground.colour = NaN"),
            ("[tiles]\ncolour = [0.5, 0.5]", "colour"),
            (
                "[primitive]\nform = { polygon = [[0.0, 0.0], [1.0, 0.0]] }",
                "three points",
            ),
        ] {
            let error = PaperStyle::parse(&format!("{base}{text}")).unwrap_err();
            assert!(error.contains(said), "{text}: {error}");
        }
    }
}
