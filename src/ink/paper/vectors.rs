//! How the vectors of a drawing are found.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::curve::Polyline;
use super::drawing::{Placement, Shade, Visible, stem_marks, width};
use super::pen::Stroke;
use super::renderer::Maps;
use super::style::PaperStyle;
use super::{tiles, whole};
use crate::ink::view::View;
use crate::math::sampling::pcg;

/// How the vectors of a drawing are found; of it bitmaps take where strokes go.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Vectors {
    /// What lines of foliage follow.
    pub lines: Lines,
    /// Where strokes of hatching go.
    pub strokes: StrokePlaces,
    /// Edge of the cells of space that anchored strokes are counted in, metres, 0 (by the view) to
    /// 1e9: the same for all frames of a sequence.
    pub cell: f64,
}

/// Where strokes that carry a tone go.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StrokePlaces {
    /// By error diffusion in the picture: an even tone, other strokes in every view.
    #[default]
    Diffused,
    /// On places of what they lie on: they stay there from frame to frame. Sequences always have
    /// these.
    Anchored,
}

/// What lines of foliage follow.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Lines {
    /// The outline of each primitive, where the bitmap has a line: exact, closed where seen whole.
    #[default]
    Primitives,
    /// The lines of the whole bitmap, stems and foliage merged: they go on from leaf to leaf.
    Bitmap,
}

/// Lines of the merged bitmap, pixels: those mostly on stems, and the others.
pub(super) fn whole_bitmap(
    maps: &Maps,
    visible: &Visible,
    shade: &Shade<'_>,
    style: &PaperStyle,
) -> [Vec<Polyline>; 2] {
    let stems = stem_marks(maps, visible, style);
    let marked: Vec<bool> = shade
        .foliage_marks()
        .zip(&visible.foliage)
        .zip(&stems)
        .enumerate()
        .map(|(i, ((line, &seen), &stem))| {
            // Of the ground only the shadow is drawn.
            let leaf = maps.foliage_number[i] as usize <= maps.leaves;
            (style.foliage.draw && line && seen && leaf) || (style.stem.draw && stem)
        })
        .collect();
    let seen = visible.foliage.iter().zip(&visible.stems).enumerate();
    let (depth, number): (Vec<f32>, Vec<u32>) = seen
        .map(|(i, (&foliage, &stem))| match (foliage, stem) {
            (true, _) => (maps.foliage_depth[i], maps.foliage_number[i]),
            (_, true) => (maps.stem_depth[i], u32::MAX),
            _ => (0.0, 0),
        })
        .unzip();
    let lines = whole::lines(&whole::Whole {
        size: maps.size,
        marked: &marked,
        depth: &depth,
        number: &number,
    });
    let on_stems = |l: &Polyline| {
        let at = |p: &&DVec2| stems[p.y as usize * maps.size[0] + p.x as usize];
        2 * l.points.iter().filter(at).count() > l.points.len()
    };
    let (stems, foliage) = lines.into_iter().partition(on_stems);
    [stems, foliage]
}

/// Lines of foliage that are no primitive's own, drawn.
pub(super) fn traced_contour(
    (maps, lines): (&Maps, &[Polyline]),
    shade: &Shade<'_>,
    style: &PaperStyle,
    placement: &Placement,
) -> Vec<Stroke> {
    let pen = &style.foliage.pen;
    let one = |line: &Polyline| {
        // Where a line starts chooses the hand, whatever others there are.
        let start = line.points.first().copied().unwrap_or_default();
        let seed = pcg(start.x as u32 ^ pcg(start.y as u32 ^ style.seed));
        pen.draw(&placement.line(line), seed, |p| {
            let p = placement.pixel(p);
            shade.pressure(p) * width(maps, p, |i| maps.foliage_number[i] > 0)
        })
    };
    lines.iter().map(one).collect()
}

/// Strokes of hatching tiles on clusters of leaves.
pub(super) fn tile_hatching(
    maps: &Maps,
    visible: &Visible,
    style: &PaperStyle,
    view: &View,
    placement: &Placement,
) -> Vec<Stroke> {
    let texel = style.tiles.texel / placement.scale;
    let found = tiles::hatched(maps, &visible.foliage, (style, texel), view);
    let on = tiles::Ground {
        size: maps.size,
        cluster: &found.cluster,
        darkness: &found.darkness,
    };
    let lines = tiles::tile_lines(&on, &found.clusters, &tiles::tile(style), texel);
    let stroke = |l: tiles::TileLine| Stroke {
        line: placement.line(&l.line),
        // Pointed ends are as wide as a pen can draw.
        widths: l
            .widths
            .iter()
            .map(|w| (w * placement.scale).max(0.05))
            .collect(),
        primitive: Some(l.cluster + 1),
    };
    lines.into_iter().map(stroke).collect()
}
