//! Vulkan mechanism: devices, queues, memory, pipelines and recorded work.
//!
//! The only room that names `ash` and the only one with `unsafe`. Reading order is the order of
//! dependence: [`queues`] and `access` are pure decisions, [`Gpu`] is the root, buffers, images
//! and pipelines hold it, [`Work`] records passes over them.
#![allow(unsafe_code, reason = "the one room that talks to Vulkan")]

mod access;
mod barriers;
mod binding;
mod buffer;
#[cfg(test)]
mod canary;
mod descriptors;
mod device;
mod draw;
mod format;
mod image;
mod instance;
mod memory;
mod passes;
mod pipeline;
mod pipeline_cache;
pub mod queues;
pub mod reflect;
mod resource;
mod select;
mod shader;
mod submission;
mod timers;
mod work;

pub use access::Access;
pub use binding::Binding;
pub use buffer::{Buffer, BufferInfo};
pub use device::{DeviceInfo, Gpu, GpuOptions, Limits, Validation};
pub use draw::{ColorTarget, DepthTarget, Draws, RenderPass};
pub use format::Format;
pub use image::{AddressMode, Image, ImageInfo, Sampler, SamplerInfo};
pub use passes::group_counts;
pub use pipeline::{ComputePipeline, Cull, GraphicsPipeline, GraphicsPipelineInfo};
pub use queues::QueueKind;
pub use shader::{Shader, shaders};
pub use submission::{Completed, Readback, Submission};
pub use timers::PassTime;
pub use work::Work;
