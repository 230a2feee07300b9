//! A model's triangles as rays meet them on the device.
//!
//! Kernels see positions divided by the diagonal of the geometry, about its centre, so that a
//! change of scale or place changes nothing they compute.

use glam::Vec3;

use super::cutouts::Cutouts;
use crate::abi::{RAY_COLUMN_BITS, RAY_MASKED_TEXELS, RAY_STACK, RAY_TRIANGLE_TEXELS};
use crate::gpu::{Format, Gpu, Image, ImageInfo, QueueKind, Sampler, SamplerInfo};
use crate::math::wide_bvh::{Texel, WideBvh};
use crate::scene::{Geometry, Model};
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
    /// The hierarchy.
    pub bvh: WideBvh,
    /// Texels of the triangles in the hierarchy's order.
    pub triangles: Vec<Texel>,
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
        let bvh = WideBvh::new(&positions, &geometry.indices, RAY_STACK as usize);
        let mut out = Self {
            positions,
            indices: geometry.indices.clone(),
            scale,
            bvh,
            triangles: Vec::new(),
            cutouts,
        };
        out.triangles = out.pack(geometry);
        out
    }

    /// Whether any triangle lets rays pass somewhere.
    #[must_use]
    pub fn masked(&self) -> bool {
        self.cutouts.any()
    }

    fn pack(&self, geometry: &Geometry) -> Vec<Texel> {
        let material_of: Vec<usize> = geometry
            .parts
            .iter()
            .flat_map(|part| std::iter::repeat_n(part.material, part.index_count / 3))
            .collect();
        let mut out = Vec::new();
        for &triangle in &self.bvh.order {
            let corners = &self.indices[3 * triangle as usize..3 * triangle as usize + 3];
            for &i in corners {
                let p = self.positions[i as usize].to_array().map(f32::to_bits);
                out.push([p[0], p[1], p[2], triangle]);
            }
            if self.masked() {
                let material = material_of[triangle as usize];
                let [m, n] = self.cutouts.transforms[material];
                let uv = |k: usize| {
                    let [u, v] = geometry.texcoords[corners[k] as usize];
                    [m, n].map(|r| (r[0] * u + r[1] * v + r[2]).to_bits())
                };
                let ([a, b], [c, d], [e, f]) = (uv(0), uv(1), uv(2));
                out.push([a, b, c, d]);
                out.push([e, f, self.cutouts.of_material[material], 0]);
            }
        }
        out
    }

    /// Bytes on the device.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let row = 16u64 << RAY_COLUMN_BITS;
        [&self.bvh.nodes, &self.triangles, &self.cutouts.texels]
            .iter()
            .map(|t| (16 * t.len() as u64).div_ceil(row).max(1) * row)
            .sum()
    }
}

/// The same on the device.
#[derive(Debug, Clone)]
pub struct RayScene {
    pub(super) nodes: Image,
    pub(super) triangles: Image,
    pub(super) cutouts: Image,
    pub(super) sampler: Sampler,
    pub(super) masked: bool,
}

impl RayScene {
    /// Uploads `occluders`.
    ///
    /// # Errors
    /// More triangles than an image holds, or memory runs out.
    pub fn new(gpu: &Gpu, occluders: &Occluders) -> Result<Self> {
        let per_triangle = if occluders.masked() {
            RAY_MASKED_TEXELS
        } else {
            RAY_TRIANGLE_TEXELS
        };
        debug_assert_eq!(
            occluders.triangles.len(),
            occluders.bvh.order.len() * per_triangle as usize,
            "texels of the triangles"
        );
        Ok(Self {
            nodes: image(gpu, "ray nodes", &occluders.bvh.nodes)?,
            triangles: image(gpu, "ray triangles", &occluders.triangles)?,
            cutouts: image(gpu, "ray cutouts", &occluders.cutouts.texels)?,
            sampler: gpu.sampler(&SamplerInfo::default())?,
            masked: occluders.masked(),
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
    let info = ImageInfo::texture(name, Format::Rgba32Uint, [1 << RAY_COLUMN_BITS, rows], 1);
    let image = gpu.image(info)?;
    let mut all = texels.to_vec();
    all.resize((rows as usize) << RAY_COLUMN_BITS, [0; 4]);
    let mut work = gpu.work(QueueKind::Transfer, name)?;
    work.upload_image(name, &image, &[bytemuck::cast_slice(&all)])?;
    work.submit()?.wait()?;
    Ok(image)
}
