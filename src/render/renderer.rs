//! The device's side of a plan: uploads once, draws any of the planned views.

use glam::Vec3;

use super::areas::Areas;
use super::batch::{self, Batch};
use super::frame::Frame;
use super::gbuffer::GBuffer;
use super::image::Picture;
use super::pipelines::Pipelines;
use super::plan::{Channel, Plan, label};
use super::settings::RenderSettings;
use super::setup::Setup;
use super::slice::SlicePlane;
use super::subject::Subject;
use super::upload::{self, Resources};
use super::view::View;
use crate::gpu::{AddressMode, Gpu, PassTime, QueueKind, Sampler, SamplerInfo};
use crate::scene::Camera;
use crate::{Error, Result};

/// A finished view and what it took.
#[derive(Debug, Clone)]
pub struct Rendered {
    /// The picture.
    pub picture: Picture,
    /// Device time of its passes. The shadow map is drawn with the first view that needs it and
    /// shared by the others.
    pub passes: Vec<PassTime>,
}

/// Everything a plan asked for, on the device.
#[derive(Debug)]
pub struct Renderer {
    gpu: Gpu,
    plan: Plan,
    settings: RenderSettings,
    setup: Setup,
    resources: Resources,
    batches: Vec<Batch>,
    samplers: Vec<[Sampler; 2]>,
    border: Sampler,
    clamp: Sampler,
    pipelines: Pipelines,
    slice: Option<SlicePlane>,
    /// The shadow map holds the sun's depth.
    shadowed: bool,
}

impl Renderer {
    /// Allocates and uploads what `plan` says, and nothing else.
    ///
    /// # Errors
    /// A texture that cannot be decoded, a target that the device does not have, memory.
    pub fn new(
        gpu: &Gpu,
        subject: &Subject<'_>,
        settings: &RenderSettings,
        plan: Plan,
    ) -> Result<Self> {
        let setup = Setup::new(subject, settings);
        let mut batches = batch::batches(&plan, subject, settings);
        let resources = Resources::new(gpu, &plan, subject, settings, &setup, &mut batches)?;
        let samplers = batches
            .iter()
            .map(|b| {
                Ok([
                    upload::sampler(gpu, b, settings.anisotropy)?,
                    upload::alpha_sampler(gpu, b)?,
                ])
            })
            .collect::<Result<_>>()?;
        let slice = subject
            .field
            .map(|f| SlicePlane::facing(&f, Vec3::from(setup.frame.right)));
        Ok(Self {
            gpu: gpu.clone(),
            settings: *settings,
            setup,
            resources,
            batches,
            samplers,
            border: gpu.sampler(&SamplerInfo {
                address: [AddressMode::BorderZero; 2],
                ..SamplerInfo::default()
            })?,
            clamp: gpu.sampler(&SamplerInfo {
                linear: true,
                address: [AddressMode::Clamp; 2],
                ..SamplerInfo::default()
            })?,
            pipelines: Pipelines::new(gpu, settings.samples, &plan.channels),
            plan,
            slice,
            shadowed: false,
        })
    }

    /// The plan it was made for.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Bytes of its buffers and images, as made: equal to [`Plan::bytes`].
    #[must_use]
    pub fn allocated_bytes(&self) -> u64 {
        self.resources.bytes()
    }

    /// The camera of its pictures.
    #[must_use]
    pub fn camera(&self) -> &Camera {
        &self.setup.camera
    }

    /// Shades every pixel as if the model could be seen there: the same picture, more slowly.
    /// Tells whether that was not so before.
    pub(crate) fn divide_nothing(&mut self) -> bool {
        let whole = Areas::whole(self.settings.size);
        std::mem::replace(&mut self.resources.areas, whole.clone()) != whole
    }

    /// Forgets what views share, so that the next view is drawn (and timed) whole.
    pub fn forget(&mut self) {
        self.shadowed = false;
    }

    /// Draws one of the plan's views.
    ///
    /// # Errors
    /// A view that is not in the plan, a lost device.
    pub fn render_view(&mut self, view: View) -> Result<Rendered> {
        if !self.plan.views.contains(&view) {
            return Err(Error::usage(format!("view `{view}` is not in the plan")));
        }
        if !view.is_lit() {
            let (gbuffer, passes) = self.render_channels()?;
            let picture = match view {
                View::Normals => gbuffer.normals_picture(),
                _ => gbuffer.depth_picture(),
            };
            return Ok(Rendered { picture, passes });
        }
        let needs_shadow = view.is_shadowed() && self.plan.image(label::SHADOW_MAP).is_some();
        let draws_shadow = needs_shadow && !self.shadowed;
        let mut work = self.gpu.work(QueueKind::Graphics, view.name())?;
        let frame_data = self.setup.frame_for(view, &self.settings);
        work.upload(
            label::FRAME,
            self.resources.buffer(label::FRAME),
            &[frame_data],
        )?;
        let (frame, pipelines) = self.frame();
        if draws_shadow {
            frame.declare_surface(&mut work, view);
            frame.shadow_map(&mut work, pipelines)?;
        }
        frame.surface(&mut work, pipelines, view)?;
        frame.shade(&mut work, pipelines, view)?;
        if view.needs_surface() || view.needs_field() {
            frame.overlay(&mut work, pipelines, view)?;
        }
        let pixels = work.read_image("read back", self.resources.image(label::PICTURE))?;
        let mut done = work.submit()?.wait()?;
        self.shadowed |= draws_shadow;
        Ok(Rendered {
            picture: Picture {
                width: self.settings.size[0],
                height: self.settings.size[1],
                rgba: done.take(pixels),
            },
            passes: done.passes().to_vec(),
        })
    }

    /// Draws the plan's G-buffer and reads it back.
    ///
    /// # Errors
    /// A plan without channels, a lost device.
    pub fn render_channels(&mut self) -> Result<(GBuffer, Vec<PassTime>)> {
        if self.plan.channels.is_empty() {
            return Err(Error::usage("the plan has no G-buffer channels"));
        }
        let needs_shadow = self.plan.channels.contains(&Channel::Shade)
            && self.plan.image(label::SHADOW_MAP).is_some()
            && !self.shadowed;
        let mut work = self.gpu.work(QueueKind::Graphics, label::GBUFFER_PASS)?;
        let frame_data = self.setup.frame;
        work.upload(
            label::FRAME,
            self.resources.buffer(label::FRAME),
            &[frame_data],
        )?;
        let (frame, pipelines) = self.frame();
        if needs_shadow {
            frame.shadow_map(&mut work, pipelines)?;
        }
        frame.gbuffer(&mut work, pipelines)?;
        let pending = self
            .plan
            .channels
            .iter()
            .map(|c| {
                Ok((
                    *c,
                    work.read_image(c.label(), self.resources.image(c.label()))?,
                ))
            })
            .collect::<Result<Vec<_>>>()?;
        let mut done = work.submit()?.wait()?;
        self.shadowed |= needs_shadow;
        let mut gbuffer = GBuffer::new(self.settings.size);
        for (channel, readback) in pending {
            gbuffer.decode(channel, &done.take(readback));
        }
        Ok((gbuffer, done.passes().to_vec()))
    }

    fn frame(&mut self) -> (Frame<'_>, &mut Pipelines) {
        (
            Frame {
                plan: &self.plan,
                settings: &self.settings,
                resources: &self.resources,
                batches: &self.batches,
                samplers: &self.samplers,
                border: &self.border,
                clamp: &self.clamp,
                slice: self.slice,
            },
            &mut self.pipelines,
        )
    }
}
