//! How much of a lamp each vertex sees: the share of the light that would arrive if nothing hid
//! the lamp. Eight points at its outline decide whether a vertex is in the penumbra; only there
//! are the rest tried.

use glam::DVec3;

use super::lamp::{Lamp, MOST_POINTS, PlacedLamps};
use super::rays::{Occluders, RayScene};
use super::receivers::Receivers;
use super::trace::{Query, RayBatch, Split, Tracer};
use crate::abi::LampBatch;
use crate::gpu::shaders::leaf as shaders;
use crate::gpu::{Binding, Buffer, BufferInfo, ComputePipeline, Gpu, QueueKind};
use crate::{Error, Result};

/// Points that decide where the rest is asked.
const FIRST_POINTS: u32 = 8;
/// Points of a batch: an invocation of the count goes over all of them.
const POINTS_PER_BATCH: u32 = 256;

/// How visibility is sampled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LampSettings {
    /// Points of each lamp, 1 to 4096.
    pub points: u32,
    /// Whether all points are tried everywhere.
    pub exhaustive: bool,
    /// A ray starts so far from its surface, in diagonals of the model.
    pub offset: f32,
    /// Rays of a batch.
    pub batch: u32,
}

impl Default for LampSettings {
    fn default() -> Self {
        Self {
            points: 16,
            exhaustive: false,
            offset: 1e-5,
            batch: 1 << 18,
        }
    }
}

/// Computes visibility of lamps on the device.
#[derive(Debug)]
pub struct LampMaps<'a> {
    gpu: &'a Gpu,
    scene: &'a RayScene,
    tracer: Tracer,
    settings: LampSettings,
    /// Metres relative to the model's origin to units of the diagonal.
    frame: (DVec3, f64),
    receivers: Buffer,
    vertices: u32,
    sums: Buffer,
    rays: RayBatch,
    make: ComputePipeline,
    count: ComputePipeline,
    /// Rays traced so far.
    pub traced: u64,
}

impl<'a> LampMaps<'a> {
    /// Uploads what the kernels need. `origin` is that of the geometry.
    ///
    /// # Errors
    /// Settings outside their range, or memory runs out.
    pub fn new(
        gpu: &'a Gpu,
        scene: &'a RayScene,
        (occluders, origin): (&Occluders, DVec3),
        receivers: &Receivers,
        settings: LampSettings,
    ) -> Result<Self> {
        if !(1..=MOST_POINTS).contains(&settings.points) {
            return Err(Error::usage(format!(
                "lamp samples: {} is not between 1 and {MOST_POINTS}",
                settings.points
            )));
        }
        let batch = u64::from(settings.batch);
        Ok(Self {
            tracer: Tracer::new(gpu)?,
            frame: (origin, f64::from(occluders.scale)),
            receivers: gpu.upload("receivers", &receivers.points)?,
            vertices: receivers.points.len() as u32,
            sums: gpu.buffer(BufferInfo::device("lamp sums", 12 * batch))?,
            rays: RayBatch::new(gpu, settings.batch)?,
            make: gpu.compute_pipeline(shaders::LAMP_RAYS_COMP)?,
            count: gpu.compute_pipeline(shaders::LAMP_COUNT_COMP)?,
            gpu,
            scene,
            settings,
            traced: 0,
        })
    }

    /// What each vertex sees of `lamp`, \[0, 1\]; 0 behind it.
    ///
    /// # Errors
    /// When memory runs out or the device is lost.
    pub fn map(&mut self, lamp: &Lamp) -> Result<Vec<f32>> {
        let all = self.settings.points;
        let placed = PlacedLamps::new(std::slice::from_ref(lamp), self.frame, all);
        let items: Vec<u32> = (0..self.vertices).collect();
        let first = if self.settings.exhaustive || all <= FIRST_POINTS {
            all
        } else {
            FIRST_POINTS
        };
        // The outermost points have the highest numbers.
        let mut sums = self.sums(&placed, &items, (all - first, first))?;
        let mixed: Vec<u32> = items
            .into_iter()
            .filter(|&i| (0.5..first as f32 - 0.5).contains(&sums[i as usize][2]))
            .collect();
        if first < all {
            let more = self.sums(&placed, &mixed, (0, all - first))?;
            for (&i, more) in mixed.iter().zip(&more) {
                (0..3).for_each(|k| sums[i as usize][k] += more[k]);
            }
        }
        let share = |s: &[f32; 3]| if s[1] > 0.0 { s[0] / s[1] } else { 0.0 };
        Ok(sums.iter().map(share).collect())
    }

    /// For each item, what arrives, what would, and how many points are seen.
    fn sums(
        &mut self,
        placed: &PlacedLamps,
        items: &[u32],
        (first, points): (u32, u32),
    ) -> Result<Vec<[f32; 3]>> {
        let mut out = vec![[0.0; 3]; items.len()];
        let device = self.gpu.upload("lamp points", &placed.points)?;
        let mut at = first;
        while at < first + points {
            let now = (first + points - at).min(POINTS_PER_BATCH);
            let per_batch = (self.settings.batch / now).max(1) as usize;
            for (number, listed) in items.chunks(per_batch).enumerate() {
                let some = self.batch((placed, &device), listed, (at, now))?;
                let own = &mut out[number * per_batch..];
                for (sum, more) in own.iter_mut().zip(&some) {
                    (0..3).for_each(|k| sum[k] += more[k]);
                }
            }
            at += now;
        }
        Ok(out)
    }

    fn batch(
        &mut self,
        (placed, points): (&PlacedLamps, &Buffer),
        items: &[u32],
        (first_point, count): (u32, u32),
    ) -> Result<Vec<[f32; 3]>> {
        let rays = items.len() as u32 * count;
        let listed = self.gpu.upload("lamp items", items)?;
        let record = placed.records[0];
        let batch = LampBatch {
            normal: record.normal,
            items: items.len() as u32,
            first_point,
            points: count,
            invocations: Split::new(rays).invocations,
            offset: self.settings.offset,
            least: record.least,
        };
        let reads = [
            Binding::Read(&self.receivers),
            Binding::Read(points),
            Binding::Read(&listed),
        ];
        let mut work = self.gpu.work(QueueKind::Compute, "lamp visibility")?;
        let mut bound = reads.to_vec();
        bound.push(Binding::StorageWrite(&self.rays.image));
        work.compute("lamp rays", &self.make, &bound, &batch, [rays, 1, 1])?;
        self.tracer
            .trace(Some(work), self.scene, &self.rays, rays, Query::Any)?;
        self.traced += u64::from(rays);
        let mut work = self.gpu.work(QueueKind::Compute, "lamp visibility")?;
        let mut bound = reads.to_vec();
        bound.extend([Binding::Read(&self.rays.hits), Binding::Write(&self.sums)]);
        work.compute(
            "count lamp rays",
            &self.count,
            &bound,
            &batch,
            [batch.items, 1, 1],
        )?;
        let sums = work.read::<[f32; 3]>("lamp sums", &self.sums)?;
        let mut done = work.submit()?.wait()?;
        self.tracer.times.extend_from_slice(done.passes());
        Ok(done.take(sums)[..items.len()].to_vec())
    }

    /// Device times of everything so far.
    #[must_use]
    pub fn times(&self) -> &[crate::gpu::PassTime] {
        &self.tracer.times
    }
}
