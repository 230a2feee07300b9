//! Light of the surroundings in glossy leaves, for one view: every change of view adds what each
//! vertex's lobe reflects of its incident light.

use glam::Vec3;

use super::lobe;
use super::optics::Optics;
use crate::Result;
use crate::abi::{GlossView, Receiver};
use crate::gpu::shaders::leaf as shaders;
use crate::gpu::{Binding, Buffer, BufferInfo, ComputePipeline, Gpu, PassTime, QueueKind};

/// Receivers under one light, for any view.
#[derive(Debug)]
pub struct GlossPass {
    gpu: Gpu,
    count: u32,
    receivers: Buffer,
    light: Buffer,
    lobes: Buffer,
    gloss: Buffer,
    radiance: Buffer,
    kernel: ComputePipeline,
}

impl GlossPass {
    /// Uploads what views share: `light` comes to `receivers` (see
    /// [`super::matrix::StoredMatrices::incident`]) in `order` bands.
    ///
    /// # Errors
    /// When memory runs out.
    pub fn new(
        gpu: &Gpu,
        receivers: &[Receiver],
        (light, order): (&[[f32; 3]], u32),
        optics: &[Optics],
    ) -> Result<Self> {
        let lobes: Vec<f32> = optics
            .iter()
            .flat_map(|o| lobe::table(f64::from(o.roughness), o.shadowing))
            .collect();
        let count = receivers.len() as u32;
        let radiance = BufferInfo::device("radiance of a view", 24 * u64::from(count));
        Ok(Self {
            gpu: gpu.clone(),
            count,
            receivers: gpu.upload("receivers", receivers)?,
            light: gpu.upload("incident light", light)?,
            lobes: gpu.upload("lobes", &lobes)?,
            gloss: super::film::gloss(gpu, optics)?,
            radiance: gpu.buffer(radiance)?,
            kernel: gpu.compute_pipeline_with(shaders::GLOSS_VIEW_COMP, &[(0, order)])?,
        })
    }

    /// What the fronts and backs of each receiver reflect towards `eye` (in units of the diagonal);
    /// ringing may go below 0.
    ///
    /// # Errors
    /// When memory runs out or the device is lost.
    pub fn view(&self, eye: Vec3) -> Result<(Vec<[f32; 3]>, Vec<PassTime>)> {
        let mut work = self.gpu.work(QueueKind::Compute, "glossy view")?;
        work.compute(
            "gloss of a view",
            &self.kernel,
            &[
                Binding::Read(&self.receivers),
                Binding::Read(&self.light),
                Binding::Read(&self.lobes),
                Binding::Read(&self.gloss),
                Binding::Write(&self.radiance),
            ],
            &GlossView {
                eye: eye.to_array(),
                count: self.count,
            },
            [self.count, 1, 1],
        )?;
        let read = work.read::<[f32; 3]>("radiance of a view", &self.radiance)?;
        let mut done = work.submit()?.wait()?;
        let times = done.passes().to_vec();
        Ok((done.take(read), times))
    }
}
