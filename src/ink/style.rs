//! A drawing style: the axes of Coconu, Deussen, Hege 2006 (figure 2) as numbers, in a file.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::strokes::{Listed, ListedLine, ListedTick};
use super::style_looks;
pub use super::style_looks::{Edges, Shading, Wash};
use crate::{Error, Result};

/// Version of style files.
pub const FORMAT_VERSION: u32 = 1;

/// A style. Every number has a range ([`Style::check`]); unknown keys of a file are errors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Style {
    /// [`FORMAT_VERSION`].
    pub format_version: u32,
    /// What it looks like, in a sentence.
    pub description: String,
    /// Seed of strokes and of the order of leaves.
    #[serde(default)]
    pub seed: u32,
    /// Clusters and leaves.
    #[serde(default)]
    pub leaves: Leaves,
    /// What is no leaf.
    #[serde(default)]
    pub bodies: Bodies,
    /// Outlines by depth.
    #[serde(default)]
    pub contour: Contour,
    /// Strokes along outlines.
    #[serde(default)]
    pub silhouette: Silhouette,
    /// Strokes for tone.
    #[serde(default)]
    pub hatching: Hatching,
    /// Light.
    #[serde(default)]
    pub shading: Shading,
    /// Lines where normals turn.
    #[serde(default)]
    pub edges: Edges,
    /// Transparent paint.
    #[serde(default)]
    pub wash: Wash,
    /// Paper and ink.
    #[serde(default)]
    pub paper: Paper,
}

/// How leaves are placed, turned and shaped.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Leaves {
    /// Largest radius of a cluster, shares of the foliage's diagonal, 0.001 to 1.
    pub cluster_radius: f32,
    /// Of the spheres that would do, a leaf joins the oldest instead of the one that ends smallest.
    pub first_fit: bool,
    /// From their own place (0) to their cluster's sphere (1).
    pub displacement: f32,
    /// From their own normal (0) to their cluster's (1).
    pub orientation: f32,
    /// From that normal (0) to facing the viewer (1).
    pub facing: f32,
    /// Factor on their size, 0 to 20.
    pub size: f32,
    /// From the leaf's outline (1) to the disc around it (0).
    pub shape: f32,
    /// Length over width, times what the leaf has, 0.1 to 10; the area stays.
    pub elongation: f32,
    /// From the leaf's own direction (0) to round its cluster, as the viewer sees it (1).
    pub swirl: f32,
    /// Share of the leaves that is drawn; the rest is dropped in a fixed random order.
    pub kept: f32,
    /// Enlarges the leaves that are left, so that their area stays (1), or not (0).
    pub enlarge: f32,
    /// Where leaves are less wide than so many pixels, fewer and larger ones are drawn, as discs, and
    /// thin wood as lines; 0 to 64, 0: never.
    pub lod: f32,
    /// Picture of the shape at the end of `shape` instead of the disc: opaque, or black on white.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outline: Option<PathBuf>,
}

impl Default for Leaves {
    fn default() -> Self {
        Self {
            cluster_radius: 0.06,
            first_fit: false,
            displacement: 0.0,
            orientation: 0.0,
            facing: 0.0,
            size: 1.0,
            shape: 1.0,
            elongation: 1.0,
            swirl: 0.0,
            kept: 1.0,
            enlarge: 1.0,
            lod: 0.0,
            outline: None,
        }
    }
}

/// What is no leaf: branches, or smooth bodies.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Bodies {
    /// Smooth bodies, hatched by clusters of their vertices; a model without leaves is welcome.
    pub smooth: bool,
    /// Largest radius of such a cluster, shares of the model's diagonal, 0.005 to 1.
    pub cluster_radius: f32,
}

impl Default for Bodies {
    fn default() -> Self {
        Self {
            smooth: false,
            cluster_radius: 0.12,
        }
    }
}

/// Outlines where depth leaps.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Contour {
    /// Strength, 0 (none) to 1.
    pub strength: f32,
    /// Least difference of depth, shares of the plants' range of depths, 0 to 1.
    pub threshold: f32,
    /// The same on wood.
    pub threshold_wood: f32,
    /// Width, pixels, 0.25 to 12.
    pub width: f32,
    /// Depths by equation 1 of Deussen and Strothotte 2000 with this z1 / z0 instead of linear
    /// ones; 0: linear.
    pub mapping: f32,
    /// Contour pixels with fewer neighbours are removed, 0 to 8.
    pub neighbours: u32,
    /// Growth of the threshold where clusters face the viewer, 0 to 100.
    pub detail: f32,
    /// Power of the cosine in it, 0.1 to 16.
    pub detail_power: f32,
}

impl Default for Contour {
    fn default() -> Self {
        Self {
            strength: 0.0,
            threshold: 0.02,
            threshold_wood: 0.02,
            width: 1.0,
            mapping: 0.0,
            neighbours: 2,
            detail: 0.0,
            detail_power: 1.0,
        }
    }
}

/// Strokes that follow outlines.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Silhouette {
    /// Strength, 0 (none) to 1.
    pub strength: f32,
    /// Width of the band of strokes, pixels, 1 to 48.
    pub width: f32,
    /// Length of the strokes' image, pixels, 8 to 1024.
    pub length: f32,
    /// Aspect, 0.1 to 10.
    pub aspect: f32,
    /// Blends neighbouring channels of tone instead of choosing one.
    pub blend: bool,
    /// Picture of the strokes: four channels, or four rows, from dark to light.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub band: Option<PathBuf>,
    /// Lines along the outline instead of the program's: channel (0 darkest to 3), u, length (of the
    /// band), v, width (texels), where it is thickest (0 to 1), enter, leave (texels).
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub strokes: Vec<ListedLine>,
    /// Ticks inwards: channel, u, depth (texels), lean, bend (of the depth), half width (texels).
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub ticks: Vec<ListedTick>,
}

impl Default for Silhouette {
    fn default() -> Self {
        Self {
            strength: 0.0,
            width: 12.0,
            length: 96.0,
            aspect: 1.0,
            blend: false,
            band: None,
            strokes: Vec::new(),
            ticks: Vec::new(),
        }
    }
}

/// How strokes run on branches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum WoodStrokes {
    /// Round them.
    #[default]
    Round,
    /// Along them.
    Along,
}

/// What hatching lies on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum HatchSpace {
    /// The clusters' fronts, as the viewer sees them (the paper's way).
    #[default]
    Cluster,
    /// The picture: strokes swim over what moves.
    Screen,
    /// The clusters' spheres: strokes shrink and shorten with them, and bunch at their poles.
    Object,
}

/// A tile as pictures.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Painted {
    /// One picture of thresholds: the darker, the lighter the tone from which it is ink.
    One(PathBuf),
    /// Pictures of one tone each, from light to dark.
    Several(Vec<PathBuf>),
}

impl Painted {
    /// Its first file, for messages.
    #[must_use]
    pub fn first(&self) -> &Path {
        match self {
            Self::One(path) => path,
            Self::Several(paths) => paths.first().map_or(Path::new(""), |p| p),
        }
    }
}

/// Strokes that give tone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Hatching {
    /// Strength, 0 (none) to 1.
    pub strength: f32,
    /// Size of the strokes, pixels of the picture for one of the tile, 0.05 to 20.
    pub scale: f32,
    /// Packs strokes towards the limb (c of equation 8), -0.5 to 2; pi/2 - 1 is the sphere's own.
    pub packing: f32,
    /// Tone above which nothing is hatched, 0 to 1.
    pub white: f32,
    /// Exponent on the darkness, 0.1 to 10.
    pub gamma: f32,
    /// Starts every cluster's strokes elsewhere, against repetition.
    pub scatter: bool,
    /// Strokes of all clusters of an object follow the camera's way about the object's middle (the
    /// paper, read literally) instead of about their own; they slip beside it.
    pub per_object: bool,
    /// How strokes run on branches.
    pub wood: WoodStrokes,
    /// Steps of the packing (the paper's figure 9c has 3); 0: smooth.
    pub packing_steps: u32,
    /// Pictures of the tile instead of strokes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tile: Option<Painted>,
    /// Strokes of the tile instead of the program's: u, v, length (edges of the tile), angle
    /// (degrees), bend (lengths), width (texels), tone (0 to 1), coarsest level (0 to 4).
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub strokes: Vec<Listed>,
    /// Width of the program's strokes, texels, 0.5 to 16.
    pub stroke_width: f32,
    /// Shortest and longest of them, edges of the tile, 0.02 to 1.
    pub stroke_length: [f32; 2],
    /// Scatter of their directions, degrees, 0 to 45.
    pub stroke_jitter: f32,
    /// Darkness above which strokes cross, 0 to 1; 1: never.
    pub crossing: f32,
    /// Direction of those that cross, degrees, -90 to 90.
    pub cross_angle: f32,
    /// Tones in which the tile is filled, 2 to 64.
    pub tones: u32,
    /// What hatching lies on; all but `cluster` are there to compare with.
    pub space: HatchSpace,
    /// Strokes keep their width and distance when they come nearer or go away: they are chosen from
    /// levels; without, they are painted on.
    pub levels: bool,
}

impl Default for Hatching {
    fn default() -> Self {
        Self {
            strength: 0.0,
            scale: 0.5,
            packing: std::f32::consts::FRAC_PI_2 - 1.0,
            white: 0.75,
            gamma: 1.0,
            scatter: true,
            per_object: false,
            wood: WoodStrokes::Round,
            packing_steps: 0,
            tile: None,
            strokes: Vec::new(),
            stroke_width: 1.6,
            stroke_length: [0.14, 0.6],
            stroke_jitter: 4.0,
            crossing: 0.6,
            cross_angle: 90.0,
            tones: 36,
            space: HatchSpace::Cluster,
            levels: true,
        }
    }
}

/// Paper and ink.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Paper {
    /// Colour of the paper, sRGB, 0 to 1.
    pub colour: [f32; 3],
    /// Colour of the ink, sRGB, 0 to 1.
    pub ink: [f32; 3],
}

impl Default for Paper {
    fn default() -> Self {
        Self {
            colour: [0.99, 0.985, 0.965],
            ink: [0.07, 0.065, 0.06],
        }
    }
}

/// Built-in styles: name and file.
pub const PRESETS: [(&str, &str); 14] = [
    ("full", include_str!("presets/full.toml")),
    ("half", include_str!("presets/half.toml")),
    ("leaves", include_str!("presets/leaves.toml")),
    ("minimal", include_str!("presets/minimal.toml")),
    ("normal-edges", include_str!("presets/normal-edges.toml")),
    (
        "normal-edges-original",
        include_str!("presets/normal-edges-original.toml"),
    ),
    ("outline", include_str!("presets/outline.toml")),
    ("photo", include_str!("presets/photo.toml")),
    ("pointillist", include_str!("presets/pointillist.toml")),
    (
        "silhouette-hatching",
        include_str!("presets/silhouette-hatching.toml"),
    ),
    ("smooth", include_str!("presets/smooth.toml")),
    ("toon", include_str!("presets/toon.toml")),
    ("van-gogh", include_str!("presets/van-gogh.toml")),
    ("watercolour", include_str!("presets/watercolour.toml")),
];

/// Whether the version of a file of styles is the one that this program reads (`known`).
///
/// # Errors
/// It is not.
pub(super) fn known_version(version: u32, known: u32) -> std::result::Result<(), String> {
    if version == known {
        Ok(())
    } else {
        Err(format!(
            "format_version {version}: this program reads {known}"
        ))
    }
}

impl Style {
    /// A built-in style by its name, or a file (its name ends in `.toml`).
    ///
    /// # Errors
    /// No such style; a file that cannot be read, has unknown keys or numbers out of range.
    pub fn named(name: &str) -> Result<Self> {
        let path = Path::new(name);
        if path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("toml"))
        {
            let text = std::fs::read_to_string(path).map_err(|e| Error::file(path, e))?;
            let mut style = Self::parse(&text).map_err(|e| Error::file(path, e))?;
            style.resolve(path.parent().unwrap_or(Path::new("")));
            style.check_files().map_err(|e| Error::file(path, e))?;
            return Ok(style);
        }
        let Some((_, text)) = PRESETS.iter().find(|p| p.0 == name) else {
            let paper = super::paper::presets::PRESETS.iter().map(|p| p.0);
            if paper.clone().any(|p| p == name) {
                return Err(Error::usage(format!(
                    "style `{name}`: draws on paper; expected a style of pictures in real time"
                )));
            }
            let names: Vec<&str> = PRESETS.iter().map(|p| p.0).chain(paper).collect();
            return Err(Error::usage(format!(
                "style `{name}`: expected {} or a file (.toml)",
                names.join(", ")
            )));
        };
        Self::parse(text).map_err(|e| Error::usage(format!("style `{name}`: {e}")))
    }

    /// From the text of a file.
    ///
    /// # Errors
    /// What is wrong, and where.
    pub fn parse(text: &str) -> std::result::Result<Self, String> {
        let style: Self = toml::from_str(text).map_err(|e| e.to_string())?;
        known_version(style.format_version, FORMAT_VERSION)?;
        style.check()?;
        Ok(style)
    }

    /// Whether every number lies in its range.
    ///
    /// # Errors
    /// The first that does not, with its range.
    pub fn check(&self) -> std::result::Result<(), String> {
        let (l, c, s) = (&self.leaves, &self.contour, &self.silhouette);
        let (h, p) = (&self.hatching, &self.paper);
        let numbers = [
            ("leaves.cluster_radius", l.cluster_radius, 0.001, 1.0),
            ("leaves.displacement", l.displacement, 0.0, 1.0),
            ("leaves.orientation", l.orientation, 0.0, 1.0),
            ("leaves.facing", l.facing, 0.0, 1.0),
            ("leaves.size", l.size, 0.0, 20.0),
            ("leaves.shape", l.shape, 0.0, 1.0),
            ("leaves.elongation", l.elongation, 0.1, 10.0),
            ("leaves.swirl", l.swirl, 0.0, 1.0),
            ("leaves.kept", l.kept, 0.0, 1.0),
            ("leaves.enlarge", l.enlarge, 0.0, 1.0),
            ("leaves.lod", l.lod, 0.0, 64.0),
            (
                "bodies.cluster_radius",
                self.bodies.cluster_radius,
                0.005,
                1.0,
            ),
            ("contour.strength", c.strength, 0.0, 1.0),
            ("contour.threshold", c.threshold, 0.0, 1.0),
            ("contour.threshold_wood", c.threshold_wood, 0.0, 1.0),
            ("contour.width", c.width, 0.25, 12.0),
            ("contour.mapping", c.mapping, 0.0, 1e6),
            ("contour.neighbours", c.neighbours as f32, 0.0, 8.0),
            ("contour.detail", c.detail, 0.0, 100.0),
            ("contour.detail_power", c.detail_power, 0.1, 16.0),
            ("silhouette.strength", s.strength, 0.0, 1.0),
            ("silhouette.width", s.width, 1.0, 48.0),
            ("silhouette.length", s.length, 8.0, 1024.0),
            ("silhouette.aspect", s.aspect, 0.1, 10.0),
            ("hatching.strength", h.strength, 0.0, 1.0),
            ("hatching.scale", h.scale, 0.05, 20.0),
            ("hatching.packing", h.packing, -0.5, 2.0),
            ("hatching.packing_steps", h.packing_steps as f32, 0.0, 16.0),
            ("hatching.stroke_width", h.stroke_width, 0.5, 16.0),
            ("hatching.stroke_length", h.stroke_length[0], 0.02, 1.0),
            ("hatching.stroke_length", h.stroke_length[1], 0.02, 1.0),
            ("hatching.stroke_jitter", h.stroke_jitter, 0.0, 45.0),
            ("hatching.crossing", h.crossing, 0.0, 1.0),
            ("hatching.cross_angle", h.cross_angle, -90.0, 90.0),
            ("hatching.tones", h.tones as f32, 2.0, 64.0),
            ("hatching.white", h.white, 0.0, 1.0),
            ("hatching.gamma", h.gamma, 0.1, 10.0),
        ];
        let colours = p.colour.iter().map(|&v| ("paper.colour", v, 0.0, 1.0));
        let inks = p.ink.iter().map(|&v| ("paper.ink", v, 0.0, 1.0));
        let looks = style_looks::numbers(&self.shading, &self.edges, &self.wash);
        let all = numbers.into_iter().chain(looks).chain(colours).chain(inks);
        for (name, value, low, high) in all {
            // Also false for NaN.
            if !(value >= low && value <= high) {
                return Err(format!("{name} = {value}: expected {low} to {high}"));
            }
        }
        self.check_strokes()?;
        if c.mapping > 0.0 && c.mapping <= 1.0 {
            return Err(format!(
                "contour.mapping = {}: expected 0 (linear depths) or more than 1",
                c.mapping
            ));
        }
        Ok(())
    }

    /// Factor on the size of the leaves that are left, so that their area stays (Deussen's "drop
    /// and resize": `w sqrt(n / k) + 1 - w`).
    #[must_use]
    pub fn enlargement(&self) -> f32 {
        let w = self.leaves.enlarge;
        w / self.leaves.kept.max(1e-6).sqrt() + 1.0 - w
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_preset_is_a_style_and_comes_back_from_its_own_text() {
        for (name, _) in PRESETS {
            let style = Style::named(name).unwrap();
            let text = toml::to_string(&style).unwrap();
            assert_eq!(Style::parse(&text).unwrap(), style, "{name}");
        }
    }

    #[test]
    fn wrong_styles_are_refused_with_what_is_wrong() {
        let base = "format_version = 1\ndescription = \"x\"\n";
        for (text, said) in [
            ("[leaves]\ncolour = 1", "colour"),
            ("[contour]\nthreshold = 2.0", "contour.threshold = 2"),
            ("[contour]\nthreshold = nan", "contour.threshold = NaN"),
            ("[contour]\nmapping = 0.5", "contour.mapping"),
            ("[paper]\nink = [0.0, 0.0, 1.5]", "paper.ink"),
        ] {
            let error = Style::parse(&format!("{base}{text}")).unwrap_err();
            assert!(error.contains(said), "{text}: {error}");
        }
        let old = Style::parse("format_version = 9\ndescription = \"\"").unwrap_err();
        assert!(old.contains("format_version 9"), "{old}");
        assert!(
            Style::named("no-such-style")
                .unwrap_err()
                .to_string()
                .contains("outline")
        );
    }

    #[test]
    fn dropped_leaves_leave_their_area_to_the_others() {
        let mut style = Style::named("outline").unwrap();
        (style.leaves.kept, style.leaves.enlarge) = (0.25, 1.0);
        assert!((style.enlargement() - 2.0).abs() < 1e-6);
        style.leaves.enlarge = 0.0;
        assert!((style.enlargement() - 1.0).abs() < 1e-6);
    }
}
