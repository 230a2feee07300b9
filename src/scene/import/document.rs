//! glTF 2.0 and GLB: from bytes to a model.
//!
//! Container and JSON types are those of the `gltf` crate; its own reader and validation are not
//! used, since they refuse extensions that umbrage reads. Every index and size is checked at its
//! use, so that a damaged file gives a sentence and never a panic.

use std::path::Path;
use std::sync::Arc;

use serde_json::Value;

use super::accessor::Source;
use super::json::Check;
use super::{LoadOptions, container, limits, material, mesh, meshopt, nodes, numbers, overrides};
use crate::scene::extensions;
use crate::scene::gltf_document::GltfDocument;
use crate::scene::model::{Material, Model};

/// Reads a document; `path` gives the folder of its other files.
pub(super) fn read(bytes: &[u8], path: &Path, options: &LoadOptions) -> Check<Model> {
    let (mut json, bin) = container::parse(bytes)?;
    let mut warnings = extensions::check(&json)?;
    numbers::check(&mut json)?;
    let folder = path.parent().unwrap_or(Path::new("."));
    let mut buffers = container::buffers(&json, bin.as_deref(), folder)?;
    meshopt::expand(&mut json, &mut buffers)?;
    overrides::apply(&mut json, &mut buffers, &options.textures)?;
    let mut model = build(&json, &buffers, folder)?;
    warnings.append(&mut model.warnings);
    model.warnings = warnings;
    model.name = path
        .file_stem()
        .map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    model.path = Some(path.to_owned());
    model.source = Some(Arc::new(GltfDocument { json, buffers }));
    Ok(model)
}

/// The model that a document with its buffers describes.
fn build(json: &Value, buffers: &[Vec<u8>], folder: &Path) -> Check<Model> {
    let source = Source::new(json, buffers)?;
    let images = material::images(json, &source, folder)?;
    let textures = material::Textures::read(json, images.len())?;
    let mut materials = material::materials(json, &textures)?;
    let (meshes, counts) = mesh::meshes(json, &source, materials.len())?;
    if counts.default_material {
        materials.push(Material {
            metallic: 1.0,
            ..Material::default()
        });
    }
    let placed = nodes::place(json, &source, meshes.len())?;
    let mut warnings = counts.warnings();
    warnings.extend(textures.warnings);
    if placed.skinned > 0 {
        warnings.push(format!(
            "{} skinned meshes are read in their rest pose",
            placed.skinned
        ));
    }
    if placed.hidden > 0 {
        warnings.push(format!("{} hidden nodes are left out", placed.hidden));
    }
    let model = Model {
        meshes,
        instances: placed.instances,
        materials,
        textures: textures.list,
        images,
        lights: placed.lights,
        warnings,
        ..Model::default()
    };
    limits::check(&model)?;
    Ok(model)
}
