//! Materials of models as leaves, and leaves as materials.
//!
//! glTF's `KHR_materials_diffuse_transmission` splits the diffuse lobe: `rho_d = (1 - f) base`,
//! `rho_t = f tint`. That is the leaf model with both sides alike.

use std::sync::Arc;

use super::appearance::{LeafMaterial, Mode, Side, USUAL_GLOSS, USUAL_THICKNESS_MM};
use super::maps::SideMaps;
use crate::Result;
use crate::math::colour::srgb8_to_linear;
use crate::scene::textures::{Rgba8, decode};
use crate::scene::{AlphaMode, Material, Model, TextureRef};

/// Transmittance over reflectance of a green leaf, per channel, where a material does not say: the
/// median of the ten measured leaves in `species.rs`.
const USUAL_TRANSMISSION: [f64; 3] = [1.0, 1.1, 0.15];
/// Most that a channel may give back where a material says more.
const MOST: f64 = 0.95;

/// The leaf that a material describes.
///
/// Its base colour texture becomes `gamma` (in the texture's own coordinates: the material's
/// texture transform still applies), its alpha the mask. Where the material has no diffuse
/// transmission the base colour is the reflectance and a green leaf's transmittance is assumed.
///
/// # Errors
/// A texture that cannot be read.
pub fn leaf_of_material(model: &Model, material: &Material) -> Result<LeafMaterial> {
    let texture = |t: &Option<TextureRef>| -> Result<Option<Rgba8>> {
        let Some(t) = t else { return Ok(None) };
        let image = model.textures[t.texture].image;
        decode(&model.images[image]).map(Some)
    };
    let base = texture(&material.base_color_texture)?;
    let cutoff = match material.alpha_mode {
        AlphaMode::Opaque => None,
        AlphaMode::Mask { cutoff } => Some(cutoff),
        AlphaMode::Blend => Some(0.5),
    };
    let mask: Option<Arc<[f32]>> = base.as_ref().zip(cutoff).map(|(image, cutoff)| {
        let visible = |p: &[u8]| {
            let alpha = f32::from(p[3]) / 255.0 * material.base_color[3];
            f32::from(u8::from(alpha >= cutoff))
        };
        image.pixels.chunks_exact(4).map(visible).collect()
    });
    let mean = base
        .as_ref()
        .map_or([1.0; 3], |image| mean_colour(image, mask.as_deref()));
    let diffuse = 1.0 - f64::from(material.metallic.clamp(0.0, 1.0));
    let colour: [f64; 3] =
        std::array::from_fn(|c| diffuse * f64::from(material.base_color[c].max(0.0)) * mean[c]);
    let (rho_d, rho_t) = match &material.diffuse_transmission {
        Some(d) => {
            let tint =
                texture(&d.color_texture)?.map_or([1.0; 3], |image| mean_colour(&image, None));
            let share = texture(&d.texture)?.map_or(1.0, |image| mean_alpha(&image));
            let f = (f64::from(d.factor) * share).clamp(0.0, 1.0);
            let through = |c: usize| diffuse * f * f64::from(d.color[c]) * tint[c];
            (colour.map(|v| (1.0 - f) * v), [0, 1, 2].map(through))
        }
        None => (
            colour,
            std::array::from_fn(|c| colour[c] * USUAL_TRANSMISSION[c]),
        ),
    };
    let (rho_d, rho_t) = within_energy(rho_d, rho_t);
    let (mut side, _) = Side::of_albedo(rho_d, rho_t, USUAL_THICKNESS_MM);
    side.rho_s = [USUAL_GLOSS; 3];
    // glTF's roughness is the square root of Beckmann's alpha.
    side.m = material.roughness.powi(2).clamp(0.05, 1.0);
    side.maps = base.map(|image| Arc::new(gamma_maps(&image, mean, side.m)));
    let leaf = LeafMaterial {
        name: material.name.clone(),
        thickness_mm: USUAL_THICKNESS_MM,
        mode: Mode::Exact,
        lower: side.clone(),
        upper: side,
        mask,
    };
    leaf.check()?;
    Ok(leaf)
}

/// Scales both where together they exceed what a leaf may give back.
fn within_energy(rho_d: [f64; 3], rho_t: [f64; 3]) -> ([f64; 3], [f64; 3]) {
    let scale: [f64; 3] =
        std::array::from_fn(|c| (MOST / (rho_d[c] + rho_t[c]).max(1e-9)).min(1.0));
    (
        std::array::from_fn(|c| rho_d[c] * scale[c]),
        std::array::from_fn(|c| rho_t[c] * scale[c]),
    )
}

/// Mean linear colour over the mask; over everything where the mask is empty.
fn mean_colour(image: &Rgba8, mask: Option<&[f32]>) -> [f64; 3] {
    let (mut sum, mut weight) = ([0.0; 3], 0.0);
    for (i, p) in image.pixels.chunks_exact(4).enumerate() {
        let w = mask.map_or(1.0, |m| f64::from(m[i]));
        for c in 0..3 {
            sum[c] += w * f64::from(srgb8_to_linear(p[c]));
        }
        weight += w;
    }
    if weight > 0.0 {
        sum.map(|s| s / weight)
    } else {
        mean_colour(image, None)
    }
}

fn mean_alpha(image: &Rgba8) -> f64 {
    let sum: f64 = image.pixels.chunks_exact(4).map(|p| f64::from(p[3])).sum();
    sum / 255.0 / (image.pixels.len() / 4) as f64
}

fn gamma_maps(image: &Rgba8, mean: [f64; 3], m: f32) -> SideMaps {
    let mut maps = SideMaps::plain([image.width, image.height], USUAL_GLOSS, m);
    for (texel, p) in maps
        .gamma_delta
        .iter_mut()
        .zip(image.pixels.chunks_exact(4))
    {
        for c in 0..3 {
            texel[c] = srgb8_to_linear(p[c]) / (mean[c] as f32).max(1e-4);
        }
    }
    maps
}
