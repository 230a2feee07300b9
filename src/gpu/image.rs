//! Named images and samplers that free themselves.

use std::fmt;
use std::sync::Arc;

use ash::vk;
use gpu_allocator::MemoryLocation;

use super::device::{Gpu, Inner, device_error};
use super::format::Format;
use super::memory::Block;
use super::resource::Tracked;
use crate::{Error, Result};

/// What an image is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Use {
    Target,
    Texture,
    Storage,
}

/// Description of a 2-D image.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ImageInfo {
    /// Shown in messages, captures and memory tables.
    pub name: String,
    /// Texel format.
    pub format: Format,
    /// Width and height in texels.
    pub extent: [u32; 2],
    /// Number of mip levels.
    pub mip_levels: u32,
    /// Samples per texel.
    pub samples: u32,
    purpose: Use,
}

impl ImageInfo {
    /// A colour or depth attachment that can be sampled (single-sample ones also copied).
    #[must_use]
    pub fn target(name: impl Into<String>, format: Format, extent: [u32; 2], samples: u32) -> Self {
        Self {
            name: name.into(),
            format,
            extent,
            mip_levels: 1,
            samples,
            purpose: Use::Target,
        }
    }

    /// A texture with its mip levels, filled by `Work::upload_image`.
    #[must_use]
    pub fn texture(
        name: impl Into<String>,
        format: Format,
        extent: [u32; 2],
        mip_levels: u32,
    ) -> Self {
        Self {
            name: name.into(),
            format,
            extent,
            mip_levels,
            samples: 1,
            purpose: Use::Texture,
        }
    }

    /// An image that kernels write and anyone samples.
    #[must_use]
    pub fn storage(name: impl Into<String>, format: Format, extent: [u32; 2]) -> Self {
        Self {
            name: name.into(),
            format,
            extent,
            mip_levels: 1,
            samples: 1,
            purpose: Use::Storage,
        }
    }

    /// Bytes of all levels and samples, tightly packed: the plan's figure, a lower bound of what
    /// the device takes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let texels: u64 = (0..self.mip_levels).map(|l| self.level_texels(l)).sum();
        texels * self.format.bytes() * u64::from(self.samples)
    }

    /// Extent of a mip level.
    #[must_use]
    pub fn level_extent(&self, level: u32) -> [u32; 2] {
        self.extent.map(|e| (e >> level).max(1))
    }

    fn level_texels(&self, level: u32) -> u64 {
        let [w, h] = self.level_extent(level);
        u64::from(w) * u64::from(h)
    }

    fn usage(&self) -> vk::ImageUsageFlags {
        use vk::ImageUsageFlags as U;
        let attachment = if self.format.is_depth() {
            U::DEPTH_STENCIL_ATTACHMENT
        } else {
            U::COLOR_ATTACHMENT
        };
        match self.purpose {
            Use::Target if self.samples > 1 => attachment | U::SAMPLED,
            Use::Target => attachment | U::SAMPLED | U::TRANSFER_SRC | U::TRANSFER_DST,
            Use::Texture => U::SAMPLED | U::TRANSFER_DST | U::TRANSFER_SRC,
            Use::Storage => U::STORAGE | U::SAMPLED | U::TRANSFER_SRC | U::TRANSFER_DST,
        }
    }
}

/// An image; cloning gives another handle to the same memory.
#[derive(Clone)]
pub struct Image {
    pub(super) inner: Arc<ImageInner>,
}

pub(super) struct ImageInner {
    gpu: Arc<Inner>,
    pub(super) raw: vk::Image,
    pub(super) view: vk::ImageView,
    block: Option<Block>,
    pub(super) info: ImageInfo,
    pub(super) tracked: Tracked,
}

impl fmt::Debug for Image {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let i = &self.inner.info;
        write!(
            f,
            "Image({}, {:?} {}x{} x{})",
            i.name, i.format, i.extent[0], i.extent[1], i.samples
        )
    }
}

impl Image {
    /// Name, format and extent.
    #[must_use]
    pub fn info(&self) -> &ImageInfo {
        &self.inner.info
    }

    pub(super) fn range(&self) -> vk::ImageSubresourceRange {
        vk::ImageSubresourceRange {
            aspect_mask: self.inner.info.format.aspect(),
            base_mip_level: 0,
            level_count: self.inner.info.mip_levels,
            base_array_layer: 0,
            layer_count: 1,
        }
    }
}

impl Gpu {
    /// Whether an image of this description can be made.
    #[must_use]
    pub fn supports(&self, info: &ImageInfo) -> bool {
        // SAFETY: plain query; unsupported combinations come back as an error.
        let properties = unsafe {
            self.inner
                .instance
                .raw
                .get_physical_device_image_format_properties(
                    self.inner.physical,
                    info.format.raw(),
                    vk::ImageType::TYPE_2D,
                    vk::ImageTiling::OPTIMAL,
                    info.usage(),
                    vk::ImageCreateFlags::empty(),
                )
        };
        properties.is_ok_and(|p| {
            let [w, h] = info.extent;
            w >= 1
                && h >= 1
                && p.max_extent.width >= w
                && p.max_extent.height >= h
                && p.max_mip_levels >= info.mip_levels
                && p.sample_counts
                    .contains(vk::SampleCountFlags::from_raw(info.samples))
        })
    }

    /// Makes an image.
    ///
    /// # Errors
    /// When the device does not support it (before anything is allocated) or memory runs out.
    pub fn image(&self, info: ImageInfo) -> Result<Image> {
        let limits = &self.info().limits;
        if !self.supports(&info) || info.bytes() > limits.max_allocation.min(limits.device_memory) {
            let [w, h] = info.extent;
            return Err(Error::Unsupported(format!(
                "{}: {} has no image {:?} of {w}x{h} with {} levels and {} samples ({} bytes; sides up to {}, {} samples)",
                info.name,
                self.info().name,
                info.format,
                info.mip_levels,
                info.samples,
                info.bytes(),
                limits.max_image_2d,
                limits.max_samples
            )));
        }
        let create = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(info.format.raw())
            .extent(vk::Extent3D {
                width: info.extent[0],
                height: info.extent[1],
                depth: 1,
            })
            .mip_levels(info.mip_levels)
            .array_layers(1)
            .samples(vk::SampleCountFlags::from_raw(info.samples))
            .tiling(vk::ImageTiling::OPTIMAL)
            .usage(info.usage())
            .sharing_mode(vk::SharingMode::EXCLUSIVE)
            .initial_layout(vk::ImageLayout::UNDEFINED);
        let device = &self.inner.device;
        // SAFETY: the description was checked; partly made objects are destroyed on failure (the
        // null view by `ImageInner::drop`, which accepts it).
        unsafe {
            let raw = device
                .create_image(&create, None)
                .map_err(|e| device_error(&info.name, e))?;
            let requirements = device.get_image_memory_requirements(raw);
            let block = match self.inner.memory.allocate(
                &info.name,
                requirements,
                MemoryLocation::GpuOnly,
                false,
            ) {
                Ok(block) => block,
                Err(e) => {
                    device.destroy_image(raw, None);
                    return Err(e);
                }
            };
            let (memory, offset) = (block.allocation.memory(), block.allocation.offset());
            self.inner.set_name(raw, &info.name);
            let mut inner = ImageInner {
                gpu: Arc::clone(&self.inner),
                raw,
                view: vk::ImageView::null(),
                block: Some(block),
                info,
                tracked: Tracked::default(),
            };
            device
                .bind_image_memory(raw, memory, offset)
                .map_err(|e| device_error(&inner.info.name, e))?;
            let view = vk::ImageViewCreateInfo::default()
                .image(raw)
                .view_type(vk::ImageViewType::TYPE_2D)
                .format(inner.info.format.raw())
                .subresource_range(vk::ImageSubresourceRange {
                    aspect_mask: inner.info.format.aspect(),
                    base_mip_level: 0,
                    level_count: inner.info.mip_levels,
                    base_array_layer: 0,
                    layer_count: 1,
                });
            inner.view = device
                .create_image_view(&view, None)
                .map_err(|e| device_error(&inner.info.name, e))?;
            self.inner.set_name(inner.view, &inner.info.name);
            Ok(Image {
                inner: Arc::new(inner),
            })
        }
    }
}

impl Drop for ImageInner {
    fn drop(&mut self) {
        // SAFETY: work that uses the image holds a handle until it has completed.
        unsafe {
            self.gpu.device.destroy_image_view(self.view, None);
            self.gpu.device.destroy_image(self.raw, None);
        }
        if let Some(block) = self.block.take() {
            self.gpu.memory.free(block);
        }
    }
}

/// Addressing outside \[0,1\].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AddressMode {
    /// Repeats.
    #[default]
    Repeat,
    /// Clamps to the edge.
    Clamp,
    /// Mirrors every other period.
    Mirror,
    /// Zero outside (depth 0: nothing in front, with reversed depth).
    BorderZero,
}

/// How an image is sampled.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SamplerInfo {
    /// Linear filter inside a level.
    pub linear: bool,
    /// Linear filter between levels; without it the nearest level is used.
    pub linear_mips: bool,
    /// Addressing along u and v.
    pub address: [AddressMode; 2],
    /// Largest anisotropy; 0 or 1 switches it off, more than the device has is clamped.
    pub anisotropy: f32,
    /// Compare a reference depth with the texel: passes when reference >= texel.
    pub compare_greater_equal: bool,
    /// Added to the level of detail.
    pub lod_bias: f32,
}

/// A sampler; cloning gives another handle.
#[derive(Clone)]
pub struct Sampler {
    pub(super) inner: Arc<SamplerInner>,
}

pub(super) struct SamplerInner {
    gpu: Arc<Inner>,
    pub(super) raw: vk::Sampler,
}

impl fmt::Debug for Sampler {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Sampler")
    }
}

impl Gpu {
    /// Makes a sampler.
    ///
    /// # Errors
    /// When the device is out of memory.
    pub fn sampler(&self, info: &SamplerInfo) -> Result<Sampler> {
        let filter = if info.linear {
            vk::Filter::LINEAR
        } else {
            vk::Filter::NEAREST
        };
        let address = info.address.map(|a| match a {
            AddressMode::Repeat => vk::SamplerAddressMode::REPEAT,
            AddressMode::Clamp => vk::SamplerAddressMode::CLAMP_TO_EDGE,
            AddressMode::Mirror => vk::SamplerAddressMode::MIRRORED_REPEAT,
            AddressMode::BorderZero => vk::SamplerAddressMode::CLAMP_TO_BORDER,
        });
        let anisotropic = self.info().anisotropy && info.anisotropy > 1.0;
        let create = vk::SamplerCreateInfo::default()
            .mag_filter(filter)
            .min_filter(filter)
            .mipmap_mode(if info.linear_mips {
                vk::SamplerMipmapMode::LINEAR
            } else {
                vk::SamplerMipmapMode::NEAREST
            })
            .address_mode_u(address[0])
            .address_mode_v(address[1])
            .address_mode_w(vk::SamplerAddressMode::CLAMP_TO_EDGE)
            .anisotropy_enable(anisotropic)
            .max_anisotropy(info.anisotropy.clamp(1.0, 16.0))
            .compare_enable(info.compare_greater_equal)
            .compare_op(vk::CompareOp::GREATER_OR_EQUAL)
            .mip_lod_bias(info.lod_bias)
            .max_lod(vk::LOD_CLAMP_NONE)
            .border_color(vk::BorderColor::FLOAT_TRANSPARENT_BLACK);
        // SAFETY: the create info is valid; anisotropy is only on where the feature is.
        let raw = unsafe { self.inner.device.create_sampler(&create, None) }
            .map_err(|e| device_error("vkCreateSampler", e))?;
        Ok(Sampler {
            inner: Arc::new(SamplerInner {
                gpu: Arc::clone(&self.inner),
                raw,
            }),
        })
    }
}

impl Drop for SamplerInner {
    fn drop(&mut self) {
        // SAFETY: work that uses the sampler holds a handle until it has completed.
        unsafe { self.gpu.device.destroy_sampler(self.raw, None) };
    }
}
