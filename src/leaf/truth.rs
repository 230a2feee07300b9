//! Path-traced pictures on the same hierarchy: what the split into transfer and visibility is
//! measured against.

use super::film::{Film, LitScene, film_axes, gloss, sky_image, turns};
use super::lamp::PlacedLamps;
use super::radiance_map::RadianceMap;
use super::rays::RayScene;
use super::shape::Shape;
use super::trace::{Query, RayBatch, Split, Tracer};
use crate::Result;
use crate::abi::{TruthBatch, TruthFrame, TruthPath};
use crate::gpu::shaders::leaf as shaders;
use crate::gpu::{
    AddressMode, Binding, Buffer, BufferInfo, ComputePipeline, Gpu, Image, QueueKind, Sampler,
    SamplerInfo, Work,
};

/// Paths of a batch.
const BATCH: u32 = 1 << 17;
/// Points of a lamp, or of the shape of the sun, that paths choose from.
const POINTS: u32 = 1024;
/// Bounces at most.
pub(crate) const BOUNCES: u32 = 64;

/// The parts of a path-traced picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    /// Light of the sun and of lamps on what the camera sees.
    pub direct: RadianceMap,
    /// The same over other leaves.
    pub indirect: RadianceMap,
    /// Light of the sky, direct and over other leaves.
    pub sky: RadianceMap,
}

impl Truth {
    /// All of it.
    #[must_use]
    pub fn full(&self) -> RadianceMap {
        self.direct.plus(&self.indirect).plus(&self.sky)
    }
}

/// Everything the kernels read and write.
struct PathTracer<'a> {
    gpu: &'a Gpu,
    scene: RayScene,
    tracer: Tracer,
    frame: Buffer,
    faces: Buffer,
    materials: Buffer,
    gloss: Buffer,
    positions: Buffer,
    normals: Buffer,
    indices: Buffer,
    sky: (Image, Sampler),
    lamps: Buffer,
    points: Buffer,
    turns: Buffer,
    rays: RayBatch,
    sun_rays: RayBatch,
    paths: Buffer,
    alive: Buffer,
    sums: Buffer,
    kernels: [ComputePipeline; 4],
}

/// Traces `samples` paths through every pixel; `step` is told the share that is done.
///
/// # Errors
/// What `step` says, or a failing device.
pub fn trace(
    gpu: &Gpu,
    scene: &LitScene<'_>,
    film: &Film,
    (samples, seed): (u32, u32),
    step: &mut dyn FnMut(f64) -> Result<()>,
) -> Result<Truth> {
    let [width, height] = film.size;
    let pixels = width * height;
    let mut tracer = PathTracer::new(gpu, scene, film, seed)?;
    let per_batch = (BATCH / pixels.min(BATCH)).clamp(1, 256);
    let mut first_pixel = 0;
    while first_pixel < pixels {
        let count = pixels.min(BATCH).min(pixels - first_pixel);
        let mut sample = 0;
        while sample < samples {
            let batch = TruthBatch {
                first_pixel,
                pixels: count,
                first_sample: sample,
                samples: per_batch.min(samples - sample),
                invocations: Split::new(count * per_batch.min(samples - sample)).invocations,
                ..TruthBatch::default()
            };
            tracer.batch(batch)?;
            sample += batch.samples;
            let done = f64::from(first_pixel) + f64::from(count * sample) / f64::from(samples);
            step(done / f64::from(pixels))?;
        }
        first_pixel += count;
    }
    let sums: Vec<[[f32; 4]; 3]> = gpu.read(&tracer.sums)?;
    let share = 1.0 / samples as f32;
    let part = |k: usize| RadianceMap {
        width: width as usize,
        height: height as usize,
        pixels: sums
            .iter()
            .map(|p| {
                let [r, g, b, _] = p[k];
                [r, g, b, p[0][3]].map(|v| share * v)
            })
            .collect(),
    };
    Ok(Truth {
        direct: part(0),
        indirect: part(1),
        sky: part(2),
    })
}

/// What is the same for all paths of a picture; the twin starts from it too.
pub(crate) fn frame(scene: &LitScene<'_>, film: &Film, seed: u32) -> TruthFrame {
    let occluders = scene.occluders;
    let scale = f64::from(occluders.scale);
    let [right, up] = film_axes(&film.camera);
    TruthFrame {
        eye: (scale * (film.camera.eye - scene.geometry.origin))
            .as_vec3()
            .to_array(),
        width: film.size[0],
        forward: film.camera.forward.as_vec3().to_array(),
        height: film.size[1],
        right: right.to_array(),
        seed,
        up: up.to_array(),
        offset: 1e-5,
        sun: film.sun.towards.as_vec3().to_array(),
        sin_radius: film.sun.radius_degrees.to_radians().sin() as f32,
        irradiance: film.sun.irradiance.as_vec3().to_array(),
        suns: u32::from(film.sun.irradiance.max_element() > 0.0),
        sun_points: if film.sun_shape == Shape::Disc {
            0
        } else {
            POINTS
        },
        lamps: film.lamps.len() as u32,
    }
}

/// The lamps, and the points of the sun's shape before theirs.
/// Without lamps, one that nobody asks for: buffers hold something.
pub(crate) fn lights(scene: &LitScene<'_>, film: &Film) -> PlacedLamps {
    let frame = (scene.geometry.origin, f64::from(scene.occluders.scale));
    let sun: Vec<[f32; 3]> = match &film.sun_shape {
        Shape::Disc => vec![[0.0; 3]],
        shape => shape
            .points(POINTS)
            .iter()
            .map(|p| [p[0] as f32, p[1] as f32, 0.0])
            .collect(),
    };
    let mut lamps = PlacedLamps::new(&film.lamps, frame, POINTS);
    for record in &mut lamps.records {
        record.first_point += sun.len() as u32;
    }
    lamps.points.splice(0..0, sun.iter().copied());
    if lamps.records.is_empty() {
        lamps.records.push(bytemuck::Zeroable::zeroed());
    }
    lamps
}

impl<'a> PathTracer<'a> {
    fn new(gpu: &'a Gpu, scene: &LitScene<'_>, film: &Film, seed: u32) -> Result<Self> {
        let occluders = scene.occluders;
        let frame = frame(scene, film, seed);
        let lamps = lights(scene, film);
        let pixels = u64::from(film.size[0]) * u64::from(film.size[1]);
        let device = |name: &str, bytes: u64| gpu.buffer(BufferInfo::device(name, bytes));
        let sampler = gpu.sampler(&SamplerInfo {
            linear: true,
            address: [AddressMode::Repeat, AddressMode::Clamp],
            ..SamplerInfo::default()
        })?;
        let kernel = |shader| gpu.compute_pipeline(shader);
        let (turns, constants) = turns(gpu, scene.receivers)?;
        Ok(Self {
            gpu,
            scene: RayScene::new(gpu, occluders)?,
            tracer: Tracer::new(gpu)?,
            frame: gpu.upload("truth frame", &[frame])?,
            faces: gpu.upload("faces", &scene.receivers.faces)?,
            materials: gpu.upload("leaf sides", &scene.receivers.materials)?,
            gloss: gloss(gpu, scene.optics)?,
            positions: gpu.upload("positions", &occluders.positions)?,
            normals: gpu.upload("normals", &scene.geometry.normals)?,
            indices: gpu.upload("indices", &occluders.indices)?,
            sky: (sky_image(gpu, &film.sky)?, sampler),
            lamps: gpu.upload("lamps", &lamps.records)?,
            points: gpu.upload("points of lights", &lamps.points)?,
            turns,
            rays: RayBatch::new(gpu, BATCH)?,
            sun_rays: RayBatch::new(gpu, BATCH)?,
            paths: device(
                "truth paths",
                u64::from(BATCH) * size_of::<TruthPath>() as u64,
            )?,
            alive: device("paths alive", 4)?,
            sums: device("truth pixels", pixels * 48)?,
            kernels: [
                kernel(shaders::TRUTH_START_COMP)?,
                gpu.compute_pipeline_with(shaders::TRUTH_BOUNCE_COMP, &constants)?,
                kernel(shaders::TRUTH_ADD_COMP)?,
                kernel(shaders::TRUTH_GATHER_COMP)?,
            ],
        })
    }

    fn work(&self) -> Result<Work> {
        self.gpu.work(QueueKind::Compute, "truth")
    }

    fn batch(&mut self, mut batch: TruthBatch) -> Result<()> {
        let count = batch.pixels * batch.samples;
        let mut work = self.work()?;
        work.compute(
            "camera rays",
            &self.kernels[0],
            &[
                Binding::Read(&self.frame),
                Binding::StorageWrite(&self.rays.image),
                Binding::Write(&self.paths),
            ],
            &batch,
            [count, 1, 1],
        )?;
        loop {
            let (scene, rays) = (&self.scene, &self.rays);
            self.tracer
                .trace(Some(work), scene, rays, count, Query::Nearest)?;
            let alive = self.bounce(&batch, count)?;
            if alive == 0 {
                break;
            }
            work = self.work()?;
            let (scene, rays) = (&self.scene, &self.sun_rays);
            self.tracer
                .trace(Some(work), scene, rays, count, Query::Any)?;
            work = self.work()?;
            work.compute(
                "add sun",
                &self.kernels[2],
                &[
                    Binding::Read(&self.sun_rays.hits),
                    Binding::ReadWrite(&self.paths),
                ],
                &batch,
                [count, 1, 1],
            )?;
            batch.bounce += 1;
            batch.last = u32::from(batch.bounce >= BOUNCES);
        }
        let mut work = self.work()?;
        work.compute(
            "gather truth",
            &self.kernels[3],
            &[Binding::Read(&self.paths), Binding::ReadWrite(&self.sums)],
            &batch,
            [batch.pixels, 1, 1],
        )?;
        work.submit()?.wait()?;
        Ok(())
    }

    /// Scatters the paths; returns how many asked for the sun.
    fn bounce(&mut self, batch: &TruthBatch, count: u32) -> Result<u32> {
        let mut work = self.work()?;
        work.fill("nobody alive", &self.alive, 0)?;
        work.compute(
            "scatter",
            &self.kernels[1],
            &[
                Binding::Read(&self.frame),
                Binding::Read(&self.rays.hits),
                Binding::Read(&self.faces),
                Binding::Read(&self.materials),
                Binding::Read(&self.gloss),
                Binding::Read(&self.positions),
                Binding::Read(&self.normals),
                Binding::Read(&self.indices),
                Binding::Sampled(&self.sky.0, &self.sky.1),
                Binding::StorageReadWrite(&self.rays.image),
                Binding::StorageWrite(&self.sun_rays.image),
                Binding::ReadWrite(&self.paths),
                Binding::ReadWrite(&self.alive),
                Binding::Read(&self.lamps),
                Binding::Read(&self.points),
                Binding::Read(&self.turns),
            ],
            batch,
            [count, 1, 1],
        )?;
        let alive = work.read::<u32>("paths alive", &self.alive)?;
        let mut done = work.submit()?.wait()?;
        Ok(done.take(alive)[0])
    }
}
