//! Which parts of alpha-masked triangles stop rays: one bit a texel.

use crate::Result;
use crate::abi::{CUTOUT_CLAMP, CUTOUT_REPEAT};
use crate::math::wide_bvh::Texel;
use crate::scene::{AlphaMode, Material, Model, Wrap, textures};

/// Alpha from which on a blended surface stops a ray.
const BLEND_CUTOFF: f32 = 0.5;

/// The cutouts of a model's materials.
#[derive(Debug, Clone, Default)]
pub struct Cutouts {
    /// A record (first texel of the bits, width, height, wrap modes) of each cutout, then bits.
    /// Record 0 is opaque everywhere.
    pub texels: Vec<Texel>,
    /// Record of each material; 0 where all of its surface stops rays.
    pub of_material: Vec<u32>,
    /// Map of each material's texture coordinates.
    pub transforms: Vec<[[f32; 3]; 2]>,
}

impl Cutouts {
    /// Decodes the alpha of every masked or blended material of `model` that `used` names.
    ///
    /// # Errors
    /// An alpha texture that cannot be decoded.
    pub fn new(model: &Model, used: &[bool]) -> Result<Self> {
        let mut masks = vec![Mask::opaque()];
        let mut out = Self::default();
        for (material, &used) in model.materials.iter().zip(used) {
            let mask = if used {
                Mask::new(model, material)?
            } else {
                None
            };
            out.transforms.push(
                material
                    .base_color_texture
                    .map_or([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], |t| t.transform),
            );
            out.of_material
                .push(mask.as_ref().map_or(0, |_| masks.len() as u32));
            masks.extend(mask);
        }
        let mut first = masks.len();
        for mask in &masks {
            let [u, v] = mask.wrap;
            out.texels
                .push([first as u32, mask.width, mask.height, u | v << 2]);
            first += mask.bits.len();
        }
        out.texels.extend(masks.into_iter().flat_map(|m| m.bits));
        Ok(out)
    }

    /// Whether any material lets rays pass somewhere.
    #[must_use]
    pub fn any(&self) -> bool {
        self.of_material.iter().any(|&m| m != 0)
    }

    /// Whether `material` stops rays at texture coordinate `uv`, before its map. The kernel's
    /// reading, for twins.
    #[must_use]
    pub fn stops(&self, material: usize, uv: [f32; 2]) -> bool {
        let [u, v] = self.transforms[material].map(|m| m[0] * uv[0] + m[1] * uv[1] + m[2]);
        let [first, width, height, wrap] = self.texels[self.of_material[material] as usize];
        let x = along(u, width, wrap & 3);
        let y = along(v, height, wrap >> 2);
        let bit = y * width + x;
        let word = self.texels[(first + (bit >> 7)) as usize][(bit >> 5 & 3) as usize];
        word >> (bit & 31) & 1 == 1
    }
}

/// Texel at a coordinate: `cutout_along` of `rays.glsl`.
fn along(at: f32, size: u32, wrap: u32) -> u32 {
    let inside = match wrap {
        CUTOUT_REPEAT => at - at.floor(),
        CUTOUT_CLAMP => at.clamp(0.0, 1.0),
        _ => 1.0 - (2.0 * (0.5 * at - (0.5 * at).floor()) - 1.0).abs(),
    };
    ((inside * size as f32) as u32).min(size - 1)
}

struct Mask {
    width: u32,
    height: u32,
    wrap: [u32; 2],
    bits: Vec<Texel>,
}

impl Mask {
    fn opaque() -> Self {
        Self {
            width: 1,
            height: 1,
            wrap: [CUTOUT_CLAMP; 2],
            bits: vec![[1, 0, 0, 0]],
        }
    }

    fn new(model: &Model, material: &Material) -> Result<Option<Self>> {
        let cutoff = match material.alpha_mode {
            AlphaMode::Opaque => return Ok(None),
            AlphaMode::Mask { cutoff } => cutoff,
            AlphaMode::Blend => BLEND_CUTOFF,
        };
        let Some(reference) = material.base_color_texture else {
            return Ok(None);
        };
        let texture = &model.textures[reference.texture];
        let image = textures::decode(&model.images[texture.image])?;
        let least = cutoff / material.base_color[3].max(f32::MIN_POSITIVE);
        let texels = (image.width as usize * image.height as usize).div_ceil(128);
        let mut bits = vec![[0u32; 4]; texels];
        let alpha = image.pixels.iter().skip(3).step_by(4);
        for (i, &alpha) in alpha.enumerate() {
            if f32::from(alpha) / 255.0 >= least {
                bits[i >> 7][i >> 5 & 3] |= 1 << (i & 31);
            }
        }
        let wrap = |w: Wrap| match w {
            Wrap::Repeat => CUTOUT_REPEAT,
            Wrap::Clamp => CUTOUT_CLAMP,
            Wrap::Mirror => 2,
        };
        Ok(Some(Self {
            width: image.width,
            height: image.height,
            wrap: [wrap(texture.wrap_u), wrap(texture.wrap_v)],
            bits,
        }))
    }
}
