//! What a pass binds, in binding order, and what it does with it.

use ash::vk;

use super::access::Access;
use super::buffer::Buffer;
use super::image::{Image, Sampler};
use super::reflect::DescriptorKind;

/// One entry of a descriptor set and how the pass uses it.
///
/// Offsets of the `Range` forms must be multiples of 256 bytes, which every device accepts.
#[derive(Debug, Clone, Copy)]
pub enum Binding<'a> {
    /// A storage buffer that is only read.
    Read(&'a Buffer),
    /// A storage buffer that is only written.
    Write(&'a Buffer),
    /// A storage buffer that is read and written.
    ReadWrite(&'a Buffer),
    /// Offset and bytes of a storage buffer, read.
    ReadRange(&'a Buffer, u64, u64),
    /// Offset and bytes of a storage buffer, written.
    WriteRange(&'a Buffer, u64, u64),
    /// Offset and bytes of a storage buffer, read and written.
    ReadWriteRange(&'a Buffer, u64, u64),
    /// A uniform buffer.
    Uniform(&'a Buffer),
    /// The index buffer (only in `RenderPass::reads`).
    Index(&'a Buffer),
    /// A sampled image.
    Sampled(&'a Image, &'a Sampler),
    /// A storage image, read.
    StorageRead(&'a Image),
    /// A storage image, written.
    StorageWrite(&'a Image),
    /// A storage image, read and written.
    StorageReadWrite(&'a Image),
}

/// The resource behind a binding.
#[derive(Debug, Clone)]
pub(super) enum Resource {
    Buffer(Buffer),
    Image(Image),
}

impl Resource {
    /// Equal for handles of the same resource.
    pub(super) fn key(&self) -> usize {
        match self {
            Self::Buffer(b) => std::sync::Arc::as_ptr(&b.inner) as usize,
            Self::Image(i) => std::sync::Arc::as_ptr(&i.inner) as usize,
        }
    }

    pub(super) fn name(&self) -> &str {
        match self {
            Self::Buffer(b) => &b.inner.info.name,
            Self::Image(i) => &i.inner.info.name,
        }
    }

    pub(super) fn tracked(&self) -> &super::resource::Tracked {
        match self {
            Self::Buffer(b) => &b.inner.tracked,
            Self::Image(i) => &i.inner.tracked,
        }
    }

    pub(super) fn is_image(&self) -> bool {
        matches!(self, Self::Image(_))
    }
}

impl Binding<'_> {
    pub(super) fn resource(&self) -> Resource {
        match *self {
            Self::Read(b)
            | Self::Write(b)
            | Self::ReadWrite(b)
            | Self::Uniform(b)
            | Self::Index(b) => Resource::Buffer(b.clone()),
            Self::ReadRange(b, ..) | Self::WriteRange(b, ..) | Self::ReadWriteRange(b, ..) => {
                Resource::Buffer(b.clone())
            }
            Self::Sampled(i, _)
            | Self::StorageRead(i)
            | Self::StorageWrite(i)
            | Self::StorageReadWrite(i) => Resource::Image(i.clone()),
        }
    }

    /// What a kernel does with it.
    pub(super) fn compute_access(&self) -> Access {
        match self {
            Self::Read(_) | Self::ReadRange(..) | Self::Uniform(_) | Self::StorageRead(_) => {
                Access::ComputeRead
            }
            Self::Write(_) | Self::WriteRange(..) | Self::StorageWrite(_) => Access::ComputeWrite,
            Self::ReadWrite(_) | Self::ReadWriteRange(..) | Self::StorageReadWrite(_) => {
                Access::ComputeReadWrite
            }
            Self::Sampled(..) => Access::ComputeSampled,
            Self::Index(_) => Access::IndexRead,
        }
    }

    /// What draws do with it.
    pub(super) fn draw_access(&self) -> Access {
        match self {
            Self::Read(_) | Self::ReadRange(..) | Self::Uniform(_) | Self::StorageRead(_) => {
                Access::DrawRead
            }
            Self::Sampled(..) => Access::DrawSampled,
            Self::Index(_) => Access::IndexRead,
            _ => Access::DrawWrite,
        }
    }

    pub(super) fn kind(&self) -> DescriptorKind {
        match self {
            Self::Uniform(_) => DescriptorKind::UniformBuffer,
            Self::Sampled(..) => DescriptorKind::CombinedImageSampler,
            Self::StorageRead(_) | Self::StorageWrite(_) | Self::StorageReadWrite(_) => {
                DescriptorKind::StorageImage
            }
            _ => DescriptorKind::StorageBuffer,
        }
    }

    /// Buffer, offset and range of the descriptor.
    pub(super) fn buffer_info(&self) -> Option<vk::DescriptorBufferInfo> {
        let (buffer, offset, range) = match *self {
            Self::Read(b) | Self::Write(b) | Self::ReadWrite(b) | Self::Uniform(b) => {
                (b, 0, b.bytes().max(4))
            }
            Self::ReadRange(b, o, n)
            | Self::WriteRange(b, o, n)
            | Self::ReadWriteRange(b, o, n) => (b, o, n.max(4)),
            _ => return None,
        };
        // Whole words: the buffer itself is rounded up to them.
        Some(vk::DescriptorBufferInfo {
            buffer: buffer.inner.raw,
            offset,
            range: range.next_multiple_of(4),
        })
    }

    /// Sampler, view and layout of the descriptor.
    pub(super) fn image_info(&self) -> Option<vk::DescriptorImageInfo> {
        let (image, sampler) = match *self {
            Self::Sampled(i, s) => (i, s.inner.raw),
            Self::StorageRead(i) | Self::StorageWrite(i) | Self::StorageReadWrite(i) => {
                (i, vk::Sampler::null())
            }
            _ => return None,
        };
        let layout = self.draw_access().scope().layout;
        Some(vk::DescriptorImageInfo {
            sampler,
            image_view: image.inner.view,
            image_layout: layout,
        })
    }

    pub(super) fn sampler(&self) -> Option<Sampler> {
        match *self {
            Self::Sampled(_, s) => Some(s.clone()),
            _ => None,
        }
    }
}

impl DescriptorKind {
    pub(super) fn raw(self) -> vk::DescriptorType {
        match self {
            Self::StorageBuffer => vk::DescriptorType::STORAGE_BUFFER,
            Self::UniformBuffer => vk::DescriptorType::UNIFORM_BUFFER,
            Self::CombinedImageSampler => vk::DescriptorType::COMBINED_IMAGE_SAMPLER,
            Self::StorageImage => vk::DescriptorType::STORAGE_IMAGE,
        }
    }
}
