//! Image formats by meaning.

use ash::vk;

/// Formats that umbrage uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// One linear byte.
    R8Unorm,
    /// Two linear bytes.
    Rg8Unorm,
    /// Four linear bytes.
    Rgba8Unorm,
    /// Four bytes, colour in sRGB.
    Rgba8Srgb,
    /// Two signed 16-bit fractions (octahedral normals).
    Rg16Snorm,
    /// Two 16-bit floats.
    Rg16Float,
    /// Four 16-bit floats.
    Rgba16Float,
    /// One 32-bit float.
    R32Float,
    /// One 32-bit integer (ids).
    R32Uint,
    /// Two 32-bit floats.
    Rg32Float,
    /// Four 32-bit floats.
    Rgba32Float,
    /// Four 32-bit integers.
    Rgba32Uint,
    /// 16-bit depth.
    Depth16,
    /// 32-bit float depth.
    Depth32,
}

impl Format {
    /// Bytes per texel.
    #[must_use]
    pub fn bytes(self) -> u64 {
        match self {
            Self::R8Unorm => 1,
            Self::Rg8Unorm | Self::Depth16 => 2,
            Self::Rgba8Unorm | Self::Rgba8Srgb | Self::Rg16Snorm | Self::Rg16Float => 4,
            Self::R32Float | Self::R32Uint | Self::Depth32 => 4,
            Self::Rgba16Float | Self::Rg32Float => 8,
            Self::Rgba32Float | Self::Rgba32Uint => 16,
        }
    }

    /// Whether it is a depth format.
    #[must_use]
    pub fn is_depth(self) -> bool {
        matches!(self, Self::Depth16 | Self::Depth32)
    }

    pub(super) fn raw(self) -> vk::Format {
        match self {
            Self::R8Unorm => vk::Format::R8_UNORM,
            Self::Rg8Unorm => vk::Format::R8G8_UNORM,
            Self::Rgba8Unorm => vk::Format::R8G8B8A8_UNORM,
            Self::Rgba8Srgb => vk::Format::R8G8B8A8_SRGB,
            Self::Rg16Snorm => vk::Format::R16G16_SNORM,
            Self::Rg16Float => vk::Format::R16G16_SFLOAT,
            Self::Rgba16Float => vk::Format::R16G16B16A16_SFLOAT,
            Self::R32Float => vk::Format::R32_SFLOAT,
            Self::R32Uint => vk::Format::R32_UINT,
            Self::Rg32Float => vk::Format::R32G32_SFLOAT,
            Self::Rgba32Float => vk::Format::R32G32B32A32_SFLOAT,
            Self::Rgba32Uint => vk::Format::R32G32B32A32_UINT,
            Self::Depth16 => vk::Format::D16_UNORM,
            Self::Depth32 => vk::Format::D32_SFLOAT,
        }
    }

    pub(super) fn aspect(self) -> vk::ImageAspectFlags {
        if self.is_depth() {
            vk::ImageAspectFlags::DEPTH
        } else {
            vk::ImageAspectFlags::COLOR
        }
    }
}
