//! Which queue does what: a pure decision, tested with the families of real devices.
//!
//! Callers ask for a [`QueueKind`]; when the device has no queue of its own for it, kinds alias
//! the same queue and nobody has to know (after Granite's queue policy).

/// What a piece of work is submitted for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum QueueKind {
    /// Drawing (may also compute and copy).
    Graphics,
    /// Preprocessing kernels (may also copy).
    Compute,
    /// Uploads and downloads.
    Transfer,
}

impl QueueKind {
    /// Every kind, in the order of [`QueuePlan::slots`].
    pub const ALL: [Self; 3] = [Self::Graphics, Self::Compute, Self::Transfer];

    /// Lower-case name for labels and tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Graphics => "graphics",
            Self::Compute => "compute",
            Self::Transfer => "transfer",
        }
    }
}

/// What the decision needs to know of a queue family.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Family {
    /// Can draw.
    pub graphics: bool,
    /// Can dispatch.
    pub compute: bool,
    /// Can copy (implied by the other two).
    pub transfer: bool,
    /// Number of queues.
    pub count: u32,
}

/// One queue of the device.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Slot {
    /// Family index.
    pub family: u32,
    /// Queue index inside the family.
    pub index: u32,
}

/// The queue of each kind; equal slots alias.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct QueuePlan {
    /// For drawing.
    pub graphics: Slot,
    /// For preprocessing.
    pub compute: Slot,
    /// For copies.
    pub transfer: Slot,
}

impl QueuePlan {
    /// Decides, or `None` when no family can both draw and compute.
    ///
    /// Compute goes to a family without graphics (asynchronous compute), else to a second queue
    /// of the graphics family, else it aliases. Transfer goes to a copy-only family, else to a
    /// spare queue of the compute family, else it aliases compute.
    #[must_use]
    pub fn decide(families: &[Family]) -> Option<Self> {
        let find = |wanted: &dyn Fn(&Family) -> bool| {
            families
                .iter()
                .position(|f| f.count > 0 && wanted(f))
                .map(|i| i as u32)
        };
        let graphics = Slot {
            family: find(&|f| f.graphics && f.compute)?,
            index: 0,
        };
        let queues_of = |family: u32| families[family as usize].count;
        let compute = match find(&|f| f.compute && !f.graphics) {
            Some(family) => Slot { family, index: 0 },
            None if queues_of(graphics.family) > 1 => Slot {
                family: graphics.family,
                index: 1,
            },
            None => graphics,
        };
        let transfer = match find(&|f| f.transfer && !f.compute && !f.graphics) {
            Some(family) => Slot { family, index: 0 },
            None if queues_of(compute.family) > compute.index + 1 => Slot {
                family: compute.family,
                index: compute.index + 1,
            },
            None => compute,
        };
        Some(Self {
            graphics,
            compute,
            transfer,
        })
    }

    /// The same queue for everything: what a device with one queue gets.
    #[must_use]
    pub fn single(self) -> Self {
        Self {
            graphics: self.graphics,
            compute: self.graphics,
            transfer: self.graphics,
        }
    }

    /// The slot of a kind.
    #[must_use]
    pub fn slot(&self, kind: QueueKind) -> Slot {
        match kind {
            QueueKind::Graphics => self.graphics,
            QueueKind::Compute => self.compute,
            QueueKind::Transfer => self.transfer,
        }
    }

    /// The distinct slots, sorted.
    #[must_use]
    pub fn slots(&self) -> Vec<Slot> {
        let mut slots: Vec<Slot> = QueueKind::ALL.iter().map(|&k| self.slot(k)).collect();
        slots.sort_unstable();
        slots.dedup();
        slots
    }
}

/// What must happen when a resource last used on one queue is used on another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Handover {
    /// Same queue: submission order and a barrier do.
    None,
    /// Another queue of the same family: wait for its timeline semaphore.
    Wait,
    /// Another family: release there, wait, acquire here.
    Transfer,
}

impl Handover {
    /// Decides from the two queues; `None` as source means never used.
    #[must_use]
    pub fn between(from: Option<Slot>, to: Slot) -> Self {
        match from {
            None => Self::None,
            Some(from) if from == to => Self::None,
            Some(from) if from.family == to.family => Self::Wait,
            Some(_) => Self::Transfer,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn family(graphics: bool, compute: bool, count: u32) -> Family {
        Family {
            graphics,
            compute,
            transfer: true,
            count,
        }
    }

    fn slot(family: u32, index: u32) -> Slot {
        Slot { family, index }
    }

    #[test]
    fn lavapipe_and_intel_alias_everything() {
        let plan = QueuePlan::decide(&[family(true, true, 1)]).expect("drawable");
        assert_eq!(plan.slots(), [slot(0, 0)]);
        assert_eq!(plan.compute, plan.graphics);
        assert_eq!(plan.transfer, plan.graphics);
    }

    #[test]
    fn nvidia_gets_async_compute_and_a_copy_engine() {
        // graphics x16, transfer x2, compute x8, then video families without any of the three
        let families = [
            family(true, true, 16),
            family(false, false, 2),
            family(false, true, 8),
            Family {
                graphics: false,
                compute: false,
                transfer: false,
                count: 1,
            },
        ];
        let plan = QueuePlan::decide(&families).expect("drawable");
        assert_eq!(
            (plan.graphics, plan.compute, plan.transfer),
            (slot(0, 0), slot(2, 0), slot(1, 0))
        );
    }

    #[test]
    fn amd_gets_async_compute_and_dma() {
        let families = [
            family(true, true, 1),
            family(false, true, 4),
            family(false, false, 2),
        ];
        let plan = QueuePlan::decide(&families).expect("drawable");
        assert_eq!(
            (plan.graphics, plan.compute, plan.transfer),
            (slot(0, 0), slot(1, 0), slot(2, 0))
        );
    }

    #[test]
    fn spare_queues_of_one_family_are_used() {
        let plan = QueuePlan::decide(&[family(true, true, 3)]).expect("drawable");
        assert_eq!((plan.compute, plan.transfer), (slot(0, 1), slot(0, 2)));
        let plan =
            QueuePlan::decide(&[family(true, true, 1), family(false, true, 2)]).expect("drawable");
        assert_eq!((plan.compute, plan.transfer), (slot(1, 0), slot(1, 1)));
    }

    #[test]
    fn a_device_that_cannot_draw_is_no_device() {
        assert_eq!(QueuePlan::decide(&[family(false, true, 4)]), None);
        assert_eq!(QueuePlan::decide(&[family(true, true, 0)]), None);
        assert_eq!(QueuePlan::decide(&[]), None);
    }

    #[test]
    fn handover_depends_on_queue_and_family() {
        assert_eq!(Handover::between(None, slot(0, 0)), Handover::None);
        assert_eq!(
            Handover::between(Some(slot(0, 0)), slot(0, 0)),
            Handover::None
        );
        assert_eq!(
            Handover::between(Some(slot(0, 1)), slot(0, 0)),
            Handover::Wait
        );
        assert_eq!(
            Handover::between(Some(slot(2, 0)), slot(0, 0)),
            Handover::Transfer
        );
    }
}
