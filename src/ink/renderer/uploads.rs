//! What of a plant lies on the device, whatever the view.

use crate::Result;
use crate::abi::InkLeaf;
use crate::gpu::{Buffer, Gpu, Image, Sampler};
use crate::ink::bodies::Bodies;
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
    /// Uploads a scene for pictures in `styles`.
    pub(super) fn new(gpu: &Gpu, scene: &InkScene<'_>, styles: &[Style]) -> Result<Self> {
        let (g, plant) = (scene.geometry, scene.plant);
        // Several styles have neither bodies nor outlines of their own.
        let style = &styles[0];
        let hatching = styles.iter().any(|s| s.hatching.strength > 0.0);
        let mut leaves = plant.records();
        if leaves.is_empty() {
            // Buffers have at least one element.
            leaves.push(InkLeaf::default());
        }
        let bodies = &plant.bodies;
        let doubled = style.bodies.smooth.then_some(&bodies.vertices[..]);
        let hatches = match doubled {
            Some(_) => body_clusters(bodies, plant.first_body_cluster),
            None => wood_hatching(g, plant, hatching),
        };
        let indices = doubled.map_or(&g.indices, |_| &bodies.indices);
        Ok(Self {
            leaves: gpu.upload("ink leaves", &leaves)?,
            positions: gpu.upload("positions", &taken(&g.positions, doubled))?,
            normals: gpu.upload("normals", &taken(&g.normals, doubled))?,
            texcoords: gpu.upload("texcoords", &taken(&g.texcoords, doubled))?,
            hatches: gpu.upload("wood hatching", &at_least_one(hatches))?,
            indices: gpu.upload("indices", &at_least_one(indices.clone()))?,
            shapes: shapes_image(gpu, plant, style)?,
            textures: material_textures(gpu, scene.model)?,
        })
    }
}

/// All of `values`, or those that `which` names.
fn taken<T: Copy + Default>(values: &[T], which: Option<&[u32]>) -> Vec<T> {
    at_least_one(match which {
        Some(which) => which.iter().map(|&v| values[v as usize]).collect(),
        None => values.to_vec(),
    })
}

fn at_least_one<T: Copy + Default>(mut values: Vec<T>) -> Vec<T> {
    if values.is_empty() {
        values.push(T::default());
    }
    values
}

/// The clusters of bodies, as the vertices of wood have their coordinates.
fn body_clusters(bodies: &Bodies, first: u32) -> Vec<[f32; 4]> {
    let of = |&c: &u32| [(first + c) as f32, 0.0, 0.0, 0.0];
    bodies.of_vertex.iter().map(of).collect()
}
