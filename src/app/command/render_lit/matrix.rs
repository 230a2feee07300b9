//! Pictures lit by transfer matrices: incident light of every vertex, and what leaves towards the
//! eye of it.

use std::time::Instant;

use glam::Vec3;

use super::Job;
use crate::abi::Receiver;
use crate::app::cli::light::{Lighting, RenderTransfer, SkyGloss};
use crate::app::relight::Relight;
use crate::leaf::gloss_view::GlossPass;
use crate::leaf::levels::Level;
use crate::leaf::light::Lighting as Lights;
use crate::leaf::matrix::{StoredMatrices, diffuse};
use crate::{Error, Result};

/// Incident light of the vertices that have matrices.
struct Incident {
    level: Level,
    receivers: Vec<Receiver>,
    order: u32,
    /// In the frames of normals.
    light: Vec<[f32; 3]>,
}

impl Job<'_> {
    /// Light besides the sun's direct one by matrices, where they are wanted and there: with vectors,
    /// which are exact for diffuse leaves, only the gloss of the surroundings is theirs.
    pub(super) fn by_matrices(&mut self, lighting: Lighting) -> Result<Option<Vec<[f32; 3]>>> {
        let light = self.relight.as_ref().and_then(Relight::whole);
        let stored = light.and_then(|l| l.matrices.as_ref());
        let vectors = light.is_some_and(|l| !l.transfer.is_empty());
        let Some(stored) = stored.filter(|_| self.args.transfer != RenderTransfer::Vector) else {
            if self.args.transfer == RenderTransfer::Matrix {
                return Err(Error::usage(
                    "--transfer matrix: needs --light FILE with transfer matrices; `umbrage light \
                     --transfer matrix` makes it",
                ));
            }
            return Ok(None);
        };
        let mixed = vectors && self.args.transfer == RenderTransfer::Auto;
        if !mixed && !self.film.lamps.is_empty() {
            return Err(Error::usage(
                "--lamp: matrices know distant light alone; `umbrage light --transfer both` also \
                 computes the vectors that lamps need",
            ));
        }
        self.same_leaves()?;
        let start = Instant::now();
        let incident = self.incident(stored, lighting)?;
        let milliseconds = 1e3 * start.elapsed().as_secs_f64();
        self.timings.add("incident light", "cpu", milliseconds);
        let mut sum = if mixed {
            self.by_vectors(lighting)?
        } else {
            let materials = &self.lit.receivers.materials;
            incident.spread(diffuse(
                &incident.light,
                incident.order,
                &incident.receivers,
                materials,
            ))
        };
        let gloss = self.gloss(&incident)?;
        for (sum, gloss) in sum.iter_mut().zip(gloss) {
            // What rings below 0 is clamped in the sum.
            *sum = (Vec3::from(*sum) + Vec3::from(gloss))
                .max(Vec3::ZERO)
                .to_array();
        }
        Ok(Some(sum))
    }

    fn incident(&self, stored: &StoredMatrices, lighting: Lighting) -> Result<Incident> {
        let level = Level::new(&self.lit.geometry, stored.edge);
        if level.vertices != stored.receivers() {
            return Err(Error::usage(
                "--light: has another level of detail than the model gives",
            ));
        }
        let all = &self.lit.receivers.points;
        let receivers = match &level.lod {
            Some(lod) => lod.coarse.iter().map(|&v| all[v as usize]).collect(),
            None => all.clone(),
        };
        let lights = Lights {
            sky: &self.film.sky.coefficients(),
            sun: &self.film.sun.coefficients(self.args.window),
            direct_sun: lighting == Lighting::Prt,
            order: self.args.order as usize,
        };
        Ok(Incident {
            light: stored.incident(&lights, &receivers),
            order: stored.order,
            level,
            receivers,
        })
    }

    /// Surroundings in the glossy reflection of every side.
    fn gloss(&mut self, incident: &Incident) -> Result<Vec<[f32; 3]>> {
        match self.args.sky_gloss {
            SkyGloss::Lobe => {}
            SkyGloss::Diffuse => return Ok(incident.spread(self.diffuse_gloss(incident))),
            SkyGloss::None => return Ok(vec![[0.0; 3]; 2 * self.lit.vertices()]),
        }
        let (light, order) = (&incident.light[..], incident.order);
        let optics = &self.lit.optics;
        let pass = GlossPass::new(self.gpu, &incident.receivers, (light, order), optics)?;
        let eye = self.film.camera.eye - self.lit.geometry.origin;
        let eye = f64::from(self.lit.occluders.scale) * eye;
        let (own, times) = pass.view(eye.as_vec3())?;
        self.timings.add_passes(&times);
        Ok(incident.spread(own))
    }

    /// The same as if gloss were diffuse reflection.
    fn diffuse_gloss(&self, incident: &Incident) -> Vec<[f32; 3]> {
        let materials = self.lit.receivers.gloss_as_diffuse();
        diffuse(
            &incident.light,
            incident.order,
            &incident.receivers,
            &materials,
        )
    }
}

impl Incident {
    /// Radiance of both sides of every vertex, from that of the level's own.
    fn spread(&self, own: Vec<[f32; 3]>) -> Vec<[f32; 3]> {
        self.level.spread(own)
    }
}
