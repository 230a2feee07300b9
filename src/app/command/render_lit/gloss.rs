//! What rays of gloss meet in lit pictures.

use super::Job;
use crate::Result;
use crate::app::cli::light::{Lighting, RenderTransfer, SkyGloss};
use crate::app::relight::Relight;
use crate::leaf::gloss_rays::GlossRays;
use crate::leaf::lamp_transfer::seen;
use crate::leaf::leaving::add_direct;
use crate::leaf::lvc::{Lvc, LvcSettings};
use crate::leaf::rays::RayScene;

impl Job<'_> {
    /// Whether rays bring the gloss of the surroundings: leaves have some, and the light of the
    /// vertices holds it as diffuse.
    fn gloss_by_rays(&self, lighting: Lighting) -> bool {
        let by_transfer = matches!(
            lighting,
            Lighting::Leaf | Lighting::Prt | Lighting::ShadowPrt
        );
        let shines = |material: usize| self.lit.optics[material].rho_s.iter().any(|&v| v > 0.0);
        let parts = &self.lit.geometry.parts;
        let relight = self.relight.as_ref();
        let matrices = relight
            .and_then(Relight::whole)
            .is_some_and(|light| light.matrices.is_some());
        let diffuse = if matrices && self.args.transfer != RenderTransfer::Vector {
            self.args.sky_gloss == SkyGloss::Diffuse
        } else {
            relight.is_some_and(Relight::gloss_is_diffuse)
        };
        let glossy = parts.iter().any(|part| shines(part.material));
        self.args.gloss_rays > 0 && by_transfer && diffuse && glossy
    }

    /// Light that leaves the vertices of the traced mesh: `radiance` and direct light as diffuse ones.
    /// Nothing where no ray asks for it. `visibility` of the sun and of lamps is that of the drawn mesh.
    pub(super) fn leaving(
        &mut self,
        lighting: Lighting,
        mut radiance: Vec<[f32; 3]>,
        (sun, lamps): (&[f32], &[Vec<f32>]),
    ) -> Result<Vec<[f32; 3]>> {
        if !self.gloss_by_rays(lighting) {
            return Ok(Vec::new());
        }
        if self.gloss.is_none() {
            let (gpu, scene, sky) = (self.gpu, self.traced(), &self.film.sky);
            self.gloss = Some(GlossRays::new(gpu, &scene, sky)?);
        }
        // Transfer alone holds direct light too.
        if lighting == Lighting::Prt {
            return Ok(radiance);
        }
        let sun = match lighting {
            Lighting::ShadowPrt => self.sun_of_vertices()?,
            _ => self.refined.to_coarse(sun),
        };
        let light = self.film.sun;
        let receivers = &self.lit.receivers;
        add_direct(&mut radiance, receivers, &sun, |_| {
            (light.towards, light.irradiance)
        });
        for (lamp, visibility) in self.film.lamps.iter().zip(lamps) {
            let visibility = self.refined.to_coarse(visibility);
            let geometry = &self.lit.geometry;
            let place = |i: usize| geometry.origin + geometry.positions[i].as_dvec3();
            add_direct(&mut radiance, receivers, &visibility, |i| {
                seen(lamp, place(i))
            });
        }
        Ok(radiance)
    }

    /// What each vertex of the traced mesh sees of the sun, where the picture takes a shadow map.
    fn sun_of_vertices(&mut self) -> Result<Vec<f32>> {
        let settings = LvcSettings {
            radius_degrees: self.film.sun.radius_degrees,
            ..LvcSettings::default()
        };
        let (gpu, lit, film) = (self.gpu, self.lit, &self.film);
        let bytes = self.timings.measure("sun map", || {
            let scene = RayScene::new(gpu, &lit.occluders)?;
            Lvc::new(gpu, &scene, &lit.receivers, settings)?
                .shaped(&film.sun_shape)?
                .maps(&[film.sun.towards.as_vec3().to_array()])
        })?;
        Ok(bytes.iter().map(|&b| f32::from(b) / 255.0).collect())
    }
}
