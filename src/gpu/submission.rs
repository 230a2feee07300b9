//! Work on its way: waiting for it, its times, and what it read back.

use std::fmt;
use std::marker::PhantomData;

use ash::vk;
use bytemuck::Pod;

use super::device::device_error;
use super::queues::Slot;
use super::timers::PassTime;
use super::work::Recorded;
use crate::{Error, Result};

/// A liveness guard, not a performance budget: software devices may work for a long time.
const PATIENCE_NANOSECONDS: u64 = 3_600_000_000_000;

/// Submitted work. Dropping it waits for it.
pub struct Submission {
    recorded: Option<Recorded>,
    slot: Slot,
    value: u64,
    label: String,
}

impl fmt::Debug for Submission {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "Submission({} on {:?}, value {})",
            self.label, self.slot, self.value
        )
    }
}

/// A promise of data that the work copies to the host.
#[derive(Debug, Clone, Copy)]
#[must_use = "take it from the completed work"]
pub struct Readback<T> {
    pub(super) index: usize,
    pub(super) bytes: usize,
    pub(super) element: PhantomData<T>,
}

/// Completed work.
pub struct Completed {
    recorded: Recorded,
    passes: Vec<PassTime>,
}

impl fmt::Debug for Completed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Completed")
            .field("passes", &self.passes)
            .finish_non_exhaustive()
    }
}

impl Submission {
    pub(super) fn new(recorded: Recorded, slot: Slot, value: u64, label: String) -> Self {
        Self {
            recorded: Some(recorded),
            slot,
            value,
            label,
        }
    }

    /// Waits for the work.
    ///
    /// # Errors
    /// When the device is lost; the message names the pass that had started last.
    pub fn wait(mut self) -> Result<Completed> {
        let result = self.block();
        let recorded = self.recorded.take().expect("taken only here");
        if let Err(e) = result {
            let doing = recorded
                .timers
                .last_started()
                .unwrap_or(&self.label)
                .to_owned();
            return Err(match device_error(&doing, e) {
                Error::Device { doing, reason } => Error::Device { doing, reason },
                other => other,
            });
        }
        let passes = recorded
            .timers
            .read(&recorded.gpu.inner, recorded.kind.name())?;
        Ok(Completed { recorded, passes })
    }

    fn block(&self) -> Result<(), vk::Result> {
        let Some(recorded) = &self.recorded else {
            return Ok(());
        };
        let inner = &recorded.gpu.inner;
        let semaphores = [inner.queue_at(self.slot).timeline];
        let values = [self.value];
        let info = vk::SemaphoreWaitInfo::default()
            .semaphores(&semaphores)
            .values(&values);
        // SAFETY: the semaphore belongs to this device.
        unsafe { inner.device.wait_semaphores(&info, PATIENCE_NANOSECONDS) }
    }
}

impl Drop for Submission {
    fn drop(&mut self) {
        if let Err(e) = self.block() {
            log::error!("{}: {e}", self.label);
        }
    }
}

impl Completed {
    /// GPU time of every pass, in order.
    #[must_use]
    pub fn passes(&self) -> &[PassTime] {
        &self.passes
    }

    /// The data of a readback.
    #[must_use]
    pub fn take<T: Pod>(&mut self, readback: Readback<T>) -> Vec<T> {
        let mut out = vec![T::zeroed(); readback.bytes / size_of::<T>().max(1)];
        self.recorded.readbacks[readback.index].read_bytes(bytemuck::cast_slice_mut(&mut out));
        out
    }
}
