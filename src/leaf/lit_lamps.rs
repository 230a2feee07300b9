//! Lamps in a lit picture: four at a time, by what each vertex sees of them and what each pixel's
//! leaf scatters of their light.

use super::lamp::{Lamp, PlacedLamps};
use crate::Result;
use crate::abi::{LAMPS_PER_PASS, LampPass};
use crate::gpu::shaders::leaf as shaders;
use crate::gpu::{
    Buffer, BufferInfo, ComputePipeline, Format, Gpu, GraphicsPipeline, GraphicsPipelineInfo,
    Image, ImageInfo,
};

/// Visibility of four lamps.
const TARGET: Format = Format::Rgba16Float;

/// Lamps and what each vertex sees of them, \[0, 1\].
#[derive(Debug, Clone, Copy)]
pub struct LampLight<'a> {
    /// The lamps.
    pub lamps: &'a [Lamp],
    /// Of each lamp, one for each vertex that is drawn.
    pub visibility: &'a [Vec<f32>],
    /// Points of a lamp at which the leaf's scattering is taken, 1 to 64.
    pub points: u32,
}

/// What draws them.
pub(super) struct LampRenderer {
    pub(super) first: GraphicsPipeline,
    pub(super) second: ComputePipeline,
    pub(super) target: Image,
}

/// The lamps of one picture on the device.
pub(super) struct LampsOnDevice {
    pub(super) records: Buffer,
    pub(super) points: Buffer,
    /// Visibility of four lamps a vertex, one buffer a pass.
    pub(super) passes: Vec<(LampPass, Buffer)>,
}

impl LampRenderer {
    pub(super) fn new(gpu: &Gpu, size: [u32; 2], constants: &[(u32, u32)]) -> Result<Self> {
        Ok(Self {
            first: gpu.graphics_pipeline(&GraphicsPipelineInfo {
                name: "lit lamps",
                vertex: shaders::LIT_LAMPS_VERT,
                fragment: Some(shaders::LIT_LAMPS_FRAG),
                color_formats: &[TARGET],
                depth_format: Some(Format::Depth32),
                ..GraphicsPipelineInfo::default()
            })?,
            second: gpu.compute_pipeline_with(shaders::LIT_LAMPS_COMP, constants)?,
            target: gpu.image(ImageInfo::target("lamp visibility", TARGET, size, 1))?,
        })
    }
}

impl LampsOnDevice {
    /// Uploads `light` for a geometry with this origin.
    pub(super) fn new(gpu: &Gpu, light: &LampLight<'_>, origin: glam::DVec3) -> Result<Self> {
        let placed = PlacedLamps::new(light.lamps, (origin, 1.0), light.points);
        let per_pass = LAMPS_PER_PASS as usize;
        let mut passes = Vec::new();
        for (number, maps) in light.visibility.chunks(per_pass).enumerate() {
            let vertices = maps.first().map_or(0, Vec::len);
            let at = |v: usize| [0, 1, 2, 3].map(|k| maps.get(k).map_or(0.0, |m: &Vec<f32>| m[v]));
            let rows: Vec<[f32; 4]> = (0..vertices).map(at).collect();
            let pass = LampPass {
                first: (number * per_pass) as u32,
                count: maps.len() as u32,
            };
            let buffer = if rows.is_empty() {
                gpu.buffer(BufferInfo::device("lamp visibility", 16))?
            } else {
                gpu.upload("lamp visibility", &rows)?
            };
            passes.push((pass, buffer));
        }
        Ok(Self {
            records: gpu.upload("lamps", &placed.records)?,
            points: gpu.upload("lamp points", &placed.points)?,
            passes,
        })
    }
}
