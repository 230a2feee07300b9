//! Stage 2: lines, strokes and washes of attributes, in image space. Each style works on its own
//! pixels; every kind of pass runs for all styles before the next kind, since a pass reads what
//! others left around its pixels.

use super::frame::InkRenderer;
use super::looks::Paints;
use super::pipelines::Stage2Pipelines;
use super::styles::half_width;
use crate::Result;
use crate::abi::{
    INK_DEPTH_LINEAR, INK_DEPTH_MAPPED, InkClean, InkCompose, InkContour, InkSilhouette,
};
use crate::gpu::{Binding, ComputePipeline, Gpu, Image, Work};
use crate::ink::images::{band_image, tile_image};
use crate::ink::mix::MixPlan;
use crate::ink::plan::Attribute;
use crate::ink::style::Style;
use crate::ink::view::View;
use crate::math::colour::srgb_to_linear;

/// Pipelines and textures of the second stage of a style.
pub(super) struct Stage2 {
    /// Number of the style.
    pub(super) number: usize,
    pub(super) style: Style,
    pipelines: Stage2Pipelines,
    /// Strokes along outlines, in four tones.
    strokes: Option<Image>,
    /// Hatching.
    tiles: Option<Image>,
    /// Whether this style is the first that has contours, or silhouettes: it clears what is not
    /// its own, so that pixels of styles without them have none.
    clears: [bool; 2],
    /// Edges and paint.
    pub(super) paints: Paints,
}

impl Stage2 {
    /// What the plan has for a style.
    pub(super) fn new(
        gpu: &Gpu,
        plan: &MixPlan,
        (number, style): (usize, &Style),
        size: [u32; 2],
    ) -> Result<Self> {
        let own = &plan.styles[number];
        let strokes = own.silhouette.then(|| band_image(gpu, style));
        let tiles = own.hatching.then(|| tile_image(gpu, style));
        let earlier = &plan.styles[..number];
        Ok(Self {
            number,
            style: style.clone(),
            pipelines: Stage2Pipelines::new(gpu, plan, number)?,
            strokes: strokes.transpose()?,
            tiles: tiles.transpose()?,
            clears: [
                !earlier.iter().any(|p| p.contour),
                !earlier.iter().any(|p| p.silhouette),
            ],
            paints: Paints::new(gpu, own, size)?,
        })
    }
}

impl InkRenderer {
    pub(super) fn stage2(&self, work: &mut Work, view: &View) -> Result<()> {
        for style in &self.stage2 {
            self.contour(work, style, view)?;
        }
        for style in &self.stage2 {
            self.clean(work, style)?;
        }
        for style in &self.stage2 {
            self.silhouette(work, style)?;
        }
        for style in &self.stage2 {
            self.edges(work, style)?;
        }
        for style in &self.stage2 {
            self.wash(work, style)?;
        }
        for style in &self.stage2 {
            self.compose(work, style)?;
        }
        Ok(())
    }

    /// Runs a kernel over the picture for a style.
    pub(super) fn pass<P: bytemuck::Pod>(
        &self,
        work: &mut Work,
        (name, of): (&str, &Stage2),
        kernel: &ComputePipeline,
        bindings: &[Binding<'_>],
        push: &P,
    ) -> Result<()> {
        let label = self.plan.label(name, of.number);
        let invocations = [self.size[0], self.size[1], 1];
        work.compute(&label, kernel, bindings, push, invocations)
    }

    fn contour(&self, work: &mut Work, of: &Stage2, view: &View) -> Result<()> {
        let (Some(kernel), Some(out)) = (&of.pipelines.contour, &self.targets.lines[0]) else {
            return Ok(());
        };
        let bindings = [
            self.targets.attribute(Attribute::Depth),
            self.targets.attribute(Attribute::Ids),
            self.targets.attribute(Attribute::Direction),
            Binding::StorageWrite(out),
        ];
        let push = self.contour_push(of, view);
        self.pass(work, ("ink contour", of), kernel, &bindings, &push)
    }

    fn clean(&self, work: &mut Work, of: &Stage2) -> Result<()> {
        let (Some(kernel), Some(out)) = (&of.pipelines.clean, &self.targets.lines[1]) else {
            return Ok(());
        };
        let bindings = [
            self.targets.line(0),
            self.targets.attribute(Attribute::Ids),
            Binding::StorageWrite(out),
        ];
        let push = InkClean {
            width: self.size[0],
            height: self.size[1],
            neighbours: of.style.contour.neighbours,
            style: of.number as u32,
            clears: u32::from(of.clears[0]),
        };
        self.pass(work, ("ink clean", of), kernel, &bindings, &push)
    }

    fn silhouette(&self, work: &mut Work, of: &Stage2) -> Result<()> {
        let (Some(kernel), Some(strokes), Some(out)) = (
            &of.pipelines.silhouette,
            &of.strokes,
            &self.targets.lines[2],
        ) else {
            return Ok(());
        };
        let bindings = [
            self.targets.attribute(Attribute::Ids),
            self.targets.attribute(Attribute::Direction),
            self.tone(of),
            self.targets.line(1),
            Binding::Sampled(strokes, &self.targets.smooth),
            Binding::Read(&self.clusters),
            Binding::StorageWrite(out),
        ];
        let s = &of.style.silhouette;
        let factor = self.factor as f32;
        let push = InkSilhouette {
            width: self.size[0],
            height: self.size[1],
            reach: (s.width * factor).max(1.0),
            band_length: s.length * factor,
            aspect: s.aspect,
            blend: u32::from(s.blend),
            style: of.number as u32,
            clears: u32::from(of.clears[1]),
        };
        self.pass(work, ("ink silhouette", of), kernel, &bindings, &push)
    }

    fn compose(&self, work: &mut Work, of: &Stage2) -> Result<()> {
        let tiles = of.tiles.as_ref().unwrap_or(&self.targets.nothing);
        let bindings = [
            self.targets.attribute(Attribute::Depth),
            self.targets.attribute(Attribute::Albedo),
            self.targets.attribute(Attribute::Normal),
            self.targets.attribute(Attribute::Hatch),
            self.targets.line(1),
            self.targets.line(2),
            Binding::Sampled(tiles, &self.targets.repeating),
            Binding::StorageWrite(&self.targets.picture),
            self.targets.attribute(Attribute::Ids),
            Binding::Read(&self.styles.records),
            self.look(self.light.as_ref().map(|l| &l.image)),
            self.look(of.paints.edges()),
            self.look(of.paints.wash()),
        ];
        let kernel = &of.pipelines.compose;
        let push = self.compose_push(of);
        self.pass(work, ("ink compose", of), kernel, &bindings, &push)
    }

    fn contour_push(&self, of: &Stage2, view: &View) -> InkContour {
        let c = &of.style.contour;
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
            style: of.number as u32,
            clears: u32::from(of.clears[0]),
        }
    }

    fn compose_push(&self, of: &Stage2) -> InkCompose {
        let s = &of.style;
        let widths = self
            .stage2
            .iter()
            .map(|o| half_width(&o.style, self.factor));
        InkCompose {
            paper: s.paper.colour.map(srgb_to_linear),
            width: self.size[0],
            ink: s.paper.ink.map(srgb_to_linear),
            height: self.size[1],
            silhouette: s.silhouette.strength,
            hatching: s.hatching.strength,
            colour: s.shading.colour,
            shading: s.shading.strength,
            half_width: widths.fold(0.0, f32::max),
            style: of.number as u32,
            steps: s.shading.steps,
            white: s.hatching.white,
            gamma: s.hatching.gamma,
            hardness: s.shading.hardness,
            sun: s.shading.sun,
            exposure: s.shading.exposure,
            sky: s.shading.sky,
            edges: s.edges.strength,
            wash: s.wash.strength,
        }
    }
}
