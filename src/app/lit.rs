//! A model as the light room sees it: triangles for rays, receivers, what materials make of light.

use std::ops::Range;
use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};

use super::cli::light::{OpticsArgs, Up};
use super::input::{Input, PlacedPlant, Source};
use crate::foliage::Split;
use crate::leaf::LeafMaterial;
use crate::leaf::import::USUAL_TRANSMISSION;
use crate::leaf::light::{ModelKey, model_key, optics_key};
use crate::leaf::optics::Optics;
use crate::leaf::rays::Occluders;
use crate::leaf::receivers::Receivers;
use crate::leaf::refine::Refined;
use crate::leaf::wear::cut_out;
use crate::scene::scene_file::SceneFile;
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
    /// The scene file, if it was one.
    pub scene: Option<SceneFile>,
    /// The plants of a scene.
    pub plants: Vec<LitPlant>,
}

/// A plant of a scene, in one or several places.
#[derive(Debug)]
pub struct LitPlant {
    /// Its name, for messages.
    pub name: String,
    /// Its triangles, as `umbrage light` of the plant alone has them.
    pub geometry: Geometry,
    /// What its materials make of light.
    optics: Vec<Optics>,
    /// Where it stands.
    pub places: Vec<LitPlace>,
}

/// One place of a plant.
#[derive(Debug, Clone, PartialEq)]
pub struct LitPlace {
    /// From the plant's world coordinates to those of the scene.
    pub to_scene: DAffine3,
    /// Its parts of the scene's geometry; their vertices are those of the plant, in order.
    pub parts: Range<usize>,
}

impl LitPlant {
    /// The triangles that a light file must have been computed for.
    #[must_use]
    pub fn key(&self) -> ModelKey {
        model_key(&self.geometry)
    }

    /// The optics that transfer vectors must have been computed for.
    #[must_use]
    pub fn optics_key(&self) -> ModelKey {
        let sides: Vec<_> = self.optics.iter().map(Optics::transfer_sides).collect();
        optics_key(&sides)
    }
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
        Self::looked_at(source, textures, (pattern, args), |_| Ok(()))
    }

    /// The same; `look` may refuse the geometry before the work on it (the hierarchy) begins.
    ///
    /// # Errors
    /// As [`LitModel::new`], and what `look` says.
    pub fn looked_at(
        source: &Source,
        textures: &[(String, std::path::PathBuf)],
        (pattern, args): (Option<&str>, &OpticsArgs),
        look: impl FnOnce(&Geometry) -> Result<()>,
    ) -> Result<Self> {
        let input = Input::load(source, textures)?;
        let turn = y_up(args.up);
        let model = turned(input.model, &turn);
        let geometry = Geometry::flatten(&model);
        for warning in &geometry.warnings {
            log::warn!("{}: {warning}", model.name);
        }
        if geometry.indices.is_empty() {
            return Err(Error::usage(format!("{source}: has no triangles to light")));
        }
        look(&geometry)?;
        let (mut optics, leaves) = optics(&model, &geometry, pattern, args)?;
        let plants = plants(&input.plants, &geometry, &turn, |model, own| {
            Ok(self::optics(model, own, pattern, args)?.0)
        })?;
        // A plant's leaves are what they are when it stands alone.
        for (placed, plant) in &plants {
            optics[input.plants[*placed].materials.clone()].clone_from_slice(&plant.optics);
        }
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
            scene: input.scene,
            plants: plants.into_iter().map(|p| p.1).collect(),
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

/// What turns a model so that +y is up.
fn y_up(up: Up) -> DAffine3 {
    match up {
        Up::Y => DAffine3::IDENTITY,
        // x stays, z becomes y, y becomes -z.
        Up::Z => DAffine3::from_mat3(DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y)),
    }
}

fn turned(model: Arc<Model>, by: &DAffine3) -> Arc<Model> {
    if *by == DAffine3::IDENTITY {
        return model;
    }
    let mut turned = Arc::unwrap_or_clone(model);
    for instance in &mut turned.instances {
        instance.local_to_world = *by * instance.local_to_world;
    }
    Arc::new(turned)
}

/// The plants of a scene, each once, with the number of the first that is placed.
fn plants(
    placed: &[PlacedPlant],
    scene: &Geometry,
    turn: &DAffine3,
    optics: impl Fn(&Model, &Geometry) -> Result<Vec<Optics>>,
) -> Result<Vec<(usize, LitPlant)>> {
    let mut out: Vec<(usize, LitPlant)> = Vec::new();
    for (number, plant) in placed.iter().enumerate() {
        let first = |i: usize| scene.parts.partition_point(|part| part.instance < i);
        let place = LitPlace {
            to_scene: *turn * plant.to_scene * turn.inverse(),
            parts: first(plant.instances.start)..first(plant.instances.end),
        };
        let same =
            |known: &&mut (usize, LitPlant)| Arc::ptr_eq(&placed[known.0].model, &plant.model);
        match out.iter_mut().find(same) {
            Some((_, known)) => known.places.push(place),
            None => {
                let model = turned(plant.model.clone(), turn);
                let geometry = Geometry::flatten(&model);
                let known = LitPlant {
                    name: plant.name.clone(),
                    optics: optics(&model, &geometry)?,
                    geometry,
                    places: vec![place],
                };
                out.push((number, known));
            }
        }
    }
    Ok(out)
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
