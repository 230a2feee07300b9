//! Stage 1: leaves and wood into targets of attributes.

use super::frame::{InkRenderer, InkScene};
use super::order::Order;
use crate::Result;
use crate::abi::{INK_OBJECTS, INK_STROKES_BODY, INK_STROKES_ROUND, InkLeafDraw, InkWoodDraw};
use crate::gpu::{Binding, Buffer, DepthTarget, Draws, RenderPass, Work};
use crate::ink::view::View;
use crate::scene::{AlphaMode, Material, Model};

impl InkRenderer {
    pub(super) fn stage1(
        &self,
        work: &mut Work,
        (scene, drawn): (&InkScene<'_>, &[u32]),
        view: &View,
    ) -> Result<()> {
        let order = Order::new(scene.plant, drawn, view.camera.forward);
        work.upload("ink order", &self.order, &order.indices)?;
        let u = &self.uploads;
        let leaf_set = self.leaf_set(&self.frame);
        let mut wood_set = self.wood_set(&self.frame).to_vec();
        wood_set.extend([
            Binding::Read(&self.styles.records),
            Binding::Read(&self.styles.parts),
            Binding::Read(&self.styles.masks),
        ]);
        let mut reads = leaf_set.to_vec();
        // The frame, the clusters and the styles are there already.
        reads.extend(wood_set[1..5].iter().chain(&wood_set[7..]));
        reads.push(Binding::Index(&u.indices));
        reads.push(Binding::Index(&self.order));
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
            self.draw_wood(draws, scene)?;
            draws.pipeline(&self.stage1.leaves);
            draws.bind(0, &leaf_set)?;
            draws.index_buffer(&self.order);
            for (material, range) in &order.batches {
                let (image, sampler) = &u.textures[*material as usize];
                draws.bind(1, &[Binding::Sampled(image, sampler)])?;
                draws.push(&self.leaf_draw(scene.model, *material as usize))?;
                draws.draw_indexed(range.clone(), 1)?;
            }
            Ok(())
        })
    }

    /// Whether bodies are drawn instead of wood; no mix does.
    fn smooth_bodies(&self) -> bool {
        self.styles.mix.styles[0].bodies.smooth
    }

    /// What leaves are drawn from, in the view of `frame`.
    pub(super) fn leaf_set<'a>(&'a self, frame: &'a Buffer) -> [Binding<'a>; 6] {
        [
            Binding::Read(frame),
            Binding::Read(&self.uploads.leaves),
            Binding::Read(&self.clusters),
            Binding::Sampled(&self.uploads.shapes, &self.targets.smooth),
            Binding::Read(&self.styles.records),
            Binding::Read(&self.styles.placements),
        ]
    }

    /// What the vertices of wood are drawn from.
    pub(super) fn wood_set<'a>(&'a self, frame: &'a Buffer) -> [Binding<'a>; 6] {
        let u = &self.uploads;
        [
            Binding::Read(frame),
            Binding::Read(&u.positions),
            Binding::Read(&u.normals),
            Binding::Read(&u.texcoords),
            Binding::Read(&u.hatches),
            Binding::Read(&self.clusters),
        ]
    }

    /// The wood, with pipeline and set 0 bound.
    pub(super) fn draw_wood(&self, draws: &mut Draws<'_>, scene: &InkScene<'_>) -> Result<()> {
        let u = &self.uploads;
        draws.index_buffer(&u.indices);
        let wood = if self.smooth_bodies() {
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
        Ok(())
    }

    pub(super) fn leaf_draw(&self, model: &Model, material: usize) -> InkLeafDraw {
        let m = &model.materials[material];
        let [u, v] = texture_rows(m);
        InkLeafDraw {
            base_color: m.base_color,
            texcoord_u: u,
            texcoord_v: v,
        }
    }

    fn wood_draw(&self, model: &Model, material: usize, instance: usize) -> InkWoodDraw {
        let m = &model.materials[material];
        let [u, v] = texture_rows(m);
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
            object: INK_OBJECTS / 2 + instance as u32,
            strokes: if self.smooth_bodies() {
                INK_STROKES_BODY
            } else {
                INK_STROKES_ROUND
            },
            parts: self.styles.regions.bits(material, instance),
        }
    }
}

/// The texture transform of a material's colour.
fn texture_rows(material: &Material) -> [[f32; 3]; 2] {
    material
        .base_color_texture
        .map_or([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], |t| t.transform)
}
