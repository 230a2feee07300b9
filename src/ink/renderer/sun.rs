//! The sun's view of a plant as the style draws it: depths that shadows are made from.

use glam::Vec3;

use super::frame::{InkRenderer, InkScene};
use super::styles::Styles;
use crate::Result;
use crate::abi::{INK_SHADOW_REACH, InkFrame, InkLight};
use crate::gpu::{Binding, DepthTarget, RenderPass, Work};
use crate::ink::plan::Attribute;
use crate::ink::style::Style;
use crate::ink::view::View;
use crate::scene::LightView;

/// Texels around the plant that stay empty, so that the filter reads light there.
const BORDER: u32 = INK_SHADOW_REACH + 1;
/// Texels of the map by which a caster must lie before what it shades, at least.
const LEAST_BIAS: f32 = 2.0;

impl InkRenderer {
    /// The box that the sun's map spans: the wood and wherever the style may put leaves.
    pub(super) fn sun_view(&self, scene: &InkScene<'_>, view: &View) -> LightView {
        let leaves = scene.plant.leaves.iter().map(|l| l.radius);
        let leaf = leaves.fold(0.0, f32::max) * self.leaf_factor(scene, view);
        let clusters = scene.plant.clusters.iter().flat_map(|set| &set.clusters);
        let corners = clusters.flat_map(|c| {
            let reach = c.radius + leaf;
            (0..8).map(move |k: u32| {
                let side = |bit: u32| if k >> bit & 1 == 1 { reach } else { -reach };
                c.centre + Vec3::new(side(0), side(1), side(2))
            })
        });
        let points = scene.geometry.positions.iter().copied().chain(corners);
        let texels = self.light.as_ref().map_or(1, |l| l.texels);
        LightView::fit(view.to_sun.as_dvec3(), points, texels, BORDER)
    }

    /// Radius of a median leaf as the style with the largest ones draws it, metres.
    fn leaf_radius(&self, scene: &InkScene<'_>, view: &View) -> f32 {
        scene.plant.leaf_radius * self.leaf_factor(scene, view)
    }

    /// What the style with the largest leaves makes of their radii.
    fn leaf_factor(&self, scene: &InkScene<'_>, view: &View) -> f32 {
        let factor = |s: &Style| {
            let long = s.leaves.elongation.max(1.0 / s.leaves.elongation);
            Styles::detail(s, scene, view, self.factor).size * long.sqrt()
        };
        let factors = self.stage2.iter().map(|s| factor(&s.style));
        factors.fold(0.0, f32::max)
    }

    /// Depth as the sun sees it, where the style has shadows. Leaves that face the viewer in the
    /// picture face the sun here: what they stand for is no thinner from there.
    pub(super) fn sun_map(
        &self,
        work: &mut Work,
        scene: &InkScene<'_>,
        view: &View,
        (frame, sun): (&InkFrame, &LightView),
    ) -> Result<()> {
        let Some(shadow) = self.light.as_ref().and_then(|l| l.shadow.as_ref()) else {
            return Ok(());
        };
        let seen = InkFrame {
            relative_to_clip: sun.relative_to_clip.to_cols_array_2d(),
            forward: (-view.to_sun).to_array(),
            wood: 0.0,
            ..*frame
        };
        work.upload("ink sun frame", &shadow.frame, &[seen])?;
        let u = &self.uploads;
        let leaf_set = self.leaf_set(&shadow.frame);
        let wood_set = self.wood_set(&shadow.frame);
        let mut reads = leaf_set.to_vec();
        reads.extend(&wood_set[1..]);
        reads.push(Binding::Index(&u.indices));
        reads.extend(u.textures.iter().map(|(i, s)| Binding::Sampled(i, s)));
        let pass = RenderPass {
            extent: shadow.map.info().extent,
            color: &[],
            depth: Some(DepthTarget {
                image: &shadow.map,
                clear: Some(0.0),
                store: true,
            }),
            reads: &reads,
        };
        work.render("ink sun", &pass, |draws| {
            draws.pipeline(&shadow.wood);
            draws.bind(0, &wood_set)?;
            self.draw_wood(draws, scene)?;
            draws.pipeline(&shadow.leaves);
            draws.bind(0, &leaf_set)?;
            for (material, range) in &scene.plant.batches {
                draws.push(&self.leaf_draw(scene.model, *material as usize))?;
                draws.draw(6 * range.start..6 * range.end, 1)?;
            }
            Ok(())
        })
    }

    /// Sun, sky and shadow of every pixel, where the style tells them apart.
    pub(super) fn light(
        &self,
        work: &mut Work,
        (scene, view): (&InkScene<'_>, &View),
        sun: &LightView,
    ) -> Result<()> {
        let Some(light) = &self.light else {
            return Ok(());
        };
        let texel = sun.extent[0].max(sun.extent[1]) / light.texels as f32;
        // A leaf is flat and hides nothing of itself: what lies within its own size casts no shadow.
        let bias = self
            .leaf_radius(scene, view)
            .max(LEAST_BIAS * texel * light.reach);
        let bindings = [
            self.targets.attribute(Attribute::Depth),
            self.targets.attribute(Attribute::Normal),
            self.look(light.shadow.as_ref().map(|s| &s.map)),
            self.targets.attribute(Attribute::Ids),
            Binding::Read(&self.frame),
            Binding::Read(&self.styles.records),
            Binding::StorageWrite(&light.image),
        ];
        let push = InkLight {
            relative_to_sun: sun.relative_to_clip.to_cols_array_2d(),
            width: self.size[0],
            height: self.size[1],
            reach: light.reach,
            bias: bias / sun.range,
            texels: light.texels,
        };
        let invocations = [self.size[0], self.size[1], 1];
        work.compute("ink light", &light.kernel, &bindings, &push, invocations)
    }
}
