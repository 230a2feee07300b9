//! Named buffers that free themselves.

use std::fmt;
use std::sync::Arc;

use ash::vk;
use gpu_allocator::MemoryLocation;

use super::device::{Gpu, Inner, device_error};
use super::memory::Block;
use super::resource::Tracked;
use crate::{Error, Result};

/// Where a buffer lives and who may touch it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Home {
    /// The device only. The host cannot map it, even where the memory would allow it.
    Device,
    /// Written by the host, copied by the device.
    Upload,
    /// Written by the device, read by the host.
    Readback,
}

/// What a buffer is for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BufferInfo {
    /// Shown in messages, captures and memory tables.
    pub name: String,
    /// Size in bytes; 0 is allowed and holds nothing.
    pub bytes: u64,
    pub(super) home: Home,
}

impl BufferInfo {
    /// A buffer of the device: storage, uniform, index, indirect arguments, copies.
    #[must_use]
    pub fn device(name: impl Into<String>, bytes: u64) -> Self {
        Self {
            name: name.into(),
            bytes,
            home: Home::Device,
        }
    }

    pub(super) fn upload(name: impl Into<String>, bytes: u64) -> Self {
        Self {
            name: name.into(),
            bytes,
            home: Home::Upload,
        }
    }

    pub(super) fn readback(name: impl Into<String>, bytes: u64) -> Self {
        Self {
            name: name.into(),
            bytes,
            home: Home::Readback,
        }
    }
}

/// A buffer; cloning gives another handle to the same memory.
#[derive(Clone)]
pub struct Buffer {
    pub(super) inner: Arc<BufferInner>,
}

pub(super) struct BufferInner {
    gpu: Arc<Inner>,
    pub(super) raw: vk::Buffer,
    block: Option<Block>,
    pub(super) info: BufferInfo,
    pub(super) tracked: Tracked,
}

impl fmt::Debug for Buffer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "Buffer({}, {} bytes)",
            self.inner.info.name, self.inner.info.bytes
        )
    }
}

impl Buffer {
    /// Name and size.
    #[must_use]
    pub fn info(&self) -> &BufferInfo {
        &self.inner.info
    }

    /// Size in bytes as asked for.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.inner.info.bytes
    }

    /// Copies into an upload buffer.
    pub(super) fn write(&self, data: &[u8]) {
        assert_eq!(
            self.inner.info.home,
            Home::Upload,
            "{self:?} is not an upload buffer"
        );
        assert!(
            data.len() as u64 <= self.bytes(),
            "{self:?} is too small for {} bytes",
            data.len()
        );
        let block = self.inner.block.as_ref().expect("allocated");
        let target = block
            .allocation
            .mapped_ptr()
            .expect("upload memory is mapped")
            .as_ptr()
            .cast::<u8>();
        // SAFETY: the mapping covers the buffer, which holds at least `data.len()` bytes, and no
        // device work uses the buffer yet.
        unsafe { std::ptr::copy_nonoverlapping(data.as_ptr(), target, data.len()) };
    }

    /// Copies out of a readback buffer after the work that fills it has been waited for.
    pub(super) fn read_bytes(&self, out: &mut [u8]) {
        assert_eq!(
            self.inner.info.home,
            Home::Readback,
            "{self:?} is not a readback buffer"
        );
        assert!(
            out.len() as u64 <= self.bytes(),
            "{self:?} has fewer than {} bytes",
            out.len()
        );
        let block = self.inner.block.as_ref().expect("allocated");
        let source = block
            .allocation
            .mapped_slice()
            .expect("readback memory is mapped");
        out.copy_from_slice(&source[..out.len()]);
    }
}

impl Gpu {
    /// Makes a buffer.
    ///
    /// # Errors
    /// When it is over the device's limits (before anything is allocated) or memory runs out.
    pub fn buffer(&self, info: BufferInfo) -> Result<Buffer> {
        let limits = &self.info().limits;
        if info.bytes > limits.max_allocation.min(limits.device_memory) {
            return Err(Error::Unsupported(format!(
                "{} needs {} bytes; {} allows {} in one allocation of {} in all",
                info.name,
                info.bytes,
                self.info().name,
                limits.max_allocation,
                limits.device_memory
            )));
        }
        use vk::BufferUsageFlags as U;
        let (usage, location) = match info.home {
            Home::Device => (
                U::STORAGE_BUFFER
                    | U::UNIFORM_BUFFER
                    | U::INDEX_BUFFER
                    | U::INDIRECT_BUFFER
                    | U::TRANSFER_SRC
                    | U::TRANSFER_DST,
                MemoryLocation::GpuOnly,
            ),
            Home::Upload => (U::TRANSFER_SRC, MemoryLocation::CpuToGpu),
            Home::Readback => (U::TRANSFER_DST, MemoryLocation::GpuToCpu),
        };
        // Vulkan has no empty buffers; the logical size stays 0.
        let create = vk::BufferCreateInfo::default()
            .size(info.bytes.max(4).next_multiple_of(4))
            .usage(usage)
            .sharing_mode(vk::SharingMode::EXCLUSIVE);
        let device = &self.inner.device;
        // SAFETY: the create info is valid and the handles belong to this device; a partly made
        // buffer is destroyed before the error is returned.
        unsafe {
            let raw = device
                .create_buffer(&create, None)
                .map_err(|e| device_error(&info.name, e))?;
            let requirements = device.get_buffer_memory_requirements(raw);
            let block = match self
                .inner
                .memory
                .allocate(&info.name, requirements, location, true)
            {
                Ok(block) => block,
                Err(e) => {
                    device.destroy_buffer(raw, None);
                    return Err(e);
                }
            };
            let (memory, offset) = (block.allocation.memory(), block.allocation.offset());
            self.inner.set_name(raw, &info.name);
            let inner = BufferInner {
                gpu: Arc::clone(&self.inner),
                raw,
                block: Some(block),
                info,
                tracked: Tracked::default(),
            };
            let buffer = Buffer {
                inner: Arc::new(inner),
            };
            device
                .bind_buffer_memory(raw, memory, offset)
                .map_err(|e| device_error(&buffer.inner.info.name, e))?;
            Ok(buffer)
        }
    }
}

impl Drop for BufferInner {
    fn drop(&mut self) {
        // SAFETY: work that uses the buffer holds a handle until it has completed.
        unsafe { self.gpu.device.destroy_buffer(self.raw, None) };
        if let Some(block) = self.block.take() {
            self.gpu.memory.free(block);
        }
    }
}
