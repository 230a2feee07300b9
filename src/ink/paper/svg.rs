//! Drawings as SVG: millimetres, layers that Inkscape and plotter tools tell apart, three ways to
//! write lines.

use std::fmt::Write as _;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::curve::{Curve, Piece};
use super::fit::{FitSettings, fit};
use super::pen::{Stroke, filled};

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
    /// Its number: layers are drawn from the lowest on.
    pub number: u32,
    /// What it shows; without digits, since plotter tools read them as the number.
    pub name: String,
    /// Strokes, in order.
    pub strokes: Vec<Stroke>,
    /// Outlines that are filled, rather than drawn.
    pub areas: Vec<Curve>,
}

/// A drawing on paper.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Drawing {
    /// Width and height of the paper, millimetres.
    pub paper: [f64; 2],
    /// Layers, from the lowest.
    pub layers: Vec<Layer>,
    /// Colour of the ink, sRGB.
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
        let [w, h] = self.paper;
        let [r, g, b] = self.ink;
        let ink = format!("#{r:02x}{g:02x}{b:02x}");
        let mut out = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
        let _ = writeln!(
            out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" \
             width=\"{w}mm\" height=\"{h}mm\" viewBox=\"0 0 {w} {h}\">"
        );
        let _ = writeln!(out, "<metadata>{}</metadata>", escaped(&self.metadata));
        for layer in &self.layers {
            layer.write(&mut out, profile, curves, &ink);
        }
        out.push_str("</svg>\n");
        out
    }
}

impl Layer {
    fn write(&self, out: &mut String, profile: Profile, curves: &FitSettings, ink: &str) {
        let width = median(self.strokes.iter().flat_map(|s| s.widths.iter().copied()));
        let _ = writeln!(
            out,
            "<g id=\"layer{0}\" inkscape:groupmode=\"layer\" inkscape:label=\"{0} {1}\" fill=\"none\" stroke=\"{ink}\" \
             stroke-width=\"{2}\" stroke-linecap=\"round\" stroke-linejoin=\"round\">",
            self.number,
            escaped(&self.name),
            number(width),
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
            Profile::Plotter => self
                .strokes
                .iter()
                .for_each(|s| write_line(out, s, curves, None)),
            Profile::Print => self.write_filled(out, curves, ink, width),
            Profile::Edit => self.write_groups(out, curves, width),
        }
        out.push_str("</g>\n");
    }

    /// Strokes of one width as one path, the others as outlines in another.
    fn write_filled(&self, out: &mut String, curves: &FitSettings, ink: &str, width: f64) {
        let even =
            |s: &&Stroke| s.is_even() && s.widths.first().is_none_or(|w| (w - width).abs() < 1e-3);
        if self.strokes.iter().any(|s| even(&s)) {
            out.push_str("<path d=\"");
            for stroke in self.strokes.iter().filter(even) {
                write_path(out, &fit(&stroke.line, curves));
            }
            out.push_str("\"/>\n");
        }
        if self.strokes.iter().any(|s| !even(&s)) {
            let _ = write!(out, "<path fill=\"{ink}\" stroke=\"none\" d=\"");
            for stroke in self.strokes.iter().filter(|s| !even(s)) {
                for outline in filled(stroke) {
                    write_path(out, &fit(&outline, curves));
                }
            }
            out.push_str("\"/>\n");
        }
    }

    fn write_groups(&self, out: &mut String, curves: &FitSettings, width: f64) {
        let mut of_primitive: std::collections::BTreeMap<Option<u32>, Vec<&Stroke>> =
            std::collections::BTreeMap::new();
        for stroke in &self.strokes {
            of_primitive
                .entry(stroke.primitive)
                .or_default()
                .push(stroke);
        }
        for (primitive, strokes) in of_primitive {
            if let Some(id) = primitive {
                let _ = writeln!(
                    out,
                    "<g id=\"p{0}-{1}\" data-prim=\"{1}\">",
                    self.number, id
                );
            }
            for stroke in strokes {
                let own = stroke.widths.iter().sum::<f64>() / stroke.widths.len().max(1) as f64;
                let own = ((own - width).abs() > 1e-3).then_some(own);
                write_line(out, stroke, curves, own);
            }
            if primitive.is_some() {
                out.push_str("</g>\n");
            }
        }
    }
}

fn write_line(out: &mut String, stroke: &Stroke, curves: &FitSettings, width: Option<f64>) {
    let curve = fit(&stroke.line, curves);
    if curve.pieces.is_empty() {
        return;
    }
    out.push_str("<path");
    if let Some(width) = width {
        let _ = write!(out, " stroke-width=\"{}\"", number(width));
    }
    out.push_str(" d=\"");
    write_path(out, &curve);
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
