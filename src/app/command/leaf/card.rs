//! A model of one leaf: what `KHR_materials_diffuse_transmission` can say of it.

use std::path::Path;

use crate::Result;
use crate::app::output::PendingFile;
use crate::leaf::{LeafMaterial, import};
use crate::scene::export::{self, ExportOptions};
use crate::scene::{Instance, Mesh, Model, Primitive};

/// Writes a rectangle of 10 cm height with the leaf on it; returns the file's name.
pub(super) fn write(leaf: &LeafMaterial, path: &Path) -> Result<String> {
    let file = PendingFile::create(path)?;
    let mut model = Model {
        name: leaf.name.clone(),
        ..Model::default()
    };
    let material = import::material_of_leaf(leaf, &mut model)?;
    model.materials.push(material);
    let aspect = leaf.size().map_or(1.0, |[w, h]| w as f32 / h as f32);
    let (x, y) = (0.05 * aspect, 0.1);
    model.meshes.push(Mesh {
        name: leaf.name.clone(),
        primitives: vec![Primitive {
            positions: vec![[-x, 0.0, 0.0], [x, 0.0, 0.0], [x, y, 0.0], [-x, y, 0.0]],
            normals: vec![[0.0, 0.0, 1.0]; 4],
            texcoords: vec![[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]],
            indices: vec![0, 1, 2, 0, 2, 3],
            ..Primitive::default()
        }],
    });
    model.instances.push(Instance {
        name: leaf.name.clone(),
        mesh: 0,
        local_to_world: glam::DAffine3::IDENTITY,
        source: None,
    });
    file.commit(&export::gltf(&model, &[], &ExportOptions::default())?)?;
    let name = path.file_name().unwrap_or_default();
    Ok(name.to_string_lossy().into_owned())
}
