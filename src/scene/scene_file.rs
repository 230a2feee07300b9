//! Scene files: plants with their places, and settings of the picture and the foliage, as TOML.
//!
//! ```toml
//! foliage_pattern = "leaf|crown" # as --foliage says it
//!
//! [picture]                    # any picture setting that `umbrage settings` lists
//! camera = "25,7"
//! sun = "-30,48"
//!
//! [foliage]                    # any foliage setting
//! cells = 64
//!
//! [[plants]]
//! model = "oak.glb"            # beside the scene file
//! name = "old-oak"             # of the baked file
//! textures = { Bark = "bark.jpg" }
//! at = [0.0, 0.0, 0.0]         # metres
//!
//! [[plants]]
//! grow = "shrub"               # a species of `umbrage grow`
//! seed = 7
//! leaves = 2000
//! at = [3.0, 0.0, 1.0]
//! yaw = 40.0                   # degrees about +y
//! scale = 1.5
//! ```

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use glam::{DAffine3, DQuat, DVec3};
use serde::Deserialize;

use crate::{Error, Result};

/// A scene as its file says it; unknown keys are errors.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// The file itself, for messages.
    #[serde(skip)]
    pub path: PathBuf,
    /// Which materials and nodes are foliage, as `--foliage` says it.
    pub foliage_pattern: Option<String>,
    /// Settings of the picture by name.
    #[serde(default)]
    pub picture: BTreeMap<String, Scalar>,
    /// Foliage settings by name.
    #[serde(default)]
    pub foliage: BTreeMap<String, Scalar>,
    /// What stands where; at least one.
    pub plants: Vec<Plant>,
}

/// The value of a setting.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum Scalar {
    /// `true` or `false`.
    Bool(bool),
    /// A whole number.
    Integer(i64),
    /// Any other number.
    Float(f64),
    /// A word.
    Text(String),
}

impl std::fmt::Display for Scalar {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Bool(v) => v.fmt(f),
            Self::Integer(v) => v.fmt(f),
            Self::Float(v) => v.fmt(f),
            Self::Text(v) => v.fmt(f),
        }
    }
}

/// A placed plant: exactly one of `model` and `grow`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plant {
    /// Name of the baked file; the model's own when absent.
    pub name: Option<String>,
    /// Model file; relative to the scene file.
    pub model: Option<PathBuf>,
    /// Species of the plant generator.
    pub grow: Option<String>,
    /// Seed of the generator.
    pub seed: Option<u64>,
    /// Number of leaves of the generator.
    pub leaves: Option<u32>,
    /// Textures by material, for models that name none; relative to the scene file.
    #[serde(default)]
    pub textures: BTreeMap<String, PathBuf>,
    /// Where it stands, metres.
    #[serde(default)]
    pub at: [f64; 3],
    /// Turn about +y, degrees.
    #[serde(default)]
    pub yaw: f64,
    /// Uniform scale, above 0.
    #[serde(default = "one")]
    pub scale: f64,
}

fn one() -> f64 {
    1.0
}

impl Plant {
    /// From the plant's own coordinates to the scene's.
    #[must_use]
    pub fn placement(&self) -> DAffine3 {
        DAffine3::from_scale_rotation_translation(
            DVec3::splat(self.scale),
            DQuat::from_rotation_y(self.yaw.to_radians()),
            self.at.into(),
        )
    }
}

impl SceneFile {
    /// Reads `path`.
    ///
    /// # Errors
    /// The file cannot be read, is no TOML, holds an unknown key or a value out of range.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).map_err(|e| Error::file(path, e))?;
        Self::parse(&text, path)
    }

    /// The scene itself and the files that it names.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        std::iter::once(&*self.path).chain(self.plants.iter().flat_map(|plant| {
            let files = plant.model.iter().chain(plant.textures.values());
            files.map(|file| &**file)
        }))
    }

    /// Parses the text of `path`; relative paths become relative to its folder.
    ///
    /// # Errors
    /// As [`SceneFile::read`].
    pub fn parse(text: &str, path: &Path) -> Result<Self> {
        let mut scene: Self = toml::from_str(text).map_err(|e| {
            let line = e
                .span()
                .map_or(1, |s| 1 + text[..s.start].matches('\n').count());
            Error::file(path, format!("line {line}: {}", e.message()))
        })?;
        path.clone_into(&mut scene.path);
        if scene.plants.is_empty() {
            return Err(Error::file(path, "plants: there is none"));
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        for (i, plant) in scene.plants.iter_mut().enumerate() {
            check(plant).map_err(|reason| Error::file(path, format!("plant {i}: {reason}")))?;
            let files = plant.model.iter_mut().chain(plant.textures.values_mut());
            files.for_each(|file| *file = folder.join(&*file));
        }
        Ok(scene)
    }
}

fn check(plant: &Plant) -> Result<(), String> {
    if plant.model.is_some() == plant.grow.is_some() {
        return Err("needs either `model` or `grow`".into());
    }
    if plant.grow.is_none() && (plant.seed.is_some() || plant.leaves.is_some()) {
        return Err("`seed` and `leaves` belong to `grow`".into());
    }
    if !(plant.scale > 0.0 && plant.scale.is_finite()) {
        return Err(format!("scale {}: must be above 0", plant.scale));
    }
    if !plant.yaw.is_finite() || plant.at.iter().any(|v| !v.is_finite()) {
        return Err("at, yaw: must be finite".into());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<SceneFile> {
        SceneFile::parse(text, Path::new("wood/scene.toml"))
    }

    #[test]
    fn a_whole_scene_is_read() {
        let scene = parse(
            "foliage_pattern = 'leaf'\n[picture]\ncamera = '25,7'\n[foliage]\ncells = 64\nnormals = 'open'\n\
             [[plants]]\nmodel = 'oak.glb'\nat = [1, 2, 3]\nyaw = 90\nscale = 2\n\
             [[plants]]\ngrow = 'shrub'\nseed = 3\n",
        )
        .unwrap();
        assert_eq!(scene.picture["camera"].to_string(), "25,7", "camera");
        assert_eq!(scene.foliage["cells"].to_string(), "64", "settings");
        let oak = &scene.plants[0];
        assert_eq!(
            oak.model.as_deref(),
            Some(Path::new("wood/oak.glb")),
            "beside the scene"
        );
        let moved = oak.placement().transform_point3(DVec3::Z);
        assert!(moved.distance(DVec3::new(3.0, 2.0, 3.0)) < 1e-12, "{moved}");
        assert_eq!(scene.plants[1].scale, 1.0, "default scale");
    }

    #[test]
    fn errors_name_file_place_and_reason() {
        for (text, expected) in [
            ("plants = []", "plants"),
            ("[[plants]]\nmodle = 'x'", "line 2: unknown field `modle`"),
            ("[[plants]]\nat = [0, 0, 0]", "plant 0: needs either"),
            (
                "[[plants]]\nmodel = 'a'\ngrow = 'b'",
                "plant 0: needs either",
            ),
            ("[[plants]]\nmodel = 'a'\nseed = 1", "`seed`"),
            ("[[plants]]\ngrow = 'b'\nscale = 0", "scale 0"),
            ("[[plants]]\ngrow = 'b'\nat = [nan, 0, 0]", "finite"),
            ("plants = 3 4", "line 1"),
        ] {
            let error = parse(text).expect_err(text).to_string();
            assert!(error.starts_with("wood/scene.toml: "), "{error}");
            assert!(error.contains(expected), "{expected:?} in {error:?}");
        }
    }
}
