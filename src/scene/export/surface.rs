//! A bare mesh, such as the implicit surface of `umbrage surface`, as GLB.

use glam::{DAffine3, DVec3, Vec3};

use super::{ExportOptions, gltf};
use crate::scene::model::{Instance, Material, Mesh, Model, Primitive};
use crate::{Error, Result};

/// An indexed triangle mesh.
#[derive(Debug, Clone, Copy)]
pub struct SurfaceMesh<'a> {
    /// Name of node and mesh.
    pub name: &'a str,
    /// World position of the mesh's zero, metres; becomes the node's translation.
    pub origin: DVec3,
    /// Positions relative to `origin`, metres.
    pub positions: &'a [Vec3],
    /// Unit normals, one per position, or none at all.
    pub normals: &'a [Vec3],
    /// Triangle list.
    pub indices: &'a [u32],
}

/// Writes a mesh as GLB under a plain, double-sided grey material.
///
/// # Errors
/// The mesh has no triangles, a position or index is out of range, or the file passes 4 GiB.
pub fn surface(mesh: &SurfaceMesh<'_>) -> Result<Vec<u8>> {
    let n = mesh.positions.len();
    if mesh.indices.len() < 3 {
        return Err(Error::usage(format!("{} has no triangles", mesh.name)));
    }
    if let Some(k) = mesh.positions.iter().position(|p| !p.is_finite()) {
        return Err(Error::usage(format!(
            "{}: vertex {k} is not finite",
            mesh.name
        )));
    }
    if let Some(i) = mesh.indices.iter().find(|&&i| i as usize >= n) {
        return Err(Error::usage(format!(
            "{}: index {i} of {n} vertices",
            mesh.name
        )));
    }
    let arrays = |v: &[Vec3]| v.iter().map(Vec3::to_array).collect();
    let primitive = Primitive {
        positions: arrays(mesh.positions),
        normals: arrays(mesh.normals),
        indices: mesh.indices[..mesh.indices.len() / 3 * 3].to_vec(),
        ..Primitive::default()
    };
    let model = Model {
        name: mesh.name.to_owned(),
        meshes: vec![Mesh {
            name: mesh.name.to_owned(),
            primitives: vec![primitive],
        }],
        instances: vec![Instance {
            name: mesh.name.to_owned(),
            mesh: 0,
            local_to_world: DAffine3::from_translation(mesh.origin),
            source: None,
        }],
        materials: vec![Material {
            name: "surface".into(),
            base_color: [0.6, 0.6, 0.6, 1.0],
            double_sided: true,
            ..Material::default()
        }],
        ..Model::default()
    };
    gltf(&model, &[], &ExportOptions::default())
}
