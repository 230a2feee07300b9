//! What stage 1 knows of styles: their numbers, and which leaf and which piece of wood has which.

use super::frame::InkScene;
use crate::Result;
use crate::abi::{
    INK_HATCH_CLUSTER, INK_HATCH_OBJECT, INK_HATCH_SCREEN, INK_STROKES_ALONG, INK_STROKES_ROUND,
    INK_TILE, InkFrame, InkPart, InkPlacement, InkStyle,
};
use crate::gpu::{Buffer, BufferInfo, Gpu, Work};
use crate::ink::lod::Detail;
use crate::ink::mix::{Mix, Regions};
use crate::ink::style::{HatchSpace, Style, WoodStrokes};
use crate::ink::view::View;

/// Styles of a scene on the device.
pub(super) struct Styles {
    pub(super) mix: Mix,
    pub(super) regions: Regions,
    pub(super) records: Buffer,
    pub(super) placements: Buffer,
    pub(super) parts: Buffer,
    pub(super) masks: Buffer,
}

impl Styles {
    /// Lays a mix over the scene for pictures of the size of `view`.
    pub(super) fn new(
        gpu: &Gpu,
        scene: &InkScene<'_>,
        mix: &Mix,
        view: &View,
        factor: u32,
    ) -> Result<Self> {
        let regions = Regions::new(mix, scene.model, scene.plant, view.size, factor)?;
        let records = mix.styles.len() * size_of::<InkStyle>();
        let parts = regions.records(view).len() * size_of::<InkPart>();
        let device = |name, bytes: usize| gpu.buffer(BufferInfo::device(name, bytes as u64));
        let mut placements = regions.placements(scene.plant, view);
        if placements.is_empty() {
            // Buffers have at least one element.
            placements.push(InkPlacement::default());
        }
        Ok(Self {
            mix: mix.clone(),
            records: device("ink styles", records)?,
            placements: gpu.upload("ink placements", &placements)?,
            parts: device("ink parts", parts)?,
            masks: gpu.upload("ink masks", regions.mask_words())?,
            regions,
        })
    }

    /// Brings up to date what depends on the view. `reference` is the metres of a pixel
    /// where strokes have the styles' size, `factor` the pixels drawn for one of the picture.
    pub(super) fn upload(
        &self,
        work: &mut Work,
        scene: &InkScene<'_>,
        view: &View,
        (reference, factor): (f64, u32),
    ) -> Result<()> {
        let record = |style: &Style| {
            let detail = Self::detail(style, scene, view, factor);
            record(style, &detail, reference, factor)
        };
        let records: Vec<InkStyle> = self.mix.styles.iter().map(record).collect();
        work.upload("ink styles", &self.records, &records)?;
        work.upload("ink parts", &self.parts, &self.regions.records(view))?;
        if self.mix.follows_view() {
            let placements: Vec<InkPlacement> = self.regions.placements(scene.plant, view);
            work.upload("ink placements", &self.placements, &placements)?;
        }
        Ok(())
    }

    /// What of a style is drawn in a view: fewer leaves where they are small.
    pub(super) fn detail(style: &Style, scene: &InkScene<'_>, view: &View, factor: u32) -> Detail {
        let metres = f64::from(factor) * view.middle_distance() / view.focal();
        Detail::seen(style, scene.plant.leaf_radius, metres as f32)
    }

    /// What kernels need of the view.
    pub(super) fn frame(&self, scene: &InkScene<'_>, view: &View, factor: u32) -> InkFrame {
        let styles = self.mix.styles.iter();
        let wood = styles.map(|s| Self::detail(s, scene, view, factor).wood);
        InkFrame {
            wood: factor as f32 * wood.fold(0.0, f32::max),
            parts: self.regions.len() as u32,
            masked: u32::from(self.regions.is_masked()),
            ..view.frame()
        }
    }
}

fn record(style: &Style, detail: &Detail, reference: f64, factor: u32) -> InkStyle {
    let (l, g) = (&style.leaves, &style.shading);
    let texel = f64::from(style.hatching.scale) * f64::from(factor);
    InkStyle {
        displacement: l.displacement,
        orientation: l.orientation,
        facing: l.facing,
        size: detail.size,
        // A painted outline is mixed into the shapes themselves.
        shape: if l.outline.is_some() {
            1.0
        } else {
            detail.shape
        },
        kept: detail.kept,
        crown: g.crown,
        packing: style.hatching.packing,
        packing_steps: style.hatching.packing_steps as f32,
        hatch_space: match style.hatching.space {
            HatchSpace::Cluster => INK_HATCH_CLUSTER,
            HatchSpace::Screen => INK_HATCH_SCREEN,
            HatchSpace::Object => INK_HATCH_OBJECT,
        },
        hatch_texel: texel as f32,
        hatch_levels: u32::from(style.hatching.levels),
        ambient: g.ambient,
        depth_of_crown: g.depth,
        wood_tiles: (1.0 / (reference * f64::from(INK_TILE) * texel)) as f32,
        wood_strokes: match style.hatching.wood {
            WoodStrokes::Along => INK_STROKES_ALONG,
            WoodStrokes::Round => INK_STROKES_ROUND,
        },
        contour: style.contour.strength,
        half_width: half_width(style, factor),
        wrap: g.wrap,
        shadow: g.shadow,
        shorten: style.edges.ambient,
        elongation: l.elongation,
        swirl: l.swirl,
        flatness: g.flat,
        variation: g.variation,
        bristles: g.bristles,
    }
}

/// Half the width of contours, pixels.
pub(super) fn half_width(style: &Style, factor: u32) -> f32 {
    0.5 * style.contour.width * factor as f32
}
