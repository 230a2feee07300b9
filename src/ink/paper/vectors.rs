//! How the vectors of a drawing are found.

use std::collections::HashMap;
use std::rc::Rc;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::curve::Polyline;
use super::drawing::{Placement, Shade, Visible, least, width};
use super::fit::nearest_on;
use super::particles::outline;
use super::pen::Stroke;
use super::polygon;
use super::renderer::Maps;
use super::silhouette::Edges;
use super::stem_strokes::stem_marks;
use super::style::PaperStyle;
use super::{tiles, whole};
use crate::ink::view::View;
use crate::math::sampling::pcg;

/// Pixels from which lines of the bitmap are moved onto outlines.
const REACH: f64 = 2.5;
/// Pixels over which the corners between two neighbouring points of a line lie.
const CORNERS: f64 = 6.0;

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
    (style, view): (&PaperStyle, &View),
    placement: &Placement,
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
    let mut known = Known::new(maps, style, view);
    let from = whole::Whole {
        size: maps.size,
        marked: &marked,
        depth: &depth,
        number: &number,
    };
    let lines = whole::lines(&from, &mut known);
    let on_stems = |l: &Polyline| {
        let at = |p: &&DVec2| stems[p.y as usize * maps.size[0] + p.x as usize];
        2 * l.points.iter().filter(at).count() > l.points.len()
    };
    let (mut stems, mut foliage): (Vec<_>, Vec<_>) = lines.into_iter().partition(on_stems);
    stems.retain(|l| l.length() >= least(style.stem.shortest, style, placement));
    foliage.retain(|l| l.length() >= least(style.foliage.shortest, style, placement));
    [stems, foliage]
}

/// Outlines that lines of the bitmap are moved onto: those of primitives, and of stems where their
/// normals turn from the eye.
struct Known<'a> {
    maps: &'a Maps,
    views: Vec<Vec<DVec2>>,
    deformation: f64,
    view: &'a View,
    /// Those that were asked for, by their number.
    found: HashMap<u32, Rc<Vec<DVec2>>>,
    stems: Edges<'a>,
}

impl<'a> Known<'a> {
    fn new(maps: &'a Maps, style: &PaperStyle, view: &'a View) -> Self {
        Self {
            maps,
            views: polygon::views(&style.primitive).unwrap_or_default(),
            deformation: style.primitive.deformation,
            view,
            found: HashMap::new(),
            stems: Edges::new(maps.size, &maps.silhouettes),
        }
    }

    /// Whether a pixel at `p` or beside it shows a primitive.
    fn shows(&self, number: u32, p: DVec2) -> bool {
        let [w, h] = self.maps.size.map(|s| s as i64);
        (0..9).any(|k| {
            let (x, y) = (p.x as i64 + k % 3 - 1, p.y as i64 + k / 3 - 1);
            let inside = x >= 0 && y >= 0 && x < w && y < h;
            inside && self.maps.foliage_number[(y * w + x) as usize] == number
        })
    }

    /// The outline of a primitive, its first point again at its end.
    fn ring(&mut self, number: u32) -> Option<Rc<Vec<DVec2>>> {
        let particle = self.maps.particles.get(number.checked_sub(1)? as usize)?;
        self.views.first()?;
        let ring = self.found.entry(number).or_insert_with(|| {
            let mut points = outline(particle, &self.views, self.deformation, self.view);
            points.extend(points.first().copied());
            Rc::new(points)
        });
        Some(Rc::clone(ring))
    }
}

impl whole::Outlines for Known<'_> {
    fn place(&mut self, number: u32, p: DVec2) -> Option<(DVec2, f64)> {
        if number == u32::MAX {
            return self.stems.way(p).map(|way| (p + way, 0.0));
        }
        let ring = self.ring(number)?;
        let side = |(k, s): (usize, &[DVec2])| {
            let q = nearest_on(p, s[0], s[1]);
            let share = q.distance(s[0]) / s[0].distance(s[1]).max(f64::MIN_POSITIVE);
            (q, k as f64 + share)
        };
        let places = ring.windows(2).enumerate().map(side);
        let nearest = places.min_by(|a, b| a.0.distance(p).total_cmp(&b.0.distance(p)));
        nearest.filter(|(q, _)| q.distance(p) <= REACH && self.shows(number, *q))
    }

    fn between(&mut self, number: u32, from: f64, to: f64) -> Vec<DVec2> {
        let Some(ring) = self.ring(number).filter(|_| number != u32::MAX) else {
            return Vec::new();
        };
        let count = ring.len() - 1;
        // Forth or back, whichever has fewer corners on its way.
        let forth = |from: f64, to: f64| -> Vec<DVec2> {
            let to = if to < from { to + count as f64 } else { to };
            let corners =
                (from.floor() as usize + 1..=to.floor() as usize).map(|k| ring[k % count]);
            corners.collect()
        };
        let (ahead, mut back) = (forth(from, to), forth(to, from));
        back.reverse();
        let way = if ahead.len() <= back.len() {
            ahead
        } else {
            back
        };
        let near = |p: &DVec2| way[0].distance(*p) <= CORNERS && self.shows(number, *p);
        if way.iter().all(near) {
            way
        } else {
            Vec::new()
        }
    }
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
