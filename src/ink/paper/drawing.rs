//! From pictures to strokes on paper: outlines of primitives through the index buffer, outlines of
//! stems from pixels, hatching of stems by error diffusion; pens, layers, the order of a plotter.

use glam::DVec2;
use rayon::prelude::*;

use super::across::{expected, layers};
use super::anchored::{Surface, hand_round, placed};
use super::curve::{Curve, Polyline};
use super::diffusion::{DiffusionSettings, Tone};
use super::fit::{FitSettings, fit};
use super::inks::{Inks, Part, bytes, on_ground};
use super::order::{ordered, pen_up};
use super::outline::{Seen, lines, shown};
use super::particles::outline;
use super::pen::Stroke;
use super::polygon;
use super::progress::{Count, Stage, Tell, quiet};
use super::region::{self, filling};
use super::renderer::Maps;
use super::single::single_lines;
use super::stem_strokes::{hatch, stem_contour, stem_hatching, stem_lines};
use super::style::{PaperStyle, ShadowForm};
use super::svg::{Drawing, Layer, Profile};
use super::vectors::{Lines, tile_hatching, traced_contour, whole_bitmap};
use crate::ink::view::View;

/// Smaller areas are specks, pixels.
const SPECK: f64 = 5.0;
/// Ends so near are joined, and lines so near are the same, millimetres.
const GAP: f64 = 0.1;

/// What the vectors of a drawing consist of, for reports.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Order {
    /// Way with the pen up before and after sorting, millimetres; 0 where nothing was sorted.
    pub pen_up: [f64; 2],
}

/// Where the picture lies on the paper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Millimetres of a pixel.
    pub scale: f64,
    /// Place of the picture's upper left corner, millimetres.
    pub corner: DVec2,
}

impl Placement {
    /// In the middle of the paper, as large as the margins let it be.
    #[must_use]
    pub fn new(style: &PaperStyle, size: [usize; 2]) -> Self {
        let paper = DVec2::from(style.sheet.paper);
        let free = paper - 2.0 * style.sheet.margin;
        let size = DVec2::new(size[0] as f64, size[1] as f64);
        let scale = (free / size).min_element();
        Self {
            scale,
            corner: 0.5 * (paper - scale * size),
        }
    }

    /// The pixel at a place of the paper.
    pub(super) fn pixel(&self, p: DVec2) -> DVec2 {
        (p - self.corner) / self.scale
    }

    pub(super) fn line(&self, line: &Polyline) -> Polyline {
        Polyline {
            points: line
                .points
                .iter()
                .map(|&p| self.corner + self.scale * p)
                .collect(),
            closed: line.closed,
        }
    }
}

/// The drawing of a view, its strokes in order.
#[must_use]
pub fn drawing(maps: &Maps, style: &PaperStyle, view: &View) -> (Drawing, Order) {
    let mut drawing = traced(maps, style, view, &quiet);
    let order = sort(&mut drawing, style);
    (drawing, order)
}

/// Puts strokes into the order of a plotter where the style is for one.
pub fn sort(drawing: &mut Drawing, style: &PaperStyle) -> Order {
    let mut order = Order::default();
    if style.sheet.profile == Profile::Plotter {
        for layer in &mut drawing.layers {
            let (strokes, pen_up) = plotted(std::mem::take(&mut layer.strokes), style);
            layer.strokes = strokes;
            order.pen_up = [order.pen_up[0] + pen_up[0], order.pen_up[1] + pen_up[1]];
        }
    }
    order
}

/// The drawing of a view, its strokes as they were found; `tell` is told how far it is.
#[must_use]
pub fn traced(maps: &Maps, style: &PaperStyle, view: &View, tell: Tell<'_>) -> Drawing {
    let placement = Placement::new(style, maps.size);
    let visible = Visible::new(maps);
    let mut layers = Vec::new();
    let inks = Inks::of(style);
    let mut add = |number, name: &str, ink, strokes: Vec<Stroke>| {
        layers.push(Layer {
            number,
            name: name.to_owned(),
            strokes,
            areas: Vec::new(),
            ink: inks.own(ink),
        });
    };
    let shade = Shade::new(maps, style);
    let whole = (style.vector.lines == Lines::Bitmap)
        .then(|| whole_bitmap(maps, &visible, &shade, (style, view), &placement));
    if style.stem.draw {
        let lines = match &whole {
            Some([stems, _]) => stems.clone(),
            None => stem_lines(maps, &visible, style, &placement),
        };
        let mut strokes = stem_contour((maps, &visible), &lines, style, view, &placement);
        strokes.extend(single_lines(maps, style, view, &placement));
        add(1, "stem contour", inks.stem, strokes);
        if style.stem.hatching > 0.0 {
            add(
                2,
                "stem hatch",
                inks.stem_hatch,
                stem_hatching((maps, &visible), style, view, &placement, tell),
            );
        }
    }
    if style.foliage.draw {
        let strokes = match &whole {
            Some([_, lines]) => traced_contour((maps, lines), &shade, style, &placement),
            None => foliage_contour((maps, &visible), &shade, style, view, &placement, tell),
        };
        add(3, "foliage contour", inks.foliage, strokes);
    }
    let mut shadow = Vec::new();
    if style.shadow.form == ShadowForm::Hatch {
        shadow = shade.hatching(&visible.foliage, view, &placement, tell);
    }
    let mut tiles = Vec::new();
    if style.tiles.strength > 0.0 {
        tell(Stage::Strokes, 0, 0);
        tiles = tile_hatching(maps, &visible, style, view, &placement);
    }
    let (ground, shadow) = on_ground(maps, style, &placement, shadow);
    for (number, name, ink, strokes) in inks.hatching(shadow, tiles, ground) {
        add(number, name, ink, strokes);
    }
    if style.shadow.form == ShadowForm::Black {
        for (number, name, ink, part) in inks.areas(style) {
            let (strokes, areas) = shade.black(&visible, &placement, part);
            let layer = Layer {
                number,
                name: name.to_owned(),
                strokes,
                areas,
                ink: inks.own(ink),
            };
            // Lines are seen on areas where inks differ.
            let coloured = layer.ink.is_some() || layers.iter().any(|l: &Layer| l.ink.is_some());
            let at = if coloured { 0 } else { layers.len() };
            layers.insert(at, layer);
        }
    }
    layers.retain(|l| !l.strokes.is_empty() || !l.areas.is_empty());
    Drawing {
        paper: style.sheet.paper,
        layers,
        ink: bytes(style.sheet.ink),
        metadata: String::new(),
    }
}

/// What is seen of foliage and stems when the nearer hides the other.
pub(super) struct Visible {
    pub(super) foliage: Vec<bool>,
    pub(super) stems: Vec<bool>,
}

impl Visible {
    pub(super) fn new(maps: &Maps) -> Self {
        let both = maps.foliage_depth.iter().zip(&maps.stem_depth);
        let (foliage, stems) = both
            .map(|(&f, &s)| {
                let foliage = f > 0.0 && (s <= 0.0 || f <= s);
                (foliage, s > 0.0 && !foliage)
            })
            .unzip();
        Self { foliage, stems }
    }
}

fn foliage_contour(
    (maps, visible): (&Maps, &Visible),
    shade: &Shade<'_>,
    style: &PaperStyle,
    view: &View,
    placement: &Placement,
    tell: Tell<'_>,
) -> Vec<Stroke> {
    let primitive: Vec<u32> = maps
        .foliage_number
        .iter()
        .zip(&visible.foliage)
        .map(|(&n, &seen)| if seen { n } else { 0 })
        .collect();
    let contour: Vec<f32> = shade
        .foliage_marks()
        .map(|line| if line { 1.0 } else { 0.0 })
        .collect();
    let seen = Seen {
        size: maps.size,
        primitive: &primitive,
        contour: &contour,
    };
    let Ok(views) = polygon::views(&style.primitive) else {
        return Vec::new();
    };
    // What no pixel shows has no line, so that memory and time are those of what is seen.
    let shown = shown(&primitive, maps.leaves);
    let count = Count::new(tell, Stage::Outlines, shown.len());
    let shortest = least(style.foliage.shortest, style, placement);
    let strokes = shown.par_iter().flat_map_iter(|&number| {
        count.add();
        let i = number as usize - 1;
        let deformation = style.primitive.deformation;
        let outline = &outline(&maps.particles[i], &views, deformation, view);
        let found = lines(&seen, number, outline, shortest);
        let row = f64::from(maps.particles[i].row);
        let found: Vec<Polyline> = if style.primitive.lower {
            let below = found.iter().flat_map(|l| below(l, row));
            below.filter(|l| l.length() >= shortest).collect()
        } else {
            found
        };
        let pen = style.foliage.pen;
        let seen = &seen;
        let hand = hand_round(outline, &maps.particles[i], (style, view), placement);
        let stroke = |line: Polyline| Stroke {
            primitive: Some(number),
            ..pen.draw_over(&placement.line(&line), &hand, |p| {
                let p = placement.pixel(p);
                shade.pressure(p) * width(maps, p, |i| seen.primitive[i] == number)
            })
        };
        found.into_iter().map(stroke).collect::<Vec<_>>()
    });
    strokes.collect()
}

/// Shorter lines are specks however long their pixels are.
const LEAST: f64 = 3.0;

/// Length (pixels) of lines of which curves within the tolerance are at least `shortest` millimetres
/// and three pixels: those of flat arcs are their chords. 0 of 0.
pub(super) fn least(shortest: f64, style: &PaperStyle, placement: &Placement) -> f64 {
    if shortest <= 0.0 {
        return 0.0;
    }
    let all = shortest.max(LEAST * placement.scale);
    let flat = style.sheet.tolerance.min(0.5 * all);
    (all + 8.0 / 3.0 * flat * flat / all) / placement.scale
}

/// Factors on threshold and width of what is seen in a pixel.
pub(super) fn factors(maps: &Maps, pixel: usize) -> [f32; 2] {
    maps.factors.get(pixel).copied().unwrap_or([1.0; 2])
}

/// Factor on the width of a line that passes `p` (pixels): that of the nearest of the pixels about
/// it that are the line's own. Outlines run along the border of what they belong to.
pub(super) fn width(maps: &Maps, p: DVec2, own: impl Fn(usize) -> bool) -> f64 {
    if maps.factors.is_empty() {
        return 1.0;
    }
    let [w, h] = maps.size.map(|s| s as i64);
    let middle = p.floor();
    let mut best = (f64::INFINITY, 1.0);
    for (dx, dy) in (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy))) {
        let (x, y) = (middle.x as i64 + dx, middle.y as i64 + dy);
        if x < 0 || y < 0 || x >= w || y >= h {
            continue;
        }
        let away = p.distance_squared(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
        let pixel = (y * w + x) as usize;
        if away < best.0 && own(pixel) {
            best = (away, f64::from(factors(maps, pixel)[1]));
        }
    }
    best.1
}

/// The sun's shadow as it is drawn.
pub(super) struct Shade<'a> {
    maps: &'a Maps,
    style: &'a PaperStyle,
}

impl<'a> Shade<'a> {
    pub(super) fn new(maps: &'a Maps, style: &'a PaperStyle) -> Self {
        Self { maps, style }
    }

    fn at(&self, pixel: usize) -> f32 {
        self.maps.shadow.get(pixel).copied().unwrap_or(0.0)
    }

    /// Whether each pixel of foliage, as if nothing hid it, is over its threshold.
    pub(super) fn foliage_marks(&self) -> impl Iterator<Item = bool> {
        let (threshold, growth) = (self.style.foliage.threshold as f32, self.detail());
        let differences = self.maps.foliage_difference.iter().enumerate();
        differences.map(move |(i, &d)| {
            let [more, wider] = factors(self.maps, i);
            d > threshold * (1.0 + growth * self.at(i)) * more && wider > 0.0
        })
    }

    /// Growth of the threshold in shadow.
    fn detail(&self) -> f32 {
        let shadow = &self.style.shadow;
        if shadow.form == ShadowForm::Detail {
            shadow.detail as f32
        } else {
            0.0
        }
    }

    /// Factor on the width of lines at a pixel.
    pub(super) fn pressure(&self, p: DVec2) -> f64 {
        let shadow = &self.style.shadow;
        if shadow.form != ShadowForm::Detail {
            return 1.0;
        }
        let [w, h] = self.maps.size;
        let at = p.clamp(DVec2::ZERO, DVec2::new(w as f64 - 1.0, h as f64 - 1.0));
        1.0 + shadow.pressure * f64::from(self.at(at.y as usize * w + at.x as usize))
    }

    /// What is black of a part of foliage, ground and stems.
    fn black(
        &self,
        visible: &Visible,
        placement: &Placement,
        part: Part,
    ) -> (Vec<Stroke>, Vec<Curve>) {
        let s = &self.style.shadow;
        let seen = visible.foliage.iter().zip(&visible.stems);
        let dark: Vec<bool> = seen
            .enumerate()
            .map(|(i, (&f, &t))| {
                let ground = f && self.maps.foliage_number[i] as usize > self.maps.leaves;
                (f || t) && part.has(ground) && f64::from(self.at(i)) > s.black
            })
            .collect();
        let size = self.maps.size;
        if self.style.sheet.profile == Profile::Plotter {
            let spacing = 0.9 * s.pen.width / placement.scale;
            let lines = filling(size, &dark, spacing, -s.angle.to_radians());
            let one = |l| s.pen.draw(&placement.line(l), 0, |_| 1.0);
            (lines.iter().map(one).collect(), Vec::new())
        } else {
            let curves = FitSettings::within(self.style.sheet.tolerance);
            let areas = region::outlines(size, &dark, SPECK);
            let one = |l| fit(&placement.line(l), &curves);
            (Vec::new(), areas.par_iter().map(one).collect())
        }
    }

    /// Strokes for the shadow on foliage and ground.
    pub(super) fn hatching(
        &self,
        foliage: &[bool],
        view: &View,
        placement: &Placement,
        tell: Tell<'_>,
    ) -> Vec<Stroke> {
        let s = &self.style.shadow;
        let darkness: Vec<f32> = foliage
            .iter()
            .enumerate()
            .map(|(i, &seen)| {
                if seen {
                    s.hatching as f32 * self.at(i)
                } else {
                    -1.0
                }
            })
            .collect();
        let settings = DiffusionSettings {
            length: s.stroke / placement.scale,
            width: (s.pen.width / placement.scale).max(1.0),
            threshold: 0.5,
            seed: self.style.seed,
            stub: s.stub,
            inset: 0.0,
        };
        let way = DVec2::from_angle(-s.angle.to_radians());
        let surface = Surface {
            view,
            depth: &self.maps.foliage_depth,
            vector: self.style.vector,
        };
        let mut out = Vec::new();
        let tones = layers(&darkness, s.crossing);
        let count = Count::new(tell, Stage::Strokes, expected(&tones, &settings));
        for (tone, turn) in tones {
            let tone = Tone {
                size: self.maps.size,
                darkness: &tone,
            };
            let way = DVec2::from_angle(turn).rotate(way);
            let found = placed(&tone, &settings, &surface, |_, _| {
                count.add();
                way
            });
            let hatched = found.iter().map(|f| hatch(f, None, &s.pen, placement));
            out.extend(hatched);
        }
        out
    }
}

/// The parts of a line below a row of the picture.
fn below(line: &Polyline, row: f64) -> Vec<Polyline> {
    let keeps: Vec<bool> = line.points.iter().map(|p| p.y >= row).collect();
    super::outline::runs_of(&line.points, &keeps, line.closed)
}

/// Strokes in the order of a plotter: nothing twice, sorted, joined. Also the way with the pen up
/// before and after.
fn plotted(strokes: Vec<Stroke>, style: &PaperStyle) -> (Vec<Stroke>, [f64; 2]) {
    let width = strokes
        .first()
        .map_or(0.3, |s| s.widths.iter().copied().fold(0.0, f64::max));
    let lines: Vec<Polyline> = strokes.into_iter().map(|s| s.line).collect();
    let before = pen_up(&lines, DVec2::ZERO);
    let lines = ordered(&lines, GAP, &FitSettings::within(style.sheet.tolerance));
    let after = pen_up(&lines, DVec2::ZERO);
    let stroke = |line: Polyline| Stroke {
        widths: vec![width; line.points.len()],
        line,
        primitive: None,
    };
    (lines.into_iter().map(stroke).collect(), [before, after])
}
