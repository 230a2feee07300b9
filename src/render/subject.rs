//! What is drawn: a model, its triangles, and what a foliage bake found out about them.

use glam::Vec3;

use crate::scene::{Geometry, Model};

/// Everything the renderer is given. Borrowed: it copies what the plan needs to the device.
#[derive(Debug, Clone, Copy)]
pub struct Subject<'a> {
    /// Materials, textures and lights.
    pub model: &'a Model,
    /// Its triangles.
    pub geometry: &'a Geometry,
    /// Realigned normals and ambient coefficients; without them every view shows the model's own
    /// normals and `k_a` = 1.
    pub baked: Option<Baked<'a>>,
    /// The density grid, for [`View::Slice`](super::View::Slice).
    pub field: Option<FieldGrid<'a>>,
    /// The implicit surface, for [`View::Surface`](super::View::Surface).
    pub surface: Option<SurfaceMesh<'a>>,
}

impl<'a> Subject<'a> {
    /// A model without a bake.
    #[must_use]
    pub fn new(model: &'a Model, geometry: &'a Geometry) -> Self {
        Self {
            model,
            geometry,
            baked: None,
            field: None,
            surface: None,
        }
    }
}

/// The renderer's share of a foliage bake. Slices have one element per vertex of the geometry.
#[derive(Debug, Clone, Copy)]
pub struct Baked<'a> {
    /// Unit normals, world frame.
    pub normals: &'a [Vec3],
    /// Ambient coefficients `k_a` in \[0,1\].
    pub ambient: &'a [f32],
    /// Per part of the geometry: its normals were realigned, so back faces are not flipped.
    pub foliage_parts: &'a [bool],
}

/// Density `F + tau` at the nodes of a grid, in the geometry's frame (relative to its origin).
#[derive(Debug, Clone, Copy)]
pub struct FieldGrid<'a> {
    /// Node (0,0,0), metres relative to the geometry's origin.
    pub min: Vec3,
    /// Edge of a cell, metres.
    pub cell: f32,
    /// Nodes along x, y, z.
    pub nodes: [usize; 3],
    /// Values, x fastest.
    pub values: &'a [f32],
    /// Threshold of the implicit surface.
    pub tau: f32,
}

/// Triangles of the implicit surface, in the geometry's frame.
#[derive(Debug, Clone, Copy)]
pub struct SurfaceMesh<'a> {
    /// Metres relative to the geometry's origin.
    pub positions: &'a [Vec3],
    /// Unit outward normals.
    pub normals: &'a [Vec3],
    /// Triangle list.
    pub indices: &'a [u32],
}
