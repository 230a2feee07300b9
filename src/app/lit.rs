//! A model as the light room sees it: triangles for rays, receivers, what materials make of light.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};

use super::cli::light::OpticsArgs;
use super::input::{Input, Source};
use crate::foliage::Split;
use crate::leaf::LeafMaterial;
use crate::leaf::import::USUAL_TRANSMISSION;
use crate::leaf::light::{ModelKey, model_key, optics_key};
use crate::leaf::optics::Optics;
use crate::leaf::rays::Occluders;
use crate::leaf::receivers::Receivers;
use crate::leaf::refine::Refined;
use crate::leaf::wear::cut_out;
use crate::scene::{Geometry, Model};
use crate::{Error, Result};

/// The leaf that each material wears, where it has maps.
pub type Worn = Vec<Option<Arc<LeafMaterial>>>;

/// A model, ready to be lit.
#[derive(Debug)]
pub struct LitModel {
    /// What was read, turned so that +y is up.
    pub model: Arc<Model>,
    /// Its triangles.
    pub geometry: Geometry,
    /// The same for rays.
    pub occluders: Occluders,
    /// Where the light of the sky and between leaves is gathered.
    pub receivers: Receivers,
    /// What each material makes of light.
    pub optics: Vec<Optics>,
    /// The leaf that a material wears, where it has maps.
    pub leaves: Worn,
}

impl LitModel {
    /// Reads and prepares `source`.
    ///
    /// # Errors
    /// Wrong input, or a model without triangles.
    pub fn new(
        source: &Source,
        textures: &[(String, std::path::PathBuf)],
        pattern: Option<&str>,
        args: &OpticsArgs,
    ) -> Result<Self> {
        let mut model = Input::load(source, textures)?.model;
        if args.up == super::cli::light::Up::Z {
            let mut turned = Arc::unwrap_or_clone(model);
            // x stays, z becomes y, y becomes -z.
            let turn = DAffine3::from_mat3(DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y));
            for instance in &mut turned.instances {
                instance.local_to_world = turn * instance.local_to_world;
            }
            model = Arc::new(turned);
        }
        let geometry = Geometry::flatten(&model);
        for warning in &geometry.warnings {
            log::warn!("{}: {warning}", model.name);
        }
        if geometry.indices.is_empty() {
            return Err(Error::usage(format!("{source}: has no triangles to light")));
        }
        let (optics, leaves) = optics(&model, &geometry, pattern, args)?;
        let model = cut_out(model, &leaves);
        let occluders = Occluders::new(&model, &geometry)?;
        let receivers = Receivers::new(&geometry, &occluders, &optics);
        Ok(Self {
            model,
            geometry,
            occluders,
            receivers,
            optics,
            leaves,
        })
    }

    /// Vertices.
    #[must_use]
    pub fn vertices(&self) -> usize {
        self.receivers.points.len()
    }

    /// The mesh for shadows, every triangle split `times` times, and its receivers.
    #[must_use]
    pub fn refined(&self, times: u32) -> (Refined, Receivers) {
        let refined = Refined::new(&self.geometry, times);
        let receivers = Receivers::new(&refined.geometry, &self.occluders, &self.optics);
        (refined, receivers)
    }

    /// The triangles that a light file must have been computed for.
    #[must_use]
    pub fn key(&self) -> ModelKey {
        model_key(&self.geometry)
    }

    /// The optics that transfer vectors must have been computed for.
    #[must_use]
    pub fn optics_key(&self) -> ModelKey {
        optics_key(&self.receivers.transfer)
    }
}

/// Optics of every material, and the leaves that they wear: those of leaves may be told on the
/// command line.
fn optics(
    model: &Model,
    geometry: &Geometry,
    pattern: Option<&str>,
    args: &OpticsArgs,
) -> Result<(Vec<Optics>, Worn)> {
    let mut leaf = vec![false; model.materials.len()];
    let mut used = leaf.clone();
    // A model without foliage by name is leaves all over.
    let parts = match Split::new(model, geometry, pattern) {
        Ok(split) => split.foliage_parts,
        Err(e) if pattern.is_some() => return Err(e),
        Err(_) => vec![true; geometry.parts.len()],
    };
    for (part, is_leaf) in geometry.parts.iter().zip(parts) {
        leaf[part.material] |= is_leaf;
        used[part.material] = true;
    }
    let named = args.leaf()?.map(Arc::new);
    let one = |((material, leaf), used): ((&crate::scene::Material, bool), bool)| {
        let mut optics = Optics::of_material(model, material)?;
        if leaf {
            if let Some(named) = &named {
                optics = Optics::of_leaf(named);
            } else if material.diffuse_transmission.is_none() {
                let share = USUAL_TRANSMISSION.map(|v| v as f32);
                optics.rho_t = [0, 1, 2].map(|c| share[c] * optics.rho_d_front[c]);
            }
            args.apply(&mut optics);
        }
        let above = optics.above_one();
        if used && above > 0 {
            log::warn!(
                "{}: material {:?}: reflectance and transmittance together are above 1 in {above} \
                 of 3 channels: scaled to 1",
                model.name,
                material.name
            );
        }
        Ok(optics)
    };
    // Numbers that are told replace those of the maps.
    let mapped = named.clone().filter(|l| l.size().is_some() && !args.told());
    let worn = leaf
        .iter()
        .map(|&is| mapped.clone().filter(|_| is))
        .collect();
    let materials = model.materials.iter().zip(leaf).zip(used);
    Ok((materials.map(one).collect::<Result<_>>()?, worn))
}
