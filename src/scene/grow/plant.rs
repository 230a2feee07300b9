//! From a species, a seed and a density to a model.

use std::sync::{Arc, OnceLock};

use glam::DAffine3;

use super::parameters::{BarkStyle, LeafShape, Parameters, inside};
use super::{Species, bark_texture, leaf_texture, leaves, skeleton, wood};
use crate::Result;
use crate::scene::{
    DiffuseTransmission, ImageSource, Instance, Material, Mesh, Model, Texture, TextureRef,
};

/// Most leaves a plant may have: at 13 vertices each it stays far below 2^32.
pub const MAX_LEAVES: u32 = 500_000;

/// What is chosen per plant rather than per species.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GrowOptions {
    /// Same seed, same plant.
    pub seed: u64,
    /// Number of leaves, 0 (winter) to [`MAX_LEAVES`]; `None` takes the species' own. Leaf size
    /// follows so that the total leaf area stays the same (below some hundred leaves, which
    /// would be longer than a tenth of the plant, it shrinks).
    pub leaves: Option<u32>,
    /// Fineness of the wood's mesh, \[0.25, 4\]; 1 suits a picture of the whole plant.
    pub detail: f32,
}

impl Default for GrowOptions {
    fn default() -> Self {
        Self {
            seed: 1,
            leaves: None,
            detail: 1.0,
        }
    }
}

impl GrowOptions {
    /// Refuses values outside the ranges stated at the fields.
    ///
    /// # Errors
    /// Names the option, its value and its range.
    pub fn check(&self) -> Result<()> {
        inside(
            "leaves",
            f64::from(self.leaves.unwrap_or(0)),
            0.0,
            f64::from(MAX_LEAVES),
        )?;
        inside("detail", f64::from(self.detail), 0.25, 4.0)
    }
}

/// Grows a plant: metres, y up, root at the origin.
///
/// The model has a mesh and node `wood` (absent in no plant) and, unless the plant is in winter,
/// `leaves`; exact leaf data stands in [`crate::scene::Primitive::botany`].
///
/// # Errors
/// Options outside their ranges.
pub fn grow(species: Species, options: &GrowOptions) -> Result<Model> {
    grow_with(species.name(), &species.parameters(), options)
}

/// Grows a plant from a table of one's own.
///
/// # Errors
/// Parameters or options outside their ranges.
pub fn grow_with(name: &str, parameters: &Parameters, options: &GrowOptions) -> Result<Model> {
    let wanted = options.leaves.unwrap_or(parameters.leaf.count);
    GrowOptions {
        leaves: Some(wanted),
        ..*options
    }
    .check()?;
    let skeleton = skeleton(parameters, options)?;
    let shares = leaves::share_out(&skeleton, parameters, wanted);
    let detail = f64::from(options.detail);
    let mut model = Model {
        name: name.to_owned(),
        ..Model::default()
    };
    let bark = add_bark(&mut model, parameters.bark);
    let trunk = wood::mesh(&skeleton, &shares.keep, parameters, detail, bark);
    add_mesh(&mut model, "wood", trunk);
    if wanted > 0 {
        let material = add_leaf(&mut model, parameters.leaf.shape);
        let foliage = leaves::mesh(&skeleton, &shares, parameters, options.seed, material);
        add_mesh(&mut model, "leaves", foliage);
    }
    Ok(model)
}

/// The plant umbrage shows when it is given none: a broad-leaved tree.
#[must_use]
pub fn embedded() -> Model {
    grow(Species::Broadleaf, &GrowOptions::default()).expect("the default options are in range")
}

fn add_mesh(model: &mut Model, name: &str, primitive: crate::scene::Primitive) {
    model.instances.push(Instance {
        name: name.to_owned(),
        mesh: model.meshes.len(),
        local_to_world: DAffine3::IDENTITY,
        source: None,
    });
    model.meshes.push(Mesh {
        name: name.to_owned(),
        primitives: vec![primitive],
    });
}

fn add_texture(model: &mut Model, name: &str, size: [u32; 2], pixels: Arc<[u8]>) -> TextureRef {
    model.images.push(ImageSource::Rgba8 {
        name: name.to_owned(),
        width: size[0],
        height: size[1],
        pixels,
    });
    model.textures.push(Texture {
        image: model.images.len() - 1,
        ..Texture::default()
    });
    TextureRef::new(model.textures.len() - 1)
}

fn add_bark(model: &mut Model, style: BarkStyle) -> usize {
    static DRAWN: [OnceLock<Arc<[u8]>>; 4] = [const { OnceLock::new() }; 4];
    let pixels = DRAWN[style as usize].get_or_init(|| bark_texture::pixels(style).into());
    let texture = add_texture(model, "bark", bark_texture::SIZE, pixels.clone());
    model.materials.push(Material {
        name: "bark".to_owned(),
        base_color_texture: Some(texture),
        roughness: 0.9,
        ..Material::default()
    });
    model.materials.len() - 1
}

fn add_leaf(model: &mut Model, shape: LeafShape) -> usize {
    static DRAWN: [OnceLock<Arc<[u8]>>; 4] = [const { OnceLock::new() }; 4];
    let (name, roughness, through) = match shape {
        LeafShape::Ovate => ("ovate leaf", 0.55, 0.38),
        LeafShape::Cordate => ("heart-shaped leaf", 0.6, 0.42),
        LeafShape::Elliptic => ("elliptic leaf", 0.5, 0.33),
        LeafShape::NeedleSpray => ("needle", 0.6, 0.15),
    };
    let pixels = DRAWN[shape as usize].get_or_init(|| leaf_texture::pixels(shape).into());
    let texture = add_texture(model, name, leaf_texture::SIZE, pixels.clone());
    model.materials.push(Material {
        name: name.to_owned(),
        base_color_texture: Some(texture),
        roughness,
        double_sided: true,
        // Leaves let 0.3 to 0.5 of what they do not absorb through, yellower than they reflect
        // (Jacquemoud and Baret 1990, green peak); needles are thick.
        diffuse_transmission: Some(DiffuseTransmission {
            factor: through,
            texture: None,
            color: [0.30, 0.42, 0.06],
            color_texture: None,
        }),
        ..Material::default()
    });
    model.materials.len() - 1
}
