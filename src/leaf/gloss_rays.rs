//! Surroundings in glossy leaves by rays: every glossy pixel of a lit picture asks in a few
//! directions of its lobe (`f_s` of Wang et al. 2005, equation 7) what is there. A free ray sees the
//! sky, a blocked one the light that leaves the leaf that it meets.
//!
//! Transfer vectors hold this gloss already, as if it were diffuse. As many rays by the cosine find
//! that part, and it is taken away: what stays is light that is counted once.

use std::cell::RefCell;

use super::environment::Environment;
use super::film::{LitScene, sky_image};
use super::rays::RayScene;
use super::trace::{Query, RayBatch, Tracer};
use crate::Result;
use crate::abi::GlossBatch;
use crate::gpu::shaders::leaf as shaders;
use crate::gpu::{
    AddressMode, Binding, Buffer, BufferInfo, ComputePipeline, Gpu, Image, PassTime, QueueKind,
    Sampler, SamplerInfo,
};

/// Rays of a batch.
const BATCH: u32 = 1 << 18;
/// Samples of a pixel in a batch at most.
const SAMPLES: u32 = 64;

/// The scene and the sky as the rays of a picture meet them.
pub struct GlossRays {
    gpu: Gpu,
    scale: f32,
    scene: RayScene,
    scene_bytes: u64,
    tracer: RefCell<Tracer>,
    rays: RayBatch,
    sky: (Image, Sampler),
    counted: Buffer,
    materials: Buffer,
    faces: Buffer,
    positions: Buffer,
    indices: Buffer,
    leaving: Buffer,
    kernels: [ComputePipeline; 2],
}

/// Gloss by rays in one picture.
#[derive(Debug, Clone, Copy)]
pub struct GlossLight<'a> {
    /// What they meet.
    pub rays: &'a GlossRays,
    /// Light that leaves the front and the back of every vertex of the traced mesh, all of it
    /// diffuse.
    pub leaving: &'a [[f32; 3]],
    /// Rays of the lobe of each pixel, at least 1, and as many of the cosine.
    pub samples: u32,
    /// Same seed, same picture.
    pub seed: u32,
}

/// What the first pass has left of each pixel, and the picture that is added to.
#[derive(Clone, Copy)]
pub(crate) struct GlossPixels<'a> {
    /// A `LitFrame`.
    pub(crate) frame: &'a Buffer,
    pub(crate) surface: &'a Image,
    pub(crate) leaf: &'a Image,
    pub(crate) shine: &'a Image,
    pub(crate) depth: &'a Image,
    pub(crate) plain: &'a Sampler,
    pub(crate) picture: &'a Image,
}

impl std::fmt::Debug for GlossRays {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "GlossRays({} bytes)", self.bytes())
    }
}

impl GlossRays {
    /// Uploads the traced mesh of `scene` and `sky`.
    ///
    /// # Errors
    /// More triangles than the device takes, or memory runs out.
    pub fn new(gpu: &Gpu, scene: &LitScene<'_>, sky: &Environment) -> Result<Self> {
        let (occluders, receivers) = (scene.occluders, scene.receivers);
        let sampler = gpu.sampler(&SamplerInfo {
            linear: true,
            address: [AddressMode::Repeat, AddressMode::Clamp],
            ..SamplerInfo::default()
        })?;
        let vertices = occluders.positions.len() as u64;
        let leaving = BufferInfo::device("light leaving leaves", 24 * vertices);
        Ok(Self {
            gpu: gpu.clone(),
            scale: occluders.scale,
            scene: RayScene::new(gpu, occluders)?,
            scene_bytes: occluders.bytes(),
            tracer: RefCell::new(Tracer::new(gpu)?),
            rays: RayBatch::new(gpu, BATCH)?,
            sky: (sky_image(gpu, sky)?, sampler),
            counted: gpu.upload("gloss as diffuse", &receivers.gloss_as_diffuse())?,
            materials: gpu.upload("leaf sides", &receivers.materials)?,
            faces: gpu.upload("faces", &receivers.faces)?,
            positions: gpu.upload("positions", &occluders.positions)?,
            indices: gpu.upload("indices", &occluders.indices)?,
            leaving: gpu.buffer(leaving)?,
            kernels: [
                gpu.compute_pipeline(shaders::GLOSS_RAYS_COMP)?,
                gpu.compute_pipeline(shaders::GLOSS_GATHER_COMP)?,
            ],
        })
    }

    /// Bytes on the device.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let buffers = [
            &self.counted,
            &self.materials,
            &self.faces,
            &self.positions,
            &self.indices,
            &self.leaving,
        ];
        let buffers: u64 = buffers.iter().map(|b| b.bytes()).sum();
        self.scene_bytes + self.rays.bytes() + self.sky.0.info().bytes() + buffers
    }

    /// Adds the gloss of `light` to the picture; the device times, each pass once.
    ///
    /// # Errors
    /// When memory runs out or the device is lost.
    pub(crate) fn add(
        &self,
        pixels: &GlossPixels<'_>,
        light: &GlossLight<'_>,
    ) -> Result<Vec<PassTime>> {
        let [width, height] = pixels.picture.info().extent;
        let all = width * height;
        let samples = light.samples.min(SAMPLES);
        let at_once = (BATCH / (2 * samples)).min(all);
        let mut times = Vec::new();
        let mut work = self.gpu.work(QueueKind::Compute, "gloss")?;
        work.upload("light leaving leaves", &self.leaving, light.leaving)?;
        times.extend_from_slice(work.submit()?.wait()?.passes());
        for first_pixel in (0..all).step_by(at_once as usize) {
            for first_sample in (0..light.samples).step_by(samples as usize) {
                let batch = GlossBatch {
                    first_pixel,
                    pixels: at_once.min(all - first_pixel),
                    first_sample,
                    samples: samples.min(light.samples - first_sample),
                    all_samples: light.samples,
                    seed: light.seed,
                    scale: self.scale,
                };
                times.extend(self.batch(pixels, &batch)?);
            }
        }
        Ok(summed(&times))
    }

    fn batch(&self, pixels: &GlossPixels<'_>, batch: &GlossBatch) -> Result<Vec<PassTime>> {
        let count = 2 * batch.pixels * batch.samples;
        let mut work = self.gpu.work(QueueKind::Compute, "gloss")?;
        work.compute(
            "gloss rays",
            &self.kernels[0],
            &[
                Binding::Read(pixels.frame),
                Binding::Read(&self.counted),
                Binding::Sampled(pixels.surface, pixels.plain),
                Binding::Sampled(pixels.leaf, pixels.plain),
                Binding::Sampled(pixels.shine, pixels.plain),
                Binding::Sampled(pixels.depth, pixels.plain),
                Binding::StorageWrite(&self.rays.image),
            ],
            batch,
            [count, 1, 1],
        )?;
        let mut tracer = self.tracer.borrow_mut();
        let query = Query::Nearest;
        tracer.trace(Some(work), &self.scene, &self.rays, count, query)?;
        let mut times: Vec<PassTime> = tracer.times.drain(..).collect();
        for time in &mut times {
            if time.label == "trace" {
                time.label = "trace gloss".to_owned();
            }
        }
        let mut work = self.gpu.work(QueueKind::Compute, "gloss")?;
        work.compute(
            "gather gloss",
            &self.kernels[1],
            &[
                Binding::Read(pixels.frame),
                Binding::Read(&self.counted),
                Binding::Read(&self.materials),
                Binding::Sampled(pixels.surface, pixels.plain),
                Binding::Sampled(pixels.leaf, pixels.plain),
                Binding::Sampled(pixels.shine, pixels.plain),
                Binding::Sampled(&self.sky.0, &self.sky.1),
                Binding::StorageRead(&self.rays.image),
                Binding::Read(&self.rays.hits),
                Binding::Read(&self.faces),
                Binding::Read(&self.positions),
                Binding::Read(&self.indices),
                Binding::Read(&self.leaving),
                Binding::StorageReadWrite(pixels.picture),
            ],
            batch,
            [batch.pixels, 1, 1],
        )?;
        times.extend_from_slice(work.submit()?.wait()?.passes());
        Ok(times)
    }
}

/// The same with each label once, its times added.
fn summed(times: &[PassTime]) -> Vec<PassTime> {
    let mut out: Vec<PassTime> = Vec::new();
    for time in times {
        match out.iter_mut().find(|known| known.label == time.label) {
            Some(known) => known.nanoseconds += time.nanoseconds,
            None => out.push(time.clone()),
        }
    }
    out
}
