//! Drawings as PDF: the same millimetres, curves and layers as in SVG. Layers are optional content,
//! which viewers show and hide.

use std::io::Write as _;

use glam::DVec2;
use pdf_writer::types::{LineCapStyle, LineJoinStyle};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, TextStr};

use super::curve::{Curve, Piece};
use super::svg::{Fitted, FittedLayer, Layer};

/// Points of a millimetre.
const POINTS: f64 = 72.0 / 25.4;

/// The bytes of a PDF file of one page.
#[must_use]
pub fn pdf(fitted: &Fitted<'_>) -> Vec<u8> {
    let drawing = fitted.drawing;
    let [catalog, pages, page, content, info] = [1, 2, 3, 4, 5].map(Ref::new);
    let layers: Vec<(Ref, String, &Layer)> = (6..)
        .zip(&drawing.layers)
        .map(|(id, layer)| (Ref::new(id), format!("L{}", layer.number), layer))
        .collect();
    let mut file = Pdf::new();
    let mut root = file.catalog(catalog);
    root.pages(pages);
    let mut optional = root.insert(Name(b"OCProperties")).dict();
    let all = || layers.iter().map(|l| l.0);
    optional.insert(Name(b"OCGs")).array().items(all());
    let mut shown = optional.insert(Name(b"D")).dict();
    shown.insert(Name(b"Order")).array().items(all());
    shown.finish();
    optional.finish();
    root.finish();
    file.pages(pages).kids([page]).count(1);
    let [w, h] = drawing.paper.map(|s| (s * POINTS) as f32);
    let mut sheet = file.page(page);
    sheet.media_box(Rect::new(0.0, 0.0, w, h));
    sheet.parent(pages).contents(content);
    let mut resources = sheet.resources();
    let mut properties = resources.insert(Name(b"Properties")).dict();
    for (id, name, _) in &layers {
        properties.pair(Name(name.as_bytes()), *id);
    }
    properties.finish();
    resources.finish();
    sheet.finish();
    for (id, _, layer) in &layers {
        let label = format!("{} {}", layer.number, layer.name);
        let mut group = file.indirect(*id).dict();
        group.pair(Name(b"Type"), Name(b"OCG"));
        group.pair(Name(b"Name"), TextStr(&label));
    }
    let mut about = file.document_info(info);
    about.creator(TextStr("umbrage"));
    about.subject(TextStr(&drawing.metadata));
    about.finish();
    let packed = packed(&written(fitted, &layers));
    file.stream(content, &packed).filter(Filter::FlateDecode);
    file.finish()
}

fn written(fitted: &Fitted<'_>, layers: &[(Ref, String, &Layer)]) -> Vec<u8> {
    let drawing = fitted.drawing;
    let mut out = Content::new();
    // Millimetres from the upper left corner.
    let scale = POINTS as f32;
    out.transform([
        scale,
        0.0,
        0.0,
        -scale,
        0.0,
        (drawing.paper[1] * POINTS) as f32,
    ]);
    out.set_line_cap(LineCapStyle::RoundCap);
    out.set_line_join(LineJoinStyle::RoundJoin);
    for ((_, name, layer), fitted) in layers.iter().zip(&fitted.layers) {
        out.begin_marked_content_with_properties(Name(b"OC"))
            .properties_named(Name(name.as_bytes()));
        let ink = layer.ink.unwrap_or(drawing.ink);
        let [r, g, b] = ink.map(|v| f32::from(v) / 255.0);
        out.set_fill_rgb(r, g, b).set_stroke_rgb(r, g, b);
        if !layer.areas.is_empty() {
            layer.areas.iter().for_each(|a| path(&mut out, a));
            out.fill_even_odd();
        }
        lines(&mut out, fitted);
        out.end_marked_content();
    }
    out.finish().into_vec()
}

fn lines(out: &mut Content, layer: &FittedLayer) {
    out.set_line_width(millimetres(layer.width));
    for line in &layer.lines {
        let own = line.width.filter(|_| !line.filled);
        if let Some(width) = own {
            out.save_state().set_line_width(millimetres(width));
        }
        path(out, &line.curve);
        if line.filled {
            out.fill_nonzero();
        } else {
            out.stroke();
        }
        if own.is_some() {
            out.restore_state();
        }
    }
}

/// Thousandths, as in SVG.
fn millimetres(value: f64) -> f32 {
    ((value * 1000.0).round() / 1000.0) as f32
}

fn path(out: &mut Content, curve: &Curve) {
    let point = |p: DVec2| [millimetres(p.x), millimetres(p.y)];
    let [x, y] = point(curve.start);
    out.move_to(x, y);
    for piece in &curve.pieces {
        match *piece {
            Piece::Line(end) => {
                let [x, y] = point(end);
                out.line_to(x, y);
            }
            Piece::Cubic(b, c, d) => {
                let [[bx, by], [cx, cy], [dx, dy]] = [b, c, d].map(point);
                out.cubic_to(bx, by, cx, cy, dx, dy);
            }
        }
    }
    if curve.closed {
        out.close_path();
    }
}

/// Deflated; as it is where that fails, which memory alone could make it.
fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
    // Writing into memory does not fail.
    let _ = encoder.write_all(bytes);
    encoder.finish().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use std::io::Read as _;

    use super::super::curve::Polyline;
    use super::super::fit::FitSettings;
    use super::super::pen::Pen;
    use super::super::svg::{Drawing, Profile};
    use super::*;

    fn drawing() -> Drawing {
        let line = Polyline {
            points: vec![DVec2::new(10.0, 20.0), DVec2::new(40.0, 20.0)],
            closed: false,
        };
        let layer = |number, name: &str| Layer {
            number,
            name: name.into(),
            strokes: vec![Pen::default().draw(&line, 0, |_| 1.0)],
            areas: Vec::new(),
            ink: (number == 3).then_some([0, 255, 0]),
        };
        Drawing {
            paper: [210.0, 297.0],
            layers: vec![layer(1, "stem contour"), layer(3, "foliage contour")],
            ink: [0, 0, 0],
            metadata: "{\"program\":\"umbrage\"}".into(),
        }
    }

    /// What stands between `from` and `to`, after the first of both.
    fn between<'a>(bytes: &'a [u8], from: &[u8], to: &[u8]) -> &'a [u8] {
        let find =
            |all: &[u8], what: &[u8]| all.windows(what.len()).position(|w| w == what).unwrap();
        let start = find(bytes, from) + from.len();
        &bytes[start..start + find(&bytes[start..], to)]
    }

    #[test]
    fn a_file_has_its_page_its_layers_and_its_lines_in_millimetres() {
        let drawing = drawing();
        let curves = FitSettings {
            tolerance: 0.05,
            corner: 1.2,
        };
        let file = pdf(&drawing.fitted(Profile::Plotter, &curves));
        assert!(file.starts_with(b"%PDF-1.") && file.ends_with(b"%%EOF"));
        let text = String::from_utf8_lossy(&file);
        assert!(text.contains("/MediaBox [0 0 595.27"), "A4 in points");
        assert!(text.contains("(1 stem contour)") && text.contains("(3 foliage contour)"));
        assert!(text.contains("umbrage"));
        // Every object stands where the table says.
        let table: Vec<&str> = text.split("xref\n").nth(1).unwrap().lines().collect();
        let count: usize = table[0].split(' ').nth(1).unwrap().parse().unwrap();
        for (number, row) in table[1..=count].iter().enumerate().skip(1) {
            let at: usize = row[..10].parse().unwrap();
            let starts = format!("{number} 0 obj");
            assert!(file[at..].starts_with(starts.as_bytes()), "object {number}");
        }
        let stream = between(&file, b"stream\n", b"\nendstream");
        let mut lines = String::new();
        flate2::read::ZlibDecoder::new(stream)
            .read_to_string(&mut lines)
            .unwrap();
        assert_eq!(lines.matches("BDC").count(), 2);
        assert_eq!(lines.matches("EMC").count(), 2);
        assert!(
            lines.contains("10 20 m") && lines.contains("40 20 l"),
            "{lines}"
        );
        assert!(lines.contains("0.3 w"), "{lines}");
        // Each layer in its own ink.
        assert!(
            lines.contains("0 0 0 RG") && lines.contains("0 1 0 RG"),
            "{lines}"
        );
    }
}
