//! One label per pass: debug label, two timestamps and a last-reached marker.

use ash::vk;

use super::buffer::{Buffer, BufferInfo};
use super::device::{Gpu, Inner, device_error};
use crate::Result;

/// GPU time of one pass.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PassTime {
    /// The pass's label.
    pub label: String,
    /// Name of the queue it ran on: `compute`, `graphics` or `transfer`.
    pub queue: &'static str,
    /// Duration by the device's clock; 0 where the queue has no timestamps.
    pub nanoseconds: u64,
}

const PASSES_PER_POOL: usize = 64;
/// Passes that get a marker of their own; later ones share the last.
const MARKERS: u64 = 1024;

/// Query pools, labels and markers of one piece of work.
pub(super) struct Timers {
    pools: Vec<vk::QueryPool>,
    pub(super) labels: Vec<String>,
    /// Word `i` becomes 1 when pass `i` starts, readable even after the device is lost.
    markers: Buffer,
}

impl Timers {
    pub(super) fn new(gpu: &Gpu) -> Result<Self> {
        let markers = gpu.buffer(BufferInfo::readback("pass markers", 4 * MARKERS))?;
        Ok(Self {
            pools: Vec::new(),
            labels: Vec::new(),
            markers,
        })
    }

    /// Clears the markers; the first command of the work.
    pub(super) fn start(&self, gpu: &Inner, cmd: vk::CommandBuffer) {
        let barrier = [vk::MemoryBarrier2::default()
            .src_stage_mask(vk::PipelineStageFlags2::ALL_TRANSFER)
            .src_access_mask(vk::AccessFlags2::TRANSFER_WRITE)
            .dst_stage_mask(vk::PipelineStageFlags2::ALL_TRANSFER)
            .dst_access_mask(vk::AccessFlags2::TRANSFER_WRITE)];
        // SAFETY: the command buffer is recording; the buffer is kept until the work is done.
        unsafe {
            gpu.device
                .cmd_fill_buffer(cmd, self.markers.inner.raw, 0, vk::WHOLE_SIZE, 0);
            gpu.device.cmd_pipeline_barrier2(
                cmd,
                &vk::DependencyInfo::default().memory_barriers(&barrier),
            );
        }
    }

    /// Opens a pass. Must stand outside of rendering.
    pub(super) fn begin(&mut self, gpu: &Inner, cmd: vk::CommandBuffer, label: &str) -> Result<()> {
        let pass = self.labels.len();
        self.labels.push(label.to_owned());
        if pass.is_multiple_of(PASSES_PER_POOL) {
            let info = vk::QueryPoolCreateInfo::default()
                .query_type(vk::QueryType::TIMESTAMP)
                .query_count(2 * PASSES_PER_POOL as u32);
            // SAFETY: the command buffer is recording outside of rendering.
            unsafe {
                let pool = gpu
                    .device
                    .create_query_pool(&info, None)
                    .map_err(|e| device_error(label, e))?;
                gpu.device
                    .cmd_reset_query_pool(cmd, pool, 0, 2 * PASSES_PER_POOL as u32);
                self.pools.push(pool);
            }
        }
        if let Some(debug) = &gpu.debug {
            let name = std::ffi::CString::new(label.replace('\0', " ")).expect("no NUL left");
            let info = vk::DebugUtilsLabelEXT::default().label_name(&name);
            // SAFETY: ended in `end`, in the same command buffer.
            unsafe { debug.cmd_begin_debug_utils_label(cmd, &info) };
        }
        if (pass as u64) < MARKERS {
            // SAFETY: each pass fills its own word, after the clearing barrier.
            unsafe {
                gpu.device
                    .cmd_fill_buffer(cmd, self.markers.inner.raw, 4 * pass as u64, 4, 1);
            };
        }
        self.stamp(gpu, cmd, 0);
        Ok(())
    }

    /// Closes the pass opened last.
    pub(super) fn end(&self, gpu: &Inner, cmd: vk::CommandBuffer) {
        self.stamp(gpu, cmd, 1);
        if let Some(debug) = &gpu.debug {
            // SAFETY: a label is open.
            unsafe { debug.cmd_end_debug_utils_label(cmd) };
        }
    }

    fn stamp(&self, gpu: &Inner, cmd: vk::CommandBuffer, end: usize) {
        if !gpu.info.timestamps {
            return;
        }
        let pass = self.labels.len() - 1;
        let query = (2 * (pass % PASSES_PER_POOL) + end) as u32;
        let pool = self.pools[pass / PASSES_PER_POOL];
        // All commands, at both ends: passes are timed one after the other, never overlapping.
        // SAFETY: the query was reset when its pool was made.
        unsafe {
            gpu.device.cmd_write_timestamp2(
                cmd,
                vk::PipelineStageFlags2::ALL_COMMANDS,
                pool,
                query,
            );
        };
    }

    /// Reads the durations of completed work.
    pub(super) fn read(&self, gpu: &Inner, queue: &'static str) -> Result<Vec<PassTime>> {
        let mut ticks = Vec::new();
        for (pool, labels) in self.pools.iter().zip(self.labels.chunks(PASSES_PER_POOL)) {
            let mut part = vec![0u64; 2 * labels.len()];
            if gpu.info.timestamps {
                // SAFETY: every query of the range was written by the completed work.
                unsafe {
                    gpu.device.get_query_pool_results(
                        *pool,
                        0,
                        &mut part,
                        vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WAIT,
                    )
                }
                .map_err(|e| device_error("reading timestamps", e))?;
            }
            ticks.append(&mut part);
        }
        let period = f64::from(gpu.info.timestamp_period_ns);
        let time = |t: &[u64]| (t[1].saturating_sub(t[0]) as f64 * period) as u64;
        Ok(self
            .labels
            .iter()
            .zip(ticks.chunks_exact(2))
            .map(|(label, t)| PassTime {
                label: label.clone(),
                queue,
                nanoseconds: time(t),
            })
            .collect())
    }

    /// Label of the last pass that started, for the error after a lost device.
    pub(super) fn last_started(&self) -> Option<&str> {
        let mut bytes = vec![0u8; 4 * self.labels.len().min(MARKERS as usize)];
        self.markers.read_bytes(&mut bytes);
        let last = bytes.chunks_exact(4).rposition(|w| w != [0; 4])?;
        self.labels.get(last).map(String::as_str)
    }

    /// # Safety
    /// The work has completed.
    pub(super) unsafe fn destroy(&mut self, gpu: &Inner) {
        for pool in self.pools.drain(..) {
            // SAFETY: promised by the caller.
            unsafe { gpu.device.destroy_query_pool(pool, None) };
        }
    }
}
