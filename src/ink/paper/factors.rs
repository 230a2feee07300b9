//! Factors on thresholds and widths in each pixel, only where a style has them.

use super::modulation::Programs;
use super::renderer::PaperScene;
use super::style::PaperStyle;
use crate::abi::{PaperDifference, PaperModulate, PaperOp, PaperTrait};
use crate::gpu::shaders::ink as shaders;
use crate::gpu::{
    Binding, Buffer, ComputePipeline, Format, Gpu, Image, ImageInfo, QueueKind, Sampler, Work,
};
use crate::{Error, Result};

/// What programs take on the device.
pub(super) struct Factors {
    /// Whether a program reads the shadow.
    pub(super) shadow: bool,
    /// Largest factor on widths, where that can be told.
    pub(super) widest: f32,
    /// Threshold and width, 16-bit floats.
    pub(super) image: Image,
    ends: [u32; 4],
    steps: Buffer,
    traits: Buffer,
    masks: Image,
    kernel: ComputePipeline,
}

/// What programs read of a picture: foliage (depth, number), stems (depth, normal), shadow.
pub(super) struct Read<'a> {
    pub(super) frame: &'a Buffer,
    pub(super) foliage: [&'a Image; 2],
    pub(super) stems: [&'a Image; 2],
    pub(super) shadow: Option<&'a Image>,
}

impl Factors {
    /// For pictures of `size` pixels; none where the style has no such factors.
    pub(super) fn new(
        gpu: &Gpu,
        scene: &PaperScene<'_>,
        style: &PaperStyle,
        size: [u32; 2],
    ) -> Result<Option<Self>> {
        let Some(programs) = Programs::new(style).map_err(Error::usage)? else {
            return Ok(None);
        };
        let of = |p: &super::particles::Particle| PaperTrait {
            normal: p.normal.to_array(),
            object: p.object as f32,
        };
        let mut traits: Vec<PaperTrait> = if programs.leaves {
            scene.particles.iter().map(of).collect()
        } else {
            Vec::new()
        };
        traits.resize(traits.len().max(1), PaperTrait::default());
        // Without masks one texel stands for them.
        let extent = if programs.masks.is_empty() {
            [1; 2]
        } else {
            size
        };
        let painted = programs.painted(extent)?;
        let masks = gpu.image(ImageInfo::texture(
            "paper masks",
            Format::Rgba8Unorm,
            extent,
            1,
        ))?;
        let mut work = gpu.work(QueueKind::Transfer, "paper masks")?;
        work.upload_image("paper masks", &masks, &[bytemuck::cast_slice(&painted)])?;
        work.submit()?.wait()?;
        Ok(Some(Self {
            shadow: programs.shadow,
            widest: programs.widest,
            image: gpu.image(ImageInfo::storage(
                "paper factors",
                Format::Rgba16Float,
                size,
            ))?,
            ends: programs.ends,
            steps: gpu.upload::<PaperOp>("paper steps", &programs.ops)?,
            traits: gpu.upload("paper traits", &traits)?,
            masks,
            kernel: gpu.compute_pipeline(shaders::MODULATE_COMP)?,
        }))
    }

    /// Fills the image; `range` is what depths are compared in.
    pub(super) fn run(
        &self,
        work: &mut Work,
        read: &Read<'_>,
        plain: &Sampler,
        range: &PaperDifference,
        ambient: f32,
    ) -> Result<()> {
        let sampled = |image| Binding::Sampled(image, plain);
        let bindings = [
            Binding::Read(read.frame),
            Binding::Read(&self.steps),
            Binding::Read(&self.traits),
            sampled(read.foliage[0]),
            sampled(read.foliage[1]),
            sampled(read.stems[0]),
            sampled(read.stems[1]),
            // Read by no program where there is none.
            sampled(read.shadow.unwrap_or(read.stems[0])),
            sampled(&self.masks),
            Binding::StorageWrite(&self.image),
        ];
        let push = PaperModulate {
            ends: self.ends,
            width: range.width,
            height: range.height,
            nearest: range.nearest,
            farthest: range.farthest,
            near: range.near,
            far: range.far,
            ambient,
        };
        let groups = [range.width, range.height, 1];
        work.compute("paper factors", &self.kernel, &bindings, &push, groups)
    }
}
