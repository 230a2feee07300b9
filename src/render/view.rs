//! What can be looked at: the paper's figure 5 and every intermediate.

use crate::{Error, Result};

/// One picture of a subject.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum View {
    /// `I_a k_a` alone, untextured (figure 5a).
    Ambient,
    /// Diffuse and specular light on realigned normals, unshadowed, untextured (figure 5b).
    Direct,
    /// Ambient and direct (figure 5c).
    Combined,
    /// Combined, with the sun's shadows (figure 5d).
    Shadowed,
    /// Everything with textures (figure 5e): the finished picture.
    Textured,
    /// Standard local illumination: the model's own normals, `k_a` = 1, no shadows, textures kept
    /// (figures 1a and 5f).
    Standard,
    /// Realigned normals as colours.
    Normals,
    /// Linear eye depth, near bright.
    Depth,
    /// A slice through the density field.
    Slice,
    /// The implicit surface over the tree.
    Surface,
}

impl View {
    /// Every view, in the order of help texts.
    pub const ALL: [Self; 10] = [
        Self::Ambient,
        Self::Direct,
        Self::Combined,
        Self::Shadowed,
        Self::Textured,
        Self::Standard,
        Self::Normals,
        Self::Depth,
        Self::Slice,
        Self::Surface,
    ];

    /// Name on the command line and on sheets.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ambient => "ambient",
            Self::Direct => "direct",
            Self::Combined => "combined",
            Self::Shadowed => "shadowed",
            Self::Textured => "textured",
            Self::Standard => "standard",
            Self::Normals => "normals",
            Self::Depth => "depth",
            Self::Slice => "slice",
            Self::Surface => "surface",
        }
    }

    /// One line for the command line's help.
    #[must_use]
    pub const fn help(self) -> &'static str {
        match self {
            Self::Ambient => "ambient reflection I_a k_a alone, untextured",
            Self::Direct => "diffuse and specular light on realigned normals",
            Self::Combined => "ambient and direct light",
            Self::Shadowed => "combined, with the sun's shadows",
            Self::Textured => "the finished picture: shadowed, with textures",
            Self::Standard => "standard local illumination: own normals, k_a = 1, no shadows",
            Self::Normals => "realigned normals as colours",
            Self::Depth => "linear eye depth",
            Self::Slice => "a slice through the density field as a heat map",
            Self::Surface => "the implicit surface over the tree",
        }
    }

    /// Shaded by eq. 1 into a colour target (the others show an attribute).
    #[must_use]
    pub const fn is_lit(self) -> bool {
        !matches!(self, Self::Normals | Self::Depth)
    }

    /// Needs realigned normals or ambient coefficients, that is, a foliage bake.
    #[must_use]
    pub const fn needs_bake(self) -> bool {
        !matches!(self, Self::Standard | Self::Depth)
    }

    /// Needs the density grid on the host.
    #[must_use]
    pub const fn needs_field(self) -> bool {
        matches!(self, Self::Slice)
    }

    /// Needs the triangles of the implicit surface.
    #[must_use]
    pub const fn needs_surface(self) -> bool {
        matches!(self, Self::Surface)
    }

    /// Light from the sun is masked by its shadow map.
    #[must_use]
    pub const fn is_shadowed(self) -> bool {
        matches!(
            self,
            Self::Shadowed | Self::Textured | Self::Slice | Self::Surface
        )
    }

    /// Base colour comes from the material and its texture (the others are untextured; alpha
    /// still cuts the leaves out).
    #[must_use]
    pub const fn is_textured(self) -> bool {
        matches!(
            self,
            Self::Textured | Self::Standard | Self::Slice | Self::Surface
        )
    }
}

impl std::fmt::Display for View {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
    }
}

impl std::str::FromStr for View {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        Self::ALL
            .into_iter()
            .find(|v| v.name() == text)
            .ok_or_else(|| {
                let names: Vec<_> = Self::ALL.iter().map(|v| v.name()).collect();
                Error::usage(format!(
                    "view `{text}` is unknown; there are: {}",
                    names.join(", ")
                ))
            })
    }
}
