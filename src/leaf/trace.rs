//! Tracing rays in batches on the compute queue.

use std::collections::HashMap;

use super::rays::{RayScene, rows};
use crate::Result;
use crate::abi::{RAY_COLUMN_BITS, RAY_NOTHING, RAY_PLACES, RAY_STACK, RAY_STATE, TraceRays};
use crate::gpu::shaders::leaf as shaders;
use crate::gpu::{
    Binding, Buffer, BufferInfo, ComputePipeline, Format, Gpu, Image, ImageInfo, PassTime,
    QueueKind, Work,
};

/// What is asked of a ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Query {
    /// Whether it meets anything.
    Any,
    /// What it meets first.
    Nearest,
}

/// A ray as kernels read it: two texels.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Ray {
    /// Start, in units of the diagonal.
    pub origin: [f32; 3],
    /// Hits at or beyond this distance do not count.
    pub t_max: f32,
    /// Direction; distances are in its lengths.
    pub direction: [f32; 3],
    /// Free for whoever made the ray.
    pub tag: f32,
}

/// The nearest hit of a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearestHit {
    /// Distance in lengths of the direction.
    pub t: f32,
    /// Number of the triangle.
    pub triangle: u32,
}

/// Rounds of the loop an invocation takes in one dispatch. Mesa's software driver ends the loops
/// of an invocation, all together, after 65,535 rounds, the outer ones counted too.
pub const ROUNDS: u32 = 24_576;
/// Fewer invocations than this leave a device idle.
const ENOUGH_INVOCATIONS: u32 = 8192;

/// Rays on the device and what they met, reused from batch to batch.
#[derive(Debug, Clone)]
pub struct RayBatch {
    /// Two texels a ray.
    pub(super) image: Image,
    /// Any: a word an invocation. Nearest: distance and triangle of each ray.
    pub(super) hits: Buffer,
    states: Buffer,
    unfinished: Buffer,
    capacity: u32,
}

impl RayBatch {
    /// Room for `capacity` rays.
    ///
    /// # Errors
    /// More rays than an image holds, or memory runs out.
    pub fn new(gpu: &Gpu, capacity: u32) -> Result<Self> {
        let rows = rows(gpu, "rays", 2 * capacity as usize)?;
        let info = ImageInfo::storage("rays", Format::Rgba32Float, [1 << RAY_COLUMN_BITS, rows]);
        let invocations = u64::from(Split::new(capacity).invocations);
        let buffer = |name: &str, words: u64| gpu.buffer(BufferInfo::device(name, 4 * words));
        Ok(Self {
            image: gpu.image(info)?,
            hits: buffer("ray hits", 2 * u64::from(capacity))?,
            states: buffer("ray states", invocations * u64::from(RAY_STATE))?,
            unfinished: buffer("unfinished rays", 1)?,
            capacity,
        })
    }

    /// Rays it has room for.
    #[must_use]
    pub fn capacity(&self) -> u32 {
        self.capacity
    }

    /// Bytes on the device.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let buffers = [&self.hits, &self.states, &self.unfinished];
        self.image.info().bytes() + buffers.iter().map(|b| b.bytes()).sum::<u64>()
    }

    /// Copies rays of the host.
    ///
    /// # Errors
    /// When memory runs out.
    pub fn upload(&self, work: &mut Work, rays: &[Ray]) -> Result<()> {
        let [width, height] = self.image.info().extent;
        let mut all = rays.to_vec();
        all.resize((width * height / 2) as usize, bytemuck::Zeroable::zeroed());
        work.upload_image("rays", &self.image, &[bytemuck::cast_slice(&all)])
    }
}

/// How rays are dealt to invocations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Split {
    /// Invocations; ray `i` is traced by invocation `i % invocations`.
    pub invocations: u32,
    /// Rays of an invocation at most.
    pub places: u32,
}

impl Split {
    /// The split of `count` rays.
    #[must_use]
    pub fn new(count: u32) -> Self {
        let places = (count / ENOUGH_INVOCATIONS).clamp(1, RAY_PLACES);
        // Whole words of lanes, so that neighbours in a subgroup take neighbouring rays.
        let invocations = count.div_ceil(places).next_multiple_of(64);
        Self {
            invocations,
            places,
        }
    }

    /// Whether ray `i` met anything, in the words of [`Query::Any`].
    #[must_use]
    pub fn bit(&self, words: &[u32], i: u32) -> bool {
        words[(i % self.invocations) as usize] >> (i / self.invocations) & 1 == 1
    }
}

/// The pipelines that trace.
#[derive(Debug)]
pub struct Tracer {
    gpu: Gpu,
    /// By query, masks and waiting groups.
    pipelines: HashMap<(Query, bool, u32), ComputePipeline>,
    /// Rounds a dispatch may take; tests lower it to see rays resumed.
    pub rounds: u32,
    /// Device times of all traces so far.
    pub times: Vec<PassTime>,
}

impl Tracer {
    /// A tracer.
    ///
    /// # Errors
    /// When the device is out of memory.
    pub fn new(gpu: &Gpu) -> Result<Self> {
        Ok(Self {
            gpu: gpu.clone(),
            pipelines: HashMap::new(),
            rounds: ROUNDS,
            times: Vec::new(),
        })
    }

    fn pipeline(&mut self, query: Query, scene: &RayScene) -> Result<ComputePipeline> {
        // A group less than levels can wait; in steps, so that few kernels are compiled.
        let stack = (scene.depth - 1).next_multiple_of(4).clamp(4, RAY_STACK);
        let key = (query, scene.masked, stack);
        if let Some(pipeline) = self.pipelines.get(&key) {
            return Ok(pipeline.clone());
        }
        let shader = match query {
            Query::Any => shaders::ANY_HIT_COMP,
            Query::Nearest => shaders::NEAREST_HIT_COMP,
        };
        let pipeline = self
            .gpu
            .compute_pipeline_with(shader, &[(0, u32::from(scene.masked)), (1, stack)])?;
        self.pipelines.insert(key, pipeline.clone());
        Ok(pipeline)
    }

    /// Traces the first `count` rays of `batch` after what `work` holds (nothing, or what makes
    /// the rays), and waits until all are done.
    ///
    /// # Errors
    /// When memory runs out or the device is lost.
    pub fn trace(
        &mut self,
        work: Option<Work>,
        scene: &RayScene,
        batch: &RayBatch,
        count: u32,
        query: Query,
    ) -> Result<()> {
        assert!(count <= batch.capacity, "{count} rays into {batch:?}");
        let pipeline = self.pipeline(query, scene)?;
        let mut work = match work {
            Some(work) => work,
            None => self.gpu.work(QueueKind::Compute, "rays")?,
        };
        let split = Split::new(count);
        let mut continues = 0;
        loop {
            self.record(
                &mut work,
                &pipeline,
                scene,
                batch,
                (count, split, continues),
            )?;
            let unfinished = work.read::<u32>("unfinished rays", &batch.unfinished)?;
            let mut done = work.submit()?.wait()?;
            self.times.extend_from_slice(done.passes());
            if done.take(unfinished)[0] == 0 {
                return Ok(());
            }
            continues = 1;
            work = self.gpu.work(QueueKind::Compute, "rays")?;
        }
    }

    fn record(
        &self,
        work: &mut Work,
        pipeline: &ComputePipeline,
        scene: &RayScene,
        batch: &RayBatch,
        (count, split, continues): (u32, Split, u32),
    ) -> Result<()> {
        work.fill("finished", &batch.unfinished, 0)?;
        work.compute(
            "trace",
            pipeline,
            &[
                Binding::StorageRead(&scene.nodes),
                Binding::StorageRead(&scene.quads),
                Binding::StorageRead(&scene.cutouts),
                Binding::StorageRead(&batch.image),
                Binding::ReadWrite(&batch.hits),
                Binding::ReadWrite(&batch.states),
                Binding::ReadWrite(&batch.unfinished),
            ],
            &TraceRays {
                count,
                invocations: split.invocations,
                places: split.places,
                rounds: self.rounds,
                continues,
            },
            [split.invocations, 1, 1],
        )
    }

    /// Whether each of `rays` meets anything.
    ///
    /// # Errors
    /// When memory runs out or the device is lost.
    pub fn any(&mut self, scene: &RayScene, rays: &[Ray]) -> Result<Vec<bool>> {
        let (count, words) = self.run(scene, rays, Query::Any)?;
        let split = Split::new(count);
        Ok((0..count).map(|i| split.bit(&words, i)).collect())
    }

    /// What each of `rays` meets first.
    ///
    /// # Errors
    /// When memory runs out or the device is lost.
    pub fn nearest(&mut self, scene: &RayScene, rays: &[Ray]) -> Result<Vec<Option<NearestHit>>> {
        let (_, words) = self.run(scene, rays, Query::Nearest)?;
        let hit = |w: &[u32]| {
            (w[1] != RAY_NOTHING).then(|| NearestHit {
                t: f32::from_bits(w[0]),
                triangle: w[1],
            })
        };
        Ok(words.chunks_exact(2).take(rays.len()).map(hit).collect())
    }

    fn run(&mut self, scene: &RayScene, rays: &[Ray], query: Query) -> Result<(u32, Vec<u32>)> {
        let count = u32::try_from(rays.len()).expect("fewer than 2^32 rays");
        let batch = RayBatch::new(&self.gpu, count.max(1))?;
        let mut work = self.gpu.work(QueueKind::Compute, "rays")?;
        batch.upload(&mut work, rays)?;
        self.trace(Some(work), scene, &batch, count, query)?;
        Ok((count, self.gpu.read(&batch.hits)?))
    }
}
