//! Stage 1: leaves and wood into targets of attributes.

use super::frame::{InkRenderer, InkScene};
use crate::Result;
use crate::abi::{
    INK_STROKES_ALONG, INK_STROKES_BODY, INK_STROKES_ROUND, INK_TILE, InkLeafDraw, InkWoodDraw,
};
use crate::gpu::{Binding, DepthTarget, RenderPass, Work};
use crate::ink::style::WoodStrokes;
use crate::scene::{AlphaMode, Material, Model};

impl InkRenderer {
    pub(super) fn stage1(&self, work: &mut Work, scene: &InkScene<'_>) -> Result<()> {
        let u = &self.uploads;
        let leaf_set = [
            Binding::Read(&self.frame),
            Binding::Read(&u.leaves),
            Binding::Read(&self.clusters),
            Binding::Sampled(&u.shapes, &self.targets.smooth),
        ];
        let wood_set = [
            Binding::Read(&self.frame),
            Binding::Read(&u.positions),
            Binding::Read(&u.normals),
            Binding::Read(&u.texcoords),
            Binding::Read(&u.hatches),
            Binding::Read(&self.clusters),
        ];
        let mut reads = leaf_set.to_vec();
        reads.extend(&wood_set[1..5]);
        reads.push(Binding::Index(&u.indices));
        reads.extend(u.textures.iter().map(|(i, s)| Binding::Sampled(i, s)));
        let pass = RenderPass {
            extent: self.size,
            color: &self.targets.color(),
            depth: Some(DepthTarget {
                image: &self.targets.depth,
                clear: Some(0.0),
                store: false,
            }),
            reads: &reads,
        };
        work.render("ink stage 1", &pass, |draws| {
            draws.pipeline(&self.stage1.wood);
            draws.bind(0, &wood_set)?;
            draws.index_buffer(&u.indices);
            let wood = if self.style.bodies.smooth {
                &scene.plant.bodies.parts
            } else {
                &scene.plant.wood
            };
            for (material, instance, range) in wood {
                let (image, sampler) = &u.textures[*material];
                draws.bind(1, &[Binding::Sampled(image, sampler)])?;
                draws.push(&self.wood_draw(scene.model, *material, *instance))?;
                draws.draw_indexed(range.clone(), 1)?;
            }
            draws.pipeline(&self.stage1.leaves);
            draws.bind(0, &leaf_set)?;
            for (material, range) in &scene.plant.batches {
                let (image, sampler) = &u.textures[*material as usize];
                draws.bind(1, &[Binding::Sampled(image, sampler)])?;
                draws.push(&self.leaf_draw(scene.model, *material as usize))?;
                draws.draw(6 * range.start..6 * range.end, 1)?;
            }
            Ok(())
        })
    }

    fn leaf_draw(&self, model: &Model, material: usize) -> InkLeafDraw {
        let m = &model.materials[material];
        let [u, v] = texture_rows(m);
        let (l, h) = (&self.style.leaves, &self.style.hatching);
        InkLeafDraw {
            base_color: m.base_color,
            texcoord_u: u,
            displacement: l.displacement,
            texcoord_v: v,
            orientation: l.orientation,
            facing: l.facing,
            size: l.size * self.style.enlargement(),
            // A painted outline is mixed into the shapes themselves.
            shape: if l.outline.is_some() { 1.0 } else { l.shape },
            kept: l.kept,
            crown: self.style.shading.crown,
            packing: h.packing,
            packing_steps: h.packing_steps as f32,
        }
    }

    fn wood_draw(&self, model: &Model, material: usize, instance: usize) -> InkWoodDraw {
        let m = &model.materials[material];
        let [u, v] = texture_rows(m);
        let scale = f64::from(self.style.hatching.scale) * f64::from(self.factor);
        InkWoodDraw {
            base_color: m.base_color,
            texcoord_u: u,
            cutoff: match m.alpha_mode {
                AlphaMode::Opaque => -1.0,
                AlphaMode::Mask { cutoff } => cutoff,
                AlphaMode::Blend => 0.5,
            },
            texcoord_v: v,
            // Wood is no part of the clusters: a line goes between the two.
            object: (1 << 20) + instance as u32,
            tiles: (1.0 / (self.reference * f64::from(INK_TILE) * scale)) as f32,
            strokes: match self.style.hatching.wood {
                _ if self.style.bodies.smooth => INK_STROKES_BODY,
                WoodStrokes::Along => INK_STROKES_ALONG,
                WoodStrokes::Round => INK_STROKES_ROUND,
            },
        }
    }
}

/// The texture transform of a material's colour.
fn texture_rows(material: &Material) -> [[f32; 3]; 2] {
    material
        .base_color_texture
        .map_or([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], |t| t.transform)
}
