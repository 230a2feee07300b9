//! What buffers and images have in common: who used them last, and how.

use std::sync::Mutex;

use super::access::State;
use super::queues::Slot;

/// Use of a resource so far.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Usage {
    /// Hazards and layout on the owning queue.
    pub(super) state: State,
    /// Queue that used it last.
    pub(super) owner: Option<Slot>,
    /// Timeline value of that use.
    pub(super) value: u64,
    /// The unsubmitted work that records with it.
    pub(super) open_in: Option<u64>,
}

/// Shared usage record of one resource.
pub(super) type Tracked = Mutex<Usage>;

/// Locks a usage record: plain data, so a poisoned lock cannot be inconsistent.
pub(super) fn usage(tracked: &Tracked) -> std::sync::MutexGuard<'_, Usage> {
    tracked
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner)
}
