//! Drawings as SVG: millimetres, layers that Inkscape and plotter tools tell apart, three ways to
//! write lines.

use std::fmt::Write as _;

use glam::DVec2;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::curve::{Curve, Piece, Polyline};
use super::fit::{FitSettings, fit};
use super::pen::{Stroke, filled};
use super::progress::{Count, Stage, Tell, quiet};

/// How lines are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Profile {
    /// Centre lines, one path each, in the order in which a plotter draws them.
    Plotter,
    /// Widths as they are: filled outlines, those of a layer in one path.
    Print,
    /// A group for every primitive.
    Edit,
}

/// Strokes that one pen draws.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Layer {
    /// Its number: layers are drawn from the lowest on, but areas before all lines where inks
    /// differ.
    pub number: u32,
    /// What it shows; without digits, since plotter tools read them as the number.
    pub name: String,
    /// Strokes, in order.
    pub strokes: Vec<Stroke>,
    /// Outlines that are filled, rather than drawn.
    pub areas: Vec<Curve>,
    /// Colour of its ink, sRGB; none: the drawing's.
    pub ink: Option<[u8; 3]>,
}

/// A drawing on paper.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Drawing {
    /// Width and height of the paper, millimetres.
    pub paper: [f64; 2],
    /// Layers, from the lowest.
    pub layers: Vec<Layer>,
    /// Colour of the ink of layers that have none of their own, sRGB.
    pub ink: [u8; 3],
    /// What drew it, as JSON.
    pub metadata: String,
}

/// What a written drawing consists of.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Content {
    /// Strokes.
    pub strokes: usize,
    /// Those that are closed.
    pub closed: usize,
    /// Their length, millimetres.
    pub length: f64,
}

impl Drawing {
    /// How much there is in it.
    #[must_use]
    pub fn content(&self) -> Content {
        let mut out = Content::default();
        for stroke in self.layers.iter().flat_map(|l| &l.strokes) {
            out.strokes += 1;
            out.closed += usize::from(stroke.line.closed);
            out.length += stroke.line.length();
        }
        out
    }

    /// The text of the file.
    #[must_use]
    pub fn text(&self, profile: Profile, curves: &FitSettings) -> String {
        self.fitted(profile, curves).text()
    }

    /// Its lines as curves, in the way of a profile.
    #[must_use]
    pub fn fitted(&self, profile: Profile, curves: &FitSettings) -> Fitted<'_> {
        self.fitted_told(profile, curves, &quiet)
    }

    /// As [`Drawing::fitted`]; `tell` is told how far it is.
    #[must_use]
    pub fn fitted_told(
        &self,
        profile: Profile,
        curves: &FitSettings,
        tell: Tell<'_>,
    ) -> Fitted<'_> {
        let strokes = self.layers.iter().map(|l| l.strokes.len()).sum();
        let count = Count::new(tell, Stage::Curves, strokes);
        Fitted {
            drawing: self,
            profile,
            layers: self
                .layers
                .iter()
                .map(|l| l.fitted(profile, curves, &count))
                .collect(),
        }
    }
}

/// A drawing whose lines are curves, ready to be written.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted<'a> {
    /// The drawing.
    pub drawing: &'a Drawing,
    /// How it is to be written.
    pub profile: Profile,
    /// Curves of each of its layers.
    pub layers: Vec<FittedLayer>,
}

/// Curves of a layer.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FittedLayer {
    /// Width of most of its lines, millimetres.
    pub width: f64,
    /// Its lines, in the order in which they are drawn.
    pub lines: Vec<FittedLine>,
}

/// A line as a curve.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedLine {
    /// The pen's way, or the outline of what it inks.
    pub curve: Curve,
    /// Whether the curve is an outline to be filled (rule: not zero).
    pub filled: bool,
    /// Width where it is not the layer's, millimetres.
    pub width: Option<f64>,
    /// Number of its primitive.
    pub primitive: Option<u32>,
}

impl Fitted<'_> {
    /// The text of an SVG file.
    #[must_use]
    pub fn text(&self) -> String {
        let drawing = self.drawing;
        let [w, h] = drawing.paper;
        let mut out = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
        let _ = writeln!(
            out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" \
             width=\"{w}mm\" height=\"{h}mm\" viewBox=\"0 0 {w} {h}\">"
        );
        let _ = writeln!(out, "<metadata>{}</metadata>", escaped(&drawing.metadata));
        for (layer, fitted) in drawing.layers.iter().zip(&self.layers) {
            let [r, g, b] = layer.ink.unwrap_or(drawing.ink);
            let ink = format!("#{r:02x}{g:02x}{b:02x}");
            layer.write(&mut out, self.profile, fitted, &ink);
        }
        out.push_str("</svg>\n");
        out
    }
}

impl Layer {
    fn fitted(&self, profile: Profile, curves: &FitSettings, count: &Count<'_>) -> FittedLayer {
        let width = median(self.strokes.iter().flat_map(|s| s.widths.iter().copied()));
        let lines = self.strokes.par_iter().flat_map_iter(|stroke| {
            count.add();
            let own = stroke.widths.iter().sum::<f64>() / stroke.widths.len().max(1) as f64;
            let other = (own - width).abs() > 1e-3;
            let fills = profile == Profile::Print && (other || !stroke.is_even());
            let lines = if fills {
                filled(stroke)
            } else {
                vec![stroke.line.clone()]
            };
            let curve = |line: Polyline| FittedLine {
                curve: fit(&line, curves),
                filled: fills,
                width: (profile == Profile::Edit && other).then_some(own),
                primitive: stroke.primitive,
            };
            lines.into_iter().map(curve).collect::<Vec<_>>()
        });
        FittedLayer {
            width,
            lines: lines.filter(|l| !l.curve.pieces.is_empty()).collect(),
        }
    }

    fn write(&self, out: &mut String, profile: Profile, fitted: &FittedLayer, ink: &str) {
        let _ = writeln!(
            out,
            "<g id=\"layer{0}\" inkscape:groupmode=\"layer\" inkscape:label=\"{0} {1}\" fill=\"none\" stroke=\"{ink}\" \
             stroke-width=\"{2}\" stroke-linecap=\"round\" stroke-linejoin=\"round\">",
            self.number,
            escaped(&self.name),
            number(fitted.width),
        );
        if !self.areas.is_empty() {
            let _ = write!(
                out,
                "<path fill=\"{ink}\" stroke=\"none\" fill-rule=\"evenodd\" d=\""
            );
            for area in &self.areas {
                write_path(out, area);
            }
            out.push_str("\"/>\n");
        }
        match profile {
            Profile::Plotter => fitted.lines.iter().for_each(|l| write_line(out, l)),
            Profile::Print => fitted.write_batches(out, ink),
            Profile::Edit => fitted.write_groups(out, self.number),
        }
        out.push_str("</g>\n");
    }
}

impl FittedLayer {
    /// Strokes of one width as one path, the others as outlines in another.
    fn write_batches(&self, out: &mut String, ink: &str) {
        for (filled, start) in [
            (false, "<path d=\"".to_owned()),
            (true, format!("<path fill=\"{ink}\" stroke=\"none\" d=\"")),
        ] {
            let mut lines = self.lines.iter().filter(|l| l.filled == filled).peekable();
            if lines.peek().is_some() {
                out.push_str(&start);
                lines.for_each(|l| write_path(out, &l.curve));
                out.push_str("\"/>\n");
            }
        }
    }

    fn write_groups(&self, out: &mut String, layer: u32) {
        let mut of_primitive: std::collections::BTreeMap<Option<u32>, Vec<&FittedLine>> =
            std::collections::BTreeMap::new();
        for line in &self.lines {
            of_primitive.entry(line.primitive).or_default().push(line);
        }
        for (primitive, lines) in of_primitive {
            if let Some(id) = primitive {
                let _ = writeln!(out, "<g id=\"p{layer}-{id}\" data-prim=\"{id}\">");
            }
            lines.into_iter().for_each(|l| write_line(out, l));
            if primitive.is_some() {
                out.push_str("</g>\n");
            }
        }
    }
}

fn write_line(out: &mut String, line: &FittedLine) {
    out.push_str("<path");
    if let Some(width) = line.width {
        let _ = write!(out, " stroke-width=\"{}\"", number(width));
    }
    out.push_str(" d=\"");
    write_path(out, &line.curve);
    out.push_str("\"/>\n");
}

fn write_path(out: &mut String, curve: &Curve) {
    let point = |out: &mut String, p: DVec2| {
        let _ = write!(out, "{},{}", number(p.x), number(p.y));
    };
    if curve.pieces.is_empty() {
        return;
    }
    out.push('M');
    point(out, curve.start);
    for piece in &curve.pieces {
        match *piece {
            Piece::Line(end) => {
                out.push('L');
                point(out, end);
            }
            Piece::Cubic(b, c, d) => {
                out.push('C');
                point(out, b);
                out.push(' ');
                point(out, c);
                out.push(' ');
                point(out, d);
            }
        }
    }
    if curve.closed {
        out.push('Z');
    }
}

/// Thousandths of a millimetre, without zeros that say nothing.
fn number(value: f64) -> String {
    let rounded = (value * 1000.0).round() / 1000.0;
    // Not "-0".
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded })
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut all: Vec<f64> = values.collect();
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied().unwrap_or(0.3)
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
