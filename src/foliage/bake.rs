//! The foliage bake: from a geometry and its split to normals and ambient coefficients.

use glam::Vec3;

use super::recorder::{PlannedResource, Progress, Recorder};
use super::settings::Settings;
use super::split::Split;
use super::stages;
use crate::Result;
use crate::gpu::{Gpu, PassTime};
use crate::scene::{Geometry, Model};

/// Per-vertex results of a bake.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Bake {
    /// Unit normal per vertex of the geometry, world frame; covered vertices keep their own.
    pub normals: Vec<Vec3>,
    /// Ambient coefficient k_a in \[0,1\] per vertex.
    pub ambient: Vec<f32>,
    /// Per part of the geometry: whether it is foliage.
    pub foliage_parts: Vec<bool>,
    /// Normal and coefficient in the form that the settings name, in words; empty for `none`.
    pub encoded: Vec<u32>,
    /// What was found on the way.
    pub stats: Stats,
}

/// What a bake found.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stats {
    /// Vertices whose normals were realigned.
    pub foliage_vertices: usize,
    /// Vertices that got an ambient coefficient only.
    pub covered_vertices: usize,
    /// Generators used.
    pub generators: usize,
    /// Diagonal of the foliage box, metres: the unit of all relative lengths.
    pub diagonal: f64,
    /// Threshold of the surface's field, where there is one.
    pub tau: f32,
    /// Threshold of the ambient field.
    pub tau_ambient: f32,
    /// Density beyond the threshold from which on equation 4 is `k_min`.
    pub d_min: f32,
    /// Vertices of the implicit surface.
    pub surface_vertices: usize,
    /// Triangles of the implicit surface.
    pub surface_triangles: usize,
    /// Vertices whose gradient was too small, so that twice the radius was used.
    pub wide_fallbacks: usize,
    /// Vertices that kept their own normal because there was no direction at all.
    pub kept_normals: usize,
    /// Vertices of mode `exact` that had not come to rest after the most steps.
    pub unsettled_normals: usize,
}

/// Passes and memory of a bake, known before it runs.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Recipe {
    /// Labels of the passes, in order; dispatches of one label in a row are one pass.
    pub passes: Vec<String>,
    /// Buffers and images, in the order of allocation.
    pub resources: Vec<PlannedResource>,
}

impl Recipe {
    /// Lists what a bake would run and allocate, without a device.
    ///
    /// # Errors
    /// As [`Bake::compute`], as far as no device is needed.
    pub fn new(geometry: &Geometry, split: &Split, settings: &Settings) -> Result<Self> {
        let mut silent = |_: &str, _: f32| {};
        let mut r = Recorder::new(None, &mut silent);
        stages::bake(&mut r, None, geometry, split, settings)?;
        Ok(Self {
            passes: r.passes,
            resources: r.resources,
        })
    }

    /// Sum of all bytes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.resources.iter().map(|r| r.bytes).sum()
    }
}

/// A bake with what it ran.
#[derive(Debug, Clone)]
pub struct Baked {
    /// The result.
    pub bake: Bake,
    /// What ran and what was allocated.
    pub recipe: Recipe,
    /// Device time of every pass, in order.
    pub times: Vec<PassTime>,
}

impl Bake {
    /// Bakes the foliage of `geometry`, which is `model` flattened, on the compute queue. Only what
    /// the settings require is allocated, decoded and run.
    ///
    /// # Errors
    /// Settings outside their range; a grid over the memory bound; a buffer over the device's
    /// limits; an alpha texture that cannot be decoded; a lost device.
    pub fn compute(
        gpu: &Gpu,
        model: &Model,
        geometry: &Geometry,
        split: &Split,
        settings: &Settings,
        progress: Progress<'_>,
    ) -> Result<Baked> {
        let mut r = Recorder::new(Some(gpu), progress);
        let bake = stages::bake(&mut r, Some(model), geometry, split, settings)?;
        if bake.stats.kept_normals > 0 {
            log::warn!(
                "{} of {} foliage vertices keep their own normal: the field has no direction there",
                bake.stats.kept_normals,
                bake.stats.foliage_vertices
            );
        }
        if bake.stats.unsettled_normals > 0 {
            log::warn!(
                "{} of {} foliage vertices have not come to rest on the surface: their normals are \
                 those of the last of {} steps",
                bake.stats.unsettled_normals,
                bake.stats.foliage_vertices,
                crate::abi::EXACT_DESCENT_STEPS
            );
        }
        Ok(Baked {
            bake,
            recipe: Recipe {
                passes: r.passes,
                resources: r.resources,
            },
            times: r.times,
        })
    }
}
