//! What a command works on: a model file, a scene file, or a plant grown on the spot.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;

use glam::DAffine3;

use super::console;
use crate::scene::grow::{self, GrowOptions, Species};
use crate::scene::import::{self, LoadOptions};
use crate::scene::scene_file::{Plant, SceneFile};
use crate::scene::{Model, Population};
use crate::{Error, Result};

/// Where a model comes from.
#[derive(Debug, Clone, PartialEq)]
pub enum Source {
    /// A glTF, GLB or OBJ file.
    File(PathBuf),
    /// A scene file (TOML).
    Scene(PathBuf),
    /// A species of the plant generator, with what differs from the defaults.
    Grown {
        /// Which plant.
        species: Species,
        /// Seed and number of leaves.
        options: GrowOptions,
    },
    /// The smooth body of the generator.
    Rabbit,
}

/// How a grown plant is written where a file is expected.
const GROWN: &str = "grow:";

impl FromStr for Source {
    type Err = Error;

    /// A path, or `grow:SPECIES[:SEED[:LEAVES]]`.
    fn from_str(text: &str) -> Result<Self> {
        let Some(rest) = text.strip_prefix(GROWN) else {
            let path = PathBuf::from(text);
            let is_scene = path
                .extension()
                .is_some_and(|e| e.eq_ignore_ascii_case("toml"));
            return Ok(if is_scene {
                Self::Scene(path)
            } else {
                Self::File(path)
            });
        };
        if rest.eq_ignore_ascii_case(grow::RABBIT) {
            return Ok(Self::Rabbit);
        }
        let wrong = || Error::usage(format!("{text}: expected grow:SPECIES[:SEED[:LEAVES]]"));
        let mut parts = rest.split(':');
        let species = Species::parse(parts.next().unwrap_or_default())?;
        let mut options = GrowOptions::default();
        if let Some(seed) = parts.next() {
            options.seed = seed.parse().map_err(|_| wrong())?;
        }
        if let Some(leaves) = parts.next() {
            options.leaves = Some(leaves.parse().map_err(|_| wrong())?);
        }
        match parts.next() {
            None => Ok(Self::Grown { species, options }),
            Some(_) => Err(wrong()),
        }
    }
}

impl Source {
    /// The files that the command line names for it.
    pub fn files<'a>(
        &'a self,
        textures: &'a [(String, PathBuf)],
    ) -> impl Iterator<Item = &'a Path> {
        let own = match self {
            Self::File(path) | Self::Scene(path) => Some(&**path),
            Self::Grown { .. } | Self::Rabbit => None,
        };
        let textures = textures.iter().map(|(_, file)| &**file);
        own.into_iter().chain(textures)
    }

    /// One model, not a scene of several.
    #[must_use]
    pub fn is_model(&self) -> bool {
        !matches!(self, Self::Scene(_))
    }
}

impl std::fmt::Display for Source {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::File(path) | Self::Scene(path) => path.display().fmt(f),
            Self::Rabbit => write!(f, "{GROWN}{}", grow::RABBIT),
            Self::Grown { species, options } => {
                write!(f, "{GROWN}{}:{}", species.name(), options.seed)?;
                options.leaves.map_or(Ok(()), |n| write!(f, ":{n}"))
            }
        }
    }
}

/// A model to work on, whatever it was made from.
#[derive(Debug)]
pub struct Input {
    /// Everything, in scene coordinates.
    pub model: Arc<Model>,
    /// The scene's plants; empty when the input is one model.
    pub plants: Vec<PlacedPlant>,
    /// The scene file, if it is one.
    pub scene: Option<SceneFile>,
}

/// A plant of a scene, before it was moved to its place.
#[derive(Debug)]
pub struct PlacedPlant {
    /// Name of its output, unique in the scene.
    pub name: String,
    /// In its own coordinates.
    pub model: Arc<Model>,
    /// From its own coordinates to the scene's.
    pub to_scene: DAffine3,
    /// Its instances in [`Input::model`].
    pub instances: Range<usize>,
    /// Its materials there.
    pub materials: Range<usize>,
}

impl Input {
    /// Reads or grows `source`. `textures` are base colour textures by material name.
    ///
    /// # Errors
    /// What reading or growing finds wrong.
    pub fn load(source: &Source, textures: &[(String, PathBuf)]) -> Result<Self> {
        let _working = console::working(format!("reading {source}"));
        let model = match source {
            Source::File(path) => read(path, textures)?,
            Source::Grown { species, options } => Model {
                // As the user wrote it, for messages.
                name: source.to_string(),
                ..grow::grow(*species, options)?
            },
            Source::Rabbit => grow::rabbit(),
            Source::Scene(path) => return Self::load_scene(path, textures),
        };
        for warning in &model.warnings {
            log::warn!("{}: {warning}", model.name);
        }
        Ok(Self {
            model: Arc::new(model),
            plants: Vec::new(),
            scene: None,
        })
    }

    fn load_scene(path: &Path, textures: &[(String, PathBuf)]) -> Result<Self> {
        if !textures.is_empty() {
            return Err(Error::file(path, "--texture: belongs into the scene file"));
        }
        let scene = SceneFile::read(path)?;
        let mut models: BTreeMap<String, Arc<Model>> = BTreeMap::new();
        let mut names: BTreeMap<String, usize> = BTreeMap::new();
        let mut plants = Vec::new();
        for (i, plant) in scene.plants.iter().enumerate() {
            // Everything but the place decides what is read.
            let key = format!(
                "{:?} {:?} {:?} {:?} {:?}",
                plant.model, plant.grow, plant.seed, plant.leaves, plant.textures
            );
            let model = match models.get(&key) {
                Some(model) => Arc::clone(model),
                None => {
                    let model = load_plant(plant)
                        .map_err(|e| Error::file(path, format!("plant {i}: {e}")))?;
                    Arc::clone(models.entry(key).or_insert(Arc::new(model)))
                }
            };
            let name = plant.name.clone().unwrap_or_else(|| model.name.clone());
            plants.push(PlacedPlant {
                name: unique(&mut names, &name),
                model,
                to_scene: plant.placement(),
                instances: 0..0,
                materials: 0..0,
            });
        }
        let placed: Vec<(&Model, DAffine3)> =
            plants.iter().map(|p| (&*p.model, p.to_scene)).collect();
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let population = Population::merge(&stem, &placed);
        let ranges = population.instances.into_iter().zip(population.materials);
        for (plant, (instances, materials)) in plants.iter_mut().zip(ranges) {
            plant.instances = instances;
            plant.materials = materials;
        }
        for warning in &population.model.warnings {
            log::warn!("{warning}");
        }
        Ok(Self {
            model: Arc::new(population.model),
            plants,
            scene: Some(scene),
        })
    }
}

fn read(path: &Path, textures: &[(String, PathBuf)]) -> Result<Model> {
    let options = LoadOptions {
        textures: textures.to_vec(),
    };
    import::load(path, &options)
}

fn load_plant(plant: &Plant) -> Result<Model> {
    if let Some(species) = &plant.grow {
        let defaults = GrowOptions::default();
        let options = GrowOptions {
            seed: plant.seed.unwrap_or(defaults.seed),
            leaves: plant.leaves,
            ..defaults
        };
        return grow::grow(Species::parse(species)?, &options);
    }
    let path = plant.model.as_deref().unwrap_or(Path::new(""));
    let textures = plant.textures.clone().into_iter().collect::<Vec<_>>();
    read(path, &textures)
}

/// `oak`, `oak-2`, `oak-3`: names that can be files side by side.
fn unique(taken: &mut BTreeMap<String, usize>, name: &str) -> String {
    let name: String = name
        .chars()
        .map(|c| if c == '/' || c == '\\' { '-' } else { c })
        .collect();
    let mut candidate = name.clone();
    loop {
        let count = taken.entry(candidate.clone()).or_insert(0);
        *count += 1;
        if *count == 1 {
            return candidate;
        }
        candidate = format!("{name}-{count}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_are_told_apart() {
        let parse = |text: &str| text.parse::<Source>();
        assert_eq!(
            parse("a/oak.glb").unwrap(),
            Source::File("a/oak.glb".into()),
            "file"
        );
        assert_eq!(
            parse("wood.TOML").unwrap(),
            Source::Scene("wood.TOML".into()),
            "scene"
        );
        let Ok(Source::Grown { species, options }) = parse("grow:shrub:7:300") else {
            panic!("a grown plant");
        };
        assert_eq!(species, Species::Shrub, "species");
        assert_eq!((options.seed, options.leaves), (7, Some(300)), "options");
        for bad in ["grow:", "grow:cactus", "grow:shrub:x", "grow:shrub:1:2:3"] {
            assert!(parse(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn names_of_plants_are_unique() {
        let mut taken = BTreeMap::new();
        let mut name = |n| unique(&mut taken, n);
        assert_eq!(
            [name("oak"), name("oak"), name("a/b")],
            ["oak", "oak-2", "a-b"],
            "names"
        );
        assert_eq!(
            [name("oak-2"), name("oak")],
            ["oak-2-2", "oak-3"],
            "no clash"
        );
    }
}
