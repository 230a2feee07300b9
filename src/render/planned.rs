//! What a plan is made of: attributes, channels, formats, images, buffers, passes.

use super::texture::TextureKey;
use super::view::View;

/// Per-vertex data that a picture needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Attribute {
    /// Position relative to the geometry's origin, 3 x f32.
    Position,
    /// Realigned normal and ambient coefficient in the chosen [`Encoding`](super::Encoding).
    Shading,
    /// The model's own normal, packed.
    ModelNormal,
    /// Texture coordinate, 2 x f32.
    Texcoord,
    /// Linear vertex colour, 4 x f16.
    Color,
}

/// What stage 1 can leave per pixel besides colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Channel {
    /// Shading normal (xyz, world) and ambient coefficient (w); zero where nothing is.
    Normal,
    /// Linear eye depth in metres; zero where nothing is.
    Depth,
    /// Linear base colour, sRGB-encoded in memory, and coverage in A.
    Albedo,
    /// Light by eq. 1 without exposure, linear, and the sun's shadow term `S` in A.
    Shade,
}

impl Channel {
    /// Every channel in the order of the render targets.
    pub const ALL: [Self; 4] = [Self::Normal, Self::Depth, Self::Albedo, Self::Shade];

    /// Name of its image.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Normal => "g-buffer normal and ambient",
            Self::Depth => "g-buffer eye depth",
            Self::Albedo => "g-buffer albedo",
            Self::Shade => "g-buffer shade",
        }
    }

    /// Format of its image.
    #[must_use]
    pub const fn format(self) -> PixelFormat {
        match self {
            Self::Normal | Self::Shade => PixelFormat::Rgba16Float,
            Self::Depth => PixelFormat::R32Float,
            Self::Albedo => PixelFormat::Rgba8Srgb,
        }
    }
}

/// Pixel formats that the plan speaks of (the device's own names stay in the gpu room).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PixelFormat {
    /// 4 x 8 bit, sRGB-encoded colour.
    Rgba8Srgb,
    /// 4 x 8 bit, linear.
    Rgba8,
    /// 1 x 8 bit.
    R8,
    /// 4 x f16.
    Rgba16Float,
    /// 1 x f32.
    R32Float,
    /// 16-bit depth.
    Depth16,
    /// 32-bit float depth.
    Depth32,
}

impl PixelFormat {
    /// Bytes of one sample.
    #[must_use]
    pub const fn bytes(self) -> u64 {
        match self {
            Self::R8 => 1,
            Self::Depth16 => 2,
            Self::Rgba8Srgb | Self::Rgba8 | Self::R32Float | Self::Depth32 => 4,
            Self::Rgba16Float => 8,
        }
    }

    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Rgba8Srgb => "rgba8 srgb",
            Self::Rgba8 => "rgba8",
            Self::R8 => "r8",
            Self::Rgba16Float => "rgba16f",
            Self::R32Float => "r32f",
            Self::Depth16 => "depth16",
            Self::Depth32 => "depth32",
        }
    }
}

/// An image that will be allocated.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedImage {
    /// Its label on the device.
    pub label: String,
    /// Format.
    pub format: PixelFormat,
    /// Width and height of the largest level.
    pub extent: [u32; 2],
    /// Mip levels.
    pub levels: u32,
    /// Samples per pixel.
    pub samples: u32,
    /// Filled from this texture of the model; `None` for render targets.
    pub texture: Option<TextureKey>,
}

impl PlannedImage {
    pub(super) fn target(label: &str, format: PixelFormat, extent: [u32; 2], samples: u32) -> Self {
        Self {
            label: label.into(),
            format,
            extent,
            levels: 1,
            samples,
            texture: None,
        }
    }

    /// Bytes of all levels and samples.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        (0..self.levels)
            .map(|l| self.extent.map(|e| u64::from((e >> l).max(1))))
            .map(|[w, h]| w * h * self.format.bytes() * u64::from(self.samples))
            .sum()
    }
}

/// A buffer that will be allocated.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlannedBuffer {
    /// Its label on the device.
    pub label: &'static str,
    /// Size.
    pub bytes: u64,
}

/// A pass that will be run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlannedPass {
    /// Its label on the device and in timings.
    pub label: &'static str,
    /// Views that need it; a pass whose result they share runs once.
    pub views: Vec<View>,
    /// Labels of the images it writes.
    pub writes: Vec<&'static str>,
}
