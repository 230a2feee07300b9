//! The sun's view of a plant as the style draws it: depths that shadows are made from.

use glam::Vec3;

use super::frame::{InkRenderer, InkScene};
use super::order::Order;
use super::styles::Styles;
use crate::Result;
use crate::abi::{INK_SHADOW_REACH, InkFrame, InkLight};
use crate::gpu::{Binding, DepthTarget, RenderPass, Work};
use crate::ink::plan::{Attribute, InkPlan};
use crate::ink::style::Style;
use crate::ink::view::View;
use crate::scene::LightView;

/// Texels around the plant that stay empty, so that the filter reads light there.
const BORDER: u32 = INK_SHADOW_REACH + 1;
/// Texels by which maps grow with the picture.
const STEP: u32 = 64;
/// Texels of the map by which a caster must lie before what it shades, at least.
const LEAST_BIAS: f32 = 2.0;

/// Size of the sun's map and of its filter, for a first view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SunMap {
    /// Texels along an edge: of the style that wants most, and no more than the picture shows.
    pub(super) texels: u32,
    /// Radius of the filter, texels: of the style with the widest.
    pub(super) reach: f32,
}

impl SunMap {
    /// For those of `styles` that have shadows.
    pub(super) fn new(scene: &InkScene<'_>, styles: &[Style], view: &View) -> Self {
        let shadows = || styles.iter().filter(|s| InkPlan::new(s).shadow);
        let full = shadows()
            .map(|s| s.shading.shadow_texels)
            .max()
            .unwrap_or(1);
        // Of the plant as it is: what the styles make of its leaves must not change the map's size
        // at every step of a slider.
        let points = scene.geometry.positions.iter().copied();
        let spanned = LightView::fit(view.to_sun.as_dvec3(), points, full, 0).extent;
        let pixel = view.middle_distance() / view.focal();
        let pixels = f64::from(spanned[0].max(spanned[1])) / pixel;
        let seen = |s: &Style| {
            // A division by zero is infinite: all texels.
            let steps = pixels / f64::from(s.shading.shadow_pixels) / f64::from(STEP);
            let steps = steps.clamp(1.0, f64::from(u32::MAX / STEP)).ceil() as u32;
            s.shading.shadow_texels.min(steps * STEP)
        };
        let texels = shadows().map(seen).max().unwrap_or(1);
        let radius = shadows().map(|s| s.shading.shadow_radius);
        let share = texels as f32 / full as f32;
        Self {
            texels,
            reach: radius.map(|r| (r * share).max(1.0)).fold(1.0, f32::max),
        }
    }
}

/// The box that the sun's map spans: the wood and wherever the styles may put leaves.
fn sun_view(
    scene: &InkScene<'_>,
    styles: &[Style],
    (view, factor): (&View, u32),
    texels: u32,
) -> LightView {
    let leaves = scene.plant.leaves.iter().map(|l| l.radius);
    let leaf = leaves.fold(0.0, f32::max) * leaf_factor(scene, styles, view, factor);
    let clusters = scene.plant.clusters.iter().flat_map(|set| &set.clusters);
    let corners = clusters.flat_map(|c| {
        let reach = c.radius + leaf;
        (0..8).map(move |k: u32| {
            let side = |bit: u32| if k >> bit & 1 == 1 { reach } else { -reach };
            c.centre + Vec3::new(side(0), side(1), side(2))
        })
    });
    let points = scene.geometry.positions.iter().copied().chain(corners);
    LightView::fit(view.to_sun.as_dvec3(), points, texels, BORDER)
}

/// What the style with the largest leaves makes of their radii.
fn leaf_factor(scene: &InkScene<'_>, styles: &[Style], view: &View, factor: u32) -> f32 {
    let of = |s: &Style| {
        let long = s.leaves.elongation.max(1.0 / s.leaves.elongation);
        Styles::detail(s, scene, view, factor).size * long.sqrt()
    };
    styles.iter().map(of).fold(0.0, f32::max)
}

impl InkRenderer {
    /// The sun's view of the plant as it is drawn in `view`.
    pub(super) fn sun_view(&self, scene: &InkScene<'_>, view: &View) -> LightView {
        let texels = self.light.as_ref().map_or(1, |l| l.map.texels);
        let styles = &self.styles.mix.styles;
        sun_view(scene, styles, (view, self.factor), texels)
    }

    /// Radius of a median leaf as the style with the largest ones draws it, metres.
    fn leaf_radius(&self, scene: &InkScene<'_>, view: &View) -> f32 {
        let styles = &self.styles.mix.styles;
        scene.plant.leaf_radius * leaf_factor(scene, styles, view, self.factor)
    }

    /// Depth as the sun sees it, where the style has shadows. Leaves that face the viewer in the
    /// picture face the sun here: what they stand for is no thinner from there.
    pub(super) fn sun_map(
        &self,
        work: &mut Work,
        (scene, drawn): (&InkScene<'_>, &[u32]),
        view: &View,
        (frame, sun): (&InkFrame, &LightView),
    ) -> Result<()> {
        let Some(shadow) = self.light.as_ref().and_then(|l| l.shadow.as_ref()) else {
            return Ok(());
        };
        let [width, height] = shadow.map.info().extent;
        let seen = InkFrame {
            width,
            height,
            relative_to_clip: sun.relative_to_clip.to_cols_array_2d(),
            forward: (-view.to_sun).to_array(),
            wood: 0.0,
            ..*frame
        };
        work.upload("ink sun frame", &shadow.frame, &[seen])?;
        // What the sun sees first hides the rest before its shape is looked up.
        let order = Order::new(scene.plant, drawn, -view.to_sun.as_dvec3());
        work.upload("ink sun order", &shadow.order, &order.indices)?;
        let u = &self.uploads;
        let leaf_set = self.leaf_set(&shadow.frame);
        let wood_set = self.wood_set(&shadow.frame);
        let mut reads = leaf_set.to_vec();
        reads.extend(&wood_set[1..]);
        reads.push(Binding::Index(&u.indices));
        reads.push(Binding::Index(&shadow.order));
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
            draws.index_buffer(&shadow.order);
            draws.draw_indexed(0..order.indices.len() as u32, 1)
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
        let texel = sun.extent[0].max(sun.extent[1]) / light.map.texels as f32;
        // A leaf is flat and hides nothing of itself: what lies within its own size casts no shadow.
        let bias = self
            .leaf_radius(scene, view)
            .max(LEAST_BIAS * texel * light.map.reach);
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
            reach: light.map.reach,
            bias: bias / sun.range,
            texels: light.map.texels,
        };
        let invocations = [self.size[0], self.size[1], 1];
        work.compute("ink light", &light.kernel, &bindings, &push, invocations)
    }
}
