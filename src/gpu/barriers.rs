//! Barriers that wait to be recorded, and the accesses of a pass that they follow from.

use ash::vk;

use super::access::{Access, Barrier};
use super::binding::Resource;
use super::device::Gpu;

/// Barriers to record before the next pass.
#[derive(Default)]
pub(super) struct Pending {
    pub(super) buffers: Vec<vk::BufferMemoryBarrier2<'static>>,
    pub(super) images: Vec<vk::ImageMemoryBarrier2<'static>>,
}

impl Pending {
    pub(super) fn is_empty(&self) -> bool {
        self.buffers.is_empty() && self.images.is_empty()
    }

    pub(super) fn push(&mut self, resource: &Resource, b: Barrier, (from, to): (u32, u32)) {
        match resource {
            Resource::Buffer(buffer) => self.buffers.push(
                vk::BufferMemoryBarrier2::default()
                    .src_stage_mask(b.src_stages)
                    .src_access_mask(b.src_access)
                    .dst_stage_mask(b.dst_stages)
                    .dst_access_mask(b.dst_access)
                    .src_queue_family_index(from)
                    .dst_queue_family_index(to)
                    .buffer(buffer.inner.raw)
                    .size(vk::WHOLE_SIZE),
            ),
            Resource::Image(image) => self.images.push(
                vk::ImageMemoryBarrier2::default()
                    .src_stage_mask(b.src_stages)
                    .src_access_mask(b.src_access)
                    .dst_stage_mask(b.dst_stages)
                    .dst_access_mask(b.dst_access)
                    .src_queue_family_index(from)
                    .dst_queue_family_index(to)
                    .old_layout(b.old_layout)
                    .new_layout(b.new_layout)
                    .image(image.inner.raw)
                    .subresource_range(image.range()),
            ),
        }
    }

    pub(super) fn record(&self, gpu: &Gpu, cmd: vk::CommandBuffer) {
        if !self.is_empty() {
            let info = vk::DependencyInfo::default()
                .buffer_memory_barriers(&self.buffers)
                .image_memory_barriers(&self.images);
            // SAFETY: recording, outside of rendering; the resources are kept alive by the work.
            unsafe { gpu.inner.device.cmd_pipeline_barrier2(cmd, &info) };
        }
    }
}

/// One access per resource: two ranges of one buffer, one read and one written by a kernel, are
/// one read-write use.
pub(super) fn combine(label: &str, accesses: &[(Resource, Access)]) -> Vec<(Resource, Access)> {
    let mut out: Vec<(Resource, Access)> = Vec::with_capacity(accesses.len());
    for (resource, access) in accesses {
        match out.iter_mut().find(|(r, _)| r.key() == resource.key()) {
            None => out.push((resource.clone(), *access)),
            Some((_, known)) if *known == *access => {}
            Some((_, known)) => {
                let kernel = [
                    Access::ComputeRead,
                    Access::ComputeWrite,
                    Access::ComputeReadWrite,
                ];
                if kernel.contains(known) && kernel.contains(access) {
                    *known = Access::ComputeReadWrite;
                } else {
                    let writes = known.scope().writes || access.scope().writes;
                    assert!(
                        !writes && !resource.is_image(),
                        "{label}: {} is used as {known:?} and {access:?}",
                        resource.name()
                    );
                    out.push((resource.clone(), *access));
                }
            }
        }
    }
    out
}
