//! Device memory through `gpu-allocator`, with a name for every allocation.

use std::collections::BTreeMap;
use std::sync::Mutex;

use ash::vk;
use gpu_allocator::vulkan::{
    Allocation, AllocationCreateDesc, AllocationScheme, Allocator, AllocatorCreateDesc,
};
use gpu_allocator::{AllocationSizes, MemoryLocation};

use crate::{Error, Result};

const MIB: u64 = 1 << 20;

/// Allocator and book-keeping.
pub(super) struct Memory {
    /// `None` once destroyed: the allocator has to go before the device.
    allocator: Mutex<Option<Allocator>>,
    book: Mutex<Book>,
}

#[derive(Default)]
struct Book {
    next_id: u64,
    live: BTreeMap<u64, (String, u64)>,
    bytes: u64,
    peak: u64,
}

/// An allocation and its entry in the book.
pub(super) struct Block {
    pub(super) allocation: Allocation,
    id: u64,
}

impl Memory {
    pub(super) fn new(
        instance: &ash::Instance,
        device: &ash::Device,
        physical: vk::PhysicalDevice,
    ) -> Result<Self> {
        // Small growing blocks: software devices have one heap of 2 GiB, and several processes
        // may test at once.
        let sizes = AllocationSizes::new(8 * MIB, 8 * MIB)
            .with_max_device_memblock_size(256 * MIB)
            .with_max_host_memblock_size(256 * MIB);
        let allocator = Allocator::new(&AllocatorCreateDesc {
            instance: instance.clone(),
            device: device.clone(),
            physical_device: physical,
            debug_settings: Default::default(),
            buffer_device_address: false,
            allocation_sizes: sizes,
        })
        .map_err(|e| Error::Unsupported(format!("memory allocator: {e}")))?;
        Ok(Self {
            allocator: Mutex::new(Some(allocator)),
            book: Mutex::default(),
        })
    }

    pub(super) fn allocate(
        &self,
        name: &str,
        requirements: vk::MemoryRequirements,
        location: MemoryLocation,
        linear: bool,
    ) -> Result<Block> {
        let mut guard = self.allocator.lock().expect("the allocator does not panic");
        let allocation = guard
            .as_mut()
            .expect("allocations end before the device")
            .allocate(&AllocationCreateDesc {
                name,
                requirements,
                location,
                linear,
                allocation_scheme: AllocationScheme::GpuAllocatorManaged,
            })
            .map_err(|e| Error::Device {
                doing: format!("allocating {name} ({} bytes)", requirements.size),
                reason: e.to_string(),
            })?;
        drop(guard);
        let mut book = self.book.lock().expect("plain data");
        let id = book.next_id;
        book.next_id += 1;
        book.live.insert(id, (name.to_owned(), requirements.size));
        book.bytes += requirements.size;
        book.peak = book.peak.max(book.bytes);
        Ok(Block { allocation, id })
    }

    pub(super) fn free(&self, block: Block) {
        if let Some(allocator) = self
            .allocator
            .lock()
            .expect("the allocator does not panic")
            .as_mut()
            && let Err(e) = allocator.free(block.allocation)
        {
            log::error!("freeing device memory: {e}");
        }
        let mut book = self.book.lock().expect("plain data");
        if let Some((_, bytes)) = book.live.remove(&block.id) {
            book.bytes -= bytes;
        }
    }

    pub(super) fn live(&self) -> Vec<(String, u64)> {
        self.book
            .lock()
            .expect("plain data")
            .live
            .values()
            .cloned()
            .collect()
    }

    pub(super) fn peak(&self) -> u64 {
        self.book.lock().expect("plain data").peak
    }

    /// Drops the allocator; nothing may be allocated afterwards.
    pub(super) fn destroy(&self) {
        drop(
            self.allocator
                .lock()
                .expect("the allocator does not panic")
                .take(),
        );
    }
}
