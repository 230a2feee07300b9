//! Records the passes of a bake on the compute queue, or only lists them.
//!
//! One code path makes both the bake and its recipe: without a device the recorder allocates and
//! runs nothing but notes every buffer and pass with its bytes. So the recipe cannot drift from
//! the bake.

use std::collections::HashMap;

use bytemuck::Pod;

use crate::gpu::{
    Binding, Buffer, BufferInfo, ComputePipeline, Format, Gpu, Image, ImageInfo, PassTime,
    QueueKind, Sampler, SamplerInfo, Shader, Work,
};
use crate::{Error, Result};

/// A buffer or image of the recipe.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlannedResource {
    /// Name of the Vulkan object.
    pub name: String,
    /// Its size.
    pub bytes: u64,
    /// Whether the size is known before the bake; the surface's size is only counted in it.
    pub exact: bool,
}

/// A buffer that exists only when there is a device.
#[derive(Debug, Clone)]
pub(super) struct Store {
    buffer: Option<Buffer>,
}

/// An image of points, fetched as texels.
#[derive(Debug, Clone)]
pub(super) struct Picture {
    image: Option<(Image, Sampler)>,
}

/// What a kernel does with a resource, in binding order.
#[derive(Debug, Clone, Copy)]
pub(super) enum Use<'a> {
    Read(&'a Store),
    Write(&'a Store),
    ReadWrite(&'a Store),
    Fetch(&'a Picture),
    Draw(&'a Picture),
}

/// A kernel with its specialisation constants.
#[derive(Debug, Clone, Copy)]
pub(super) struct Kernel<'a> {
    pub(super) shader: Shader,
    pub(super) constants: &'a [(u32, u32)],
}

impl From<Shader> for Kernel<'_> {
    fn from(shader: Shader) -> Self {
        Self {
            shader,
            constants: &[],
        }
    }
}

type PipelineKey = (&'static str, Vec<(u32, u32)>);

/// Called between submissions with what is being done and the share that is done.
pub type Progress<'a> = &'a mut dyn FnMut(&str, f32);

pub(super) struct Recorder<'a> {
    gpu: Option<Gpu>,
    work: Option<Work>,
    pipelines: HashMap<PipelineKey, ComputePipeline>,
    sampler: Option<Sampler>,
    /// Labels of all passes, in order.
    pub(super) passes: Vec<String>,
    /// Everything allocated, in order.
    pub(super) resources: Vec<PlannedResource>,
    /// Device times of the passes submitted so far.
    pub(super) times: Vec<PassTime>,
    /// Whether sizes from here on are estimates.
    pub(super) estimated: bool,
    progress: Progress<'a>,
}

impl<'a> Recorder<'a> {
    pub(super) fn new(gpu: Option<&Gpu>, progress: Progress<'a>) -> Self {
        Self {
            gpu: gpu.cloned(),
            work: None,
            pipelines: HashMap::new(),
            sampler: None,
            passes: Vec::new(),
            resources: Vec::new(),
            times: Vec::new(),
            estimated: false,
            progress,
        }
    }

    /// Whether nothing is run.
    pub(super) fn is_plan(&self) -> bool {
        self.gpu.is_none()
    }

    pub(super) fn report(&mut self, what: &str, share: f32) {
        (self.progress)(what, share);
    }

    /// A device buffer.
    pub(super) fn buffer(&mut self, name: &str, bytes: u64) -> Result<Store> {
        // An empty buffer cannot be bound.
        let bytes = bytes.max(16);
        self.note(name, bytes);
        let buffer = match &self.gpu {
            None => None,
            Some(gpu) => {
                let limit = gpu.info().limits.max_storage_range;
                if bytes > limit {
                    return Err(Error::Unsupported(format!(
                        "{name} takes {bytes} bytes, the device binds at most {limit}; \
                         try fewer cells or a fraction of the generators"
                    )));
                }
                Some(gpu.buffer(BufferInfo::device(name, bytes))?)
            }
        };
        Ok(Store { buffer })
    }

    /// A device buffer of `count` elements.
    pub(super) fn array<T>(&mut self, name: &str, count: usize) -> Result<Store> {
        self.buffer(name, (count * size_of::<T>()) as u64)
    }

    /// A device buffer filled with `data`.
    pub(super) fn upload<T: Pod>(&mut self, name: &str, data: &[T]) -> Result<Store> {
        let store = self.array::<T>(name, data.len())?;
        if let Some(work) = self.work()? {
            let buffer = store.buffer.as_ref().expect("there is a device");
            work.upload(name, buffer, data)?;
        }
        Ok(store)
    }

    /// An image for `count` texels of four floats.
    pub(super) fn picture(
        &mut self,
        name: &str,
        count: usize,
        column_bits: u32,
    ) -> Result<Picture> {
        let width = 1u32 << column_bits;
        let rows = count.div_ceil(width as usize).max(1);
        let rows = u32::try_from(rows).unwrap_or(u32::MAX);
        let info = ImageInfo::storage(name, Format::Rgba32Float, [width, rows]);
        self.note(name, info.bytes());
        let Some(gpu) = self.gpu.clone() else {
            return Ok(Picture { image: None });
        };
        let limit = gpu.info().limits.max_image_2d;
        if rows > limit {
            return Err(Error::Unsupported(format!(
                "{name}: {count} generators, the device takes at most {}; \
                 try a fraction of the generators",
                u64::from(limit) * u64::from(width)
            )));
        }
        let sampler = match &self.sampler {
            Some(sampler) => sampler.clone(),
            None => gpu.sampler(&SamplerInfo::default())?,
        };
        self.sampler = Some(sampler.clone());
        Ok(Picture {
            image: Some((gpu.image(info)?, sampler)),
        })
    }

    fn note(&mut self, name: &str, bytes: u64) {
        self.resources.push(PlannedResource {
            name: name.to_owned(),
            bytes,
            exact: !self.estimated,
        });
    }

    /// Dispatches in a row are one pass: how many it takes may only show when it runs.
    fn pass(&mut self, label: &str) {
        if self.passes.last().is_none_or(|last| last != label) {
            self.passes.push(label.to_owned());
        }
    }

    /// Sets every word of a buffer.
    pub(super) fn fill(&mut self, label: &str, store: &Store, word: u32) -> Result<()> {
        self.pass(label);
        match self.work()? {
            Some(work) => work.fill(label, store.buffer.as_ref().expect("device"), word),
            None => Ok(()),
        }
    }

    /// Runs a one-dimensional kernel.
    pub(super) fn compute<'k, P: Pod>(
        &mut self,
        label: &str,
        kernel: impl Into<Kernel<'k>>,
        uses: &[Use<'_>],
        push: &P,
        invocations: usize,
    ) -> Result<()> {
        self.pass(label);
        if self.is_plan() {
            return Ok(());
        }
        let pipeline = self.pipeline(kernel.into())?;
        let bindings: Vec<Binding<'_>> = uses.iter().map(|u| u.binding()).collect();
        let count = u32::try_from(invocations).map_err(|_| {
            Error::Unsupported(format!("{label}: {invocations} invocations are too many"))
        })?;
        let work = self.work()?.expect("there is a device");
        work.compute(label, &pipeline, &bindings, push, [count, 1, 1])
    }

    fn pipeline(&mut self, kernel: Kernel<'_>) -> Result<ComputePipeline> {
        let key = (kernel.shader.name, kernel.constants.to_vec());
        if let Some(pipeline) = self.pipelines.get(&key) {
            return Ok(pipeline.clone());
        }
        let gpu = self.gpu.as_ref().expect("there is a device");
        let pipeline = gpu.compute_pipeline_with(kernel.shader, kernel.constants)?;
        self.pipelines.insert(key, pipeline.clone());
        Ok(pipeline)
    }

    fn work(&mut self) -> Result<Option<&mut Work>> {
        if let (Some(gpu), None) = (&self.gpu, &self.work) {
            self.work = Some(gpu.work(QueueKind::Compute, "foliage bake")?);
        }
        Ok(self.work.as_mut())
    }

    /// Submits what is recorded, waits, and returns the content of `store`; `estimate` stands in
    /// for it in a plan.
    pub(super) fn fetch<T: Pod>(
        &mut self,
        label: &str,
        store: &Store,
        estimate: impl FnOnce() -> Vec<T>,
    ) -> Result<Vec<T>> {
        Ok(self.fetch_all(label, &[store], estimate)?.remove(0))
    }

    /// As [`Recorder::fetch`] for several buffers at once; the estimate is that of each.
    pub(super) fn fetch_all<T: Pod>(
        &mut self,
        label: &str,
        stores: &[&Store],
        estimate: impl FnOnce() -> Vec<T>,
    ) -> Result<Vec<Vec<T>>> {
        if self.is_plan() {
            return Ok(vec![estimate(); stores.len()]);
        }
        let mut promises = Vec::new();
        for store in stores {
            let work = self.work()?.expect("there is a device");
            promises.push(work.read::<T>(label, store.buffer.as_ref().expect("device"))?);
        }
        let work = self.work.take().expect("just recorded");
        let mut done = work.submit()?.wait()?;
        self.times.extend_from_slice(done.passes());
        Ok(promises.into_iter().map(|p| done.take(p)).collect())
    }
}

impl Use<'_> {
    fn binding(&self) -> Binding<'_> {
        const DEVICE: &str = "bound only where there is a device";
        match self {
            Self::Read(s) => Binding::Read(s.buffer.as_ref().expect(DEVICE)),
            Self::Write(s) => Binding::Write(s.buffer.as_ref().expect(DEVICE)),
            Self::ReadWrite(s) => Binding::ReadWrite(s.buffer.as_ref().expect(DEVICE)),
            Self::Fetch(p) => {
                let (image, sampler) = p.image.as_ref().expect(DEVICE);
                Binding::Sampled(image, sampler)
            }
            Self::Draw(p) => Binding::StorageWrite(&p.image.as_ref().expect(DEVICE).0),
        }
    }
}
