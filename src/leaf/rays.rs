//! A model's triangles as rays meet them on the device.
//!
//! Kernels see positions divided by the diagonal of the geometry, about its centre, so that a
//! change of scale or place changes nothing they compute.

use glam::Vec3;

use super::cutouts::Cutouts;
use crate::abi::{RAY_COLUMN_BITS, RAY_MASKED_TEXELS, RAY_QUAD_TEXELS, RAY_STACK};
use crate::gpu::{Format, Gpu, Image, ImageInfo, QueueKind};
use crate::math::quads::{self, Quad};
use crate::math::sah::Bounds;
use crate::math::wide_bvh::{Texel, WideBvh};
use crate::scene::{Geometry, Model, Part};
use crate::{Error, Result};

/// Triangles of a model in the form of the kernels, on the host.
#[derive(Debug, Clone)]
pub struct Occluders {
    /// Corners in units of the diagonal.
    pub positions: Vec<Vec3>,
    /// Three a triangle.
    pub indices: Vec<u32>,
    /// Metres to units of the diagonal.
    pub scale: f32,
    /// The hierarchy over the pairs.
    pub bvh: WideBvh,
    /// Texels of the pairs of triangles in the hierarchy's order.
    pub quads: Vec<Texel>,
    /// Alpha masks.
    pub cutouts: Cutouts,
}

impl Occluders {
    /// All triangles of `geometry`, with the alpha of `model`'s materials.
    ///
    /// # Errors
    /// An alpha texture that cannot be decoded.
    pub fn new(model: &Model, geometry: &Geometry) -> Result<Self> {
        let mut used = vec![false; model.materials.len()];
        for part in &geometry.parts {
            used[part.material] = true;
        }
        let cutouts = Cutouts::new(model, &used)?;
        Ok(Self::with_cutouts(geometry, cutouts))
    }

    /// All triangles of `geometry`, solid.
    #[must_use]
    pub fn solid(geometry: &Geometry) -> Self {
        Self::with_cutouts(geometry, Cutouts::default())
    }

    fn with_cutouts(geometry: &Geometry, cutouts: Cutouts) -> Self {
        let diagonal = geometry.diagonal();
        let scale = if diagonal > 0.0 {
            diagonal.recip()
        } else {
            1.0
        };
        let positions: Vec<Vec3> = geometry.positions.iter().map(|&p| scale * p).collect();
        let mut out = Self {
            positions,
            indices: geometry.indices.clone(),
            scale,
            bvh: WideBvh::default(),
            quads: Vec::new(),
            cutouts,
        };
        let cutout_of = out.cutout_of_triangles(geometry);
        let pairs = out.pair(geometry, &cutout_of);
        let boxes: Vec<Bounds> = pairs.iter().map(|q| q.bounds(&out.positions)).collect();
        out.bvh = WideBvh::new(&boxes, RAY_STACK as usize);
        let order = out.bvh.order.iter();
        out.quads = order
            .flat_map(|&i| out.pack(geometry, pairs[i as usize], &cutout_of))
            .collect();
        out
    }

    /// Whether any triangle lets rays pass somewhere.
    #[must_use]
    pub fn masked(&self) -> bool {
        self.cutouts.any()
    }

    /// Record of the cutout, and material, of every triangle.
    fn cutout_of_triangles(&self, geometry: &Geometry) -> Vec<(u32, usize)> {
        let record = |material: usize| self.cutouts.of_material.get(material).copied();
        let of_part = |part: &Part| (record(part.material).unwrap_or(0), part.material);
        let parts = geometry.parts.iter();
        parts
            .flat_map(|part| std::iter::repeat_n(of_part(part), part.index_count / 3))
            .collect()
    }

    fn pair(&self, geometry: &Geometry, cutout_of: &[(u32, usize)]) -> Vec<Quad> {
        // Adding 0 makes -0 a 0.
        let position = |i: u32| {
            (self.positions[i as usize] + 0.0)
                .to_array()
                .map(f32::to_bits)
        };
        if !self.masked() {
            return quads::pair(&self.positions, &self.indices, position, |_| 0);
        }
        // A pair shares texture coordinates where it shares a vertex.
        let vertex = |i: u32| {
            (
                position(i),
                geometry.texcoords[i as usize].map(f32::to_bits),
            )
        };
        let material = |t: u32| cutout_of[t as usize].1 as u32;
        quads::pair(&self.positions, &self.indices, vertex, material)
    }

    /// Texels of a pair: three corners, each with a coordinate of the fourth; the numbers of the
    /// triangles and the record of their cutout; with cutouts, the texture coordinates.
    fn pack(&self, geometry: &Geometry, pair: Quad, cutout_of: &[(u32, usize)]) -> Vec<Texel> {
        let corner = |k: usize| self.positions[pair.corners[k] as usize].to_array();
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| corner(k).map(f32::to_bits));
        let [first, second] = pair.triangles;
        let (record, material) = cutout_of[first as usize];
        let mut out = vec![
            [a[0], a[1], a[2], d[0]],
            [b[0], b[1], b[2], d[1]],
            [c[0], c[1], c[2], d[2]],
            [first, second, record, 0],
        ];
        if self.masked() {
            let map = self.cutouts.transforms[material];
            let uv = |k: usize| {
                let [u, v] = geometry.texcoords[pair.corners[k] as usize];
                map.map(|r| (r[0] * u + r[1] * v + r[2]).to_bits())
            };
            let ([a, b], [c, d], [e, f], [g, h]) = (uv(0), uv(1), uv(2), uv(3));
            out.extend([[a, b, c, d], [e, f, g, h]]);
        }
        out
    }

    /// Bytes on the device.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let row = 16u64 << RAY_COLUMN_BITS;
        [&self.bvh.nodes, &self.quads, &self.cutouts.texels]
            .iter()
            .map(|t| (16 * t.len() as u64).div_ceil(row).max(1) * row)
            .sum()
    }
}

/// The same on the device.
#[derive(Debug, Clone)]
pub struct RayScene {
    pub(super) nodes: Image,
    pub(super) quads: Image,
    pub(super) cutouts: Image,
    pub(super) masked: bool,
    /// Levels of the hierarchy.
    pub(super) depth: u32,
}

impl RayScene {
    /// Uploads `occluders`.
    ///
    /// # Errors
    /// More triangles than an image holds, or memory runs out.
    pub fn new(gpu: &Gpu, occluders: &Occluders) -> Result<Self> {
        let per_pair = if occluders.masked() {
            RAY_MASKED_TEXELS
        } else {
            RAY_QUAD_TEXELS
        };
        debug_assert_eq!(
            occluders.quads.len(),
            occluders.bvh.order.len() * per_pair as usize,
            "texels of the pairs"
        );
        Ok(Self {
            nodes: image(gpu, "ray nodes", &occluders.bvh.nodes)?,
            quads: image(gpu, "ray quads", &occluders.quads)?,
            cutouts: image(gpu, "ray cutouts", &occluders.cutouts.texels)?,
            masked: occluders.masked(),
            depth: occluders.bvh.depth as u32,
        })
    }
}

/// Rows of an image that holds `texels`.
pub(super) fn rows(gpu: &Gpu, name: &str, texels: usize) -> Result<u32> {
    let rows = texels.div_ceil(1 << RAY_COLUMN_BITS).max(1);
    let limit = gpu.info().limits.max_image_2d;
    match u32::try_from(rows) {
        Ok(rows) if rows <= limit => Ok(rows),
        _ => Err(Error::Unsupported(format!(
            "{name}: {texels} texels, the device takes at most {}; try a simpler model",
            u64::from(limit) << RAY_COLUMN_BITS
        ))),
    }
}

fn image(gpu: &Gpu, name: &str, texels: &[Texel]) -> Result<Image> {
    let rows = rows(gpu, name, texels.len())?;
    let info = ImageInfo::storage(name, Format::Rgba32Uint, [1 << RAY_COLUMN_BITS, rows]);
    let image = gpu.image(info)?;
    let mut all = texels.to_vec();
    all.resize((rows as usize) << RAY_COLUMN_BITS, [0; 4]);
    let mut work = gpu.work(QueueKind::Transfer, name)?;
    work.upload_image(name, &image, &[bytemuck::cast_slice(&all)])?;
    work.submit()?.wait()?;
    Ok(image)
}
