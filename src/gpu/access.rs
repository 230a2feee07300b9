//! The synchronisation vocabulary: what a pass does to a resource, and the barrier that follows.
//!
//! Stage and access masks stand only here. The decision is pure and tested without a device.

use ash::vk;

/// What one pass does to one buffer or image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Access {
    /// A kernel reads it (storage or uniform buffer, storage image).
    ComputeRead,
    /// A kernel writes it.
    ComputeWrite,
    /// A kernel reads and writes it.
    ComputeReadWrite,
    /// A kernel samples the image.
    ComputeSampled,
    /// Draws read it (storage or uniform buffer, storage image) in any shader.
    DrawRead,
    /// Draws sample the image.
    DrawSampled,
    /// Draws write it from the fragment shader.
    DrawWrite,
    /// The index buffer of draws.
    IndexRead,
    /// Arguments of an indirect dispatch or draw.
    IndirectRead,
    /// Source of a copy.
    TransferRead,
    /// Target of a copy, fill or clear. `ALL_TRANSFER`: validation layers model fills as copies.
    TransferWrite,
    /// Colour attachment, also the target of a resolve.
    ColorWrite,
    /// Depth attachment, tested and written.
    DepthWrite,
    /// Read by the host after the submission has been waited for.
    HostRead,
}

/// Masks and layout of an access.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Scope {
    pub(super) stages: vk::PipelineStageFlags2,
    pub(super) access: vk::AccessFlags2,
    pub(super) layout: vk::ImageLayout,
    pub(super) writes: bool,
}

impl Access {
    /// The one table from meaning to masks.
    pub(super) fn scope(self) -> Scope {
        use vk::{AccessFlags2 as A, ImageLayout as L, PipelineStageFlags2 as S};
        let draw_shaders = S::VERTEX_SHADER | S::FRAGMENT_SHADER;
        let depth_tests = S::EARLY_FRAGMENT_TESTS | S::LATE_FRAGMENT_TESTS;
        let storage_read = A::SHADER_STORAGE_READ | A::UNIFORM_READ;
        let (stages, access, layout, writes) = match self {
            Self::ComputeRead => (S::COMPUTE_SHADER, storage_read, L::GENERAL, false),
            Self::ComputeWrite => (S::COMPUTE_SHADER, A::SHADER_STORAGE_WRITE, L::GENERAL, true),
            Self::ComputeReadWrite => (
                S::COMPUTE_SHADER,
                A::SHADER_STORAGE_READ | A::SHADER_STORAGE_WRITE,
                L::GENERAL,
                true,
            ),
            Self::ComputeSampled => (
                S::COMPUTE_SHADER,
                A::SHADER_SAMPLED_READ,
                L::SHADER_READ_ONLY_OPTIMAL,
                false,
            ),
            Self::DrawRead => (draw_shaders, storage_read, L::GENERAL, false),
            Self::DrawSampled => (
                draw_shaders,
                A::SHADER_SAMPLED_READ,
                L::SHADER_READ_ONLY_OPTIMAL,
                false,
            ),
            Self::DrawWrite => (
                S::FRAGMENT_SHADER,
                A::SHADER_STORAGE_READ | A::SHADER_STORAGE_WRITE,
                L::GENERAL,
                true,
            ),
            Self::IndexRead => (S::INDEX_INPUT, A::INDEX_READ, L::UNDEFINED, false),
            Self::IndirectRead => (
                S::DRAW_INDIRECT,
                A::INDIRECT_COMMAND_READ,
                L::UNDEFINED,
                false,
            ),
            Self::TransferRead => (
                S::ALL_TRANSFER,
                A::TRANSFER_READ,
                L::TRANSFER_SRC_OPTIMAL,
                false,
            ),
            Self::TransferWrite => (
                S::ALL_TRANSFER,
                A::TRANSFER_WRITE,
                L::TRANSFER_DST_OPTIMAL,
                true,
            ),
            Self::ColorWrite => (
                S::COLOR_ATTACHMENT_OUTPUT,
                A::COLOR_ATTACHMENT_READ | A::COLOR_ATTACHMENT_WRITE,
                L::COLOR_ATTACHMENT_OPTIMAL,
                true,
            ),
            // Resolving a depth attachment happens in the colour output stage; it is not used here.
            Self::DepthWrite => (
                depth_tests,
                A::DEPTH_STENCIL_ATTACHMENT_READ | A::DEPTH_STENCIL_ATTACHMENT_WRITE,
                L::DEPTH_ATTACHMENT_OPTIMAL,
                true,
            ),
            Self::HostRead => (S::HOST, A::HOST_READ, L::GENERAL, false),
        };
        Scope {
            stages,
            access,
            layout,
            writes,
        }
    }
}

/// What has happened to a resource so far on its queue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct State {
    /// Stages and accesses of the last write; empty when nothing is pending.
    write_stages: vk::PipelineStageFlags2,
    write_access: vk::AccessFlags2,
    /// Stages that read since the last write.
    read_stages: vk::PipelineStageFlags2,
    /// Stages and accesses that the last write has been made visible to.
    seen_stages: vk::PipelineStageFlags2,
    seen_access: vk::AccessFlags2,
    /// Current layout of an image; `UNDEFINED` for buffers and untouched images.
    pub(super) layout: vk::ImageLayout,
}

impl Default for State {
    fn default() -> Self {
        Self {
            write_stages: vk::PipelineStageFlags2::NONE,
            write_access: vk::AccessFlags2::NONE,
            read_stages: vk::PipelineStageFlags2::NONE,
            seen_stages: vk::PipelineStageFlags2::NONE,
            seen_access: vk::AccessFlags2::NONE,
            layout: vk::ImageLayout::UNDEFINED,
        }
    }
}

/// A barrier to record before the next pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Barrier {
    pub(super) src_stages: vk::PipelineStageFlags2,
    pub(super) src_access: vk::AccessFlags2,
    pub(super) dst_stages: vk::PipelineStageFlags2,
    pub(super) dst_access: vk::AccessFlags2,
    pub(super) old_layout: vk::ImageLayout,
    pub(super) new_layout: vk::ImageLayout,
}

impl State {
    /// Advances to `next` and returns the barrier that must come before it, if any.
    pub(super) fn advance(&mut self, next: Access, is_image: bool) -> Option<Barrier> {
        let scope = next.scope();
        let layout = if is_image {
            scope.layout
        } else {
            vk::ImageLayout::UNDEFINED
        };
        let relayout = is_image && layout != self.layout;
        let old_layout = self.layout;
        // A layout change reads and writes the image, so it counts as a write.
        let modifies = scope.writes || relayout;
        let (src_stages, src_access) = if modifies && !self.read_stages.is_empty() {
            // Readers saw the write already: only execution has to be ordered after them.
            (self.read_stages | self.write_stages, self.write_access)
        } else {
            (self.write_stages, self.write_access)
        };
        let visible =
            self.seen_stages.contains(scope.stages) && self.seen_access.contains(scope.access);
        let needed = relayout
            || if modifies {
                !src_stages.is_empty()
            } else {
                !self.write_stages.is_empty() && !visible
            };
        if modifies {
            *self = Self {
                layout,
                ..Self::default()
            };
            if scope.writes {
                self.write_stages = scope.stages;
                self.write_access = scope.access;
            } else {
                // The transition itself is made visible to this reader by the barrier; a later
                // reader of another stage chains after this one.
                self.write_stages = scope.stages;
                self.read_stages = scope.stages;
                self.seen_stages = scope.stages;
                self.seen_access = scope.access;
            }
        } else {
            self.read_stages |= scope.stages;
            if needed {
                self.seen_stages |= scope.stages;
                self.seen_access |= scope.access;
            }
        }
        needed.then_some(Barrier {
            src_stages,
            src_access,
            dst_stages: scope.stages,
            dst_access: scope.access,
            old_layout,
            new_layout: layout,
        })
    }

    /// Everything pending, for a release to another queue or a host wait.
    pub(super) fn pending(&self) -> (vk::PipelineStageFlags2, vk::AccessFlags2) {
        (self.write_stages | self.read_stages, self.write_access)
    }

    /// After a semaphore wait nothing is pending any more; the layout stays.
    pub(super) fn settle(&mut self) {
        *self = Self {
            layout: self.layout,
            ..Self::default()
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vk::{ImageLayout as L, PipelineStageFlags2 as S};

    fn run(accesses: &[Access], image: bool) -> Vec<Option<Barrier>> {
        let mut state = State::default();
        accesses.iter().map(|&a| state.advance(a, image)).collect()
    }

    #[test]
    fn first_use_of_a_buffer_needs_no_barrier() {
        assert_eq!(run(&[Access::ComputeWrite], false), [None]);
    }

    #[test]
    fn read_after_write_waits_once() {
        let b = run(
            &[
                Access::ComputeWrite,
                Access::ComputeRead,
                Access::ComputeRead,
            ],
            false,
        );
        let first = b[1].expect("read after write");
        assert_eq!(
            (first.src_stages, first.dst_stages),
            (S::COMPUTE_SHADER, S::COMPUTE_SHADER)
        );
        assert!(
            first
                .src_access
                .contains(vk::AccessFlags2::SHADER_STORAGE_WRITE),
            "made available"
        );
        assert_eq!(
            b[2], None,
            "the second reader of the same stage sees it already"
        );
    }

    #[test]
    fn a_reader_of_another_stage_waits_for_the_writer_too() {
        let b = run(
            &[
                Access::ComputeWrite,
                Access::ComputeRead,
                Access::IndirectRead,
            ],
            false,
        );
        let second = b[2].expect("indirect read after write");
        assert_eq!(
            (second.src_stages, second.dst_stages),
            (S::COMPUTE_SHADER, S::DRAW_INDIRECT)
        );
    }

    #[test]
    fn write_after_read_waits_for_every_reader() {
        let b = run(
            &[
                Access::ComputeWrite,
                Access::ComputeRead,
                Access::DrawRead,
                Access::TransferWrite,
            ],
            false,
        );
        let last = b[3].expect("write after reads");
        assert!(
            last.src_stages
                .contains(S::COMPUTE_SHADER | S::VERTEX_SHADER | S::FRAGMENT_SHADER)
        );
    }

    #[test]
    fn write_after_write_waits() {
        assert!(run(&[Access::TransferWrite, Access::ComputeWrite], false)[1].is_some());
    }

    #[test]
    fn images_change_layout_between_readers() {
        let b = run(
            &[
                Access::ColorWrite,
                Access::DrawSampled,
                Access::TransferRead,
                Access::TransferRead,
            ],
            true,
        );
        assert_eq!(b[0].expect("from undefined").old_layout, L::UNDEFINED);
        assert_eq!(
            b[1].expect("to sampled").new_layout,
            L::SHADER_READ_ONLY_OPTIMAL
        );
        let third = b[2].expect("to transfer source");
        assert!(
            third.src_stages.contains(S::FRAGMENT_SHADER),
            "waits for the sampling reader"
        );
        assert_eq!(b[3], None);
    }

    #[test]
    fn settled_resources_keep_their_layout_and_owe_nothing() {
        let mut state = State::default();
        let _ = state.advance(Access::ColorWrite, true);
        state.settle();
        assert_eq!(state.layout, L::COLOR_ATTACHMENT_OPTIMAL);
        assert_eq!(state.pending(), (S::NONE, vk::AccessFlags2::NONE));
    }

    #[test]
    fn every_write_access_is_marked_as_one() {
        for access in [
            Access::ComputeWrite,
            Access::ComputeReadWrite,
            Access::DrawWrite,
            Access::TransferWrite,
            Access::ColorWrite,
            Access::DepthWrite,
        ] {
            assert!(access.scope().writes, "{access:?}");
        }
        for access in [
            Access::ComputeRead,
            Access::ComputeSampled,
            Access::DrawRead,
            Access::DrawSampled,
            Access::IndexRead,
            Access::IndirectRead,
            Access::TransferRead,
            Access::HostRead,
        ] {
            assert!(!access.scope().writes, "{access:?}");
        }
    }
}
