//! The sun's view of particles and stems, and how deep pixels lie in its shadow.

use std::sync::{Mutex, PoisonError};

use glam::Vec3;

use super::eye::Eye;
use super::particles::unit;
use super::style::PaperStyle;
use crate::Result;
use crate::abi::{InkFrame, PaperParticle, PaperSunlit};
use crate::gpu::shaders::ink as shaders;
use crate::gpu::{Buffer, BufferInfo, ComputePipeline, Format, Gpu, Image, ImageInfo};
use crate::ink::view::View;
use crate::scene::{Geometry, LightView};

/// Texels along the sun's map.
const SIZE: u32 = 1024;

/// What shadows take, only where a style has them.
pub(super) struct SunMap {
    pub(super) frame: Buffer,
    pub(super) foliage: [Image; 2],
    pub(super) stems: [Image; 2],
    pub(super) shadow: Image,
    pub(super) kernel: ComputePipeline,
    depth: Image,
    /// What the map shows: the sun's direction, and the particles as it sees them.
    shown: Mutex<Option<Shown>>,
}

type Shown = (Vec3, Vec<PaperParticle>);

/// The particles as the sun sees them: where a camera stands matters only where primitives turn
/// with the view.
fn as_seen(particles: &[PaperParticle], turning: bool) -> Vec<PaperParticle> {
    let one = |p: &PaperParticle| PaperParticle {
        row: 0.0,
        tilt: if turning { p.tilt } else { [0.0; 2] },
        ..*p
    };
    particles.iter().map(one).collect()
}

impl SunMap {
    /// For pictures of `size` pixels.
    pub(super) fn new(gpu: &Gpu, size: [u32; 2]) -> Result<Self> {
        let target = |name: &str, format| gpu.image(ImageInfo::target(name, format, [SIZE; 2], 1));
        Ok(Self {
            frame: gpu.buffer(BufferInfo::device(
                "sun frame",
                size_of::<InkFrame>() as u64,
            ))?,
            foliage: [
                target("sun foliage", Format::R32Float)?,
                target("sun foliage number", Format::R32Float)?,
            ],
            stems: [
                target("sun stems", Format::R32Float)?,
                target("sun stem normal", Format::Rgba16Float)?,
            ],
            shadow: gpu.image(ImageInfo::storage("shadow", Format::R32Float, size))?,
            kernel: gpu.compute_pipeline(shaders::SUNLIT_COMP)?,
            depth: target("sun depth test", Format::Depth32)?,
            shown: Mutex::new(None),
        })
    }

    /// Whether the map shows these particles from this sun already; otherwise it shows nothing
    /// that counts until [`SunMap::rests`]. `turning`: primitives turn with the view.
    pub(super) fn shows(&self, view: &View, particles: &[PaperParticle], turning: bool) -> bool {
        let mut shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner);
        let same = shown.as_ref().is_some_and(|(to_sun, drawn)| {
            *to_sun == view.to_sun && *drawn == as_seen(particles, turning)
        });
        if !same {
            *shown = None;
        }
        same
    }

    /// The map was drawn.
    pub(super) fn rests(&self, view: &View, particles: &[PaperParticle], turning: bool) {
        let mut shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner);
        if shown.is_none() {
            *shown = Some((view.to_sun, as_seen(particles, turning)));
        }
    }

    /// The sun as an eye, and its frame.
    pub(super) fn eye(&self, geometry: &Geometry, view: &View) -> (Eye<'_>, InkFrame) {
        let to_sun = view.to_sun.as_dvec3();
        let light = LightView::fit(to_sun, geometry.positions.iter().copied(), SIZE, 8);
        let forward = -view.to_sun;
        let hint = if forward.y.abs() > 0.999 {
            Vec3::Z
        } else {
            Vec3::Y
        };
        let right = forward.cross(hint).normalize();
        let middle = 0.5 * (geometry.min + geometry.max);
        // Before everything, so that all depths are above 0.
        let eye = middle + view.to_sun * (geometry.max - geometry.min).length();
        let frame = InkFrame {
            relative_to_clip: light.relative_to_clip.to_cols_array_2d(),
            eye: eye.to_array(),
            forward: forward.to_array(),
            right: right.to_array(),
            up: right.cross(forward).to_array(),
            to_sun: view.to_sun.to_array(),
            width: SIZE,
            height: SIZE,
            ..InkFrame::default()
        };
        let eye = Eye {
            name: ["sun foliage", "sun stems"],
            frame: &self.frame,
            foliage: &self.foliage,
            stems: &self.stems,
            depth: &self.depth,
            extent: [SIZE; 2],
        };
        (eye, frame)
    }

    pub(super) fn push(
        &self,
        style: &PaperStyle,
        (size, leaves): ([u32; 2], usize),
        view: &View,
    ) -> PaperSunlit {
        let unit = unit(view);
        PaperSunlit {
            width: size[0],
            height: size[1],
            map_size: SIZE,
            reach: style.shadow.reach,
            bias: (style.shadow.bias * unit) as f32,
            softness: (style.shadow.softness * unit) as f32,
            leaves: leaves as u32,
            ground_bias: (style.ground.bias * unit) as f32,
            ground_softness: (style.ground.softness * unit) as f32,
        }
    }
}
