//! Writing models as GLB: the source document with a bake added, or a fresh document.
//!
//! The Khronos validator reports no errors on what is written from valid input
//! (`tests/validator`).

mod bake;
mod fresh;
mod in_place;
mod materials;
mod placement;
mod surface;
mod writer;

use glam::Vec3;

use super::geometry::Geometry;
use super::model::Model;
use crate::Result;

pub use surface::{SurfaceMesh, surface};

/// How a bake is written into a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ExportOptions {
    /// Write the ambient coefficient as the vertex attribute `_AMBIENT` (one float).
    pub ambient_attribute: bool,
    /// Write it into one channel of `COLOR_0`; the other channels keep the file's colours, or
    /// are 1. Engines that multiply the base colour by `COLOR_0` will see it.
    pub color_channel: Option<Channel>,
    /// Write it as an occlusion texture: a ramp image shared by all materials, addressed by a
    /// texture coordinate set that holds the coefficient. Interpolation across a triangle is
    /// then exact, which an atlas of one texel per vertex cannot give.
    pub occlusion_texture: bool,
    /// What happens to the backs of foliage.
    pub back_faces: BackFaces,
}

impl Default for ExportOptions {
    fn default() -> Self {
        Self {
            ambient_attribute: true,
            color_channel: None,
            occlusion_texture: false,
            back_faces: BackFaces::Unflipped,
        }
    }
}

/// A channel of `COLOR_0`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channel {
    /// Red.
    R,
    /// Green.
    G,
    /// Blue.
    B,
    /// Alpha.
    A,
}

/// How the backs of double-sided foliage are to be lit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BackFaces {
    /// With the realigned normals as they are: foliage materials are marked in their `extras`
    /// (`umbrage_keep_normals_on_back_faces`), since glTF has no such flag.
    #[default]
    Unflipped,
    /// With flipped normals, as glTF says for double-sided materials: no mark.
    Flipped,
    /// With the realigned normals in every glTF viewer: each foliage triangle is written twice,
    /// the second one reversed with the same vertices, under a single-sided material.
    Duplicate,
}

/// The bake of one primitive of one instance.
#[derive(Debug, Clone, Default)]
pub struct BakedPart {
    /// Index into [`Model::instances`].
    pub instance: usize,
    /// Index into the primitives of the instance's mesh.
    pub primitive: usize,
    /// Unit normals in world coordinates, one per vertex; `None` leaves the file's normals.
    pub normals: Option<Vec<Vec3>>,
    /// Ambient coefficient in \[0,1\] per vertex; `None` writes none.
    pub ambient: Option<Vec<f32>>,
    /// The part is foliage: [`ExportOptions::back_faces`] applies to it.
    pub foliage: bool,
}

impl BakedPart {
    /// Cuts results for all vertices of a geometry into its parts. Only foliage parts
    /// (`foliage_parts`, one entry per part) get new normals; every part gets its ambient.
    #[must_use]
    pub fn split(
        geometry: &Geometry,
        normals: &[Vec3],
        ambient: &[f32],
        foliage_parts: &[bool],
    ) -> Vec<Self> {
        let parts = geometry.parts.iter().zip(foliage_parts);
        parts
            .map(|(part, &foliage)| Self {
                instance: part.instance,
                primitive: part.primitive,
                normals: foliage.then(|| normals[part.vertices()].to_vec()),
                ambient: Some(ambient[part.vertices()].to_vec()),
                foliage,
            })
            .collect()
    }
}

/// Writes `model` with a bake as GLB.
///
/// A model read from glTF keeps everything that the bake does not change: its document is
/// edited. A mesh placed several times is written once per placement (the accessors that the
/// bake leaves alone are shared), and instances of `EXT_mesh_gpu_instancing` become nodes.
/// The same input always gives the same bytes.
///
/// # Errors
/// The file would be larger than the 4 GiB a GLB can hold, or an image cannot be encoded.
///
/// # Panics
/// A part of `baked` does not fit `model`.
pub fn gltf(model: &Model, baked: &[BakedPart], options: &ExportOptions) -> Result<Vec<u8>> {
    let (document, places) = match &model.source {
        Some(document) => (document.clone(), placement::Places::of_source(model)),
        None => fresh::document(model)?,
    };
    let mut output = writer::Output::new(&document);
    output.embed_images(model);
    bake::apply(&mut output, &document, model, baked, &places, options);
    output.finish()
}
