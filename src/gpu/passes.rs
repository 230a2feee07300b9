//! The passes that are not drawing: kernels, fills, copies, uploads and downloads.

use std::marker::PhantomData;

use ash::vk;
use bytemuck::Pod;

use super::access::Access;
use super::binding::{Binding, Resource};
use super::buffer::{Buffer, BufferInfo};
use super::device::Gpu;
use super::image::Image;
use super::pipeline::{ComputePipeline, PipelineInner};
use super::queues::QueueKind;
use super::submission::Readback;
use super::work::{Work, buffer_resource};
use crate::Result;

/// Groups that cover `invocations`. One-dimensional dispatches are folded over y when they have
/// more groups than one dimension allows (`dispatch.glsl` unfolds them).
///
/// # Panics
/// When a folded dispatch still does not fit, or a dispatch in several dimensions is too large.
#[must_use]
pub fn group_counts(invocations: [u32; 3], local: [u32; 3], max_groups: u32) -> [u32; 3] {
    let mut groups = [0, 1, 2].map(|i| invocations[i].div_ceil(local[i]));
    if groups[0] > max_groups && groups[1..] == [1, 1] {
        groups[1] = groups[0].div_ceil(max_groups);
        groups[0] = max_groups;
    }
    assert!(
        groups.iter().all(|&g| g <= max_groups),
        "{groups:?} groups, {max_groups} allowed"
    );
    groups
}

impl Work {
    /// Runs a kernel over at least `invocations` (the group count comes from the shader).
    ///
    /// `push` must have the size of the shader's push constants (`&()` for none).
    ///
    /// # Errors
    /// When a binding exceeds the device's range or memory runs out.
    ///
    /// # Panics
    /// When bindings or push constants are not what the shader declares.
    pub fn compute<P: Pod>(
        &mut self,
        label: &str,
        pipeline: &ComputePipeline,
        bindings: &[Binding<'_>],
        push: &P,
        invocations: [u32; 3],
    ) -> Result<()> {
        self.begin_compute(label, pipeline, bindings, push)?;
        let max = self.recorded.gpu.info().limits.max_groups;
        let [x, y, z] = group_counts(invocations, pipeline.local_size(), max);
        if x > 0 && y > 0 && z > 0 {
            // SAFETY: pipeline, sets and push constants are bound; the counts are in range.
            unsafe {
                self.recorded
                    .gpu
                    .inner
                    .device
                    .cmd_dispatch(self.cmd, x, y, z);
            };
        }
        self.end_pass();
        Ok(())
    }

    fn begin_compute<P: Pod>(
        &mut self,
        label: &str,
        pipeline: &ComputePipeline,
        bindings: &[Binding<'_>],
        push: &P,
    ) -> Result<()> {
        let accesses: Vec<_> = bindings
            .iter()
            .map(|b| (b.resource(), b.compute_access()))
            .collect();
        let inner = &pipeline.inner;
        let gpu = self.recorded.gpu.clone();
        let set = match inner.sets.is_empty() {
            true => None,
            false => Some(
                self.recorded
                    .descriptors
                    .set(&gpu.inner, inner, 0, bindings)?,
            ),
        };
        self.begin_pass(label, &accesses)?;
        let device = &gpu.inner.device;
        // SAFETY: pipeline and set belong together; both are kept until the work is done.
        unsafe {
            device.cmd_bind_pipeline(self.cmd, vk::PipelineBindPoint::COMPUTE, inner.raw);
            if let Some(set) = set {
                device.cmd_bind_descriptor_sets(
                    self.cmd,
                    vk::PipelineBindPoint::COMPUTE,
                    inner.layout,
                    0,
                    &[set],
                    &[],
                );
            }
        }
        self.push_constants(label, inner, push);
        for sampler in bindings.iter().filter_map(Binding::sampler) {
            self.keep(sampler);
        }
        self.keep(pipeline.clone());
        Ok(())
    }

    pub(super) fn push_constants<P: Pod>(&self, label: &str, pipeline: &PipelineInner, push: &P) {
        let bytes = bytemuck::bytes_of(push);
        assert_eq!(
            bytes.len(),
            pipeline.push_bytes as usize,
            "{label}: push constants of {}",
            pipeline.name
        );
        if !bytes.is_empty() {
            let device = &self.recorded.gpu.inner.device;
            // SAFETY: the range is the one of the layout.
            unsafe {
                device.cmd_push_constants(self.cmd, pipeline.layout, pipeline.stages, 0, bytes);
            };
        }
    }

    /// Sets every word of a buffer.
    ///
    /// # Errors
    /// When memory runs out.
    pub fn fill(&mut self, label: &str, buffer: &Buffer, word: u32) -> Result<()> {
        self.begin_pass(label, &[(buffer_resource(buffer), Access::TransferWrite)])?;
        // SAFETY: recording; the buffer is kept by the work.
        unsafe {
            self.recorded.gpu.inner.device.cmd_fill_buffer(
                self.cmd,
                buffer.inner.raw,
                0,
                vk::WHOLE_SIZE,
                word,
            );
        };
        self.end_pass();
        Ok(())
    }

    /// Copies `data` to the start of a buffer through a staging buffer.
    ///
    /// # Errors
    /// When memory runs out.
    pub fn upload<T: Pod>(&mut self, label: &str, buffer: &Buffer, data: &[T]) -> Result<()> {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        assert!(
            bytes.len() as u64 <= buffer.bytes(),
            "{label}: {} bytes into {buffer:?}",
            bytes.len()
        );
        if bytes.is_empty() {
            return Ok(());
        }
        let staging = self.stage(label, bytes)?;
        self.begin_pass(label, &[(buffer_resource(buffer), Access::TransferWrite)])?;
        let region = [vk::BufferCopy::default().size(bytes.len() as u64)];
        // SAFETY: both buffers hold the region and are kept by the work.
        unsafe {
            self.recorded.gpu.inner.device.cmd_copy_buffer(
                self.cmd,
                staging.inner.raw,
                buffer.inner.raw,
                &region,
            );
        }
        self.end_pass();
        self.keep(staging);
        Ok(())
    }

    fn stage(&self, label: &str, bytes: &[u8]) -> Result<Buffer> {
        let staging = self.recorded.gpu.buffer(BufferInfo::upload(
            format!("{label} staging"),
            bytes.len() as u64,
        ))?;
        staging.write(bytes);
        Ok(staging)
    }

    /// Copies the whole of `source` to the start of `target`.
    ///
    /// # Errors
    /// When memory runs out.
    pub fn copy(&mut self, label: &str, source: &Buffer, target: &Buffer) -> Result<()> {
        assert!(
            source.bytes() <= target.bytes(),
            "{label}: {source:?} into {target:?}"
        );
        self.begin_pass(
            label,
            &[
                (buffer_resource(source), Access::TransferRead),
                (buffer_resource(target), Access::TransferWrite),
            ],
        )?;
        if source.bytes() > 0 {
            let region = [vk::BufferCopy::default().size(source.bytes())];
            // SAFETY: both buffers hold the region and are kept by the work.
            unsafe {
                self.recorded.gpu.inner.device.cmd_copy_buffer(
                    self.cmd,
                    source.inner.raw,
                    target.inner.raw,
                    &region,
                );
            }
        }
        self.end_pass();
        Ok(())
    }

    /// Fills the mip levels of an image, tightly packed, and leaves it ready to be sampled.
    ///
    /// # Errors
    /// When memory runs out.
    ///
    /// # Panics
    /// When a level has not the size that the image says.
    pub fn upload_image(&mut self, label: &str, image: &Image, levels: &[&[u8]]) -> Result<()> {
        let info = image.info();
        assert_eq!(
            levels.len(),
            info.mip_levels as usize,
            "{label}: levels of {image:?}"
        );
        let mut regions = Vec::new();
        let mut bytes = Vec::new();
        for (level, data) in (0u32..).zip(levels) {
            let [w, h] = info.level_extent(level);
            let expected = u64::from(w) * u64::from(h) * info.format.bytes();
            assert_eq!(
                data.len() as u64,
                expected,
                "{label}: level {level} of {image:?}"
            );
            regions.push(image_copy(image, level, bytes.len() as u64));
            bytes.extend_from_slice(data);
            // Copies want offsets that are multiples of the texel size; 16 is one of all formats.
            bytes.resize(bytes.len().next_multiple_of(16), 0);
        }
        let staging = self.stage(label, &bytes)?;
        let resource = Resource::Image(image.clone());
        self.begin_pass(label, &[(resource.clone(), Access::TransferWrite)])?;
        // SAFETY: every region lies in both; both are kept by the work.
        unsafe {
            self.recorded.gpu.inner.device.cmd_copy_buffer_to_image(
                self.cmd,
                staging.inner.raw,
                image.inner.raw,
                vk::ImageLayout::TRANSFER_DST_OPTIMAL,
                &regions,
            );
        }
        self.end_pass();
        self.keep(staging);
        if self.recorded.kind == QueueKind::Graphics {
            self.touch(label, &resource, Access::DrawSampled);
            self.flush_barriers();
        }
        Ok(())
    }

    /// Copies a whole buffer to the host; take it from the completed work.
    ///
    /// # Errors
    /// When memory runs out.
    pub fn read<T: Pod>(&mut self, label: &str, buffer: &Buffer) -> Result<Readback<T>> {
        let target = self.recorded.gpu.buffer(BufferInfo::readback(
            format!("{label} readback"),
            buffer.bytes(),
        ))?;
        self.copy(label, buffer, &target)?;
        self.touch(label, &buffer_resource(&target), Access::HostRead);
        self.flush_barriers();
        Ok(self.promise(target))
    }

    /// Copies level 0 of an image to the host, tightly packed.
    ///
    /// # Errors
    /// When memory runs out.
    pub fn read_image(&mut self, label: &str, image: &Image) -> Result<Readback<u8>> {
        let [w, h] = image.info().extent;
        let bytes = u64::from(w) * u64::from(h) * image.info().format.bytes();
        let target = self
            .recorded
            .gpu
            .buffer(BufferInfo::readback(format!("{label} readback"), bytes))?;
        let accesses = [
            (Resource::Image(image.clone()), Access::TransferRead),
            (buffer_resource(&target), Access::TransferWrite),
        ];
        self.begin_pass(label, &accesses)?;
        // SAFETY: the target holds the whole level; both are kept by the work.
        unsafe {
            self.recorded.gpu.inner.device.cmd_copy_image_to_buffer(
                self.cmd,
                image.inner.raw,
                vk::ImageLayout::TRANSFER_SRC_OPTIMAL,
                target.inner.raw,
                &[image_copy(image, 0, 0)],
            );
        }
        self.end_pass();
        self.touch(label, &buffer_resource(&target), Access::HostRead);
        self.flush_barriers();
        Ok(self.promise(target))
    }

    fn promise<T>(&mut self, target: Buffer) -> Readback<T> {
        let bytes = usize::try_from(target.bytes()).expect("fits the host");
        self.recorded.readbacks.push(target);
        Readback {
            index: self.recorded.readbacks.len() - 1,
            bytes,
            element: PhantomData,
        }
    }
}

fn image_copy(image: &Image, level: u32, offset: u64) -> vk::BufferImageCopy {
    let [width, height] = image.info().level_extent(level);
    vk::BufferImageCopy {
        buffer_offset: offset,
        buffer_row_length: 0,
        buffer_image_height: 0,
        image_subresource: vk::ImageSubresourceLayers {
            aspect_mask: image.info().format.aspect(),
            mip_level: level,
            base_array_layer: 0,
            layer_count: 1,
        },
        image_offset: vk::Offset3D::default(),
        image_extent: vk::Extent3D {
            width,
            height,
            depth: 1,
        },
    }
}

impl Gpu {
    /// Makes a device buffer with this content, through the transfer queue.
    ///
    /// # Errors
    /// As [`Gpu::buffer`].
    pub fn upload<T: Pod>(&self, name: &str, data: &[T]) -> Result<Buffer> {
        let buffer = self.buffer(BufferInfo::device(name, size_of_val(data) as u64))?;
        let mut work = self.work(QueueKind::Transfer, name)?;
        work.upload(name, &buffer, data)?;
        work.submit()?.wait()?;
        Ok(buffer)
    }

    /// The content of a buffer.
    ///
    /// # Errors
    /// When memory runs out or the device is lost.
    pub fn read<T: Pod>(&self, buffer: &Buffer) -> Result<Vec<T>> {
        let label = buffer.info().name.clone();
        let mut work = self.work(QueueKind::Transfer, &label)?;
        let readback = work.read(&label, buffer)?;
        Ok(work.submit()?.wait()?.take(readback))
    }
}

#[cfg(test)]
mod tests {
    use super::group_counts;

    #[test]
    fn groups_cover_the_invocations() {
        assert_eq!(group_counts([1, 1, 1], [64, 1, 1], 65_535), [1, 1, 1]);
        assert_eq!(group_counts([65, 1, 1], [64, 1, 1], 65_535), [2, 1, 1]);
        assert_eq!(group_counts([0, 1, 1], [64, 1, 1], 65_535), [0, 1, 1]);
        assert_eq!(group_counts([33, 17, 9], [4, 4, 4], 65_535), [9, 5, 3]);
    }

    #[test]
    fn long_dispatches_fold_over_y() {
        let [x, y, z] = group_counts([10_000_000, 1, 1], [64, 1, 1], 65_535);
        assert_eq!((x, z), (65_535, 1));
        assert!(u64::from(x) * u64::from(y) * 64 >= 10_000_000);
    }

    #[test]
    #[should_panic(expected = "groups")]
    fn a_volume_too_large_is_a_bug_of_the_caller() {
        let _ = group_counts([1 << 20, 1 << 20, 1], [1, 1, 1], 65_535);
    }
}
