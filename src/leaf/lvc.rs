//! Light visibility: the share of the sun's disc that each vertex sees, a byte for each direction
//! of the sun (Wang et al. 2005, section 4.2, with the cosine left out of the convolution, so
//! that bytes are relative and shading normals stay free).

use super::rays::RayScene;
use super::receivers::Receivers;
use super::shape::Shape;
use super::trace::{Query, RayBatch, Split, Tracer};
use crate::abi::{LvcBatch, Receiver};
use crate::gpu::shaders::leaf as shaders;
use crate::gpu::{Binding, Buffer, BufferInfo, ComputePipeline, Gpu, QueueKind};
use crate::{Error, Result};

/// Angular radius of the sun, degrees.
pub const SUN_RADIUS_DEGREES: f64 = 0.2665;
/// Samples on the rim of the disc that decide whether a vertex is in the penumbra.
const FIRST_SAMPLES: u32 = 4;

/// How visibility is sampled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LvcSettings {
    /// Angular radius of the light's disc, degrees.
    pub radius_degrees: f64,
    /// Points of the disc; 1 is its middle.
    pub samples: u32,
    /// Whether all points are tried everywhere; otherwise the four outermost decide where.
    pub exhaustive: bool,
    /// A ray starts so far from its surface, in diagonals of the model.
    pub offset: f32,
    /// Rays of a batch.
    pub batch: u32,
    /// Receivers on the device at once; where a buffer holds fewer, those.
    pub at_once: u32,
}

impl Default for LvcSettings {
    fn default() -> Self {
        Self {
            radius_degrees: SUN_RADIUS_DEGREES,
            samples: 16,
            exhaustive: false,
            offset: 1e-5,
            batch: 1 << 18,
            at_once: u32::MAX,
        }
    }
}

/// Computes visibility maps on the device.
#[derive(Debug)]
pub struct Lvc<'a> {
    gpu: &'a Gpu,
    scene: &'a RayScene,
    tracer: Tracer,
    settings: LvcSettings,
    /// Receivers, as many as a buffer holds, or the next of them in turn.
    receivers: Vec<Buffer>,
    /// Receivers of each of these buffers but the last.
    at_once: u32,
    counts: Buffer,
    /// Of the light's shape, in units of its radius.
    points: Buffer,
    rays: RayBatch,
    make: ComputePipeline,
    count: ComputePipeline,
    vertices: u32,
    /// Rays traced so far.
    pub traced: u64,
}

impl<'a> Lvc<'a> {
    /// Uploads what the kernels need.
    ///
    /// # Errors
    /// Settings outside their range, or memory runs out.
    pub fn new(
        gpu: &'a Gpu,
        scene: &'a RayScene,
        receivers: &Receivers,
        settings: LvcSettings,
    ) -> Result<Self> {
        if settings.samples == 0 || settings.samples > 255 {
            return Err(Error::usage(format!(
                "sun samples: {} is not between 1 and 255",
                settings.samples
            )));
        }
        if !(0.0..45.0).contains(&settings.radius_degrees) {
            return Err(Error::usage(format!(
                "sun radius: {} degrees is not between 0 and 45",
                settings.radius_degrees
            )));
        }
        let fits = gpu.info().limits.max_storage_range / size_of::<Receiver>() as u64;
        let at_once = settings.at_once.min(fits as u32).max(1);
        let parts = receivers.points.chunks(at_once as usize);
        Ok(Self {
            tracer: Tracer::new(gpu)?,
            receivers: parts
                .map(|part| gpu.upload("receivers", part))
                .collect::<Result<_>>()?,
            at_once,
            counts: gpu.buffer(BufferInfo::device(
                "open rays",
                u64::from(settings.batch).next_multiple_of(4),
            ))?,
            points: points(gpu, &Shape::Disc, settings.samples)?,
            rays: RayBatch::new(gpu, settings.batch)?,
            make: gpu.compute_pipeline(shaders::LVC_RAYS_COMP)?,
            count: gpu.compute_pipeline(shaders::LVC_COUNT_COMP)?,
            gpu,
            scene,
            settings,
            vertices: receivers.points.len() as u32,
            traced: 0,
        })
    }

    /// Spreads the light over `shape` in place of an even disc.
    ///
    /// # Errors
    /// When memory runs out.
    pub fn shaped(mut self, shape: &Shape) -> Result<Self> {
        self.points = points(self.gpu, shape, self.settings.samples)?;
        Ok(self)
    }

    /// Directions that one call of [`Lvc::maps`] may take.
    #[must_use]
    pub fn directions_per_batch(&self) -> usize {
        let rays = self.first_samples() * self.vertices.max(1);
        (self.settings.batch / rays).max(1) as usize
    }

    fn first_samples(&self) -> u32 {
        if self.settings.exhaustive || self.settings.samples <= FIRST_SAMPLES {
            self.settings.samples
        } else {
            FIRST_SAMPLES
        }
    }

    /// Visibility of the light in each of `directions` (unit vectors to it) from every vertex, 0
    /// to 255: all vertices of the first direction, then of the second.
    ///
    /// # Errors
    /// When memory runs out or the device is lost.
    pub fn maps(&mut self, directions: &[[f32; 3]]) -> Result<Vec<u8>> {
        let centres = self.gpu.upload("sun directions", directions)?;
        let vertices = self.vertices as usize;
        if self.receivers.len() == 1 {
            return self.part(&centres, directions.len() as u32, 0);
        }
        let mut out = vec![0; directions.len() * vertices];
        for part in 0..self.receivers.len() {
            let bytes = self.part(&centres, directions.len() as u32, part)?;
            let first = part * self.at_once as usize;
            let count = bytes.len() / directions.len().max(1);
            for (row, part) in bytes.chunks_exact(count.max(1)).enumerate() {
                let at = row * vertices + first;
                out[at..at + count].copy_from_slice(part);
            }
        }
        Ok(out)
    }

    /// [`Lvc::maps`] of the receivers of one buffer.
    fn part(&mut self, centres: &Buffer, directions: u32, part: usize) -> Result<Vec<u8>> {
        let first = part as u32 * self.at_once;
        let count = self.at_once.min(self.vertices - first);
        let receivers = self.receivers[part].clone();
        let items: Vec<[u32; 2]> = (0..directions)
            .flat_map(|d| (0..count).map(move |v| [d, v]))
            .collect();
        let sees = (&receivers, centres);
        let first = self.first_samples();
        let all = self.settings.samples;
        // The outermost samples have the highest numbers.
        let open = self.open(sees, &items, (all - first, first))?;
        if first == all {
            return Ok(open.iter().map(|&n| byte(n, all)).collect());
        }
        let mixed: Vec<usize> = (0..open.len())
            .filter(|&i| open[i] != 0 && u32::from(open[i]) != first)
            .collect();
        let listed: Vec<[u32; 2]> = mixed.iter().map(|&i| items[i]).collect();
        let rest = self.open(sees, &listed, (0, all - first))?;
        let mut bytes: Vec<u8> = open.iter().map(|&n| byte(n, first)).collect();
        for (&i, &more) in mixed.iter().zip(&rest) {
            bytes[i] = byte(open[i] + more, all);
        }
        Ok(bytes)
    }

    /// How many of `samples` rays from sample `first` on meet nothing, for each item.
    fn open(
        &mut self,
        (receivers, centres): (&Buffer, &Buffer),
        items: &[[u32; 2]],
        (first, samples): (u32, u32),
    ) -> Result<Vec<u8>> {
        let per_batch = (self.settings.batch / samples).max(1) as usize;
        let mut out = Vec::with_capacity(items.len());
        for items in items.chunks(per_batch) {
            let count = items.len() as u32 * samples;
            let listed = self.gpu.upload("sun items", items)?;
            let batch = LvcBatch {
                items: items.len() as u32,
                first_sample: first,
                samples,
                sin_radius: self.settings.radius_degrees.to_radians().sin() as f32,
                offset: self.settings.offset,
                invocations: Split::new(count).invocations,
            };
            let mut work = self.gpu.work(QueueKind::Compute, "visibility")?;
            work.compute(
                "sun rays",
                &self.make,
                &[
                    Binding::Read(receivers),
                    Binding::Read(centres),
                    Binding::Read(&listed),
                    Binding::StorageWrite(&self.rays.image),
                    Binding::Read(&self.points),
                ],
                &batch,
                [count, 1, 1],
            )?;
            self.tracer
                .trace(Some(work), self.scene, &self.rays, count, Query::Any)?;
            self.traced += u64::from(count);
            let mut work = self.gpu.work(QueueKind::Compute, "visibility")?;
            work.compute(
                "count open rays",
                &self.count,
                &[Binding::Read(&self.rays.hits), Binding::Write(&self.counts)],
                &batch,
                [batch.items.div_ceil(4), 1, 1],
            )?;
            let counts = work.read::<u8>("open rays", &self.counts)?;
            let mut done = work.submit()?.wait()?;
            self.tracer.times.extend_from_slice(done.passes());
            out.extend_from_slice(&done.take(counts)[..items.len()]);
        }
        Ok(out)
    }

    /// Device times of everything so far.
    #[must_use]
    pub fn times(&self) -> &[crate::gpu::PassTime] {
        &self.tracer.times
    }
}

fn points(gpu: &Gpu, shape: &Shape, count: u32) -> Result<Buffer> {
    let rows: Vec<[f32; 2]> = shape
        .points(count)
        .iter()
        .map(|p| p.map(|v| v as f32))
        .collect();
    gpu.upload("points of the sun", &rows)
}

fn byte(open: u8, of: u32) -> u8 {
    ((u32::from(open) * 255 + of / 2) / of) as u8
}
