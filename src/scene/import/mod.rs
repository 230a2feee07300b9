//! Reading models: glTF 2.0, GLB and Wavefront OBJ, told apart by their content.

pub(in crate::scene) mod accessor;
mod container;
mod document;
pub(in crate::scene) mod json;
mod limits;
pub(in crate::scene) mod material;
mod mesh;
mod meshopt;
mod mtl;
pub(in crate::scene) mod nodes;
mod numbers;
mod obj;
mod obj_materials;
mod overrides;
pub(crate) mod polygon;
mod texture_search;

use std::path::{Path, PathBuf};

use super::model::Model;
use crate::{Error, Result};

/// What the user may say about a file.
#[derive(Debug, Clone, Default)]
pub struct LoadOptions {
    /// Base colour textures by material name (`--texture MATERIAL=FILE`).
    pub textures: Vec<(String, PathBuf)>,
}

/// Reads the model in `path`.
///
/// # Errors
/// [`Error::File`] that names the file, the object inside it and the reason.
pub fn load(path: impl AsRef<Path>, options: &LoadOptions) -> Result<Model> {
    let path = path.as_ref();
    let bytes = std::fs::read(path).map_err(|e| Error::file(path, format!("cannot read: {e}")))?;
    from_bytes(&bytes, path, options)
}

/// Reads a model that is in memory already. `path` names it in messages, and its folder is
/// where the other files of the model are looked for.
///
/// # Errors
/// As [`load`].
pub fn from_bytes(bytes: &[u8], path: impl AsRef<Path>, options: &LoadOptions) -> Result<Model> {
    let path = path.as_ref();
    let is_obj = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("obj"));
    let model = if container::is_glb(bytes) || container::is_json(bytes) {
        document::read(bytes, path, options)
    } else if is_obj {
        obj::read(bytes, path, options)
    } else if bytes.is_empty() {
        Err("the file is empty".into())
    } else {
        Err("is neither glTF (JSON or GLB) nor a Wavefront OBJ".into())
    };
    model.map_err(|reason| Error::file(path, reason))
}
