//! Textures of the model: which are used, and how they are decoded.

use std::sync::Arc;

use super::subject::Subject;
use crate::Result;
use crate::scene::{AlphaMode, ImageSource, Material, Model, textures};

/// Longest edge of the alpha textures of the shadow pass, texels: a leaf covers few texels of a
/// shadow map, so finer levels would never be read.
const SHADOW_ALPHA_EDGE: u32 = 512;

/// One use of an image: what distinguishes two textures on the device.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct TextureKey {
    /// Index into [`Model::images`].
    pub image: usize,
    /// Bits of the alpha cutoff that the levels keep the coverage of; `None` = alpha is averaged.
    pub cutoff: Option<u32>,
    /// Only alpha, in one byte.
    pub alpha_only: bool,
}

impl TextureKey {
    /// Label of its image on the device.
    #[must_use]
    pub fn label(&self, model: &Model) -> String {
        let name = match model.images.get(self.image) {
            Some(ImageSource::Encoded { name, .. } | ImageSource::Rgba8 { name, .. }) => name,
            None => "?",
        };
        let what = if self.alpha_only { "alpha" } else { "texture" };
        format!("{what} {name}")
    }
}

/// Cutoff of the alpha test for a material; 0 where alpha does nothing. Blending is drawn as a
/// mask at 1/2: leaves are cut out, not glass.
#[must_use]
pub fn cutoff(material: &Material) -> f32 {
    match material.alpha_mode {
        AlphaMode::Opaque => 0.0,
        AlphaMode::Mask { cutoff } => cutoff,
        AlphaMode::Blend => 0.5,
    }
}

/// The key of a material's base colour texture.
#[must_use]
pub fn base_color_key(model: &Model, material: &Material) -> Option<TextureKey> {
    let texture = model.textures.get(material.base_color_texture?.texture)?;
    let cutoff = cutoff(material);
    (texture.image < model.images.len()).then_some(TextureKey {
        image: texture.image,
        cutoff: (cutoff > 0.0).then_some(cutoff.to_bits()),
        alpha_only: false,
    })
}

/// Materials that are drawn and have a texture, with its key.
pub fn used<'a>(
    subject: &Subject<'a>,
) -> impl Iterator<Item = (&'a Material, TextureKey)> + use<'a> {
    let model = subject.model;
    let mut drawn = vec![false; model.materials.len()];
    for part in &subject.geometry.parts {
        if let Some(d) = drawn.get_mut(part.material) {
            *d |= part.index_count > 0;
        }
    }
    model
        .materials
        .iter()
        .zip(drawn)
        .filter(|(_, drawn)| *drawn)
        .filter_map(move |(m, _)| base_color_key(model, m).map(|k| (m, k)))
}

/// Extent of the largest level whose longest edge is within `limit`, and the number of levels
/// from there down to 1x1.
#[must_use]
pub fn levels_within(extent: [u32; 2], limit: u32) -> ([u32; 2], u32) {
    let mut e = extent.map(|v| v.max(1));
    while e[0].max(e[1]) > limit.max(1) {
        e = e.map(|v| (v / 2).max(1));
    }
    (e, e[0].max(e[1]).ilog2() + 1)
}

/// Longest edge used for a key when `limit` is the setting.
#[must_use]
pub fn edge_limit(key: TextureKey, limit: u32) -> u32 {
    if key.alpha_only {
        limit.min(SHADOW_ALPHA_EDGE)
    } else {
        limit
    }
}

/// A decoded image: sRGB colour and linear alpha.
#[derive(Debug, Clone)]
pub struct Decoded {
    /// Texels across and down.
    pub extent: [u32; 2],
    /// `width * height * 4` bytes.
    pub rgba: Arc<[u8]>,
}

/// Decodes one image of the model.
///
/// # Errors
/// Names the model's file and the image when it cannot be decoded.
pub fn decode(model: &Model, image: usize) -> Result<Decoded> {
    let extent = textures::dimensions_of(model, image)?;
    let rgba = match &model.images[image] {
        ImageSource::Rgba8 { pixels, .. } => pixels.clone(),
        ImageSource::Encoded { .. } => textures::decode_of(model, image)?.pixels.into(),
    };
    Ok(Decoded { extent, rgba })
}
