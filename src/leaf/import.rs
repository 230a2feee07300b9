//! Materials of models as leaves, and leaves as materials.
//!
//! glTF's `KHR_materials_diffuse_transmission` splits the diffuse lobe: `rho_d = (1 - f) base`,
//! `rho_t = f tint`. That is the leaf model with both sides alike.

use std::sync::Arc;

use super::appearance::{
    Face, LeafMaterial, Mode, Side, SideOptics, USUAL_GLOSS, USUAL_THICKNESS_MM,
};
use super::fit::{Channel, exact_thickness};
use super::maps::SideMaps;
use super::slab_table::SlabTable;
use super::species::{DRAWN_SIZE, LeafSpecies};
use crate::Result;
use crate::math::colour::{linear_to_srgb8, srgb8_to_linear};
use crate::scene::textures::{Rgba8, decode_of, encode_png};
use crate::scene::{
    AlphaMode, DiffuseTransmission, ImageSource, Material, Model, Texture, TextureRef, Wrap,
};

/// Transmittance over reflectance of a green leaf, per channel, where a material does not say: the
/// median of the ten measured leaves in `species.rs`.
pub const USUAL_TRANSMISSION: [f64; 3] = [1.0, 1.1, 0.15];
/// Most that a channel may give back where a material says more.
const MOST: f64 = 0.95;

/// The leaf that a material describes.
///
/// Its base colour texture becomes `gamma` (in the texture's own coordinates: the material's
/// texture transform still applies), its alpha the mask. Where the material has no diffuse
/// transmission the base colour is the reflectance and a green leaf's transmittance is assumed.
///
/// Leaves of the plant generator become the measured leaves they are drawn after.
///
/// # Errors
/// A texture that cannot be read.
pub fn leaf_of_material(model: &Model, material: &Material) -> Result<LeafMaterial> {
    if let Some(species) = grown(model, material) {
        return Ok(species.drawn(DRAWN_SIZE));
    }
    let said = Said::new(model, material)?;
    let through = said.rho_t;
    let untold = std::array::from_fn(|c| said.rho_d[c] * USUAL_TRANSMISSION[c]);
    let (rho_d, rho_t) = (said.rho_d, through.unwrap_or(untold));
    let (rho_d, rho_t) = within_energy(rho_d, rho_t);
    let (mut side, _) = Side::of_albedo(rho_d, rho_t, USUAL_THICKNESS_MM);
    side.rho_s = [USUAL_GLOSS; 3];
    // glTF's roughness is the square root of Beckmann's alpha.
    side.m = material.roughness.powi(2).clamp(0.05, 1.0);
    // Where nothing is said of the light that goes through, it is taken to follow the colour.
    let light = if through.is_some() {
        said.light.as_ref()
    } else {
        said.base.as_ref()
    };
    let mask = said.mask.as_deref();
    side.maps = said.base.as_ref().map(|image| {
        let mut maps = gamma_maps(image, said.mean, side.m);
        if let Some(light) = light.filter(|l| (l.width, l.height) == (image.width, image.height)) {
            thicken(&mut maps, &side, light, mask);
        }
        Arc::new(maps)
    });
    let leaf = LeafMaterial {
        name: material.name.clone(),
        thickness_mm: USUAL_THICKNESS_MM,
        mode: Mode::Exact,
        lower: side.clone(),
        upper: side,
        mask: said.mask,
    };
    leaf.check()?;
    Ok(leaf)
}

/// What a material says of itself, as means over what is visible of it.
pub(super) struct Said {
    /// Its base colour texture.
    base: Option<Rgba8>,
    /// Where that is visible; `None`: everywhere.
    mask: Option<Arc<[f32]>>,
    /// Linear mean of the base colour texture.
    pub mean: [f64; 3],
    /// Its diffuse transmission colour texture.
    light: Option<Rgba8>,
    /// Diffuse reflectance, `(1 - f) base`.
    pub rho_d: [f64; 3],
    /// Diffuse transmittance, `f tint`; nothing where the material has no diffuse transmission.
    pub rho_t: Option<[f64; 3]>,
}

impl Said {
    /// # Errors
    /// A texture that cannot be read.
    pub(super) fn new(model: &Model, material: &Material) -> Result<Self> {
        let texture = |t: &Option<TextureRef>| -> Result<Option<Rgba8>> {
            let Some(t) = t else { return Ok(None) };
            decode_of(model, model.textures[t.texture].image).map(Some)
        };
        let base = texture(&material.base_color_texture)?;
        let mask = base.as_ref().and_then(|image| visible(material, image));
        let mean = base
            .as_ref()
            .map_or([1.0; 3], |image| mean_colour(image, mask.as_deref()));
        // Metalness is passed over: glTF's default is metal, and leaves that do not say are none.
        let colour: [f64; 3] =
            std::array::from_fn(|c| f64::from(material.base_color[c].max(0.0)) * mean[c]);
        let mut out = Self {
            base,
            mask,
            mean,
            light: None,
            rho_d: colour,
            rho_t: None,
        };
        let Some(d) = &material.diffuse_transmission else {
            return Ok(out);
        };
        out.light = texture(&d.color_texture)?;
        let tint = out.light.as_ref().map_or([1.0; 3], |image| {
            let fits = |m: &&[f32]| 4 * m.len() == image.pixels.len();
            mean_colour(image, out.mask.as_deref().filter(fits))
        });
        let share = texture(&d.texture)?.map_or(1.0, |image| mean_alpha(&image));
        let f = (f64::from(d.factor) * share).clamp(0.0, 1.0);
        out.rho_d = colour.map(|v| (1.0 - f) * v);
        out.rho_t = Some([0, 1, 2].map(|c| f * f64::from(d.color[c].max(0.0)) * tint[c]));
        Ok(out)
    }
}

/// Where a material's alpha lets its texture be seen; `None`: everywhere.
fn visible(material: &Material, image: &Rgba8) -> Option<Arc<[f32]>> {
    let cutoff = match material.alpha_mode {
        AlphaMode::Opaque => return None,
        AlphaMode::Mask { cutoff } => cutoff,
        AlphaMode::Blend => 0.5,
    };
    let texel = |p: &[u8]| {
        let alpha = f32::from(p[3]) / 255.0 * material.base_color[3];
        f32::from(u8::from(alpha >= cutoff))
    };
    Some(image.pixels.chunks_exact(4).map(texel).collect())
}

/// The measured leaf behind a leaf material that the plant generator has just made.
fn grown(model: &Model, material: &Material) -> Option<&'static LeafSpecies> {
    let texture = material.base_color_texture?;
    let image = model
        .images
        .get(model.textures.get(texture.texture)?.image)?;
    // A file that was written and read again carries its own colours.
    if !matches!(image, ImageSource::Rgba8 { .. }) {
        return None;
    }
    let plant = match material.name.as_str() {
        "ovate leaf" => "broadleaf",
        "heart-shaped leaf" => "lime",
        "elliptic leaf" => "shrub",
        "needle" => "conifer",
        _ => return None,
    };
    LeafSpecies::of_plant(plant)
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

/// Thickness such that the green light that goes through follows `light`, and gamma such that the
/// reflectance stays. An image of bytes has 256 greens, so each is solved for once.
fn thicken(maps: &mut SideMaps, side: &Side, light: &Rgba8, mask: Option<&[f32]>) {
    let columns = [0, 1, 2].map(|c| SlabTable::shared().at(side.omega(c)));
    let deltas = [0, 1, 2].map(|c| side.sigma_t(c) * USUAL_THICKNESS_MM);
    let usual = [0, 1, 2].map(|c| columns[c].share(deltas[c]));
    let mean = mean_colour(light, mask)[1].max(1e-6);
    let of_green: Vec<(f32, [f32; 3])> = (0..=255)
        .map(|byte| {
            let wanted = usual[1].t * f64::from(srgb8_to_linear(byte)) / mean;
            let d = exact_thickness(&[Channel {
                column: &columns[1],
                delta: deltas[1],
                mean: usual[1].t,
                measured: wanted.clamp(1e-4, 0.97),
            }]);
            let gamma = |c: usize| {
                let r = columns[c].share(deltas[c] * (1.0 + d)).r;
                (usual[c].r / r.max(1e-6)) as f32
            };
            (d as f32, [0, 1, 2].map(gamma))
        })
        .collect();
    for (texel, p) in maps
        .gamma_delta
        .iter_mut()
        .zip(light.pixels.chunks_exact(4))
    {
        let (d, gamma) = of_green[usize::from(p[1])];
        texel[3] = d;
        (0..3).for_each(|c| texel[c] *= gamma[c]);
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

/// The leaf as a material; its textures are added to `model`.
///
/// `f = rho_t / (rho_d + rho_t)` of the leaf's brightness splits the lobe. glTF has one colour for
/// both sides, so the sides' means are taken; gloss is left to its own Fresnel term.
///
/// # Errors
/// The maps cannot be encoded.
pub fn material_of_leaf(leaf: &LeafMaterial, model: &mut Model) -> Result<Material> {
    let sides = Face::ALL.map(|face| leaf.sampler(face));
    let mean = |index: Option<usize>| -> ([f32; 3], [f32; 3]) {
        let o = [0, 1].map(|i| index.map_or_else(|| sides[i].mean(), |t| sides[i].of(t)));
        let both = |f: fn(&SideOptics) -> [f32; 3]| {
            let (a, b) = (f(&o[0]), f(&o[1]));
            [0, 1, 2].map(|c| 0.5 * (a[c] + b[c]))
        };
        (both(|o| o.rho_d), both(|o| o.rho_t))
    };
    let (rho_d, rho_t) = mean(None);
    let bright = |v: [f32; 3]| 0.2126 * v[0] + 0.7152 * v[1] + 0.0722 * v[2];
    let f = bright(rho_t) / (bright(rho_d) + bright(rho_t)).max(1e-6);
    // Neither colour may exceed 1: their sum does not, so there is always such a share.
    let most = |v: [f32; 3]| v.into_iter().fold(0.0, f32::max);
    let f = f.clamp(most(rho_t).min(1.0), (1.0 - most(rho_d)).max(0.0));
    let split = |(d, t): ([f32; 3], [f32; 3])| {
        (
            d.map(|v| v / (1.0 - f).max(1e-6)),
            t.map(|v| v / f.max(1e-6)),
        )
    };
    let m = leaf.optics(Face::Upper).m;
    let mut out = Material {
        name: leaf.name.clone(),
        roughness: m.sqrt(),
        double_sided: true,
        ..Material::default()
    };
    let (base, tint) = split((rho_d, rho_t));
    let mut transmission = DiffuseTransmission {
        factor: f,
        texture: None,
        color: tint,
        color_texture: None,
    };
    out.base_color = [base[0], base[1], base[2], 1.0];
    if let Some(size) = leaf.size() {
        let count = size[0] as usize * size[1] as usize;
        let (mut bases, mut tints) = (Vec::with_capacity(4 * count), Vec::with_capacity(4 * count));
        for i in 0..count {
            let (base, tint) = split(mean(Some(i)));
            bases.extend(base.map(linear_to_srgb8));
            bases.push((leaf.coverage(i) * 255.0).round() as u8);
            tints.extend(tint.map(linear_to_srgb8));
            tints.push(255);
        }
        out.base_color = [1.0; 4];
        out.base_color_texture = Some(add_texture(model, "leaf colour", size, &bases)?);
        transmission.color = [1.0; 3];
        transmission.color_texture = Some(add_texture(model, "leaf light", size, &tints)?);
        if leaf.mask.is_some() {
            out.alpha_mode = AlphaMode::Mask { cutoff: 0.5 };
        }
    }
    out.diffuse_transmission = Some(transmission);
    Ok(out)
}

fn add_texture(model: &mut Model, name: &str, size: [u32; 2], pixels: &[u8]) -> Result<TextureRef> {
    model.images.push(ImageSource::Encoded {
        name: name.to_owned(),
        bytes: encode_png(size[0], size[1], pixels)?.into(),
    });
    model.textures.push(Texture {
        image: model.images.len() - 1,
        wrap_u: Wrap::Clamp,
        wrap_v: Wrap::Clamp,
        nearest: false,
    });
    Ok(TextureRef::new(model.textures.len() - 1))
}
