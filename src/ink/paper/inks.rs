//! Inks of the layers of a drawing: each pen's own, or the sheet's.

use glam::DVec2;

use super::drawing::Placement;
use super::pen::Stroke;
use super::renderer::Maps;
use super::style::PaperStyle;
use crate::math::colour::srgb_to_linear;

/// Colours of the inks of a drawing, sRGB unless they were made [`Inks::linear`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Inks {
    sheet: [f32; 3],
    /// Outlines of stems.
    pub(super) stem: [f32; 3],
    /// Strokes on stems.
    pub(super) stem_hatch: [f32; 3],
    /// Lines of foliage.
    pub(super) foliage: [f32; 3],
    /// Strokes of tiles on foliage.
    pub(super) foliage_hatch: [f32; 3],
    /// Areas and strokes of the sun's shadow.
    pub(super) shadow: [f32; 3],
    /// The same on the ground.
    pub(super) ground: [f32; 3],
}

/// A layer of strokes: number, name, ink.
type Hatching = (u32, &'static str, [f32; 3], Vec<Stroke>);

/// Of what areas are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    Whole,
    Plants,
    Ground,
}

impl Part {
    /// Whether a pixel of the ground, or of anything else, belongs to it.
    pub(super) fn has(self, ground: bool) -> bool {
        match self {
            Self::Whole => true,
            Self::Plants => !ground,
            Self::Ground => ground,
        }
    }
}

impl Inks {
    pub(super) fn of(style: &PaperStyle) -> Self {
        let sheet = style.sheet.ink;
        let shadow = style.shadow.pen.colour.unwrap_or(sheet);
        Self {
            sheet,
            stem: style.stem.pen.colour.unwrap_or(sheet),
            stem_hatch: style.stem.hatching_pen.colour.unwrap_or(sheet),
            foliage: style.foliage.pen.colour.unwrap_or(sheet),
            foliage_hatch: style.tiles.colour.unwrap_or(sheet),
            shadow,
            ground: style.ground.colour.unwrap_or(shadow),
        }
    }

    pub(super) fn linear(&self) -> Self {
        let linear = |ink: [f32; 3]| ink.map(srgb_to_linear);
        Self {
            sheet: linear(self.sheet),
            stem: linear(self.stem),
            stem_hatch: linear(self.stem_hatch),
            foliage: linear(self.foliage),
            foliage_hatch: linear(self.foliage_hatch),
            shadow: linear(self.shadow),
            ground: linear(self.ground),
        }
    }

    /// The bytes of an ink that is not the sheet's.
    pub(super) fn own(&self, ink: [f32; 3]) -> Option<[u8; 3]> {
        (ink != self.sheet).then(|| bytes(ink))
    }

    /// Layers of hatching: strokes of shadow and of tiles share one where they share an ink, since
    /// a plotter has one pen for a layer.
    pub(super) fn hatching(
        &self,
        shadow: Vec<Stroke>,
        mut tiles: Vec<Stroke>,
        ground: Vec<Stroke>,
    ) -> Vec<Hatching> {
        let mut out = Vec::new();
        if tiles.is_empty() || self.shadow == self.foliage_hatch {
            let mut both = shadow;
            both.append(&mut tiles);
            out.push((4, "foliage hatch", self.shadow, both));
        } else {
            out.push((4, "foliage hatch", self.foliage_hatch, tiles));
            out.push((5, "shadow", self.shadow, shadow));
        }
        out.push((6, "ground", self.ground, ground));
        out
    }

    /// Layers of areas: that on the ground is another where its ink is.
    pub(super) fn areas(&self, style: &PaperStyle) -> Vec<(u32, &'static str, [f32; 3], Part)> {
        if style.ground.colour.is_none() {
            return vec![(5, "shadow", self.shadow, Part::Whole)];
        }
        vec![
            (5, "shadow", self.shadow, Part::Plants),
            (6, "ground", self.ground, Part::Ground),
        ]
    }
}

/// Strokes that lie on the ground, if it has an ink of its own, and the others.
pub(super) fn on_ground(
    maps: &Maps,
    style: &PaperStyle,
    placement: &Placement,
    strokes: Vec<Stroke>,
) -> (Vec<Stroke>, Vec<Stroke>) {
    if style.ground.colour.is_none() {
        return (Vec::new(), strokes);
    }
    let [w, h] = maps.size;
    let last = DVec2::new(w as f64 - 1.0, h as f64 - 1.0);
    strokes.into_iter().partition(|stroke| {
        let points = &stroke.line.points;
        points.get(points.len() / 2).is_some_and(|&p| {
            let at = placement.pixel(p).clamp(DVec2::ZERO, last);
            maps.foliage_number[at.y as usize * w + at.x as usize] as usize > maps.leaves
        })
    })
}

/// Every number of the colours with its name and range.
pub(super) fn numbers(style: &PaperStyle) -> Vec<(String, f64, f64, f64)> {
    let colours = [
        ("foliage.pen.colour", style.foliage.pen.colour),
        ("stem.pen.colour", style.stem.pen.colour),
        ("stem.hatching_pen.colour", style.stem.hatching_pen.colour),
        ("shadow.pen.colour", style.shadow.pen.colour),
        ("tiles.colour", style.tiles.colour),
        ("ground.colour", style.ground.colour),
    ];
    let all = colours.into_iter().flat_map(|(name, colour)| {
        let one = move |v: f32| (name.to_owned(), f64::from(v), 0.0, 1.0);
        colour.into_iter().flatten().map(one)
    });
    all.collect()
}

/// As files write a colour.
pub(super) fn bytes(colour: [f32; 3]) -> [u8; 3] {
    colour.map(|v| (255.0 * v).round() as u8)
}
