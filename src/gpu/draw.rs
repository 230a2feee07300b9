//! Drawing: dynamic rendering into one or more targets.

use std::fmt;

use ash::vk;
use bytemuck::Pod;

use super::access::Access;
use super::binding::{Binding, Resource};
use super::buffer::Buffer;
use super::device::Gpu;
use super::image::Image;
use super::pipeline::GraphicsPipeline;
use super::work::Work;
use crate::Result;

/// A colour attachment.
#[derive(Debug, Clone, Copy)]
pub struct ColorTarget<'a> {
    /// The image drawn into.
    pub image: &'a Image,
    /// Clear value; `None` keeps what is there.
    pub clear: Option<[f32; 4]>,
    /// Averages the samples into this image at the end.
    pub resolve: Option<&'a Image>,
    /// Keep the (multisampled) content after the pass.
    pub store: bool,
}

/// The depth attachment.
#[derive(Debug, Clone, Copy)]
pub struct DepthTarget<'a> {
    /// The image.
    pub image: &'a Image,
    /// Clear value (0 is infinitely far, depth is reversed); `None` keeps what is there.
    pub clear: Option<f32>,
    /// Keep the content after the pass.
    pub store: bool,
}

/// Targets of a pass and what its draws read.
#[derive(Debug, Clone, Copy)]
pub struct RenderPass<'a> {
    /// Width and height drawn, pixels.
    pub extent: [u32; 2],
    /// Colour attachments in order.
    pub color: &'a [ColorTarget<'a>],
    /// Depth attachment.
    pub depth: Option<DepthTarget<'a>>,
    /// What the draws bind and other passes wrote (barriers cannot stand inside rendering).
    pub reads: &'a [Binding<'a>],
}

/// Records draws inside a pass.
pub struct Draws<'a> {
    work: &'a mut Work,
    gpu: Gpu,
    label: &'a str,
    pipeline: Option<GraphicsPipeline>,
}

impl fmt::Debug for Draws<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Draws({})", self.label)
    }
}

impl RenderPass<'_> {
    fn accesses(&self) -> Vec<(Resource, Access)> {
        let mut accesses: Vec<_> = self
            .reads
            .iter()
            .map(|b| (b.resource(), b.draw_access()))
            .collect();
        for target in self.color {
            accesses.push((Resource::Image(target.image.clone()), Access::ColorWrite));
            accesses.extend(
                target
                    .resolve
                    .map(|r| (Resource::Image(r.clone()), Access::ColorWrite)),
            );
        }
        accesses.extend(
            self.depth
                .map(|d| (Resource::Image(d.image.clone()), Access::DepthWrite)),
        );
        accesses
    }
}

impl Work {
    /// Makes everything ready for `pass` before the passes that come first; [`Work::render`] of the
    /// same pass then waits for nothing. The passes between must not touch what it writes.
    ///
    /// # Panics
    /// Later, when a pass between uses a target of this one, or writes what it reads.
    pub fn declare(&mut self, label: &str, pass: &RenderPass<'_>) {
        self.declare_accesses(label, &pass.accesses());
    }

    /// Draws into targets: clears or loads, runs `record`, resolves and stores.
    ///
    /// # Errors
    /// Those of `record`, or when memory runs out.
    ///
    /// # Panics
    /// When a draw binds a resource that is not ready and not in [`RenderPass::reads`].
    pub fn render(
        &mut self,
        label: &str,
        pass: &RenderPass<'_>,
        record: impl FnOnce(&mut Draws<'_>) -> Result<()>,
    ) -> Result<()> {
        let accesses = pass.accesses();
        self.begin_pass(label, &accesses)?;
        self.begin_rendering(pass);
        let gpu = self.recorded.gpu.clone();
        let result = record(&mut Draws {
            work: self,
            gpu,
            label,
            pipeline: None,
        });
        // SAFETY: rendering was begun above.
        unsafe { self.recorded.gpu.inner.device.cmd_end_rendering(self.cmd) };
        self.end_pass();
        result
    }

    fn begin_rendering(&mut self, pass: &RenderPass<'_>) {
        let load = |cleared: bool| {
            if cleared {
                vk::AttachmentLoadOp::CLEAR
            } else {
                vk::AttachmentLoadOp::LOAD
            }
        };
        let store = |kept: bool| {
            if kept {
                vk::AttachmentStoreOp::STORE
            } else {
                vk::AttachmentStoreOp::DONT_CARE
            }
        };
        let color: Vec<_> = pass
            .color
            .iter()
            .map(|t| {
                let clear = vk::ClearValue {
                    color: vk::ClearColorValue {
                        float32: t.clear.unwrap_or_default(),
                    },
                };
                let info = vk::RenderingAttachmentInfo::default()
                    .image_view(t.image.inner.view)
                    .image_layout(vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL)
                    .load_op(load(t.clear.is_some()))
                    .store_op(store(t.store))
                    .clear_value(clear);
                match t.resolve {
                    Some(r) => info
                        .resolve_mode(vk::ResolveModeFlags::AVERAGE)
                        .resolve_image_view(r.inner.view)
                        .resolve_image_layout(vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL),
                    None => info,
                }
            })
            .collect();
        let depth = pass.depth.map(|d| {
            let clear = vk::ClearDepthStencilValue {
                depth: d.clear.unwrap_or_default(),
                stencil: 0,
            };
            vk::RenderingAttachmentInfo::default()
                .image_view(d.image.inner.view)
                .image_layout(vk::ImageLayout::DEPTH_ATTACHMENT_OPTIMAL)
                .load_op(load(d.clear.is_some()))
                .store_op(store(d.store))
                .clear_value(vk::ClearValue {
                    depth_stencil: clear,
                })
        });
        let area = vk::Rect2D {
            offset: vk::Offset2D::default(),
            extent: vk::Extent2D {
                width: pass.extent[0],
                height: pass.extent[1],
            },
        };
        let mut info = vk::RenderingInfo::default()
            .render_area(area)
            .layer_count(1)
            .color_attachments(&color);
        if let Some(depth) = &depth {
            info = info.depth_attachment(depth);
        }
        let viewport = vk::Viewport {
            x: 0.0,
            y: 0.0,
            width: pass.extent[0] as f32,
            height: pass.extent[1] as f32,
            min_depth: 0.0,
            max_depth: 1.0,
        };
        let device = &self.recorded.gpu.inner.device;
        // SAFETY: the attachments are in the layouts named, by the barriers of `begin_pass`.
        unsafe {
            device.cmd_begin_rendering(self.cmd, &info);
            device.cmd_set_viewport(self.cmd, 0, &[viewport]);
            device.cmd_set_scissor(self.cmd, 0, &[area]);
        }
    }
}

impl Draws<'_> {
    /// Uses a pipeline for the draws that follow.
    pub fn pipeline(&mut self, pipeline: &GraphicsPipeline) {
        // SAFETY: the pipeline is kept until the work is done.
        unsafe {
            self.gpu.inner.device.cmd_bind_pipeline(
                self.work.cmd,
                vk::PipelineBindPoint::GRAPHICS,
                pipeline.inner.raw,
            );
        }
        self.work.keep(pipeline.clone());
        self.pipeline = Some(pipeline.clone());
    }

    /// Binds descriptor set `set` of the current pipeline.
    ///
    /// # Errors
    /// When a binding exceeds the device's range or memory runs out.
    ///
    /// # Panics
    /// Without a pipeline, or when a resource is not ready and not declared in the pass.
    pub fn bind(&mut self, set: u32, bindings: &[Binding<'_>]) -> Result<()> {
        for binding in bindings {
            self.require(&binding.resource(), binding.draw_access());
            if let Some(sampler) = binding.sampler() {
                self.work.keep(sampler);
            }
        }
        let pipeline = self.current();
        let raw =
            self.work
                .recorded
                .descriptors
                .set(&self.gpu.inner, &pipeline.inner, set, bindings)?;
        // SAFETY: the set was made for this pipeline's layout.
        unsafe {
            self.gpu.inner.device.cmd_bind_descriptor_sets(
                self.work.cmd,
                vk::PipelineBindPoint::GRAPHICS,
                pipeline.inner.layout,
                set,
                &[raw],
                &[],
            );
        }
        Ok(())
    }

    /// Sets the push constants; the size must be what the shaders declare.
    ///
    /// # Errors
    /// Never; kept fallible like its neighbours.
    pub fn push<P: Pod>(&mut self, push: &P) -> Result<()> {
        let pipeline = self.current();
        self.work.push_constants(self.label, &pipeline.inner, push);
        Ok(())
    }

    /// Uses a buffer of 32-bit indices for the draws that follow.
    pub fn index_buffer(&mut self, buffer: &Buffer) {
        self.require(&Resource::Buffer(buffer.clone()), Access::IndexRead);
        // SAFETY: the buffer is kept by the work.
        unsafe {
            self.gpu.inner.device.cmd_bind_index_buffer(
                self.work.cmd,
                buffer.inner.raw,
                0,
                vk::IndexType::UINT32,
            );
        }
    }

    /// Draws a range of the index buffer.
    ///
    /// # Errors
    /// Never; kept fallible like its neighbours.
    pub fn draw_indexed(&mut self, indices: std::ops::Range<u32>, instances: u32) -> Result<()> {
        let count = indices.end.saturating_sub(indices.start);
        if count > 0 && instances > 0 {
            // SAFETY: pipeline and index buffer are bound.
            unsafe {
                self.gpu.inner.device.cmd_draw_indexed(
                    self.work.cmd,
                    count,
                    instances,
                    indices.start,
                    0,
                    0,
                );
            };
        }
        Ok(())
    }

    /// Keeps the draws that follow within pixels: first corner, and one past the last.
    pub fn scissor(&mut self, [x0, y0, x1, y1]: [u32; 4]) {
        let signed = |v: u32| i32::try_from(v).expect("an edge of an image");
        let rectangle = vk::Rect2D {
            offset: vk::Offset2D {
                x: signed(x0),
                y: signed(y0),
            },
            extent: vk::Extent2D {
                width: x1.saturating_sub(x0),
                height: y1.saturating_sub(y0),
            },
        };
        // SAFETY: a rectangle with corners that are not negative.
        unsafe {
            self.gpu
                .inner
                .device
                .cmd_set_scissor(self.work.cmd, 0, &[rectangle]);
        };
    }

    /// Draws without an index buffer: `gl_VertexIndex` goes through `vertices`.
    ///
    /// # Errors
    /// Never; kept fallible like its neighbours.
    pub fn draw(&mut self, vertices: std::ops::Range<u32>, instances: u32) -> Result<()> {
        // SAFETY: a pipeline is bound.
        unsafe {
            self.gpu.inner.device.cmd_draw(
                self.work.cmd,
                vertices.end - vertices.start,
                instances,
                vertices.start,
                0,
            );
        };
        Ok(())
    }

    fn current(&self) -> GraphicsPipeline {
        self.pipeline
            .clone()
            .unwrap_or_else(|| panic!("{}: no pipeline is bound", self.label))
    }

    fn require(&mut self, resource: &Resource, access: Access) {
        assert!(
            self.work.is_ready(resource, access),
            "{}: {} is bound as {access:?} but needs a barrier; name it in RenderPass::reads",
            self.label,
            resource.name()
        );
        self.work.note_use(self.label, resource, access);
    }
}
