//! Which part of an alpha-masked card is leaf.

use glam::Vec3;
use rayon::prelude::*;

use crate::Result;
use crate::math::sampling;
use crate::scene::textures;
use crate::scene::{AlphaMode, Geometry, Material, Model, TextureRef, Wrap};

/// Alpha from which on a blended surface stops a ray.
const BLEND_CUTOFF: f32 = 0.5;

/// Points at which a part's surface is looked at by [`opaque_shares`].
const SAMPLES: u32 = 4096;

/// Share of each part's area (in the order of [`Geometry::parts`]) that is leaf rather than the
/// transparent margin of a card, in \[0,1\]: the leaf-area field counts leaf only. Parts that are not
/// `wanted` are not looked at and get 1.
///
/// # Errors
/// An alpha texture that cannot be decoded.
pub fn opaque_shares(model: &Model, geometry: &Geometry, wanted: &[bool]) -> Result<Vec<f32>> {
    let cutouts: Vec<Option<Cutout>> = (0..model.materials.len())
        .into_par_iter()
        .map(|material| {
            let parts = geometry.parts.iter().zip(wanted);
            let used = parts.filter(|p| *p.1).any(|p| p.0.material == material);
            used.then(|| Cutout::new(model, &model.materials[material]))
                .transpose()
        })
        .collect::<Result<_>>()?;
    let share = |part: &crate::scene::Part| {
        let indices = &geometry.indices[part.index_range()];
        match &cutouts[part.material] {
            Some(cutout) if !cutout.is_solid() && !indices.is_empty() => {
                cutout.opaque_share(geometry, indices)
            }
            _ => 1.0,
        }
    };
    Ok(geometry.parts.iter().map(share).collect())
}

/// What of a material's surface stops rays.
#[derive(Debug)]
pub(super) struct Cutout {
    /// Alpha texture; `None` where all of the surface stops rays.
    alpha: Option<AlphaMap>,
    /// Smallest alpha that stops a ray.
    cutoff: f32,
}

impl Cutout {
    /// The cutout of `material`.
    pub(super) fn new(model: &Model, material: &Material) -> Result<Self> {
        let cutoff = match material.alpha_mode {
            AlphaMode::Opaque => None,
            AlphaMode::Mask { cutoff } => Some(cutoff),
            AlphaMode::Blend => Some(BLEND_CUTOFF),
        };
        let (Some(cutoff), Some(texture)) = (cutoff, material.base_color_texture) else {
            return Ok(Self {
                alpha: None,
                cutoff: 0.0,
            });
        };
        Ok(Self {
            alpha: Some(AlphaMap::new(model, texture)?),
            cutoff: cutoff / material.base_color[3].max(f32::MIN_POSITIVE),
        })
    }

    /// Whether all of the surface stops rays.
    pub(super) fn is_solid(&self) -> bool {
        self.alpha.is_none()
    }

    /// Whether the surface stops rays at `uv`.
    pub(super) fn is_opaque(&self, uv: [f32; 2]) -> bool {
        self.alpha
            .as_ref()
            .is_none_or(|map| map.at(uv) >= self.cutoff)
    }

    /// Share of the area of some triangles that stops rays, from [`SAMPLES`] points: triangles
    /// are picked by area, points in them uniformly.
    fn opaque_share(&self, geometry: &Geometry, indices: &[u32]) -> f32 {
        let mut ends = Vec::with_capacity(indices.len() / 3);
        let mut total = 0.0;
        for t in indices.chunks_exact(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| geometry.positions[i as usize]);
            total += f64::from(Vec3::cross(b - a, c - a).length());
            ends.push(total);
        }
        let opaque = (0..SAMPLES)
            .filter(|&k| {
                let u = sampling::r2(k);
                let area = (f64::from(k) + 0.5) / f64::from(SAMPLES) * total;
                let triangle = ends.partition_point(|&end| end <= area).min(ends.len() - 1);
                let root = u.x.sqrt();
                let weights = [1.0 - root, root * (1.0 - u.y), root * u.y];
                let mut uv = [0.0; 2];
                for (weight, &i) in weights.iter().zip(&indices[3 * triangle..]) {
                    let corner = geometry.texcoords[i as usize];
                    uv = [0, 1].map(|axis| uv[axis] + *weight as f32 * corner[axis]);
                }
                self.is_opaque(uv)
            })
            .count();
        opaque as f32 / SAMPLES as f32
    }
}

/// The alpha channel of a texture as a material uses it.
#[derive(Debug)]
struct AlphaMap {
    width: u32,
    height: u32,
    alpha: Vec<u8>,
    wrap: [Wrap; 2],
    transform: [[f32; 3]; 2],
}

impl AlphaMap {
    fn new(model: &Model, reference: TextureRef) -> Result<Self> {
        let texture = &model.textures[reference.texture];
        let image = textures::decode_of(model, texture.image)?;
        Ok(Self {
            width: image.width,
            height: image.height,
            alpha: image.pixels.iter().skip(3).step_by(4).copied().collect(),
            wrap: [texture.wrap_u, texture.wrap_v],
            transform: reference.transform,
        })
    }

    /// Alpha of the nearest texel, in \[0,1\].
    fn at(&self, uv: [f32; 2]) -> f32 {
        let [u, v] = self
            .transform
            .map(|row| row[0] * uv[0] + row[1] * uv[1] + row[2]);
        let x = wrapped_texel(u, self.width, self.wrap[0]);
        let y = wrapped_texel(v, self.height, self.wrap[1]);
        f32::from(self.alpha[y * self.width as usize + x]) / 255.0
    }
}

fn wrapped_texel(coordinate: f32, size: u32, wrap: Wrap) -> usize {
    let c = match wrap {
        Wrap::Repeat => coordinate.rem_euclid(1.0),
        Wrap::Clamp => coordinate.clamp(0.0, 1.0),
        Wrap::Mirror => 1.0 - (coordinate.rem_euclid(2.0) - 1.0).abs(),
    };
    ((c * size as f32) as usize).min(size as usize - 1)
}
