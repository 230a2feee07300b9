//! Images and coordinates that are made once for a plant and a style.

use super::branches::Branches;
use super::plant::Plant;
use super::shape::SHAPE_SIZE;
use super::strokes::{self, Tile, TileSettings};
use crate::Result;
use crate::abi::{INK_BAND_LENGTH, INK_BAND_WIDTH, INK_LEVELS, INK_TILE};
use crate::gpu::{AddressMode, Format, Gpu, Image, ImageInfo, QueueKind, Sampler, SamplerInfo};
use crate::scene::{Geometry, Model, Wrap, textures};

/// Coordinates in which wood is hatched, for each vertex; nothing where no style asks.
pub(super) fn wood_hatching(g: &Geometry, plant: &Plant, wanted: bool) -> Vec<[f32; 4]> {
    if !wanted {
        return vec![[0.0; 4]; g.positions.len()];
    }
    let ranges = plant
        .wood
        .iter()
        .map(|w| w.2.start as usize..w.2.end as usize);
    let indices: Vec<u32> = ranges.flat_map(|r| &g.indices[r]).copied().collect();
    Branches::new(&g.positions, &indices).hatch
}

pub(super) fn filled_image(
    gpu: &Gpu,
    name: &str,
    format: Format,
    extent: [u32; 2],
    levels: &[&[u8]],
) -> Result<Image> {
    let info = ImageInfo::texture(name, format, extent, levels.len() as u32);
    let image = gpu.image(info)?;
    let mut work = gpu.work(QueueKind::Transfer, name)?;
    work.upload_image(name, &image, levels)?;
    work.submit()?.wait()?;
    Ok(image)
}

/// Shapes below each other.
pub(super) fn shapes_image(gpu: &Gpu, plant: &Plant) -> Result<Image> {
    let texels: Vec<u8> = plant
        .shapes
        .iter()
        .flat_map(|s| &s.texels)
        .copied()
        .collect();
    let extent = [SHAPE_SIZE as u32, (SHAPE_SIZE * plant.shapes.len()) as u32];
    filled_image(gpu, "leaf shapes", Format::R8Unorm, extent, &[&texels])
}

pub(super) fn band_image(gpu: &Gpu, seed: u32) -> Result<Image> {
    let extent = [INK_BAND_LENGTH, INK_BAND_WIDTH];
    let texels = strokes::band(seed);
    filled_image(
        gpu,
        "silhouette strokes",
        Format::Rgba8Unorm,
        extent,
        &[&texels],
    )
}

pub(super) fn tile_image(gpu: &Gpu, seed: u32) -> Result<Image> {
    let tile = Tile::new(&TileSettings {
        seed: seed.wrapping_add(1),
        ..TileSettings::default()
    });
    let levels: Vec<&[u8]> = tile.levels.iter().map(Vec::as_slice).collect();
    debug_assert_eq!(
        levels.len(),
        INK_LEVELS as usize,
        "a texture of as many levels"
    );
    filled_image(gpu, "hatching", Format::R8Unorm, [INK_TILE; 2], &levels)
}

/// The base colour of every material; white where it has no texture.
pub(super) fn material_textures(gpu: &Gpu, model: &Model) -> Result<Vec<(Image, Sampler)>> {
    let one = |material: &crate::scene::Material| {
        let (texels, extent, wrap) = match material.base_color_texture {
            Some(reference) => {
                let texture = &model.textures[reference.texture];
                let image = textures::decode(&model.images[texture.image])?;
                let wrap = [texture.wrap_u, texture.wrap_v];
                (image.pixels, [image.width, image.height], wrap)
            }
            None => (vec![255; 4], [1, 1], [Wrap::Clamp; 2]),
        };
        let image = filled_image(gpu, "base colour", Format::Rgba8Srgb, extent, &[&texels])?;
        let sampler = gpu.sampler(&SamplerInfo {
            linear: true,
            address: wrap.map(|w| match w {
                Wrap::Repeat => AddressMode::Repeat,
                Wrap::Clamp => AddressMode::Clamp,
                Wrap::Mirror => AddressMode::Mirror,
            }),
            ..SamplerInfo::default()
        })?;
        Ok((image, sampler))
    };
    model.materials.iter().map(one).collect()
}
