//! Materials of a lit picture: base colour textures, and maps of leaves (reflectance,
//! transmittance, gloss and roughness of every texel of both sides).

use rayon::prelude::*;

use super::appearance::{Face, LeafMaterial, SideOptics};
use super::optics::mean_colour;
use crate::Result;
use crate::abi::LitDraw;
use crate::gpu::{AddressMode, Format, Gpu, Image, ImageInfo, QueueKind, Sampler, SamplerInfo};
use crate::math::packing::f32_to_f16;
use crate::scene::{AlphaMode, Material, Model, Wrap, textures};

/// Maps of a leaf: reflectance and roughness of the front and of the back, transmittance, specular
/// intensity of the front and of the back.
const MAPS: usize = 5;

/// A material on the device.
pub(super) struct LitMaterial {
    pub(super) draw: LitDraw,
    /// Base colour.
    pub(super) base: Image,
    /// Of the leaf, or of one texel that nobody reads.
    pub(super) maps: [Image; MAPS],
    /// Whether the maps are the leaf's.
    pub(super) mapped: bool,
    pub(super) sampler: Sampler,
}

impl LitMaterial {
    /// Material number `number` of `model`, worn as `leaf` where that has maps.
    pub(super) fn new(
        gpu: &Gpu,
        model: &Model,
        number: usize,
        leaf: Option<&LeafMaterial>,
    ) -> Result<Self> {
        let material = &model.materials[number];
        let (texels, extent, wrap, transform) = match material.base_color_texture {
            Some(reference) => {
                let texture = model.textures[reference.texture];
                let image = textures::decode(&model.images[texture.image])?;
                (
                    image.pixels,
                    [image.width, image.height],
                    [texture.wrap_u, texture.wrap_v],
                    reference.transform,
                )
            }
            None => (
                vec![255; 4],
                [1, 1],
                [Wrap::Clamp; 2],
                [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            ),
        };
        let sampler = gpu.sampler(&SamplerInfo {
            linear: true,
            address: wrap.map(|w| match w {
                Wrap::Repeat => AddressMode::Repeat,
                Wrap::Clamp => AddressMode::Clamp,
                Wrap::Mirror => AddressMode::Mirror,
            }),
            ..SamplerInfo::default()
        })?;
        let draw = draw(model, material, (number, transform))?;
        let leaf = leaf.filter(|l| l.size().is_some());
        Ok(Self {
            draw,
            base: texture(gpu, Format::Rgba8Srgb, extent, &texels)?,
            maps: maps(gpu, leaf)?,
            mapped: leaf.is_some(),
            sampler,
        })
    }
}

fn draw(
    model: &Model,
    material: &Material,
    (number, transform): (usize, [[f32; 3]; 2]),
) -> Result<LitDraw> {
    let base = material.base_color;
    let mean = mean_colour(model, material)?;
    Ok(LitDraw {
        texcoord_u: transform[0],
        texcoord_v: transform[1],
        tint: [0, 1, 2].map(|c| {
            if mean[c] > 0.0 {
                base[c] / mean[c]
            } else {
                1.0
            }
        }),
        alpha: base[3],
        cutoff: match material.alpha_mode {
            AlphaMode::Opaque => -1.0,
            AlphaMode::Mask { cutoff } => cutoff,
            AlphaMode::Blend => 0.5,
        },
        material: number as u32,
    })
}

fn texture(gpu: &Gpu, format: Format, extent: [u32; 2], texels: &[u8]) -> Result<Image> {
    let image = gpu.image(ImageInfo::texture("leaf texture", format, extent, 1))?;
    let mut work = gpu.work(QueueKind::Transfer, "leaf texture")?;
    work.upload_image("leaf texture", &image, &[texels])?;
    work.submit()?.wait()?;
    Ok(image)
}

fn maps(gpu: &Gpu, leaf: Option<&LeafMaterial>) -> Result<[Image; MAPS]> {
    let size = leaf.and_then(LeafMaterial::size).unwrap_or([1, 1]);
    let mut out: [Vec<[f32; 4]>; MAPS] = std::array::from_fn(|_| vec![[0.0; 4]]);
    if let Some(leaf) = leaf {
        let count = size[0] as usize * size[1] as usize;
        let [front, back] = Face::ALL.map(|face| {
            let sampler = leaf.sampler(face);
            let at = |i: usize| sampler.of(i);
            (0..count).into_par_iter().map(at).collect::<Vec<_>>()
        });
        let side = |o: &SideOptics| [o.rho_d[0], o.rho_d[1], o.rho_d[2], o.m];
        let shine = |o: &SideOptics| [o.rho_s[0], o.rho_s[1], o.rho_s[2], 0.0];
        // Light goes through equally either way.
        let through = |(a, b): (&SideOptics, &SideOptics)| {
            let t = [0, 1, 2].map(|c| 0.5 * (a.rho_t[c] + b.rho_t[c]));
            [t[0], t[1], t[2], 0.0]
        };
        out = [
            front.iter().map(side).collect(),
            back.iter().map(side).collect(),
            front.iter().zip(&back).map(through).collect(),
            front.iter().map(shine).collect(),
            back.iter().map(shine).collect(),
        ];
    }
    let image = |texels: &Vec<[f32; 4]>| {
        let halves: Vec<[u16; 4]> = texels.iter().map(|t| t.map(f32_to_f16)).collect();
        texture(
            gpu,
            Format::Rgba16Float,
            size,
            bytemuck::cast_slice(&halves),
        )
    };
    let [a, b, c, d, e] = &out;
    Ok([image(a)?, image(b)?, image(c)?, image(d)?, image(e)?])
}
