//! Bakes through the cache.

use glam::Vec3;

use super::{Context, bake_file, console};
use crate::Result;
use crate::foliage::bake::{Bake, Baked, Recipe};
use crate::foliage::{Settings, Split, table};
use crate::gpu::DeviceInfo;
use crate::scene::{Geometry, ImageSource, Model};

/// A bake of `geometry`, computed or found. Found ones have an empty recipe and no times.
///
/// # Errors
/// As [`Bake::compute`].
pub fn bake(
    context: &Context,
    model: &Model,
    geometry: &Geometry,
    split: &Split,
    settings: &Settings,
) -> Result<Baked> {
    let gpu = context.gpu()?;
    let cache = context.cache();
    let key = cache
        .folder()
        .map(|_| key(model, geometry, split, settings, gpu.info()));
    if let Some(bake) = key.and_then(|key| cache.load(bake_file::KIND, &key)) {
        let fits = |bake: &Bake| bake.normals.len() == geometry.positions.len();
        if let Some(bake) = bake_file::from_bytes(&bake).filter(fits) {
            log::info!("the bake was found in the cache");
            return Ok(Baked {
                bake,
                recipe: Recipe::default(),
                times: Vec::new(),
            });
        }
    }
    let working = console::working("baking");
    let baked = Bake::compute(gpu, model, geometry, split, settings, &mut |label, _| {
        working.step(label);
    })?;
    if let Some(key) = key {
        cache.store(bake_file::KIND, &key, &bake_file::to_bytes(&baked.bake));
    }
    Ok(baked)
}

/// Hash of everything a bake depends on: geometry, what is foliage, what cuts leaves out, the
/// settings, and the device, whose rounding may differ in the last bits.
fn key(
    model: &Model,
    geometry: &Geometry,
    split: &Split,
    settings: &Settings,
    device: &DeviceInfo,
) -> blake3::Hash {
    let mut hasher = Hasher(blake3::Hasher::new());
    hasher.bytes(env!("CARGO_PKG_VERSION").as_bytes());
    hasher.bytes(format!("{} {}", device.name, device.driver_info).as_bytes());
    for info in table::SETTINGS {
        hasher.bytes((info.get)(settings).as_bytes());
    }
    hasher.bytes(bytemuck::bytes_of(&geometry.origin));
    hasher.bytes(bytemuck::cast_slice::<Vec3, u8>(&geometry.positions));
    hasher.bytes(bytemuck::cast_slice::<Vec3, u8>(&geometry.normals));
    hasher.bytes(bytemuck::cast_slice(&geometry.texcoords));
    hasher.bytes(bytemuck::cast_slice(&geometry.indices));
    for (part, &foliage) in geometry.parts.iter().zip(&split.foliage_parts) {
        hasher.bytes(format!("{part:?} {foliage}").as_bytes());
    }
    for material in &model.materials {
        hasher.bytes(format!("{material:?}").as_bytes());
    }
    for texture in &model.textures {
        hasher.bytes(format!("{texture:?}").as_bytes());
    }
    for image in &model.images {
        match image {
            ImageSource::Encoded { bytes, .. } => hasher.bytes(bytes),
            ImageSource::Rgba8 { pixels, width, .. } => {
                hasher.bytes(&width.to_le_bytes());
                hasher.bytes(pixels);
            }
        }
    }
    hasher.0.finalize()
}

/// Hashes fields behind their lengths, so that no two lists of fields look alike.
struct Hasher(blake3::Hasher);

impl Hasher {
    fn bytes(&mut self, bytes: &[u8]) {
        self.0.update(&(bytes.len() as u64).to_le_bytes());
        self.0.update(bytes);
    }
}
