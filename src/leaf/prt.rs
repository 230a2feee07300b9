//! Precomputed radiance transfer: what of a distant environment leaves each side of each vertex.
//!
//! For diffuse leaves the light that leaves does not depend on the direction of view, so that a
//! vector a side and channel is exact (Sloan, Kautz, Snyder 2002, Precomputed Radiance Transfer,
//! for the two-sided leaf of Wang et al. 2005, equation 9). The direct part T^d (light that
//! reaches the vertex from the sky at once) and the indirect part T^i (over other leaves) are
//! kept apart: the sky takes both, the sun, whose direct light is found exactly, only T^i.

use super::matrix::raw_floats;
use super::rays::RayScene;
use super::receivers::Receivers;
use super::trace::{Query, RayBatch, Tracer};
use crate::abi::{PrtBatch, PrtBounce};
use crate::gpu::shaders::leaf as shaders;
use crate::gpu::{
    Binding, Buffer, BufferInfo, ComputePipeline, Gpu, QueueKind, Sampler, SamplerInfo,
};
use crate::math::sh::MAX_ORDER;
use crate::{Error, Result};

/// Floats of one side of one receiver of `order` bands: direct and indirect, coefficients, RGB.
#[must_use]
pub const fn side_floats(order: u32) -> usize {
    6 * (order * order) as usize
}

/// Samples of a side that one invocation of `prt_gather.comp` adds at most.
const SAMPLES_PER_BATCH: u32 = 1024;

/// How transfer is sampled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrtSettings {
    /// Bands of the vectors, 1 to 6: the square of it are coefficients.
    pub order: u32,
    /// Paths of each side of each vertex.
    pub paths: u32,
    /// Bounces at most; what is left then is lost.
    pub bounces: u32,
    /// Chance of a path to go on, in albedos of what it met; 0 goes on always.
    pub survival: f32,
    /// Seed of the random numbers.
    pub seed: u32,
    /// A ray starts so far from its surface, in diagonals of the model.
    pub offset: f32,
    /// Rays of a batch.
    pub batch: u32,
    /// Whether the gloss of the leaf that a vector belongs to counts as diffuse reflection; that of
    /// leaves that paths meet always does.
    pub gloss: bool,
}

impl Default for PrtSettings {
    fn default() -> Self {
        Self {
            order: 5,
            paths: 1024,
            bounces: 64,
            survival: 1.6,
            seed: 1,
            offset: 1e-5,
            batch: 1 << 18,
            gloss: true,
        }
    }
}

/// Transfer vectors of some receivers: for each its front and back, [`side_floats`] each.
#[derive(Debug, Clone, PartialEq)]
pub struct Transfer {
    /// Bands.
    pub order: u32,
    /// The vectors.
    pub values: Vec<f32>,
}

impl Transfer {
    /// Direct (0) or indirect (1) transfer of a side (0 front, 1 back) of a receiver: RGB for
    /// each coefficient.
    #[must_use]
    pub fn vector(&self, receiver: usize, side: usize, part: usize) -> &[[f32; 3]] {
        let n = (self.order * self.order) as usize;
        let first = ((2 * receiver + side) * 2 + part) * n * 3;
        bytemuck::cast_slice(&self.values[first..first + 3 * n])
    }
}

/// Where a precomputation stands, told after every batch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Paths done.
    pub done: u64,
    /// Paths in all.
    pub all: u64,
}

/// What an interrupted precomputation needs to go on.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Snapshot {
    /// Receivers that are done.
    pub receivers: u32,
    /// The last of them, as far as they were not taken.
    pub values: Vec<f32>,
    /// Samples that the next receivers have, and their sums.
    pub sample: u32,
    /// Sums of these samples.
    pub sums: Vec<f32>,
}

/// What the escapes of paths are added to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Gathered {
    /// A vector for each side.
    Vectors,
    /// Matrices for each receiver (see [`super::matrix`]).
    Matrices,
}

impl Gathered {
    /// Sides from which paths start at a receiver.
    const fn sides(self) -> u32 {
        match self {
            Self::Vectors => 2,
            Self::Matrices => 1,
        }
    }

    /// Floats of a receiver.
    const fn floats(self, order: u32) -> usize {
        match self {
            Self::Vectors => 2 * side_floats(order),
            Self::Matrices => raw_floats(order),
        }
    }
}

/// A precomputation on the device.
#[derive(Debug)]
pub struct Prt<'a> {
    gpu: &'a Gpu,
    scene: &'a RayScene,
    tracer: Tracer,
    settings: PrtSettings,
    gathered: Gathered,
    receivers: Buffer,
    faces: Buffer,
    /// Of the leaves that paths meet, and of those that they start from.
    materials: Buffer,
    own: Buffer,
    paths: Buffer,
    alive: Buffer,
    sums: Buffer,
    rays: RayBatch,
    start: ComputePipeline,
    bounce: ComputePipeline,
    gather: ComputePipeline,
    sampler: Sampler,
    count: u32,
    /// Receivers that are done at once.
    chunk: u32,
    /// First receiver under way, and the samples it has.
    first: u32,
    sample: u32,
    /// What is done.
    values: Vec<f32>,
    /// Rays traced so far.
    pub traced: u64,
}

impl<'a> Prt<'a> {
    /// Transfer vectors: uploads what the kernels need.
    ///
    /// # Errors
    /// Settings outside their range, or memory runs out.
    pub fn new(
        gpu: &'a Gpu,
        scene: &'a RayScene,
        receivers: &Receivers,
        settings: PrtSettings,
    ) -> Result<Self> {
        Self::gathering(gpu, scene, receivers, settings, Gathered::Vectors)
    }

    /// Transfer matrices, as [`super::matrix::pack`] takes them: `settings.paths` for each receiver.
    ///
    /// # Errors
    /// Settings outside their range, or memory runs out.
    pub fn matrices(
        gpu: &'a Gpu,
        scene: &'a RayScene,
        receivers: &Receivers,
        settings: PrtSettings,
    ) -> Result<Self> {
        Self::gathering(gpu, scene, receivers, settings, Gathered::Matrices)
    }

    fn gathering(
        gpu: &'a Gpu,
        scene: &'a RayScene,
        receivers: &Receivers,
        settings: PrtSettings,
        gathered: Gathered,
    ) -> Result<Self> {
        if settings.paths == 0 || settings.batch < 2 || settings.bounces == 0 {
            return Err(Error::usage(
                "paths, bounces and batch must be at least 1, 1 and 2",
            ));
        }
        if !(1..=MAX_ORDER as u32).contains(&settings.order) {
            return Err(Error::usage("the order of transfer must be 1 to 6"));
        }
        let count = receivers.points.len() as u32;
        let bytes = 4 * gathered.floats(settings.order) as u64;
        let fits = (gpu.info().limits.max_storage_range / bytes) as u32;
        let chunk = count.min(settings.batch / 2).min(fits).max(1);
        let [start, gather] = match gathered {
            Gathered::Vectors => [shaders::PRT_START_COMP, shaders::PRT_GATHER_COMP],
            Gathered::Matrices => [shaders::MATRIX_START_COMP, shaders::MATRIX_GATHER_COMP],
        };
        let own = if settings.gloss {
            &receivers.transfer
        } else {
            &receivers.materials
        };
        let buffer = |name: &str, bytes: u64| gpu.buffer(BufferInfo::device(name, bytes));
        let some = |v: &[[f32; 4]]| {
            if v.is_empty() {
                vec![[0.0; 4]]
            } else {
                v.to_vec()
            }
        };
        Ok(Self {
            tracer: Tracer::new(gpu)?,
            receivers: gpu.upload("receivers", &receivers.points)?,
            faces: gpu.upload("faces", &some(&receivers.faces))?,
            materials: gpu.upload("leaf sides", &receivers.transfer)?,
            own: gpu.upload("own leaf sides", own)?,
            paths: buffer("paths", 16 * u64::from(settings.batch))?,
            alive: buffer("paths alive", 4)?,
            sums: buffer("transfer", bytes * u64::from(chunk))?,
            rays: RayBatch::new(gpu, settings.batch)?,
            start: gpu.compute_pipeline(start)?,
            bounce: gpu.compute_pipeline(shaders::PRT_BOUNCE_COMP)?,
            gather: gpu.compute_pipeline_with(gather, &[(0, settings.order)])?,
            sampler: gpu.sampler(&SamplerInfo::default())?,
            gpu,
            scene,
            settings,
            gathered,
            count,
            chunk,
            first: 0,
            sample: 0,
            values: Vec::new(),
            traced: 0,
        })
    }

    /// Everything; `step` is called after every batch and may [`Prt::take`] what is done.
    ///
    /// # Errors
    /// What `step` says (an interrupted run), or the device fails.
    pub fn run(&mut self, step: &mut dyn FnMut(&mut Self) -> Result<()>) -> Result<()> {
        while self.first < self.count {
            self.advance()?;
            step(self)?;
        }
        Ok(())
    }

    /// The transfer vectors of all receivers.
    ///
    /// # Errors
    /// What `step` says (an interrupted run), or the device fails.
    pub fn all(&mut self, step: &mut dyn FnMut(&mut Self) -> Result<()>) -> Result<Transfer> {
        self.run(step)?;
        Ok(Transfer {
            order: self.settings.order,
            values: self.take(),
        })
    }

    /// Takes away the vectors of the receivers that were done since the last time.
    pub fn take(&mut self) -> Vec<f32> {
        std::mem::take(&mut self.values)
    }

    /// Where it stands.
    #[must_use]
    pub fn step(&self) -> Step {
        let paths = u64::from(self.settings.paths);
        let each = self.gathered.sides();
        let sides = u64::from(each) * u64::from(self.first);
        Step {
            done: sides * paths + u64::from(self.sides()) * u64::from(self.sample),
            all: u64::from(each) * u64::from(self.count) * paths,
        }
    }

    /// Floats of a receiver.
    fn floats(&self) -> usize {
        self.gathered.floats(self.settings.order)
    }

    fn sides(&self) -> u32 {
        self.gathered.sides() * self.chunk.min(self.count - self.first)
    }

    /// Takes one more batch.
    fn advance(&mut self) -> Result<()> {
        let sides = self.sides();
        let per_batch = (self.settings.batch / sides).clamp(1, SAMPLES_PER_BATCH);
        let batch = PrtBatch {
            first_side: self.gathered.sides() * self.first,
            sides,
            first_sample: self.sample,
            samples: per_batch.min(self.settings.paths - self.sample),
            seed: self.settings.seed,
            offset: self.settings.offset,
        };
        self.batch(batch)?;
        self.sample += batch.samples;
        if self.sample == self.settings.paths {
            let mut sums: Vec<f32> = self.gpu.read(&self.sums)?;
            let receivers = sides / self.gathered.sides();
            sums.truncate(receivers as usize * self.floats());
            // Directions of vectors have the density of the cosine, those of matrices that of the
            // sphere.
            let all = match self.gathered {
                Gathered::Vectors => 1.0,
                Gathered::Matrices => 4.0 * std::f32::consts::PI,
            };
            let share = all / self.settings.paths as f32;
            self.values.extend(sums.iter().map(|v| v * share));
            self.first += receivers;
            self.sample = 0;
        }
        Ok(())
    }

    /// What an interrupted run needs to go on.
    ///
    /// # Errors
    /// The device fails.
    pub fn snapshot(&self) -> Result<Snapshot> {
        let sums = if self.sample > 0 {
            self.gpu.read(&self.sums)?
        } else {
            Vec::new()
        };
        Ok(Snapshot {
            receivers: self.first,
            values: self.values.clone(),
            sample: self.sample,
            sums,
        })
    }

    /// Goes on from a snapshot of a run with the same model and settings.
    ///
    /// # Errors
    /// A snapshot of another size, or the device fails.
    pub fn restore(&mut self, snapshot: Snapshot) -> Result<()> {
        let floats = self.floats();
        let fits = snapshot.values.len().is_multiple_of(floats)
            && snapshot.values.len() <= snapshot.receivers as usize * floats
            && snapshot.receivers <= self.count
            && snapshot.sample < self.settings.paths
            && (snapshot.sample == 0 || 4 * snapshot.sums.len() as u64 == self.sums.bytes());
        if !fits {
            return Err(Error::usage("the interrupted run had other settings"));
        }
        self.first = snapshot.receivers;
        self.sample = snapshot.sample;
        self.values = snapshot.values;
        if self.sample > 0 {
            let mut work = self.gpu.work(QueueKind::Transfer, "transfer so far")?;
            work.upload("transfer so far", &self.sums, &snapshot.sums)?;
            work.submit()?.wait()?;
        }
        Ok(())
    }

    /// Traces one batch of paths to their ends and adds what escaped to the sums.
    fn batch(&mut self, batch: PrtBatch) -> Result<()> {
        let count = batch.sides * batch.samples;
        let mut work = self.gpu.work(QueueKind::Compute, "transfer")?;
        let mut bindings = vec![Binding::Read(&self.receivers)];
        if self.gathered == Gathered::Vectors {
            bindings.push(Binding::Read(&self.own));
        }
        bindings.push(Binding::StorageWrite(&self.rays.image));
        bindings.push(Binding::Write(&self.paths));
        work.compute("start paths", &self.start, &bindings, &batch, [count, 1, 1])?;
        let mut alive = count;
        let mut number = 0;
        while alive > 0 {
            self.traced += u64::from(alive);
            self.tracer
                .trace(Some(work), self.scene, &self.rays, count, Query::Nearest)?;
            work = self.gpu.work(QueueKind::Compute, "transfer")?;
            work.fill("nobody alive", &self.alive, 0)?;
            work.compute(
                "bounce",
                &self.bounce,
                &[
                    Binding::Read(&self.rays.hits),
                    Binding::Read(&self.faces),
                    Binding::Read(&self.materials),
                    Binding::StorageReadWrite(&self.rays.image),
                    Binding::ReadWrite(&self.paths),
                    Binding::ReadWrite(&self.alive),
                ],
                &PrtBounce {
                    batch,
                    bounce: number,
                    last: u32::from(number + 1 >= self.settings.bounces),
                    survival: if self.settings.survival > 0.0 {
                        self.settings.survival
                    } else {
                        f32::INFINITY
                    },
                },
                [count, 1, 1],
            )?;
            let counted = work.read::<u32>("paths alive", &self.alive)?;
            let mut done = work.submit()?.wait()?;
            self.tracer.times.extend_from_slice(done.passes());
            alive = done.take(counted)[0];
            number += 1;
            work = self.gpu.work(QueueKind::Compute, "transfer")?;
        }
        let rows = match self.gathered {
            Gathered::Vectors => 2,
            Gathered::Matrices => self.settings.order.pow(2),
        };
        work.compute(
            "gather",
            &self.gather,
            &[
                Binding::Sampled(&self.rays.image, &self.sampler),
                Binding::Read(&self.paths),
                Binding::ReadWrite(&self.sums),
            ],
            &batch,
            [rows * batch.sides, 1, 1],
        )?;
        let done = work.submit()?.wait()?;
        self.tracer.times.extend_from_slice(done.passes());
        Ok(())
    }

    /// Device times of everything so far.
    #[must_use]
    pub fn times(&self) -> &[crate::gpu::PassTime] {
        &self.tracer.times
    }
}
