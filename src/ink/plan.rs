//! What a style needs: attributes of stage 1, passes of stage 2. What is not listed is neither
//! allocated nor computed.

use super::style::Style;
use crate::abi;
use crate::gpu::Format;

/// An attribute of stage 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Attribute {
    /// Base colour.
    Albedo,
    /// Shading normal and tone.
    Normal,
    /// Linear eye depth.
    Depth,
    /// Object and cluster.
    Ids,
    /// Projection of the cluster's normal.
    Direction,
    /// Hatch coordinates.
    Hatch,
}

impl Attribute {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Albedo,
        Self::Normal,
        Self::Depth,
        Self::Ids,
        Self::Direction,
        Self::Hatch,
    ];

    /// Its number in shaders.
    #[must_use]
    pub fn number(self) -> u32 {
        match self {
            Self::Albedo => abi::INK_ALBEDO,
            Self::Normal => abi::INK_NORMAL,
            Self::Depth => abi::INK_DEPTH,
            Self::Ids => abi::INK_IDS,
            Self::Direction => abi::INK_DIRECTION,
            Self::Hatch => abi::INK_HATCH,
        }
    }

    /// Its name in plans and messages.
    #[must_use]
    pub fn label(self) -> &'static str {
        match self {
            Self::Albedo => "ink albedo",
            Self::Normal => "ink normal",
            Self::Depth => "ink depth",
            Self::Ids => "ink ids",
            Self::Direction => "ink direction",
            Self::Hatch => "ink hatch",
        }
    }

    /// Format of its target.
    #[must_use]
    pub fn format(self) -> Format {
        match self {
            Self::Albedo => Format::Rgba8Srgb,
            Self::Normal => Format::Rgba16Float,
            // Strokes are steep: a step of a 16-bit float is a quarter of a texel.
            Self::Hatch => Format::Rgba32Float,
            Self::Depth => Format::R32Float,
            Self::Ids => Format::Rg32Float,
            Self::Direction => Format::Rg16Float,
        }
    }
}

/// Every pass, in the order in which they run.
pub const PASSES: [&str; 11] = [
    "ink sun",
    "ink stage 1",
    "ink light",
    "ink contour",
    "ink clean",
    "ink silhouette",
    "ink edges",
    "ink soften across",
    "ink soften down",
    "ink wash",
    "ink compose",
];
/// How many of them, the first, run once whatever styles there are.
pub(super) const SHARED: usize = 3;

/// What a picture in a style takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct InkPlan {
    /// Outlines by depth are searched.
    pub contour: bool,
    /// The threshold of contours depends on the clusters' normals.
    pub detail: bool,
    /// Strokes along outlines are drawn.
    pub silhouette: bool,
    /// Strokes for tone are drawn.
    pub hatching: bool,
    /// Shading shows.
    pub shading: bool,
    /// The model's colours show.
    pub colour: bool,
    /// The plant's shadow on itself is searched.
    pub shadow: bool,
    /// Sun and sky are told apart behind stage 1.
    pub light: bool,
    /// Lines are drawn where normals turn.
    pub edges: bool,
    /// Transparent paint is laid under the lines.
    pub wash: bool,
    /// The foliage bake is needed (normals and ambient coefficient of crowns).
    pub crown: bool,
}

impl InkPlan {
    /// The plan of a style.
    #[must_use]
    pub fn new(style: &Style) -> Self {
        let silhouette = style.silhouette.strength > 0.0;
        let hatching = style.hatching.strength > 0.0;
        let shading = style.shading.strength > 0.0;
        let (edges, wash) = (style.edges.strength > 0.0, style.wash.strength > 0.0);
        let tone = silhouette || hatching || shading || wash;
        let shadow = tone && style.shading.shadow > 0.0;
        Self {
            shadow,
            light: shadow || (shading && style.shading.is_tinted()),
            edges,
            wash,
            contour: style.contour.strength > 0.0 || silhouette,
            detail: style.contour.detail > 0.0,
            silhouette,
            hatching,
            shading,
            colour: style.shading.colour > 0.0,
            crown: (tone && (style.shading.crown > 0.0 || style.shading.depth > 0.0))
                || (edges && (style.shading.crown > 0.0 || style.edges.ambient > 0.0)),
        }
    }

    /// Attributes of stage 1, in the order of its targets.
    #[must_use]
    pub fn attributes(&self) -> Vec<Attribute> {
        let tone = self.silhouette || self.hatching || self.shading || self.wash;
        let wanted = |a: &Attribute| match a {
            Attribute::Albedo => self.colour || self.wash,
            Attribute::Normal => tone || self.edges,
            Attribute::Depth => true,
            Attribute::Ids => self.contour,
            Attribute::Direction => self.silhouette || (self.contour && self.detail),
            Attribute::Hatch => self.hatching,
        };
        Attribute::ALL.into_iter().filter(wanted).collect()
    }

    /// Passes in their order.
    #[must_use]
    pub fn passes(&self) -> Vec<&'static str> {
        let has = |pass: &&str| match *pass {
            "ink contour" | "ink clean" => self.contour,
            "ink silhouette" => self.silhouette,
            "ink sun" => self.shadow,
            "ink light" => self.light,
            "ink edges" => self.edges,
            "ink soften across" | "ink soften down" | "ink wash" => self.wash,
            _ => true,
        };
        PASSES.into_iter().filter(has).collect()
    }

    /// Bytes of the images of stage 1 and 2 for a picture of `size` pixels, without the sun's map.
    #[must_use]
    pub fn bytes(&self, [width, height]: [u32; 2]) -> u64 {
        let lines = 2 * u64::from(self.contour) + u64::from(self.silhouette);
        let light = u64::from(self.light) * Format::Rgba16Float.bytes();
        // Of a wash colour and tone twice, and its paint.
        let own = u64::from(self.edges) * Format::R32Float.bytes()
            + 5 * u64::from(self.wash) * Format::Rgba16Float.bytes();
        let pixel = bytes_per_pixel(&self.attributes(), lines) + light + own;
        pixel * u64::from(width) * u64::from(height)
    }
}

/// Bytes of all images for one pixel: the attributes, the depth test's, `lines` of lines and the
/// picture.
fn bytes_per_pixel(attributes: &[Attribute], lines: u64) -> u64 {
    let stage1: u64 = attributes.iter().map(|a| a.format().bytes()).sum();
    let depth = Format::Depth32.bytes();
    stage1 + depth + lines * Format::R32Float.bytes() + Format::Rgba16Float.bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn switching_a_thing_off_removes_its_attributes_passes_and_bytes() {
        let mut style = Style::named("full").unwrap();
        style.silhouette.strength = 1.0;
        let all = InkPlan::new(&style);
        style.silhouette.strength = 0.0;
        let without = InkPlan::new(&style);
        assert!(all.passes().contains(&"ink silhouette"));
        assert!(!without.passes().contains(&"ink silhouette"));
        assert!(without.bytes([64, 64]) < all.bytes([64, 64]));
        style.hatching.strength = 0.0;
        style.shading.colour = 0.0;
        style.shading.strength = 0.0;
        style.contour.detail = 0.0;
        let lines = InkPlan::new(&style);
        assert_eq!(lines.attributes(), [Attribute::Depth, Attribute::Ids]);
        assert!(!lines.crown, "lines need no bake");
        style.contour.strength = 0.0;
        let nothing = InkPlan::new(&style);
        assert_eq!(nothing.attributes(), [Attribute::Depth]);
        assert_eq!(nothing.passes(), ["ink stage 1", "ink compose"]);
    }
}
