//! One piece of work: passes recorded in order into one command buffer for one queue.

use std::any::Any;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use ash::vk;

use super::access::{Access, Barrier};
use super::barriers::{Pending, combine};
use super::binding::Resource;
use super::buffer::Buffer;
use super::descriptors::Descriptors;
use super::device::{Gpu, device_error};
use super::queues::{Handover, QueueKind, Slot};
use super::resource::{Usage, usage};
use super::submission::Submission;
use super::timers::Timers;
use crate::Result;

/// Everything that completed work has to free; shared by [`Work`] and [`Submission`].
pub(super) struct Recorded {
    pub(super) gpu: Gpu,
    pub(super) kind: QueueKind,
    pub(super) pools: Vec<vk::CommandPool>,
    pub(super) timers: Timers,
    pub(super) descriptors: Descriptors,
    /// Filled by the work, read by the host afterwards.
    pub(super) readbacks: Vec<Buffer>,
    /// Pipelines, samplers, staging buffers and resources that must outlive the work.
    pub(super) keep: Vec<Box<dyn Any + Send>>,
}

impl Drop for Recorded {
    fn drop(&mut self) {
        let inner = &self.gpu.inner;
        // SAFETY: either never submitted or waited for (see `Submission::drop`).
        unsafe {
            self.descriptors.destroy(inner);
            self.timers.destroy(inner);
            for &pool in &self.pools {
                inner.device.destroy_command_pool(pool, None);
            }
        }
    }
}

struct Touched {
    resource: Resource,
    /// Usage before this work.
    before: Usage,
}

/// Resources that the work uses; dropped without `commit`, their usage is put back.
#[derive(Default)]
struct Touches {
    by_key: BTreeMap<usize, Touched>,
}

impl Touches {
    fn note(&mut self, resource: &Resource, before: Usage) {
        let entry = || Touched {
            resource: resource.clone(),
            before,
        };
        self.by_key.entry(resource.key()).or_insert_with(entry);
    }

    /// The work was submitted with this timeline value.
    fn commit(mut self, value: u64) -> Vec<Resource> {
        let resources: Vec<_> = std::mem::take(&mut self.by_key)
            .into_values()
            .map(|t| t.resource)
            .collect();
        for resource in &resources {
            let mut now = usage(resource.tracked());
            now.open_in = None;
            now.value = value;
        }
        resources
    }
}

impl Drop for Touches {
    fn drop(&mut self) {
        for touched in self.by_key.values() {
            *usage(touched.resource.tracked()) = touched.before;
        }
    }
}

/// A command buffer being recorded.
pub struct Work {
    pub(super) recorded: Recorded,
    pub(super) cmd: vk::CommandBuffer,
    label: String,
    slot: Slot,
    id: u64,
    touched: Touches,
    pending: Pending,
    /// Ownership releases to record on other queues, by queue.
    releases: BTreeMap<Slot, Pending>,
    /// Timeline values of other queues to wait for.
    waits: BTreeMap<Slot, u64>,
    /// What a later pass will do to resources that are ready for it (see [`Work::declare`]).
    declared: BTreeMap<usize, Access>,
}

impl fmt::Debug for Work {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Work({} on {:?})", self.label, self.slot)
    }
}

static NEXT_ID: AtomicU64 = AtomicU64::new(1);

impl Gpu {
    /// Starts recording work for a queue.
    ///
    /// # Errors
    /// When the device is out of memory.
    pub fn work(&self, kind: QueueKind, label: &str) -> Result<Work> {
        let slot = self.info().queues.slot(kind);
        let (pool, cmd) = begin_commands(self, slot, label)?;
        let timers = Timers::new(self)?;
        timers.start(&self.inner, cmd);
        let recorded = Recorded {
            gpu: self.clone(),
            kind,
            pools: vec![pool],
            timers,
            descriptors: Descriptors::default(),
            readbacks: Vec::new(),
            keep: Vec::new(),
        };
        Ok(Work {
            recorded,
            cmd,
            label: label.to_owned(),
            slot,
            id: NEXT_ID.fetch_add(1, Ordering::Relaxed),
            touched: Touches::default(),
            pending: Pending::default(),
            releases: BTreeMap::new(),
            waits: BTreeMap::new(),
            declared: BTreeMap::new(),
        })
    }
}

fn begin_commands(
    gpu: &Gpu,
    slot: Slot,
    label: &str,
) -> Result<(vk::CommandPool, vk::CommandBuffer)> {
    let device = &gpu.inner.device;
    let pool_info = vk::CommandPoolCreateInfo::default()
        .queue_family_index(slot.family)
        .flags(vk::CommandPoolCreateFlags::TRANSIENT);
    // SAFETY: the family exists; the pool is destroyed if anything after it fails.
    unsafe {
        let pool = device
            .create_command_pool(&pool_info, None)
            .map_err(|e| device_error(label, e))?;
        let allocate = vk::CommandBufferAllocateInfo::default()
            .command_pool(pool)
            .level(vk::CommandBufferLevel::PRIMARY)
            .command_buffer_count(1);
        let begin = vk::CommandBufferBeginInfo::default()
            .flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        let made = device.allocate_command_buffers(&allocate).and_then(|cmds| {
            device
                .begin_command_buffer(cmds[0], &begin)
                .map(|()| cmds[0])
        });
        match made {
            Ok(cmd) => {
                gpu.inner.set_name(cmd, label);
                Ok((pool, cmd))
            }
            Err(e) => {
                device.destroy_command_pool(pool, None);
                Err(device_error(label, e))
            }
        }
    }
}

impl Work {
    /// Records what must come before `accesses` and opens the pass `label`.
    pub(super) fn begin_pass(
        &mut self,
        label: &str,
        accesses: &[(Resource, Access)],
    ) -> Result<()> {
        for (resource, access) in combine(label, accesses) {
            match self.declared.get(&resource.key()) {
                Some(known) if *known == access && access.scope().writes => {
                    self.declared.remove(&resource.key());
                }
                _ => self.touch(label, &resource, access),
            }
        }
        self.flush_barriers();
        self.recorded
            .timers
            .begin(&self.recorded.gpu.inner, self.cmd, label)
    }

    /// Makes resources ready for a pass that comes after others, before those: with no barrier
    /// between them independent passes overlap on devices that wait at barriers.
    pub(super) fn declare_accesses(&mut self, label: &str, accesses: &[(Resource, Access)]) {
        for (resource, access) in combine(label, accesses) {
            self.touch(label, &resource, access);
            self.declared.insert(resource.key(), access);
        }
    }

    pub(super) fn end_pass(&mut self) {
        self.recorded.timers.end(&self.recorded.gpu.inner, self.cmd);
    }

    /// Keeps `object` alive until the work has completed.
    pub(super) fn keep(&mut self, object: impl Any + Send) {
        self.recorded.keep.push(Box::new(object));
    }

    /// Advances the resource's state and queues the barrier that follows from it.
    pub(super) fn touch(&mut self, label: &str, resource: &Resource, access: Access) {
        if let Some(known) = self.declared.get(&resource.key()) {
            let clash = known.scope().writes || access.scope().writes;
            assert!(
                !clash,
                "{label}: {} is used as {access:?} before a pass that declared {known:?}",
                resource.name()
            );
        }
        let mut now = usage(resource.tracked());
        let open_elsewhere = now.open_in.is_some_and(|id| id != self.id);
        assert!(
            !open_elsewhere,
            "{label}: {} is used by other work that is not submitted yet",
            resource.name()
        );
        self.touched.note(resource, *now);
        let handover = Handover::between(now.owner, self.slot);
        let from = now.owner;
        let source = now.state.pending();
        if let (Some(from), true) = (from, handover != Handover::None) {
            let value = self.waits.entry(from).or_default();
            *value = now.value.max(*value);
            now.state.settle();
        }
        let old_layout = now.state.layout;
        let barrier = now.state.advance(access, resource.is_image());
        now.owner = Some(self.slot);
        now.open_in = Some(self.id);
        drop(now);
        match (handover, from) {
            (Handover::Transfer, Some(from)) => {
                let scope = access.scope();
                let new_layout = if resource.is_image() {
                    scope.layout
                } else {
                    old_layout
                };
                let families = (from.family, self.slot.family);
                let mut release = Barrier {
                    src_stages: source.0,
                    src_access: source.1,
                    dst_stages: vk::PipelineStageFlags2::NONE,
                    dst_access: vk::AccessFlags2::NONE,
                    old_layout,
                    new_layout,
                };
                self.releases
                    .entry(from)
                    .or_default()
                    .push(resource, release, families);
                release.src_stages = vk::PipelineStageFlags2::NONE;
                release.src_access = vk::AccessFlags2::NONE;
                release.dst_stages = scope.stages;
                release.dst_access = scope.access;
                self.pending.push(resource, release, families);
            }
            _ => {
                if let Some(barrier) = barrier {
                    let none = (vk::QUEUE_FAMILY_IGNORED, vk::QUEUE_FAMILY_IGNORED);
                    self.pending.push(resource, barrier, none);
                }
            }
        }
    }

    pub(super) fn flush_barriers(&mut self) {
        let pending = std::mem::take(&mut self.pending);
        pending.record(&self.recorded.gpu, self.cmd);
    }

    /// Whether draws may bind the resource now: no barrier would be needed.
    pub(super) fn is_ready(&self, resource: &Resource, access: Access) -> bool {
        let now = usage(resource.tracked());
        let mut copy = now.state;
        Handover::between(now.owner, self.slot) == Handover::None
            && copy.advance(access, resource.is_image()).is_none()
    }

    /// Records a use that needed no barrier, so that later writers wait for it.
    pub(super) fn note_use(&mut self, label: &str, resource: &Resource, access: Access) {
        self.touch(label, resource, access);
        debug_assert!(
            self.pending.is_empty(),
            "{label}: {} was ready",
            resource.name()
        );
    }

    /// Ends recording and hands the work to its queue.
    ///
    /// # Errors
    /// When the device is lost or out of memory.
    pub fn submit(mut self) -> Result<Submission> {
        let gpu = self.recorded.gpu.clone();
        let device = &gpu.inner.device;
        // SAFETY: the command buffer is recording and outside of rendering.
        unsafe { device.end_command_buffer(self.cmd) }.map_err(|e| device_error(&self.label, e))?;
        for (slot, release) in std::mem::take(&mut self.releases) {
            let value = self.submit_release(slot, release)?;
            self.waits.insert(slot, value);
        }
        let value = submit_commands(&gpu, self.slot, self.cmd, &self.waits, &self.label)?;
        let Self {
            mut recorded,
            touched,
            slot,
            label,
            ..
        } = self;
        recorded.keep.push(Box::new(touched.commit(value)));
        Ok(Submission::new(recorded, slot, value, label))
    }

    /// The releasing half of an ownership transfer, on the queue that owned the resources.
    fn submit_release(&mut self, slot: Slot, release: Pending) -> Result<u64> {
        let gpu = self.recorded.gpu.clone();
        let (pool, cmd) = begin_commands(&gpu, slot, "ownership release")?;
        self.recorded.pools.push(pool);
        release.record(&gpu, cmd);
        // SAFETY: the command buffer is recording.
        unsafe { gpu.inner.device.end_command_buffer(cmd) }
            .map_err(|e| device_error("ownership release", e))?;
        submit_commands(&gpu, slot, cmd, &BTreeMap::new(), "ownership release")
    }
}

fn submit_commands(
    gpu: &Gpu,
    slot: Slot,
    cmd: vk::CommandBuffer,
    waits: &BTreeMap<Slot, u64>,
    label: &str,
) -> Result<u64> {
    let stages = vk::PipelineStageFlags2::ALL_COMMANDS;
    let wait_infos: Vec<_> = waits
        .iter()
        .map(|(&from, &value)| {
            let timeline = gpu.inner.queue_at(from).timeline;
            vk::SemaphoreSubmitInfo::default()
                .semaphore(timeline)
                .value(value)
                .stage_mask(stages)
        })
        .collect();
    let queue = gpu.inner.queue_at(slot);
    let mut last = queue
        .last_value
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner);
    let value = *last + 1;
    let signal = [vk::SemaphoreSubmitInfo::default()
        .semaphore(queue.timeline)
        .value(value)
        .stage_mask(stages)];
    let commands = [vk::CommandBufferSubmitInfo::default().command_buffer(cmd)];
    let info = vk::SubmitInfo2::default()
        .wait_semaphore_infos(&wait_infos)
        .command_buffer_infos(&commands)
        .signal_semaphore_infos(&signal);
    // SAFETY: the lock makes access to the queue exclusive; everything the commands use is kept
    // until the submission has been waited for.
    unsafe {
        gpu.inner
            .device
            .queue_submit2(queue.raw, &[info], vk::Fence::null())
    }
    .map_err(|e| device_error(label, e))?;
    *last = value;
    Ok(value)
}

/// Shorthand for passes: a buffer handle as a resource.
pub(super) fn buffer_resource(buffer: &Buffer) -> Resource {
    Resource::Buffer(Buffer {
        inner: Arc::clone(&buffer.inner),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::{BufferInfo, GpuOptions, Validation};

    /// What a device with a compute family of its own would record. The one-family drivers at
    /// hand cannot run it, so the barriers themselves are compared.
    #[test]
    fn a_resource_of_another_family_is_released_there_and_acquired_here() {
        let options = GpuOptions {
            validation: Validation::Required,
            ..Default::default()
        };
        let gpu = Gpu::new(&options).expect("a driver and the validation layer");
        let buffer = gpu
            .buffer(BufferInfo::device("from elsewhere", 64))
            .expect("small");
        let elsewhere = Slot {
            family: 7,
            index: 0,
        };
        {
            let mut known = usage(&buffer.inner.tracked);
            let _ = known.state.advance(Access::ComputeWrite, false);
            known.owner = Some(elsewhere);
            known.value = 3;
        }
        let mut work = gpu.work(QueueKind::Graphics, "draws").expect("records");
        work.touch("draws", &buffer_resource(&buffer), Access::DrawRead);
        let families =
            |b: &vk::BufferMemoryBarrier2<'_>| (b.src_queue_family_index, b.dst_queue_family_index);
        let release = work.releases[&elsewhere].buffers[0];
        let acquire = work.pending.buffers[0];
        assert_eq!(families(&release), (7, work.slot.family));
        assert_eq!(
            families(&release),
            families(&acquire),
            "both halves name the same queues"
        );
        assert!(
            release
                .src_access_mask
                .contains(vk::AccessFlags2::SHADER_STORAGE_WRITE),
            "made available"
        );
        assert_eq!(release.dst_stage_mask, vk::PipelineStageFlags2::NONE);
        assert_eq!(acquire.src_stage_mask, vk::PipelineStageFlags2::NONE);
        assert!(
            acquire
                .dst_stage_mask
                .contains(vk::PipelineStageFlags2::VERTEX_SHADER)
        );
        assert_eq!(
            work.waits[&elsewhere], 3,
            "waits for the submission that wrote it"
        );
        drop(work);
        assert_eq!(
            usage(&buffer.inner.tracked).owner,
            Some(elsewhere),
            "abandoned work changes nothing"
        );
        // So that nothing else looks for a queue of family 7.
        *usage(&buffer.inner.tracked) = Usage::default();
    }
}
