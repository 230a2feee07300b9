//! What of a plant lies on the device, whatever the view.

use crate::Result;
use crate::gpu::{Buffer, Gpu, Image, Sampler};
use crate::ink::images::{material_textures, shapes_image, wood_hatching};
use crate::ink::renderer::InkScene;
use crate::ink::style::Style;

/// Leaves, wood, their shapes and textures.
pub(super) struct Uploads {
    pub(super) leaves: Buffer,
    pub(super) positions: Buffer,
    pub(super) normals: Buffer,
    pub(super) texcoords: Buffer,
    pub(super) hatches: Buffer,
    pub(super) indices: Buffer,
    pub(super) shapes: Image,
    pub(super) textures: Vec<(Image, Sampler)>,
}

impl Uploads {
    /// Uploads a scene for pictures in `style`.
    pub(super) fn new(gpu: &Gpu, scene: &InkScene<'_>, style: &Style) -> Result<Self> {
        let g = scene.geometry;
        let hatching = style.hatching.strength > 0.0;
        Ok(Self {
            leaves: gpu.upload("ink leaves", &scene.plant.records(style.seed))?,
            positions: gpu.upload("positions", &g.positions)?,
            normals: gpu.upload("normals", &g.normals)?,
            texcoords: gpu.upload("texcoords", &g.texcoords)?,
            hatches: gpu.upload("wood hatching", &wood_hatching(g, scene.plant, hatching))?,
            indices: gpu.upload("indices", &g.indices)?,
            shapes: shapes_image(gpu, scene.plant)?,
            textures: material_textures(gpu, scene.model)?,
        })
    }
}
