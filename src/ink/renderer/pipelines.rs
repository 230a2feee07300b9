//! Pipelines of the two stages.

use crate::Result;
use crate::gpu::shaders::ink as shaders;
use crate::gpu::{ComputePipeline, Format, Gpu, GraphicsPipeline, GraphicsPipelineInfo, Shader};
use crate::ink::mix::MixPlan;

/// Fragment shaders for one to six targets.
const LEAF_FRAGMENTS: [Shader; 6] = [
    shaders::LEAF_1_FRAG,
    shaders::LEAF_2_FRAG,
    shaders::LEAF_3_FRAG,
    shaders::LEAF_4_FRAG,
    shaders::LEAF_5_FRAG,
    shaders::LEAF_6_FRAG,
];
/// The same for wood.
const WOOD_FRAGMENTS: [Shader; 6] = [
    shaders::WOOD_1_FRAG,
    shaders::WOOD_2_FRAG,
    shaders::WOOD_3_FRAG,
    shaders::WOOD_4_FRAG,
    shaders::WOOD_5_FRAG,
    shaders::WOOD_6_FRAG,
];

/// Pipelines that write attributes.
pub(super) struct Stage1Pipelines {
    pub(super) leaves: GraphicsPipeline,
    pub(super) wood: GraphicsPipeline,
}

impl Stage1Pipelines {
    /// For the attributes of a plan.
    pub(super) fn new(gpu: &Gpu, plan: &MixPlan) -> Result<Self> {
        let attributes = plan.attributes();
        let formats: Vec<Format> = attributes.iter().map(|a| a.format()).collect();
        let numbers = attributes.iter().map(|a| a.number());
        let all = attributes.iter().map(|a| 1 << a.number()).sum();
        let channels: Vec<(u32, u32)> = (0..)
            .zip(numbers)
            .chain([(6, u32::from(plan.is_mixed())), (7, all)])
            .collect();
        let pipeline = |name, vertex, fragments: [Shader; 6]| {
            gpu.graphics_pipeline(&GraphicsPipelineInfo {
                name,
                vertex,
                fragment: Some(fragments[attributes.len() - 1]),
                color_formats: &formats,
                depth_format: Some(Format::Depth32),
                specialization: &channels,
                ..GraphicsPipelineInfo::default()
            })
        };
        Ok(Self {
            leaves: pipeline("ink leaves", shaders::LEAF_VERT, LEAF_FRAGMENTS)?,
            wood: pipeline("ink wood", shaders::WOOD_VERT, WOOD_FRAGMENTS)?,
        })
    }
}

/// Pipelines that make a picture of attributes.
pub(super) struct Stage2Pipelines {
    pub(super) contour: Option<ComputePipeline>,
    pub(super) clean: Option<ComputePipeline>,
    pub(super) silhouette: Option<ComputePipeline>,
    pub(super) compose: ComputePipeline,
}

impl Stage2Pipelines {
    /// Those of a style of a plan.
    pub(super) fn new(gpu: &Gpu, mix: &MixPlan, style: usize) -> Result<Self> {
        let plan = &mix.styles[style];
        let mixed = u32::from(mix.is_mixed());
        let kernel = |wanted: bool, shader, constants: &[(u32, u32)]| {
            wanted
                .then(|| gpu.compute_pipeline_with(shader, constants))
                .transpose()
        };
        let contour = [(0, u32::from(plan.detail)), (1, mixed)];
        let switches = [
            // Lines of other styles reach over into this one's pixels.
            mix.any(|s| s.contour),
            plan.silhouette,
            plan.hatching,
            plan.shading,
            plan.colour,
            mix.is_mixed(),
            plan.light,
            plan.edges,
            plan.wash,
        ];
        let switches: Vec<(u32, u32)> = (0..).zip(switches.map(u32::from)).collect();
        Ok(Self {
            contour: kernel(plan.contour, shaders::CONTOUR_COMP, &contour)?,
            clean: kernel(plan.contour, shaders::CLEAN_COMP, &[(0, mixed)])?,
            silhouette: kernel(plan.silhouette, shaders::SILHOUETTE_COMP, &[(0, mixed)])?,
            compose: gpu.compute_pipeline_with(shaders::COMPOSE_COMP, &switches)?,
        })
    }
}
