//! Draws: everything of one material goes out in one call.

use std::ops::Range;

use super::order::{self, Cluster};
use super::plan::Plan;
use super::settings::RenderSettings;
use super::subject::Subject;
use super::texture::{self, TextureKey};
use crate::abi::{self, RenderMaterial};
use crate::scene::{Material, Wrap};

/// All triangles that share a material and the way their normals are treated.
#[derive(Debug, Clone)]
pub(super) struct Batch {
    /// Push constants.
    pub(super) material: RenderMaterial,
    /// Leaves are cut out by alpha.
    pub(super) cuts: bool,
    /// Realigned normals: they do not turn round on back faces.
    pub(super) foliage: bool,
    /// Label of the base colour texture's image.
    pub(super) texture: Option<String>,
    /// Label of the alpha texture's image for the shadow pass.
    pub(super) alpha: Option<String>,
    /// Wrap modes and magnification of the texture.
    pub(super) wrap: ([Wrap; 2], bool),
    /// Pieces that are sorted by depth.
    pub(super) clusters: Vec<Cluster>,
    /// Range of the index buffer in camera order.
    pub(super) indices: Range<u32>,
    /// Range of the index buffer in sun order.
    pub(super) shadow_indices: Range<u32>,
}

/// Parts of a subject that one draw can hold.
#[derive(Debug, Clone)]
pub(super) struct Group {
    /// Index of the material.
    material: usize,
    /// Normals were realigned.
    foliage: bool,
    /// Index ranges.
    ranges: Vec<Range<usize>>,
}

/// Parts grouped by material and treatment of normals, in order of appearance.
pub(super) fn groups(subject: &Subject<'_>) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for (i, part) in subject.geometry.parts.iter().enumerate() {
        let foliage = subject
            .baked
            .is_some_and(|b| b.foliage_parts.get(i).copied().unwrap_or(false));
        let found = groups
            .iter_mut()
            .find(|g| (g.material, g.foliage) == (part.material, foliage));
        match found {
            Some(group) => group.ranges.push(part.index_range()),
            None => groups.push(Group {
                material: part.material,
                foliage,
                ranges: vec![part.index_range()],
            }),
        }
    }
    groups
}

/// Materials that a surface record can tell apart; the rest share the last one's reflection (not
/// its base colour).
const MATERIAL_IDS: usize = 256;

/// The batches of a subject: opaque ones first, since what they hide need not be read.
pub(super) fn batches(plan: &Plan, subject: &Subject<'_>, settings: &RenderSettings) -> Vec<Batch> {
    let mut out: Vec<Batch> = groups(subject)
        .into_iter()
        .map(|group| {
            let default = Material::default();
            let material = subject
                .model
                .materials
                .get(group.material)
                .unwrap_or(&default);
            batch(plan, subject, settings, material, &group)
        })
        .collect();
    out.sort_by_key(|b| b.cuts);
    for (i, batch) in out.iter_mut().enumerate() {
        batch.material.id = u32::try_from(i.min(MATERIAL_IDS - 1)).expect("small");
    }
    out
}

fn batch(
    plan: &Plan,
    subject: &Subject<'_>,
    settings: &RenderSettings,
    material: &Material,
    group: &Group,
) -> Batch {
    let foliage = group.foliage;
    let model = subject.model;
    let planned = |alpha_only| {
        let key = texture::base_color_key(model, material)?;
        let label = TextureKey { alpha_only, ..key }.label(model);
        plan.image(&label).map(|i| i.label.clone())
    };
    let texture = planned(false);
    // Without its texture alpha would cut nothing out but could hide everything.
    let cutoff = if texture.is_some() {
        texture::cutoff(material)
    } else {
        0.0
    };
    let cuts = cutoff > 0.0;
    let reference = material.base_color_texture;
    let [texcoord_u, texcoord_v] = reference.map_or([[1., 0., 0.], [0., 1., 0.]], |r| r.transform);
    let wrap = reference
        .and_then(|r| model.textures.get(r.texture))
        .map_or(([Wrap::Repeat; 2], false), |t| {
            ([t.wrap_u, t.wrap_v], t.nearest)
        });
    let unlit = if material.unlit {
        abi::MATERIAL_UNLIT
    } else {
        0
    };
    Batch {
        material: RenderMaterial {
            base_color: material.base_color,
            texcoord_u,
            cutoff,
            texcoord_v,
            specular: settings.specular * (1.0 - material.roughness * material.roughness).max(0.0),
            emissive: material.emissive,
            shininess: settings.shininess,
            transmission: transmission(material, foliage, settings),
            flags: unlit,
            id: 0,
        },
        cuts,
        foliage,
        texture,
        alpha: planned(true).filter(|_| cuts),
        wrap,
        clusters: order::clusters(&subject.geometry.indices, &group.ranges),
        indices: 0..0,
        shadow_indices: 0..0,
    }
}

/// Share and tint of light that goes through: the material's own, else the setting for foliage.
fn transmission(material: &Material, foliage: bool, settings: &RenderSettings) -> [f32; 3] {
    match &material.diffuse_transmission {
        Some(t) => t.color.map(|c| c * t.factor),
        None if foliage => [settings.translucency; 3],
        None => [0.0; 3],
    }
}

impl Batch {
    /// Push constants for a draw in which normals are the realigned ones or the model's own.
    pub(super) fn push(&self, realigned: bool, flip_back_faces: bool) -> RenderMaterial {
        let keeps = realigned && self.foliage && !flip_back_faces;
        let flip = if keeps { 0 } else { abi::MATERIAL_FLIP };
        RenderMaterial {
            flags: self.material.flags | flip,
            ..self.material
        }
    }
}
