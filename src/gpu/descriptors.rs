//! Descriptor sets of one piece of work: allocated as needed, freed together.

use ash::vk;

use super::binding::Binding;
use super::device::{Inner, device_error};
use super::pipeline::PipelineInner;
use crate::{Error, Result};

const SETS_PER_POOL: u32 = 128;

/// Pools that grow by one when the last is full.
#[derive(Default)]
pub(super) struct Descriptors {
    pools: Vec<vk::DescriptorPool>,
}

impl Descriptors {
    /// Allocates and writes set `set` of `pipeline`.
    pub(super) fn set(
        &mut self,
        gpu: &Inner,
        pipeline: &PipelineInner,
        set: u32,
        bindings: &[Binding<'_>],
    ) -> Result<vk::DescriptorSet> {
        check(gpu, pipeline, set, bindings)?;
        let raw = self.allocate(gpu, pipeline, set)?;
        let wanted: Vec<_> = pipeline.bindings.iter().filter(|b| b.set == set).collect();
        let buffers: Vec<_> = wanted
            .iter()
            .map(|b| {
                bindings[b.binding as usize]
                    .buffer_info()
                    .unwrap_or_default()
            })
            .collect();
        let images: Vec<_> = wanted
            .iter()
            .map(|b| {
                bindings[b.binding as usize]
                    .image_info()
                    .unwrap_or_default()
            })
            .collect();
        let writes: Vec<_> = wanted
            .iter()
            .enumerate()
            .map(|(i, b)| {
                let write = vk::WriteDescriptorSet::default()
                    .dst_set(raw)
                    .dst_binding(b.binding)
                    .descriptor_type(b.kind.raw());
                match bindings[b.binding as usize].buffer_info() {
                    Some(_) => write.buffer_info(std::slice::from_ref(&buffers[i])),
                    None => write.image_info(std::slice::from_ref(&images[i])),
                }
            })
            .collect();
        // SAFETY: set, buffers and views are alive; the set is not in use yet.
        unsafe { gpu.device.update_descriptor_sets(&writes, &[]) };
        Ok(raw)
    }

    fn allocate(
        &mut self,
        gpu: &Inner,
        pipeline: &PipelineInner,
        set: u32,
    ) -> Result<vk::DescriptorSet> {
        let layouts = [pipeline.sets[set as usize]];
        if let Some(&pool) = self.pools.last() {
            let info = vk::DescriptorSetAllocateInfo::default()
                .descriptor_pool(pool)
                .set_layouts(&layouts);
            // SAFETY: pool and layout are alive. A full pool is a normal answer.
            match unsafe { gpu.device.allocate_descriptor_sets(&info) } {
                Ok(sets) => return Ok(sets[0]),
                Err(vk::Result::ERROR_OUT_OF_POOL_MEMORY | vk::Result::ERROR_FRAGMENTED_POOL) => {}
                Err(e) => return Err(device_error(&pipeline.name, e)),
            }
        }
        self.pools.push(new_pool(gpu)?);
        let info = vk::DescriptorSetAllocateInfo::default()
            .descriptor_pool(*self.pools.last().expect("just pushed"))
            .set_layouts(&layouts);
        // SAFETY: as above.
        let sets = unsafe { gpu.device.allocate_descriptor_sets(&info) };
        Ok(sets.map_err(|e| device_error(&pipeline.name, e))?[0])
    }

    /// # Safety
    /// No work uses the sets any more.
    pub(super) unsafe fn destroy(&mut self, gpu: &Inner) {
        for pool in self.pools.drain(..) {
            // SAFETY: promised by the caller.
            unsafe { gpu.device.destroy_descriptor_pool(pool, None) };
        }
    }
}

fn new_pool(gpu: &Inner) -> Result<vk::DescriptorPool> {
    let size = |ty, descriptor_count| vk::DescriptorPoolSize {
        ty,
        descriptor_count,
    };
    let sizes = [
        size(vk::DescriptorType::STORAGE_BUFFER, 8 * SETS_PER_POOL),
        size(vk::DescriptorType::UNIFORM_BUFFER, SETS_PER_POOL),
        size(
            vk::DescriptorType::COMBINED_IMAGE_SAMPLER,
            4 * SETS_PER_POOL,
        ),
        size(vk::DescriptorType::STORAGE_IMAGE, SETS_PER_POOL),
    ];
    let info = vk::DescriptorPoolCreateInfo::default()
        .max_sets(SETS_PER_POOL)
        .pool_sizes(&sizes);
    // SAFETY: plain creation.
    unsafe { gpu.device.create_descriptor_pool(&info, None) }
        .map_err(|e| device_error("vkCreateDescriptorPool", e))
}

/// The bindings given must be what the shaders declare; ranges must fit the device.
fn check(gpu: &Inner, pipeline: &PipelineInner, set: u32, bindings: &[Binding<'_>]) -> Result<()> {
    for wanted in pipeline.bindings.iter().filter(|b| b.set == set) {
        let Some(given) = bindings.get(wanted.binding as usize) else {
            panic!(
                "{}: set {set} binding {} is not given",
                pipeline.name, wanted.binding
            );
        };
        assert_eq!(
            given.kind(),
            wanted.kind,
            "{}: set {set} binding {}",
            pipeline.name,
            wanted.binding
        );
        let limit = gpu.info.limits.max_storage_range;
        if let Some(info) = given.buffer_info().filter(|i| i.range > limit) {
            return Err(Error::Unsupported(format!(
                "{} binds {} bytes of {}; {} allows {limit} bytes in one binding",
                pipeline.name,
                info.range,
                given.resource().name(),
                gpu.info.name
            )));
        }
    }
    Ok(())
}
