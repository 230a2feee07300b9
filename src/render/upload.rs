//! Buffers and images of a plan, filled.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use rayon::prelude::*;

use super::areas::Areas;
use super::mips;
use super::order;
use super::outline::{Outlines, Texels, mix_arrays, mix_normals, mix_points};
use super::plan::{Attribute, PixelFormat, Plan, PlannedImage, label};
use super::settings::{Encoding, RenderSettings};
use super::setup::Setup;
use super::slice::{self, SlicePlane};
use super::subject::Subject;
use super::texture;
use crate::Result;
use crate::abi::{self, RenderLight};
use crate::gpu::{
    AddressMode, Buffer, BufferInfo, Format, Gpu, Image, ImageInfo, QueueKind, Sampler,
    SamplerInfo, Work,
};
use crate::math::packing::{f32_to_f16, pack_normal16, pack_unorm16};
use crate::scene::{LightKind, PunctualLight, Wrap};

use super::batch::Batch;

/// The device's name of a planned format.
#[must_use]
pub(super) fn format(f: PixelFormat) -> Format {
    match f {
        PixelFormat::Rgba8Srgb => Format::Rgba8Srgb,
        PixelFormat::Rgba8 => Format::Rgba8Unorm,
        PixelFormat::R8 => Format::R8Unorm,
        PixelFormat::Rgba16Float => Format::Rgba16Float,
        PixelFormat::R32Float => Format::R32Float,
        PixelFormat::Depth16 => Format::Depth16,
        PixelFormat::Depth32 => Format::Depth32,
    }
}

/// Everything of a plan that lies on the device.
#[derive(Debug)]
pub(super) struct Resources {
    buffers: Vec<Buffer>,
    images: Vec<Image>,
    /// The picture, divided by what may be seen.
    pub(super) areas: Areas,
}

impl Resources {
    /// The buffer with this label; it must be in the plan.
    pub(super) fn buffer(&self, label: &str) -> &Buffer {
        self.find_buffer(label)
            .unwrap_or_else(|| panic!("the plan has no buffer `{label}`"))
    }

    pub(super) fn find_buffer(&self, label: &str) -> Option<&Buffer> {
        self.buffers.iter().find(|b| b.info().name == label)
    }

    /// The image with this label; it must be in the plan.
    pub(super) fn image(&self, label: &str) -> &Image {
        self.find_image(label)
            .unwrap_or_else(|| panic!("the plan has no image `{label}`"))
    }

    pub(super) fn find_image(&self, label: &str) -> Option<&Image> {
        self.images.iter().find(|i| i.info().name == label)
    }

    pub(super) fn bytes(&self) -> u64 {
        let images: u64 = self.images.iter().map(|i| i.info().bytes()).sum();
        images + self.buffers.iter().map(Buffer::bytes).sum::<u64>()
    }

    /// Makes and fills all of the plan.
    pub(super) fn new(
        gpu: &Gpu,
        plan: &Plan,
        subject: &Subject<'_>,
        settings: &RenderSettings,
        setup: &Setup,
        batches: &mut [Batch],
    ) -> Result<Self> {
        let mut out = Self {
            buffers: Vec::new(),
            images: Vec::new(),
            areas: Areas::default(),
        };
        for b in &plan.buffers {
            out.buffers
                .push(gpu.buffer(BufferInfo::device(b.label, b.bytes))?);
        }
        for i in &plan.images {
            let (name, format) = (i.label.clone(), format(i.format));
            let filled =
                i.texture.is_some() || i.label == label::SLICE || i.label == label::NO_TEXTURE;
            let info = if filled {
                ImageInfo::texture(name, format, i.extent, i.levels)
            } else {
                ImageInfo::target(name, format, i.extent, i.samples)
            };
            out.images.push(gpu.image(info)?);
        }
        let mut work = gpu.work(QueueKind::Graphics, "upload")?;
        let textures = Textures::new(plan, subject, settings)?;
        let outlines = Outlines::new(subject, batches, settings.leaf_outline, |label| {
            textures.texels(label)
        });
        let positions = outlines.apply(&subject.geometry.positions, mix_points);
        if plan.pass(label::SHADE_PASS).is_some() {
            let texels = plan.image(label::SHADOW_MAP).map(|i| i.extent[0]);
            let triangles = (&positions[..], &subject.geometry.indices[..]);
            out.areas = Areas::new(&setup.frame, settings.size, texels, triangles);
        }
        out.fill(&mut work, label::POSITIONS, || {
            positions.iter().map(|p| p.to_array()).collect()
        })?;
        out.fill_vertices(&mut work, (plan, settings), subject, batches, &outlines)?;
        out.fill_indices(&mut work, subject, setup, batches)?;
        out.fill_overlays(&mut work, subject, setup)?;
        out.fill_textures(&mut work, &textures)?;
        work.submit()?.wait()?;
        Ok(out)
    }

    /// Uploads to a buffer, if it is in the plan.
    fn fill<T: Pod>(
        &self,
        work: &mut Work,
        label: &str,
        data: impl FnOnce() -> Vec<T>,
    ) -> Result<()> {
        match self.find_buffer(label) {
            Some(buffer) => work.upload(label, buffer, &data()),
            None => Ok(()),
        }
    }

    fn fill_vertices(
        &self,
        work: &mut Work,
        (plan, settings): (&Plan, &RenderSettings),
        subject: &Subject<'_>,
        batches: &[Batch],
        outlines: &Outlines,
    ) -> Result<()> {
        let g = subject.geometry;
        if let Some(baked) = subject.baked.filter(|_| plan.has(Attribute::Shading)) {
            let normals = outlines.apply(baked.normals, mix_normals);
            let ambient = outlines.apply(baked.ambient, |v, w| mix_arrays(v.map(|k| [k]), w)[0]);
            let words = encode(&normals, &ambient, settings.encoding);
            work.upload(label::SHADING, self.buffer(label::SHADING), &words)?;
        }
        self.fill(work, label::MODEL_NORMALS, || {
            let moved = outlines.apply(&g.normals, mix_normals);
            moved.par_iter().map(|n| pack_normal16(*n)).collect()
        })?;
        self.fill(work, label::TEXCOORDS, || {
            outlines.apply(&g.texcoords, mix_arrays)
        })?;
        self.fill(work, label::COLORS, || {
            let moved = outlines.apply(&g.colors, mix_arrays);
            moved.iter().map(|c| c.map(f32_to_f16)).collect()
        })?;
        self.fill(work, label::MATERIALS, || {
            // A subject without triangles still binds a table.
            let materials = batches.iter().map(|b| b.material);
            materials
                .chain([Zeroable::zeroed()])
                .take(batches.len().max(1))
                .collect()
        })?;
        self.fill(work, label::LIGHTS, || {
            let lights = subject.model.lights.iter();
            lights.map(|l| light(l, g.origin)).collect()
        })
    }

    /// Indices of all batches, each from near to far; tells the batches their ranges.
    fn fill_indices(
        &self,
        work: &mut Work,
        subject: &Subject<'_>,
        setup: &Setup,
        batches: &mut [Batch],
    ) -> Result<()> {
        let g = subject.geometry;
        let sort = |batches: &mut [Batch], direction: Vec3, range: fn(&mut Batch) -> &mut _| {
            let mut out = Vec::with_capacity(g.indices.len());
            for batch in batches {
                let start = out.len();
                order::append_sorted(
                    &mut out,
                    &batch.clusters,
                    &g.indices,
                    &g.positions,
                    direction,
                );
                let ends = [start, out.len()];
                let [a, b] = ends.map(|v| u32::try_from(v).expect("fewer than 2^32 indices"));
                *range(batch) = a..b;
            }
            out
        };
        if let Some(buffer) = self.find_buffer(label::INDICES) {
            let direction = setup.camera.forward.as_vec3();
            let sorted = sort(batches, direction, |b| &mut b.indices);
            work.upload(label::INDICES, buffer, &sorted)?;
        }
        if let Some(buffer) = self.find_buffer(label::SHADOW_INDICES) {
            let direction = -Vec3::from(setup.frame.sun_direction);
            let sorted = sort(batches, direction, |b| &mut b.shadow_indices);
            work.upload(label::SHADOW_INDICES, buffer, &sorted)?;
        }
        Ok(())
    }

    fn fill_overlays(&self, work: &mut Work, subject: &Subject<'_>, setup: &Setup) -> Result<()> {
        if let Some(s) = subject.surface {
            self.fill(work, label::SURFACE_POSITIONS, || {
                s.positions.iter().map(|p| p.to_array()).collect()
            })?;
            self.fill(work, label::SURFACE_NORMALS, || {
                s.normals.iter().map(|n| pack_normal16(*n)).collect()
            })?;
            self.fill(work, label::SURFACE_INDICES, || {
                // From near to far and with depth writes, so that only the nearest layer blends.
                let all = 0..s.indices.len();
                let mut out = Vec::with_capacity(all.len());
                let triangles = order::triangles(all);
                let direction = setup.camera.forward.as_vec3();
                order::append_sorted(&mut out, &triangles, s.indices, s.positions, direction);
                out
            })?;
        }
        if let (Some(field), Some(image)) = (subject.field, self.find_image(label::SLICE)) {
            let plane = SlicePlane::facing(&field, Vec3::from(setup.frame.right));
            let picture = slice::picture(&field, &plane);
            work.upload_image(label::SLICE, image, &[&picture.rgba])?;
        }
        Ok(())
    }

    fn fill_textures(&self, work: &mut Work, textures: &Textures<'_>) -> Result<()> {
        if let Some(image) = self.find_image(label::NO_TEXTURE) {
            work.upload_image(label::NO_TEXTURE, image, &[&[255; 4]])?;
        }
        for (planned, levels) in &textures.made {
            let slices: Vec<&[u8]> = levels.iter().map(Vec::as_slice).collect();
            work.upload_image(&planned.label, self.image(&planned.label), &slices)?;
        }
        Ok(())
    }
}

/// Mip levels of every planned texture.
struct Textures<'a> {
    made: Vec<(&'a PlannedImage, Vec<Vec<u8>>)>,
}

impl<'a> Textures<'a> {
    fn new(plan: &'a Plan, subject: &Subject<'_>, settings: &RenderSettings) -> Result<Self> {
        let planned: Vec<_> = plan
            .images
            .iter()
            .filter_map(|i| i.texture.map(|key| (i, key)))
            .collect();
        let mut sources: Vec<usize> = planned.iter().map(|(_, key)| key.image).collect();
        sources.sort_unstable();
        sources.dedup();
        let decoded: Vec<(usize, texture::Decoded)> = sources
            .par_iter()
            .map(|&i| Ok((i, texture::decode(subject.model, i)?)))
            .collect::<Result<_>>()?;
        let made = planned
            .par_iter()
            .map(|&(i, key)| {
                let (_, image) = decoded
                    .iter()
                    .find(|d| d.0 == key.image)
                    .expect("every image was decoded");
                (i, mips::mip_levels(image, key, settings.texture_size))
            })
            .collect();
        Ok(Self { made })
    }

    /// Levels of the texture with this label.
    fn texels(&self, label: &str) -> Option<Texels<'_>> {
        let (planned, levels) = self.made.iter().find(|(i, _)| i.label == label)?;
        Some(Texels {
            extent: planned.extent,
            levels,
        })
    }
}

/// Normals and coefficients as words in one of the encodings.
fn encode(normals: &[Vec3], ambient: &[f32], encoding: Encoding) -> Vec<u32> {
    let pairs = normals.par_iter().zip(ambient);
    match encoding {
        Encoding::Packed => pairs
            .flat_map_iter(|(n, k)| [pack_normal16(*n), pack_unorm16(*k)])
            .collect(),
        Encoding::Length => pairs
            .flat_map_iter(|(n, k)| {
                let v = *n * k.clamp(abi::LENGTH_MIN_AMBIENT, 1.0);
                v.to_array().map(f32::to_bits)
            })
            .collect(),
        Encoding::Float => pairs
            .flat_map_iter(|(n, k)| [n.x, n.y, n.z, *k].map(f32::to_bits))
            .collect(),
    }
}

/// A punctual light relative to the geometry's origin. Its intensity over pi is what a white
/// diffuse surface at distance 1 reflects, so that eq. 1 needs no other unit.
fn light(l: &PunctualLight, origin: glam::DVec3) -> RenderLight {
    let (kind, cos_inner, cos_outer) = match l.kind {
        LightKind::Directional => (abi::LIGHT_DIRECTIONAL, 1.0, 0.0),
        LightKind::Point => (abi::LIGHT_POINT, 1.0, 0.0),
        LightKind::Spot { inner, outer } => (abi::LIGHT_SPOT, inner.cos(), outer.cos()),
    };
    RenderLight {
        position: (l.position - origin).as_vec3().into(),
        kind,
        direction: l.direction.as_vec3().into(),
        range: if l.range.is_finite() { l.range } else { 0.0 },
        color: l.color.map(|c| c * std::f32::consts::FRAC_1_PI),
        cos_outer,
        cone_scale: 1.0 / (cos_inner - cos_outer).max(1e-4),
    }
}

/// A sampler for a material's base colour. Leaves read the nearest mip level only: their cards
/// are a few pixels across, so blending levels shows nothing and costs as much as the rest.
pub(super) fn sampler(gpu: &Gpu, batch: &Batch, anisotropy: f32) -> Result<Sampler> {
    let (wrap, nearest) = batch.wrap;
    gpu.sampler(&SamplerInfo {
        linear: !nearest,
        linear_mips: !batch.cuts || anisotropy > 1.0,
        address: wrap.map(address),
        anisotropy,
        ..SamplerInfo::default()
    })
}

/// A sampler for a material's alpha in the shadow map, which is itself a raster of points.
pub(super) fn alpha_sampler(gpu: &Gpu, batch: &Batch) -> Result<Sampler> {
    gpu.sampler(&SamplerInfo {
        address: batch.wrap.0.map(address),
        ..SamplerInfo::default()
    })
}

fn address(wrap: Wrap) -> AddressMode {
    match wrap {
        Wrap::Repeat => AddressMode::Repeat,
        Wrap::Clamp => AddressMode::Clamp,
        Wrap::Mirror => AddressMode::Mirror,
    }
}
