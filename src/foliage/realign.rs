//! Realigned normals of foliage vertices (Luft, Balzer, Deussen 2007, section 3.3).

use super::bake::Stats;
use super::implicit;
use super::recorder::{Kernel, Recorder, Store, Use};
use super::settings::NormalsMode;
use super::stages::{Scene, Sources, Vertices};
use crate::Result;
use crate::abi;
use crate::gpu::shaders::foliage as shaders;

/// Directions (unit, and 1 where there is one) of the foliage vertices in the mode of the
/// settings. Gaps are filled from the field with twice the radius.
pub(super) fn directions(
    r: &mut Recorder<'_>,
    scene: &Scene<'_>,
    sources: &Sources,
    foliage: &Vertices<'_>,
    stats: &mut Stats,
) -> Result<Store> {
    let s = scene.settings;
    if s.needs_surface() {
        return implicit::directions(r, scene, sources, foliage, stats);
    }
    let near = sources.field(s.rho, s.norm);
    let wide = sources.field(2.0 * s.rho, s.norm);
    let at = &foliage.queries;
    let near = near.at_queries(r, "field at foliage", at, abi::FIELD_GRADIENT)?;
    let wide =
        |r: &mut Recorder<'_>| wide.at_queries(r, "wide field at foliage", at, abi::FIELD_GRADIENT);
    let steps = Steps::new(r, foliage.numbers.len(), s.rho)?;
    match s.normals {
        NormalsMode::Gradient => {
            let missing = steps.run(r, abi::DIRECTIONS_SINGLE, &near, &near)?;
            if missing > 0 {
                let wide = wide(r)?;
                stats.kept_normals = steps.run(r, abi::DIRECTIONS_FILL, &wide, &wide)?;
                stats.wide_fallbacks = missing - stats.kept_normals;
            }
        }
        NormalsMode::Multiscale => {
            let wide = wide(r)?;
            stats.kept_normals = steps.run(r, abi::DIRECTIONS_MEAN, &near, &wide)?;
        }
        mode => unreachable!("{mode} is handled before the field modes"),
    }
    Ok(steps.found)
}

/// The passes that turn gradients into directions.
pub(super) struct Steps {
    count: usize,
    pub(super) found: Store,
    counters: Store,
    radius: f32,
}

impl Steps {
    pub(super) fn new(r: &mut Recorder<'_>, count: usize, radius: f32) -> Result<Self> {
        Ok(Self {
            count,
            found: r.array::<[f32; 4]>("directions", count)?,
            counters: r.array::<u32>("missing directions", 1)?,
            radius,
        })
    }

    /// Runs `directions.comp` in one of its modes; returns how many directions are missing.
    pub(super) fn run(
        &self,
        r: &mut Recorder<'_>,
        mode: u32,
        near: &Store,
        wide: &Store,
    ) -> Result<usize> {
        r.fill("clear missing", &self.counters, 0)?;
        r.compute(
            "directions",
            Kernel {
                shader: shaders::DIRECTIONS_COMP,
                constants: &[(0, mode)],
            },
            &[
                Use::Read(near),
                Use::Read(wide),
                Use::ReadWrite(&self.found),
                Use::ReadWrite(&self.counters),
            ],
            &abi::GradientDirections {
                count: self.count as u32,
                radius: self.radius,
                wide_radius: 2.0 * self.radius,
            },
            self.count,
        )?;
        Ok(r.fetch::<u32>("missing directions", &self.counters, || vec![0])?[0] as usize)
    }
}

/// Blends the directions with the vertices' own normals.
pub(super) fn normals(
    r: &mut Recorder<'_>,
    scene: &Scene<'_>,
    foliage: &Vertices<'_>,
    found: &Store,
) -> Result<Store> {
    let own: Vec<[f32; 3]> = foliage
        .numbers
        .iter()
        .map(|&v| scene.geometry.normals[v as usize].to_array())
        .collect();
    blend(r, &own, found, scene.settings.blend)
}

/// N' = normalize((1-b) N + b N_s) on the device.
pub(super) fn blend(
    r: &mut Recorder<'_>,
    own: &[[f32; 3]],
    found: &Store,
    blend: f32,
) -> Result<Store> {
    let count = own.len();
    let own = r.upload("own normals", own)?;
    let normals = r.array::<[f32; 3]>("realigned normals", count)?;
    r.compute(
        "realign",
        shaders::REALIGN_COMP,
        &[Use::Read(found), Use::Read(&own), Use::Write(&normals)],
        &abi::Realign {
            count: count as u32,
            blend,
        },
        count,
    )?;
    Ok(normals)
}
