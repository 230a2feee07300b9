//! Images and coordinates that are made once for a plant and a style.

use super::branches::Branches;
use super::plant::Plant;
use super::shape::{SHAPE_SIZE, Shape};
use super::strokes::{band_of, outline_of, tile_of};
use super::style::Style;
use crate::Result;
use crate::abi::{INK_LEVELS, INK_TILE};
use crate::gpu::{AddressMode, Format, Gpu, Image, ImageInfo, QueueKind, Sampler, SamplerInfo};
use crate::scene::{Geometry, Model, Wrap, textures};

/// Coordinates in which wood is hatched, for each vertex; nothing where no style asks.
pub(super) fn wood_hatching(g: &Geometry, plant: &Plant, wanted: bool) -> Vec<[f32; 4]> {
    if !wanted {
        return vec![[0.0; 4]; g.positions.len()];
    }
    match &plant.branches {
        Some(known) => known.hatch.clone(),
        None => Branches::new(&g.positions, &plant.wood_indices(g)).hatch,
    }
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
pub(super) fn shapes_image(gpu: &Gpu, plant: &Plant, style: &Style) -> Result<Image> {
    let outline = outline_of(style)?;
    let shaped = |s: &Shape| match &outline {
        Some(outline) => s.towards(outline, style.leaves.shape).texels,
        None => s.texels.clone(),
    };
    let mut texels: Vec<u8> = plant.shapes.iter().flat_map(shaped).collect();
    // A plant without leaves has none; images have at least one.
    texels.resize(texels.len().max(SHAPE_SIZE * SHAPE_SIZE), 0);
    let extent = [SHAPE_SIZE as u32, (texels.len() / SHAPE_SIZE) as u32];
    filled_image(gpu, "leaf shapes", Format::R8Unorm, extent, &[&texels])
}

pub(super) fn band_image(gpu: &Gpu, style: &Style) -> Result<Image> {
    let band = band_of(style)?;
    filled_image(
        gpu,
        "silhouette strokes",
        Format::Rgba8Unorm,
        band.extent,
        &[&band.texels],
    )
}

/// Levels of a tile below each other: the finest, then each of half the edge.
pub(super) fn tile_image(gpu: &Gpu, style: &Style) -> Result<Image> {
    let tile = tile_of(style)?;
    let edge = INK_TILE as usize;
    let mut texels = Vec::with_capacity(2 * edge * edge);
    for (level, rows) in tile.levels.iter().enumerate() {
        for row in rows.chunks_exact(edge >> level) {
            texels.extend_from_slice(row);
            texels.resize(texels.len().next_multiple_of(edge), 0);
        }
    }
    debug_assert_eq!(
        tile.levels.len(),
        INK_LEVELS as usize,
        "an image of as many levels"
    );
    let extent = [INK_TILE, (texels.len() / edge) as u32];
    filled_image(gpu, "hatching", Format::R8Unorm, extent, &[&texels])
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
