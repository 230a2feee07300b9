//! Attributes of both stages as pictures that can be read.

use std::str::FromStr;

use super::plan::InkPlan;
use super::style::{PRESETS, Style};
use crate::gpu::Format;
use crate::math::colour::linear_to_srgb8;
use crate::math::packing::f16_to_f32;

/// What is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InkView {
    /// Base colour.
    Albedo,
    /// Normals that are shaded with, x to red, y to green, z to blue.
    Normal,
    /// Linear eye depth: near is dark.
    Depth,
    /// A colour for each object.
    Object,
    /// A colour for each cluster.
    Cluster,
    /// Direction of the clusters' normals in the picture as hue, their lengths as brightness.
    Direction,
    /// Hatch coordinates as red and green, the level as blue.
    Hatch,
    /// Tone.
    Tone,
    /// How far the sun is hidden.
    Shadow,
    /// Outlines by depth.
    Contour,
    /// Strokes along outlines.
    Silhouette,
    /// Lines where normals turn.
    Edges,
    /// Paint.
    Wash,
}

/// Paper behind the plant, sRGB.
const NOTHING: [u8; 3] = [255; 3];

impl InkView {
    /// All of them, with their names.
    pub const ALL: [(&'static str, Self); 13] = [
        ("albedo", Self::Albedo),
        ("normal", Self::Normal),
        ("depth", Self::Depth),
        ("object", Self::Object),
        ("cluster", Self::Cluster),
        ("direction", Self::Direction),
        ("hatch", Self::Hatch),
        ("tone", Self::Tone),
        ("shadow", Self::Shadow),
        ("contour", Self::Contour),
        ("silhouette", Self::Silhouette),
        ("edges", Self::Edges),
        ("wash", Self::Wash),
    ];

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|v| v.1 == self).map_or("", |v| v.0)
    }

    /// Whether a plan has it.
    #[must_use]
    pub fn is_in(self, plan: &InkPlan) -> bool {
        use super::plan::Attribute as A;
        let has = |a| plan.attributes().contains(&a);
        match self {
            Self::Albedo => has(A::Albedo),
            Self::Normal => has(A::Normal),
            Self::Depth => true,
            Self::Object | Self::Cluster => has(A::Ids),
            Self::Direction => has(A::Direction),
            Self::Hatch => has(A::Hatch),
            Self::Tone => plan.silhouette || plan.hatching || plan.shading || plan.wash,
            Self::Shadow => plan.shadow,
            Self::Contour => plan.contour,
            Self::Silhouette => plan.silhouette,
            Self::Edges => plan.edges,
            Self::Wash => plan.wash,
        }
    }

    /// Numbers of a style that bring it in.
    #[must_use]
    pub fn needs(self) -> &'static str {
        match self {
            Self::Albedo => "shading.colour or wash.strength above 0",
            Self::Normal => {
                "shading.strength, hatching.strength, silhouette.strength, wash.strength or \
                 edges.strength above 0"
            }
            Self::Depth => "nothing",
            Self::Object | Self::Cluster | Self::Contour => {
                "contour.strength or silhouette.strength above 0"
            }
            Self::Direction => {
                "silhouette.strength above 0, or contour.strength and contour.detail above 0"
            }
            Self::Hatch => "hatching.strength above 0",
            Self::Tone => {
                "shading.strength, hatching.strength, silhouette.strength or wash.strength above 0"
            }
            Self::Shadow => "shading.shadow above 0 and something with a tone",
            Self::Silhouette => "silhouette.strength above 0",
            Self::Edges => "edges.strength above 0",
            Self::Wash => "wash.strength above 0",
        }
    }

    /// Whether the style has it.
    ///
    /// # Errors
    /// What it would take, and which presets have it.
    pub fn check(self, named: &str, style: &Style) -> Result<(), String> {
        if self.is_in(&InkPlan::new(style)) {
            return Ok(());
        }
        let has = |name: &str| Style::named(name).is_ok_and(|s| self.is_in(&InkPlan::new(&s)));
        let names: Vec<&str> = PRESETS.iter().map(|p| p.0).filter(|n| has(n)).collect();
        Err(format!(
            "--ink-view {}: style `{named}` has none; it takes {} (as in {})",
            self.name(),
            self.needs(),
            names.join(", ")
        ))
    }
}

impl FromStr for InkView {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let names = || Self::ALL.map(|v| v.0).join(", ");
        let found = Self::ALL.iter().find(|v| v.0 == text);
        found
            .map(|v| v.1)
            .ok_or_else(|| format!("expected one of {}", names()))
    }
}

/// Texels of an image as four floats each; colours as they are stored.
fn decode(format: Format, bytes: &[u8]) -> Vec<[f32; 4]> {
    let halves = |b: &[u8]| f16_to_f32(u16::from_le_bytes([b[0], b[1]]));
    let float = |b: &[u8]| f32::from_le_bytes([b[0], b[1], b[2], b[3]]);
    let channels = match format {
        Format::R32Float => 1,
        Format::Rg32Float | Format::Rg16Float => 2,
        _ => 4,
    };
    let size = format.bytes() as usize / channels;
    let texel = |t: &[u8]| {
        let mut out = [0.0; 4];
        for (value, b) in out.iter_mut().zip(t.chunks_exact(size)) {
            *value = match size {
                1 => f32::from(b[0]) / 255.0,
                2 => halves(b),
                _ => float(b),
            };
        }
        out
    };
    bytes
        .chunks_exact(format.bytes() as usize)
        .map(texel)
        .collect()
}

/// The picture of an image of both stages: RGBA, sRGB. `depths` are the smallest and largest of
/// the view; where `covered` says that nothing is, the paper is white.
#[must_use]
pub fn picture(
    which: InkView,
    (format, bytes): (Format, &[u8]),
    covered: &[bool],
    depths: [f32; 2],
) -> Vec<u8> {
    let texels = decode(format, bytes);
    let pixel = |(t, &covered): (&[f32; 4], &bool)| {
        let [r, g, b] = if covered || which == InkView::Wash {
            colour(which, *t, depths)
        } else {
            NOTHING
        };
        [r, g, b, 255]
    };
    texels.iter().zip(covered).flat_map(pixel).collect()
}

fn byte(v: f32) -> u8 {
    (v.clamp(0.0, 1.0) * 255.0).round() as u8
}

fn colour(which: InkView, t: [f32; 4], [near, far]: [f32; 2]) -> [u8; 3] {
    let grey = |v: f32| [byte(v); 3];
    match which {
        // Stored as sRGB.
        InkView::Albedo => [t[0], t[1], t[2]].map(byte),
        InkView::Normal => [t[0], t[1], t[2]].map(|v| byte(0.5 + 0.5 * v)),
        InkView::Depth => grey(0.1 + 0.85 * (t[0] - near) / (far - near).max(f32::MIN_POSITIVE)),
        InkView::Object => of_number(t[0] as u32),
        // Wood is no part of any cluster.
        InkView::Cluster if t[1] <= 0.0 => [120; 3],
        InkView::Cluster => of_number(t[1] as u32),
        InkView::Direction => {
            let turn = (-t[1]).atan2(t[0]) / std::f32::consts::TAU;
            hue(turn, t[0].hypot(t[1]))
        }
        InkView::Hatch => {
            let level = t[2] / (crate::abi::INK_LEVELS as f32 - 1.0);
            [t[0], t[1], level].map(byte)
        }
        InkView::Tone => grey(t[3]),
        InkView::Shadow => grey(1.0 - t[2]),
        InkView::Contour | InkView::Silhouette | InkView::Edges => grey(1.0 - t[0]),
        InkView::Wash => [t[0], t[1], t[2]].map(linear_to_srgb8),
    }
}

/// A colour for a number: neighbours differ, by the golden ratio.
fn of_number(number: u32) -> [u8; 3] {
    let turn = f64::from(number) * 0.618_033_988_749_895;
    let bright = 0.55 + 0.15 * f64::from(number % 4);
    hue(turn.fract() as f32, bright as f32)
}

/// A hue (0 to 1 is a whole turn) of some brightness.
fn hue(turn: f32, bright: f32) -> [u8; 3] {
    [0.0, 1.0, 2.0].map(|third: f32| {
        let wave = (std::f32::consts::TAU * (turn - third / 3.0)).cos();
        byte((0.55 + 0.45 * wave) * bright)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_view_that_a_style_lacks_is_refused_with_what_would_have_it() {
        let outline = Style::named("outline").unwrap();
        let error = InkView::Shadow.check("outline", &outline).unwrap_err();
        for said in ["outline", "shading.shadow", "photo"] {
            assert!(error.contains(said), "{error}");
        }
        assert!(InkView::Contour.check("outline", &outline).is_ok());
        for (_, view) in InkView::ALL {
            let has = |p: &(&str, &str)| {
                let style = Style::named(p.0).unwrap();
                view.is_in(&InkPlan::new(&style))
            };
            assert!(PRESETS.iter().any(has), "{view:?}: in no preset");
        }
    }

    #[test]
    fn numbers_next_to_each_other_have_colours_apart() {
        for n in 0..200 {
            let (a, b) = (of_number(n), of_number(n + 1));
            let apart = a.iter().zip(b).map(|(a, b)| a.abs_diff(b)).max();
            assert!(apart > Some(40), "{n}: {a:?} {b:?}");
        }
    }
}
