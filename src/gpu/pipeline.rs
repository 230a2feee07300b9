//! Compute and graphics pipelines; layouts come from what the shaders say of themselves.

use std::fmt;
use std::sync::Arc;

use ash::vk;

use super::Shader;
use super::device::{Gpu, Inner, device_error};
use super::format::Format;
use super::reflect::{ReflectedBinding, Reflection};
use crate::Result;

/// A pipeline, its layout and set layouts.
pub(super) struct PipelineInner {
    gpu: Arc<Inner>,
    pub(super) name: String,
    pub(super) raw: vk::Pipeline,
    pub(super) layout: vk::PipelineLayout,
    pub(super) sets: Vec<vk::DescriptorSetLayout>,
    pub(super) bindings: Vec<ReflectedBinding>,
    pub(super) push_bytes: u32,
    pub(super) stages: vk::ShaderStageFlags,
    pub(super) local_size: [u32; 3],
}

/// A kernel.
#[derive(Clone)]
pub struct ComputePipeline {
    pub(super) inner: Arc<PipelineInner>,
}

/// A drawing pipeline.
#[derive(Clone)]
pub struct GraphicsPipeline {
    pub(super) inner: Arc<PipelineInner>,
}

impl fmt::Debug for ComputePipeline {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "ComputePipeline({})", self.inner.name)
    }
}

impl fmt::Debug for GraphicsPipeline {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "GraphicsPipeline({})", self.inner.name)
    }
}

impl ComputePipeline {
    /// Invocations per group, from the shader.
    #[must_use]
    pub fn local_size(&self) -> [u32; 3] {
        self.inner.local_size
    }
}

/// Which faces are not drawn. Front faces are counter-clockwise on the screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Cull {
    /// All are drawn.
    #[default]
    None,
    /// Back faces are not.
    Back,
    /// Front faces are not.
    Front,
}

/// Description of a drawing pipeline. Depth is reversed: nearer is greater.
#[derive(Debug, Clone, Copy)]
pub struct GraphicsPipelineInfo<'a> {
    /// Shown in messages and captures.
    pub name: &'a str,
    /// Vertex shader; it pulls its vertices from storage buffers.
    pub vertex: Shader,
    /// Fragment shader; none for depth-only passes.
    pub fragment: Option<Shader>,
    /// Colour attachments.
    pub color_formats: &'a [Format],
    /// Depth attachment.
    pub depth_format: Option<Format>,
    /// Samples per pixel.
    pub samples: u32,
    /// Culling.
    pub cull: Cull,
    /// Fragments behind are discarded (greater or equal passes).
    pub depth_test: bool,
    /// Depth is written.
    pub depth_write: bool,
    /// Constant and slope-scaled depth bias.
    pub depth_bias: Option<(f32, f32)>,
    /// Alpha of attachment 0 becomes sample coverage.
    pub alpha_to_coverage: bool,
    /// `src * a + dst * (1 - a)` on every attachment.
    pub blend: bool,
    /// (constant id, value) for both stages.
    pub specialization: &'a [(u32, u32)],
}

impl Default for GraphicsPipelineInfo<'_> {
    fn default() -> Self {
        Self {
            name: "",
            vertex: Shader {
                name: "",
                spirv: &[],
            },
            fragment: None,
            color_formats: &[],
            depth_format: None,
            samples: 1,
            cull: Cull::None,
            depth_test: true,
            depth_write: true,
            depth_bias: None,
            alpha_to_coverage: false,
            blend: false,
            specialization: &[],
        }
    }
}

struct Constants {
    entries: Vec<vk::SpecializationMapEntry>,
    data: Vec<u8>,
}

impl Constants {
    fn new(values: &[(u32, u32)]) -> Self {
        let entries = (0u32..)
            .zip(values)
            .map(|(i, &(id, _))| vk::SpecializationMapEntry {
                constant_id: id,
                offset: 4 * i,
                size: 4,
            })
            .collect();
        Self {
            entries,
            data: values.iter().flat_map(|v| v.1.to_le_bytes()).collect(),
        }
    }

    fn info(&self) -> vk::SpecializationInfo<'_> {
        vk::SpecializationInfo::default()
            .map_entries(&self.entries)
            .data(&self.data)
    }
}

impl Gpu {
    /// Makes a kernel.
    ///
    /// # Errors
    /// When the device is out of memory.
    pub fn compute_pipeline(&self, shader: Shader) -> Result<ComputePipeline> {
        self.compute_pipeline_with(shader, &[])
    }

    /// Makes a kernel with specialisation constants (id, value).
    ///
    /// # Errors
    /// When the device is out of memory.
    pub fn compute_pipeline_with(
        &self,
        shader: Shader,
        constants: &[(u32, u32)],
    ) -> Result<ComputePipeline> {
        let words = shader.words();
        let reflection = Reflection::of(&words);
        let mut inner =
            self.pipeline_layout(shader.name, &[&reflection], vk::ShaderStageFlags::COMPUTE)?;
        inner.local_size = reflection.local_size;
        let module = Module::new(&self.inner, shader.name, &words)?;
        let constants = Constants::new(constants);
        let specialization = constants.info();
        let stage = vk::PipelineShaderStageCreateInfo::default()
            .stage(vk::ShaderStageFlags::COMPUTE)
            .module(module.raw)
            .name(c"main")
            .specialization_info(&specialization);
        let info = vk::ComputePipelineCreateInfo::default()
            .stage(stage)
            .layout(inner.layout);
        // SAFETY: module and layout are alive; the create info points at locals that outlive it.
        let made = unsafe {
            self.inner
                .device
                .create_compute_pipelines(self.inner.pipeline_cache.raw, &[info], None)
        };
        inner.raw = made.map_err(|(_, e)| device_error(shader.name, e))?[0];
        self.inner.set_name(inner.raw, shader.name);
        self.inner.pipeline_cache.note_new_pipeline();
        Ok(ComputePipeline {
            inner: Arc::new(inner),
        })
    }

    /// Makes a drawing pipeline.
    ///
    /// # Errors
    /// When the device is out of memory.
    pub fn graphics_pipeline(&self, info: &GraphicsPipelineInfo<'_>) -> Result<GraphicsPipeline> {
        let mut shaders = vec![(vk::ShaderStageFlags::VERTEX, info.vertex)];
        shaders.extend(info.fragment.map(|f| (vk::ShaderStageFlags::FRAGMENT, f)));
        let words: Vec<Vec<u32>> = shaders.iter().map(|s| s.1.words()).collect();
        let reflections: Vec<Reflection> = words.iter().map(|w| Reflection::of(w)).collect();
        let stages = shaders
            .iter()
            .fold(vk::ShaderStageFlags::empty(), |a, s| a | s.0);
        let mut inner =
            self.pipeline_layout(info.name, &reflections.iter().collect::<Vec<_>>(), stages)?;
        let modules: Vec<Module<'_>> = shaders
            .iter()
            .zip(&words)
            .map(|(s, w)| Module::new(&self.inner, s.1.name, w))
            .collect::<Result<_>>()?;
        let constants = Constants::new(info.specialization);
        let specialization = constants.info();
        let stage_infos: Vec<_> = shaders
            .iter()
            .zip(&modules)
            .map(|((stage, _), module)| {
                vk::PipelineShaderStageCreateInfo::default()
                    .stage(*stage)
                    .module(module.raw)
                    .name(c"main")
                    .specialization_info(&specialization)
            })
            .collect();
        inner.raw = self.create_graphics(info, &stage_infos, inner.layout)?;
        self.inner.set_name(inner.raw, info.name);
        self.inner.pipeline_cache.note_new_pipeline();
        Ok(GraphicsPipeline {
            inner: Arc::new(inner),
        })
    }

    fn create_graphics(
        &self,
        info: &GraphicsPipelineInfo<'_>,
        stages: &[vk::PipelineShaderStageCreateInfo<'_>],
        layout: vk::PipelineLayout,
    ) -> Result<vk::Pipeline> {
        let vertex_input = vk::PipelineVertexInputStateCreateInfo::default();
        let assembly = vk::PipelineInputAssemblyStateCreateInfo::default()
            .topology(vk::PrimitiveTopology::TRIANGLE_LIST);
        let viewport = vk::PipelineViewportStateCreateInfo::default()
            .viewport_count(1)
            .scissor_count(1);
        let (bias_constant, bias_slope) = info.depth_bias.unwrap_or_default();
        let raster = vk::PipelineRasterizationStateCreateInfo::default()
            .polygon_mode(vk::PolygonMode::FILL)
            .cull_mode(match info.cull {
                Cull::None => vk::CullModeFlags::NONE,
                Cull::Back => vk::CullModeFlags::BACK,
                Cull::Front => vk::CullModeFlags::FRONT,
            })
            .front_face(vk::FrontFace::COUNTER_CLOCKWISE)
            .depth_bias_enable(info.depth_bias.is_some())
            .depth_bias_constant_factor(bias_constant)
            .depth_bias_slope_factor(bias_slope)
            .line_width(1.0);
        let multisample = vk::PipelineMultisampleStateCreateInfo::default()
            .rasterization_samples(vk::SampleCountFlags::from_raw(info.samples))
            .alpha_to_coverage_enable(info.alpha_to_coverage);
        let depth = vk::PipelineDepthStencilStateCreateInfo::default()
            .depth_test_enable(info.depth_test)
            .depth_write_enable(info.depth_write)
            .depth_compare_op(vk::CompareOp::GREATER_OR_EQUAL);
        let attachment = vk::PipelineColorBlendAttachmentState::default()
            .blend_enable(info.blend)
            .src_color_blend_factor(vk::BlendFactor::SRC_ALPHA)
            .dst_color_blend_factor(vk::BlendFactor::ONE_MINUS_SRC_ALPHA)
            .src_alpha_blend_factor(vk::BlendFactor::ONE)
            .dst_alpha_blend_factor(vk::BlendFactor::ONE_MINUS_SRC_ALPHA)
            .color_write_mask(vk::ColorComponentFlags::RGBA);
        let attachments = vec![attachment; info.color_formats.len()];
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&attachments);
        let dynamic_states = [vk::DynamicState::VIEWPORT, vk::DynamicState::SCISSOR];
        let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&dynamic_states);
        let formats: Vec<vk::Format> = info.color_formats.iter().map(|f| f.raw()).collect();
        let mut rendering = vk::PipelineRenderingCreateInfo::default()
            .color_attachment_formats(&formats)
            .depth_attachment_format(info.depth_format.map_or(vk::Format::UNDEFINED, Format::raw));
        let create = vk::GraphicsPipelineCreateInfo::default()
            .stages(stages)
            .vertex_input_state(&vertex_input)
            .input_assembly_state(&assembly)
            .viewport_state(&viewport)
            .rasterization_state(&raster)
            .multisample_state(&multisample)
            .depth_stencil_state(&depth)
            .color_blend_state(&blend)
            .dynamic_state(&dynamic)
            .layout(layout)
            .push_next(&mut rendering);
        // SAFETY: everything `create` points at is a local that outlives the call.
        let made = unsafe {
            self.inner.device.create_graphics_pipelines(
                self.inner.pipeline_cache.raw,
                &[create],
                None,
            )
        };
        Ok(made.map_err(|(_, e)| device_error(info.name, e))?[0])
    }

    /// Set layouts and pipeline layout of the union of the stages' bindings.
    fn pipeline_layout(
        &self,
        name: &str,
        stages: &[&Reflection],
        flags: vk::ShaderStageFlags,
    ) -> Result<PipelineInner> {
        let mut bindings: Vec<ReflectedBinding> = stages
            .iter()
            .flat_map(|r| r.bindings.iter().copied())
            .collect();
        bindings.sort_by_key(|b| (b.set, b.binding));
        bindings.dedup();
        for pair in bindings.windows(2) {
            let clash = (pair[0].set, pair[0].binding) == (pair[1].set, pair[1].binding);
            assert!(
                !clash,
                "{name}: set {} binding {} differs between stages",
                pair[0].set, pair[0].binding
            );
        }
        let push_bytes = stages.iter().map(|r| r.push_bytes).max().unwrap_or(0);
        let limit = self.info().limits.max_push_bytes;
        assert!(
            push_bytes <= limit,
            "{name}: {push_bytes} bytes of push constants, the device has {limit}"
        );
        let mut inner = PipelineInner {
            gpu: Arc::clone(&self.inner),
            name: name.to_owned(),
            raw: vk::Pipeline::null(),
            layout: vk::PipelineLayout::null(),
            sets: Vec::new(),
            bindings,
            push_bytes,
            stages: flags,
            local_size: [1; 3],
        };
        let set_count = inner.bindings.last().map_or(0, |b| b.set + 1);
        for set in 0..set_count {
            let entries: Vec<_> = inner
                .bindings
                .iter()
                .filter(|b| b.set == set)
                .map(|b| {
                    vk::DescriptorSetLayoutBinding::default()
                        .binding(b.binding)
                        .descriptor_type(b.kind.raw())
                        .descriptor_count(1)
                        .stage_flags(flags)
                })
                .collect();
            let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&entries);
            // SAFETY: `entries` outlives the call.
            let made = unsafe { self.inner.device.create_descriptor_set_layout(&info, None) };
            inner.sets.push(made.map_err(|e| device_error(name, e))?);
        }
        let ranges = [vk::PushConstantRange {
            stage_flags: flags,
            offset: 0,
            size: push_bytes,
        }];
        let info = vk::PipelineLayoutCreateInfo::default()
            .set_layouts(&inner.sets)
            .push_constant_ranges(if push_bytes > 0 { &ranges } else { &[] });
        // SAFETY: the set layouts are alive.
        let made = unsafe { self.inner.device.create_pipeline_layout(&info, None) };
        inner.layout = made.map_err(|e| device_error(name, e))?;
        Ok(inner)
    }
}

/// A shader module that lives while a pipeline is made.
struct Module<'a> {
    gpu: &'a Inner,
    raw: vk::ShaderModule,
}

impl<'a> Module<'a> {
    fn new(gpu: &'a Inner, name: &str, words: &[u32]) -> Result<Self> {
        let info = vk::ShaderModuleCreateInfo::default().code(words);
        // SAFETY: the words come from this program's own build.
        let raw = unsafe { gpu.device.create_shader_module(&info, None) }
            .map_err(|e| device_error(name, e))?;
        gpu.set_name(raw, name);
        Ok(Self { gpu, raw })
    }
}

impl Drop for Module<'_> {
    fn drop(&mut self) {
        // SAFETY: a module is not needed once its pipelines exist.
        unsafe { self.gpu.device.destroy_shader_module(self.raw, None) };
    }
}

impl Drop for PipelineInner {
    fn drop(&mut self) {
        // SAFETY: work that uses the pipeline holds it until it has completed; null handles of a
        // partly made pipeline are accepted.
        unsafe {
            let device = &self.gpu.device;
            device.destroy_pipeline(self.raw, None);
            device.destroy_pipeline_layout(self.layout, None);
            for &set in &self.sets {
                device.destroy_descriptor_set_layout(set, None);
            }
        }
    }
}
