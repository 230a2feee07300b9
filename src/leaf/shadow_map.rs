//! The sun's shadows by a shadow map, to compare visibility maps with.

use glam::{DVec3, Vec3};

use crate::Result;
use crate::abi::ShadowView;
use crate::gpu::shaders::leaf as shaders;
use crate::gpu::{
    Buffer, BufferInfo, ComputePipeline, Format, Gpu, GraphicsPipeline, GraphicsPipelineInfo,
    Image, ImageInfo,
};
use crate::scene::camera::LightView;

/// How the shadow map is drawn and read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShadowSettings {
    /// Texels along an edge.
    pub size: u32,
    /// Radius of the filter, texels.
    pub radius: f32,
}

/// What draws and reads it.
pub(super) struct ShadowRenderer {
    pub(super) view: Buffer,
    pub(super) map: Image,
    pub(super) first: GraphicsPipeline,
    pub(super) second: ComputePipeline,
}

impl ShadowRenderer {
    pub(super) fn new(gpu: &Gpu, size: u32, constants: &[(u32, u32)]) -> Result<Self> {
        Ok(Self {
            view: gpu.buffer(BufferInfo::device(
                "shadow view",
                size_of::<ShadowView>() as u64,
            ))?,
            map: gpu.image(ImageInfo::target(
                "shadow map",
                Format::Depth32,
                [size; 2],
                1,
            ))?,
            first: gpu.graphics_pipeline(&GraphicsPipelineInfo {
                name: "lit shadow",
                vertex: shaders::LIT_SHADOW_VERT,
                fragment: Some(shaders::LIT_SHADOW_FRAG),
                depth_format: Some(Format::Depth32),
                ..GraphicsPipelineInfo::default()
            })?,
            second: gpu.compute_pipeline_with(shaders::LIT_SHADOW_COMP, constants)?,
        })
    }
}

/// The map's view of `points` along the direction to the sun.
#[must_use]
pub fn view(towards: DVec3, points: &[Vec3], settings: ShadowSettings) -> ShadowView {
    let border = settings.radius.ceil() as u32 + 2;
    let light = LightView::fit(towards, points.iter().copied(), settings.size, border);
    ShadowView {
        relative_to_sun: light.relative_to_clip.to_cols_array_2d(),
        size: settings.size,
        texel: light.extent[0].max(light.extent[1]) / settings.size as f32,
        range: light.range,
        radius: settings.radius,
    }
}
