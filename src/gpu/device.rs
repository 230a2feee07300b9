//! The device and its queues: the root that every other GPU object holds.

use std::ffi::CStr;
use std::fmt;
use std::path::PathBuf;
use std::sync::{Arc, Mutex};

use ash::{ext, vk};

use super::instance::{Canary, Instance};
use super::memory::Memory;
use super::pipeline_cache::PipelineCache;
use super::queues::{Family, QueuePlan, Slot};
use super::select::{Candidate, choose};
use crate::{Error, Result};

/// Whether the Khronos validation layer (with synchronisation validation) is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Validation {
    /// Not loaded.
    #[default]
    Off,
    /// Loaded when installed.
    IfPresent,
    /// An error when it is not installed: tests never run unchecked.
    Required,
}

/// How to open a device.
#[derive(Debug, Clone, Default)]
pub struct GpuOptions {
    /// Index or part of the name; the best device when absent.
    pub device: Option<String>,
    /// Validation layer.
    pub validation: Validation,
    /// Folder of the pipeline cache; none when absent.
    pub pipeline_cache: Option<PathBuf>,
    /// Use one queue for everything, even where the device has more.
    pub single_queue: bool,
}

/// Limits that callers check before they allocate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Largest range of one storage-buffer binding, bytes.
    pub max_storage_range: u64,
    /// Largest single allocation, bytes.
    pub max_allocation: u64,
    /// Sum of the device-local heaps, bytes.
    pub device_memory: u64,
    /// Largest width and height of a 2-D image.
    pub max_image_2d: u32,
    /// Invocations per compute group.
    pub max_group_invocations: u32,
    /// Groups per dimension of a dispatch.
    pub max_groups: u32,
    /// Largest sample count for colour and depth together.
    pub max_samples: u32,
    /// Bytes of push constants.
    pub max_push_bytes: u32,
}

/// What the device says of itself.
#[derive(Debug, Clone)]
pub struct DeviceInfo {
    /// Position in the loader's list.
    pub index: usize,
    /// Device name.
    pub name: String,
    /// Driver name, such as `llvmpipe`.
    pub driver: String,
    /// Driver version text.
    pub driver_info: String,
    /// `VkDriverId` as a number.
    pub driver_id: i32,
    /// Vulkan version, `1.3.230`.
    pub api_version: String,
    /// `cpu`, `integrated`, `discrete` ...
    pub device_type: &'static str,
    /// PCI vendor.
    pub vendor_id: u32,
    /// PCI device.
    pub device_id: u32,
    /// Limits.
    pub limits: Limits,
    /// Lanes of a subgroup: a run-time variable on software devices.
    pub subgroup_size: u32,
    /// Nanoseconds per timestamp tick.
    pub timestamp_period_ns: f32,
    /// Whether passes are timed.
    pub timestamps: bool,
    /// Anisotropic filtering.
    pub anisotropy: bool,
    /// Which queue does what.
    pub queues: QueuePlan,
}

/// A queue and the timeline semaphore that its submissions signal.
pub(super) struct Queue {
    pub(super) slot: Slot,
    pub(super) raw: vk::Queue,
    pub(super) timeline: vk::Semaphore,
    /// Last value given to a submission. Locked while submitting, so values rise in order.
    pub(super) last_value: Mutex<u64>,
}

/// Shared by all objects of the device. Field order is drop order; see `Drop`.
pub(super) struct Inner {
    pub(super) info: DeviceInfo,
    pub(super) device: ash::Device,
    pub(super) debug: Option<ext::debug_utils::Device>,
    pub(super) queues: Vec<Queue>,
    pub(super) memory: Memory,
    pub(super) pipeline_cache: PipelineCache,
    pub(super) physical: vk::PhysicalDevice,
    canary: Canary,
    pub(super) instance: Instance,
}

/// A Vulkan device; cloning gives another handle to the same device.
#[derive(Clone)]
pub struct Gpu {
    pub(super) inner: Arc<Inner>,
}

impl fmt::Debug for Gpu {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Gpu")
            .field("info", &self.inner.info)
            .finish_non_exhaustive()
    }
}

impl Gpu {
    /// Opens a device without a window: the normal way.
    ///
    /// # Errors
    /// When no device fits (every device and its reason is named), or the validation layer is
    /// required and missing.
    pub fn new(options: &GpuOptions) -> Result<Self> {
        let instance = Instance::new(options.validation)?;
        // SAFETY: plain query.
        let physicals = unsafe { instance.raw.enumerate_physical_devices() }
            .map_err(|e| Error::Unsupported(format!("vkEnumeratePhysicalDevices: {e}")))?;
        let candidates: Vec<Candidate> = physicals
            .iter()
            .map(|&p| candidate(&instance.raw, p))
            .collect();
        let index = choose(&candidates, options.device.as_deref())?;
        let physical = physicals[index];
        let mut plan = QueuePlan::decide(&candidates[index].families).expect("rated above");
        if options.single_queue {
            plan = plan.single();
        }
        let info = describe(&instance.raw, physical, index, plan);
        log::info!(
            "device {index}: {} ({} {})",
            info.name,
            info.driver,
            info.driver_info
        );
        let device = create_device(&instance.raw, physical, plan)?;
        let debug = instance
            .debug
            .as_ref()
            .map(|_| ext::debug_utils::Device::new(&instance.raw, &device));
        let queues = plan
            .slots()
            .into_iter()
            .map(|slot| open_queue(&device, slot))
            .collect::<Result<_>>()?;
        let memory = Memory::new(&instance.raw, &device, physical)?;
        let pipeline_cache = PipelineCache::open(
            &device,
            &info,
            options.pipeline_cache.as_deref(),
            uuid(&instance.raw, physical),
        );
        let canary = instance.canary();
        let inner = Inner {
            info,
            device,
            debug,
            queues,
            memory,
            pipeline_cache,
            physical,
            canary,
            instance,
        };
        Ok(Self {
            inner: Arc::new(inner),
        })
    }

    /// What the device says of itself.
    #[must_use]
    pub fn info(&self) -> &DeviceInfo {
        &self.inner.info
    }

    /// Messages of the validation layer so far; tests assert that there are none.
    #[must_use]
    pub fn validation_messages(&self) -> Vec<String> {
        self.inner
            .canary
            .lock()
            .map(|m| m.clone())
            .unwrap_or_default()
    }

    /// Takes the messages, leaving none.
    #[must_use]
    pub fn take_validation_messages(&self) -> Vec<String> {
        self.inner
            .canary
            .lock()
            .map(|mut m| std::mem::take(&mut *m))
            .unwrap_or_default()
    }

    /// Live allocations as (name, bytes), in the order they were made.
    #[must_use]
    pub fn allocations(&self) -> Vec<(String, u64)> {
        self.inner.memory.live()
    }

    /// Largest sum of live allocations so far, bytes.
    #[must_use]
    pub fn peak_bytes(&self) -> u64 {
        self.inner.memory.peak()
    }
}

impl Inner {
    pub(super) fn queue_at(&self, slot: Slot) -> &Queue {
        self.queues
            .iter()
            .find(|q| q.slot == slot)
            .expect("every planned slot was opened")
    }

    /// Names an object for the validation layer and for captures.
    pub(super) fn set_name<T: vk::Handle>(&self, object: T, name: &str) {
        if let Some(debug) = &self.debug {
            let name = std::ffi::CString::new(name.replace('\0', " ")).expect("no NUL left");
            let info = vk::DebugUtilsObjectNameInfoEXT::default()
                .object_handle(object)
                .object_name(&name);
            // SAFETY: the handle belongs to this device. A name that cannot be set is no harm.
            let _ = unsafe { debug.set_debug_utils_object_name(&info) };
        }
    }
}

impl Drop for Inner {
    fn drop(&mut self) {
        for (name, bytes) in self.memory.live() {
            log::error!("leaked {name}: {bytes} bytes");
        }
        self.pipeline_cache.save(&self.device);
        // SAFETY: every object of the device holds an `Arc` of this struct, so none is alive.
        // The allocator goes before the device.
        unsafe {
            let _ = self.device.device_wait_idle();
            self.pipeline_cache.destroy(&self.device);
            self.memory.destroy();
            for queue in &self.queues {
                self.device.destroy_semaphore(queue.timeline, None);
            }
            self.device.destroy_device(None);
        }
    }
}

/// A Vulkan result that the user can do something about, or a bug.
pub(super) fn device_error(doing: &str, result: vk::Result) -> Error {
    match result {
        vk::Result::ERROR_DEVICE_LOST
        | vk::Result::ERROR_OUT_OF_DEVICE_MEMORY
        | vk::Result::ERROR_OUT_OF_HOST_MEMORY
        | vk::Result::TIMEOUT => Error::Device {
            doing: doing.into(),
            reason: result.to_string(),
        },
        other => panic!("{doing}: {other:?}"),
    }
}

fn candidate(instance: &ash::Instance, physical: vk::PhysicalDevice) -> Candidate {
    // SAFETY: plain queries.
    let (properties, families) = unsafe {
        (
            instance.get_physical_device_properties(physical),
            instance.get_physical_device_queue_family_properties(physical),
        )
    };
    Candidate {
        name: properties
            .device_name_as_c_str()
            .unwrap_or(c"?")
            .to_string_lossy()
            .into_owned(),
        api_version: properties.api_version,
        device_type: properties.device_type,
        families: families
            .iter()
            .map(|f| Family {
                graphics: f.queue_flags.contains(vk::QueueFlags::GRAPHICS),
                compute: f.queue_flags.contains(vk::QueueFlags::COMPUTE),
                transfer: f.queue_flags.contains(vk::QueueFlags::TRANSFER),
                count: f.queue_count,
            })
            .collect(),
        missing: missing_features(instance, physical, properties.api_version),
        max_group_invocations: properties.limits.max_compute_work_group_invocations,
        max_storage_buffers_per_stage: properties.limits.max_per_stage_descriptor_storage_buffers,
    }
}

fn missing_features(
    instance: &ash::Instance,
    physical: vk::PhysicalDevice,
    api: u32,
) -> Vec<&'static str> {
    if api < vk::API_VERSION_1_3 {
        return Vec::new();
    }
    let mut v12 = vk::PhysicalDeviceVulkan12Features::default();
    let mut v13 = vk::PhysicalDeviceVulkan13Features::default();
    let mut all = vk::PhysicalDeviceFeatures2::default()
        .push_next(&mut v12)
        .push_next(&mut v13);
    // SAFETY: the chain is valid for a 1.3 device.
    unsafe { instance.get_physical_device_features2(physical, &mut all) };
    let independent_blend = all.features.independent_blend;
    let required = [
        (v13.dynamic_rendering, "dynamicRendering"),
        (v13.synchronization2, "synchronization2"),
        (v13.maintenance4, "maintenance4"),
        (v12.timeline_semaphore, "timelineSemaphore"),
        (v12.scalar_block_layout, "scalarBlockLayout"),
        (independent_blend, "independentBlend"),
    ];
    required
        .iter()
        .filter(|(have, _)| *have == vk::FALSE)
        .map(|(_, name)| *name)
        .collect()
}

fn describe(
    instance: &ash::Instance,
    physical: vk::PhysicalDevice,
    index: usize,
    queues: QueuePlan,
) -> DeviceInfo {
    let mut driver = vk::PhysicalDeviceDriverProperties::default();
    let mut v11 = vk::PhysicalDeviceVulkan11Properties::default();
    let mut v13 = vk::PhysicalDeviceVulkan13Properties::default();
    let mut all = vk::PhysicalDeviceProperties2::default()
        .push_next(&mut driver)
        .push_next(&mut v11)
        .push_next(&mut v13);
    // SAFETY: the chain is valid for a 1.3 device.
    let (memory, families, features) = unsafe {
        instance.get_physical_device_properties2(physical, &mut all);
        (
            instance.get_physical_device_memory_properties(physical),
            instance.get_physical_device_queue_family_properties(physical),
            instance.get_physical_device_features(physical),
        )
    };
    let p = all.properties;
    let samples =
        p.limits.framebuffer_color_sample_counts & p.limits.framebuffer_depth_sample_counts;
    let text = |s: std::result::Result<&CStr, _>| {
        s.map(|s| s.to_string_lossy().into_owned())
            .unwrap_or_default()
    };
    let device_memory = memory
        .memory_heaps_as_slice()
        .iter()
        .filter(|h| h.flags.contains(vk::MemoryHeapFlags::DEVICE_LOCAL))
        .map(|h| h.size)
        .sum();
    let api = p.api_version;
    DeviceInfo {
        index,
        name: text(p.device_name_as_c_str()),
        driver: text(driver.driver_name_as_c_str()),
        driver_info: text(driver.driver_info_as_c_str()),
        driver_id: driver.driver_id.as_raw(),
        api_version: format!(
            "{}.{}.{}",
            vk::api_version_major(api),
            vk::api_version_minor(api),
            vk::api_version_patch(api)
        ),
        device_type: match p.device_type {
            vk::PhysicalDeviceType::DISCRETE_GPU => "discrete",
            vk::PhysicalDeviceType::INTEGRATED_GPU => "integrated",
            vk::PhysicalDeviceType::VIRTUAL_GPU => "virtual",
            vk::PhysicalDeviceType::CPU => "cpu",
            _ => "other",
        },
        vendor_id: p.vendor_id,
        device_id: p.device_id,
        limits: Limits {
            max_storage_range: u64::from(p.limits.max_storage_buffer_range),
            max_allocation: v11.max_memory_allocation_size.min(v13.max_buffer_size),
            device_memory,
            max_image_2d: p.limits.max_image_dimension2_d,
            max_group_invocations: p.limits.max_compute_work_group_invocations,
            max_groups: *p
                .limits
                .max_compute_work_group_count
                .iter()
                .min()
                .expect("three dimensions"),
            max_samples: 1 << (31 - samples.as_raw().max(1).leading_zeros()),
            max_push_bytes: p.limits.max_push_constants_size,
        },
        subgroup_size: v11.subgroup_size,
        timestamp_period_ns: p.limits.timestamp_period,
        timestamps: queues
            .slots()
            .iter()
            .all(|s| families[s.family as usize].timestamp_valid_bits > 0),
        anisotropy: features.sampler_anisotropy == vk::TRUE,
        queues,
    }
}

fn create_device(
    instance: &ash::Instance,
    physical: vk::PhysicalDevice,
    plan: QueuePlan,
) -> Result<ash::Device> {
    // SAFETY: plain query.
    let have = unsafe { instance.get_physical_device_features(physical) };
    let wanted = vk::PhysicalDeviceFeatures {
        independent_blend: vk::TRUE,
        sampler_anisotropy: have.sampler_anisotropy,
        shader_image_gather_extended: have.shader_image_gather_extended,
        ..Default::default()
    };
    let mut v12 = vk::PhysicalDeviceVulkan12Features::default()
        .timeline_semaphore(true)
        .scalar_block_layout(true);
    let mut v13 = vk::PhysicalDeviceVulkan13Features::default()
        .dynamic_rendering(true)
        .synchronization2(true)
        .maintenance4(true);
    let slots = plan.slots();
    let priorities = vec![1.0f32; slots.len()];
    let mut families: Vec<(u32, usize)> = Vec::new();
    for slot in &slots {
        match families.iter_mut().find(|f| f.0 == slot.family) {
            Some(f) => f.1 += 1,
            None => families.push((slot.family, 1)),
        }
    }
    let queue_infos: Vec<_> = families
        .iter()
        .map(|&(family, count)| {
            vk::DeviceQueueCreateInfo::default()
                .queue_family_index(family)
                .queue_priorities(&priorities[..count])
        })
        .collect();
    let info = vk::DeviceCreateInfo::default()
        .queue_create_infos(&queue_infos)
        .enabled_features(&wanted)
        .push_next(&mut v12)
        .push_next(&mut v13);
    // SAFETY: every pointer in `info` outlives the call; the features were checked.
    unsafe { instance.create_device(physical, &info, None) }
        .map_err(|e| Error::Unsupported(format!("vkCreateDevice: {e}")))
}

fn open_queue(device: &ash::Device, slot: Slot) -> Result<Queue> {
    let mut kind =
        vk::SemaphoreTypeCreateInfo::default().semaphore_type(vk::SemaphoreType::TIMELINE);
    let info = vk::SemaphoreCreateInfo::default().push_next(&mut kind);
    // SAFETY: the queue was requested at device creation.
    unsafe {
        let timeline = device
            .create_semaphore(&info, None)
            .map_err(|e| device_error("vkCreateSemaphore", e))?;
        let raw = device.get_device_queue(slot.family, slot.index);
        Ok(Queue {
            slot,
            raw,
            timeline,
            last_value: Mutex::new(0),
        })
    }
}

fn uuid(instance: &ash::Instance, physical: vk::PhysicalDevice) -> [u8; 16] {
    // SAFETY: plain query.
    unsafe { instance.get_physical_device_properties(physical) }.pipeline_cache_uuid
}
