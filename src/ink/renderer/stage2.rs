//! Stage 2: lines, strokes and washes of attributes, in image space.

use super::frame::InkRenderer;
use super::pipelines::Stage2Pipelines;
use crate::Result;
use crate::abi::{
    INK_DEPTH_LINEAR, INK_DEPTH_MAPPED, InkClean, InkCompose, InkContour, InkSilhouette,
};
use crate::gpu::{Binding, Gpu, Image, Work};
use crate::ink::images::{band_image, tile_image};
use crate::ink::plan::{Attribute, InkPlan};
use crate::ink::style::Style;
use crate::ink::view::View;
use crate::math::colour::srgb_to_linear;

/// Pipelines and textures of the second stage of a style.
pub(super) struct Stage2 {
    pipelines: Stage2Pipelines,
    /// Strokes along outlines, in four tones.
    strokes: Option<Image>,
    /// Hatching.
    tiles: Option<Image>,
}

impl Stage2 {
    /// What `plan`, the plan of `style`, has.
    pub(super) fn new(gpu: &Gpu, style: &Style, plan: &InkPlan) -> Result<Self> {
        let strokes = plan.silhouette.then(|| band_image(gpu, style));
        let tiles = plan.hatching.then(|| tile_image(gpu, style));
        Ok(Self {
            pipelines: Stage2Pipelines::new(gpu, plan)?,
            strokes: strokes.transpose()?,
            tiles: tiles.transpose()?,
        })
    }
}

impl InkRenderer {
    pub(super) fn stage2(&self, work: &mut Work, view: &View) -> Result<()> {
        self.contour(work, view)?;
        self.clean(work)?;
        self.silhouette(work)?;
        self.compose(work)
    }

    fn invocations(&self) -> [u32; 3] {
        [self.size[0], self.size[1], 1]
    }

    fn contour(&self, work: &mut Work, view: &View) -> Result<()> {
        let (Some(kernel), Some(out)) = (&self.stage2.pipelines.contour, &self.targets.lines[0])
        else {
            return Ok(());
        };
        let bindings = [
            self.targets.attribute(Attribute::Depth),
            self.targets.attribute(Attribute::Ids),
            self.targets.attribute(Attribute::Direction),
            Binding::StorageWrite(out),
        ];
        let push = self.contour_push(view);
        work.compute("ink contour", kernel, &bindings, &push, self.invocations())
    }

    fn clean(&self, work: &mut Work) -> Result<()> {
        let (Some(kernel), Some(out)) = (&self.stage2.pipelines.clean, &self.targets.lines[1])
        else {
            return Ok(());
        };
        let bindings = [self.targets.line(0), Binding::StorageWrite(out)];
        let push = InkClean {
            width: self.size[0],
            height: self.size[1],
            neighbours: self.style.contour.neighbours,
        };
        work.compute("ink clean", kernel, &bindings, &push, self.invocations())
    }

    fn silhouette(&self, work: &mut Work) -> Result<()> {
        let p = &self.stage2.pipelines;
        let (Some(kernel), Some(strokes), Some(out)) =
            (&p.silhouette, &self.stage2.strokes, &self.targets.lines[2])
        else {
            return Ok(());
        };
        let bindings = [
            self.targets.attribute(Attribute::Ids),
            self.targets.attribute(Attribute::Direction),
            self.targets.attribute(Attribute::Normal),
            self.targets.line(1),
            Binding::Sampled(strokes, &self.targets.smooth),
            Binding::Read(&self.clusters),
            Binding::StorageWrite(out),
        ];
        let s = &self.style.silhouette;
        let factor = self.factor as f32;
        let push = InkSilhouette {
            width: self.size[0],
            height: self.size[1],
            reach: (s.width * factor).round().max(1.0) as u32,
            band_length: s.length * factor,
            aspect: s.aspect,
            blend: u32::from(s.blend),
        };
        work.compute(
            "ink silhouette",
            kernel,
            &bindings,
            &push,
            self.invocations(),
        )
    }

    fn compose(&self, work: &mut Work) -> Result<()> {
        let tiles = self.stage2.tiles.as_ref().unwrap_or(&self.targets.nothing);
        let bindings = [
            self.targets.attribute(Attribute::Depth),
            self.targets.attribute(Attribute::Albedo),
            self.targets.attribute(Attribute::Normal),
            self.targets.attribute(Attribute::Hatch),
            self.targets.line(1),
            self.targets.line(2),
            Binding::Sampled(tiles, &self.targets.repeating),
            Binding::StorageWrite(&self.targets.picture),
        ];
        work.compute(
            "ink compose",
            &self.stage2.pipelines.compose,
            &bindings,
            &self.compose_push(),
            self.invocations(),
        )
    }

    fn contour_push(&self, view: &View) -> InkContour {
        let c = &self.style.contour;
        let [nearest, mut farthest] = view.depths;
        let mapped = c.mapping > 0.0;
        if mapped {
            // The mapping's own range: its ratio is the strength of abstraction.
            farthest = nearest * c.mapping;
        }
        InkContour {
            width: self.size[0],
            height: self.size[1],
            threshold: c.threshold,
            threshold_wood: c.threshold_wood,
            mapping: if mapped {
                INK_DEPTH_MAPPED
            } else {
                INK_DEPTH_LINEAR
            },
            nearest,
            farthest,
            detail: c.detail,
            detail_power: c.detail_power,
        }
    }

    fn compose_push(&self) -> InkCompose {
        let s = &self.style;
        InkCompose {
            paper: s.paper.colour.map(srgb_to_linear),
            width: self.size[0],
            ink: s.paper.ink.map(srgb_to_linear),
            height: self.size[1],
            contour: s.contour.strength,
            silhouette: s.silhouette.strength,
            hatching: s.hatching.strength,
            colour: s.shading.colour,
            shading: s.shading.strength,
            half_width: 0.5 * s.contour.width * self.factor as f32,
            steps: s.shading.steps as f32,
            white: s.hatching.white,
            gamma: s.hatching.gamma,
        }
    }
}
