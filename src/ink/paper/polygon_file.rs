//! Outlines of primitives from files: the paths of an SVG, or points in TOML.

use std::fs;
use std::path::Path;

use glam::DVec2;
use roxmltree::{Document, Node};
use serde::Deserialize;
use svgtypes::{SimplePathSegment, SimplifyingPathParser};

use super::polygon::views;
use super::style::{Form, Primitive};
use crate::{Error, Result};

/// Straight pieces of a curve.
const PIECES: u32 = 16;
/// Files that are larger hold no outline.
const MOST_BYTES: u64 = 4 << 20;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    polygon: Option<Vec<[f64; 2]>>,
    views: Option<Vec<Vec<[f64; 2]>>>,
}

/// The outline or the nine outlines of a file.
///
/// In TOML `polygon` or `views`, as in styles. In an SVG each path is one closed line, its first
/// point the one where the leaf is fixed; nine of them are the nine views in the order of the
/// file. Their middles become (0, 0), and one scale fits all into the unit disc.
///
/// # Errors
/// A file that cannot be read, is neither, holds neither one outline nor nine, transforms, or
/// outlines that cannot be filled.
pub fn outlines(path: &Path) -> Result<Form> {
    let wrong = |why: String| Error::file(path, why);
    let size = fs::metadata(path)
        .map_err(|e| wrong(format!("cannot read: {e}")))?
        .len();
    if size > MOST_BYTES {
        return Err(wrong(format!(
            "{size} bytes: outlines take at most {MOST_BYTES}"
        )));
    }
    let text = fs::read_to_string(path).map_err(|e| wrong(format!("cannot read: {e}")))?;
    let is_svg = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("svg"));
    let all = if is_svg { drawn(&text) } else { written(&text) }.map_err(wrong)?;
    let form = match <[Vec<[f64; 2]>; 1]>::try_from(all) {
        Ok([one]) => Form::Polygon(one),
        Err(all) => Form::Views(all),
    };
    let primitive = Primitive {
        form: form.clone(),
        ..Primitive::default()
    };
    views(&primitive).map_err(|e| wrong(e.replace("primitive.form: ", "")))?;
    Ok(form)
}

fn written(text: &str) -> std::result::Result<Vec<Vec<[f64; 2]>>, String> {
    let written: Written = toml::from_str(text).map_err(|e| e.to_string())?;
    match (written.polygon, written.views) {
        (Some(one), None) => Ok(vec![one]),
        (None, Some(nine)) if nine.len() == 9 => Ok(nine),
        (None, Some(all)) => Err(format!("{} views, expected nine", all.len())),
        _ => Err("expected polygon or views".into()),
    }
}

fn drawn(text: &str) -> std::result::Result<Vec<Vec<[f64; 2]>>, String> {
    let document = Document::parse(text).map_err(|e| format!("is no SVG: {e}"))?;
    let is_path = |n: &Node<'_, '_>| n.is_element() && n.tag_name().name() == "path";
    let paths: Vec<_> = document.descendants().filter(is_path).collect();
    if !matches!(paths.len(), 1 | 9) {
        return Err(format!("{} paths, expected one or nine", paths.len()));
    }
    let mut rings = Vec::new();
    for path in paths {
        if path.ancestors().any(|n| n.has_attribute("transform")) {
            return Err("a transform: apply it to the path first".into());
        }
        rings.push(ring(path.attribute("d").unwrap_or_default())?);
    }
    let bounds = |ring: &Vec<DVec2>| {
        let low = ring.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        0.5 * (low + ring.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max))
    };
    let middles: Vec<DVec2> = rings.iter().map(bounds).collect();
    let reach = |(ring, middle): (&Vec<DVec2>, &DVec2)| {
        ring.iter().map(|p| p.distance(*middle)).fold(0.0, f64::max)
    };
    let scale = rings.iter().zip(&middles).map(reach).fold(0.0, f64::max);
    if !(scale > 0.0 && scale.is_finite()) {
        return Err("an outline needs at least three points".into());
    }
    // Rows of an SVG go downwards.
    let placed = |(ring, middle): (Vec<DVec2>, DVec2)| {
        let point = |p: DVec2| ((p - middle) * DVec2::new(1.0, -1.0) / scale).to_array();
        ring.into_iter().map(point).collect()
    };
    Ok(rings.into_iter().zip(middles).map(placed).collect())
}

/// The points of a path of one closed line.
fn ring(data: &str) -> std::result::Result<Vec<DVec2>, String> {
    let mut out: Vec<DVec2> = Vec::new();
    let mut ended = false;
    for segment in SimplifyingPathParser::from(data) {
        let segment = segment.map_err(|e| format!("path: {e}"))?;
        if ended || (!out.is_empty() && matches!(segment, SimplePathSegment::MoveTo { .. })) {
            return Err("a path of several lines: one closed line is an outline".into());
        }
        let last = out.last().copied().unwrap_or_default();
        let mut curve = |at: &dyn Fn(f64) -> DVec2| {
            out.extend((1..=PIECES).map(|k| at(f64::from(k) / f64::from(PIECES))));
        };
        match segment {
            SimplePathSegment::MoveTo { x, y } | SimplePathSegment::LineTo { x, y } => {
                out.push(DVec2::new(x, y));
            }
            SimplePathSegment::Quadratic { x1, y1, x, y } => {
                let (a, b) = (DVec2::new(x1, y1), DVec2::new(x, y));
                curve(&|t| last.lerp(a, t).lerp(a.lerp(b, t), t));
            }
            SimplePathSegment::CurveTo {
                x1,
                y1,
                x2,
                y2,
                x,
                y,
            } => {
                let [a, b, c] = [DVec2::new(x1, y1), DVec2::new(x2, y2), DVec2::new(x, y)];
                curve(&|t| {
                    let middle = a.lerp(b, t);
                    let (l, r) = (
                        last.lerp(a, t).lerp(middle, t),
                        middle.lerp(b.lerp(c, t), t),
                    );
                    l.lerp(r, t)
                });
            }
            SimplePathSegment::ClosePath => ended = true,
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_become_outlines_about_their_middle() {
        let of = |d: &str| {
            drawn(&format!(
                "<svg xmlns='http://www.w3.org/2000/svg'><path d='{d}'/></svg>"
            ))
        };
        let square = of("M10 30 h20 v-20 h-20 z").unwrap();
        let half = 0.5_f64.sqrt();
        let want = [[-half, -half], [half, -half], [half, half], [-half, half]];
        for (found, want) in square[0].iter().zip(want) {
            assert!((DVec2::from(*found) - DVec2::from(want)).length() < 1e-12);
        }
        let round = of("M0 5 A5 5 0 0 1 10 5 A5 5 0 0 1 0 5 Z").unwrap();
        assert!(round[0].len() > 32);
        assert!(
            round[0]
                .iter()
                .all(|p| (DVec2::from(*p).length() - 1.0).abs() < 0.01)
        );
        for (d, said) in [
            ("M0 0 L1 0 L0 1 Z M5 5 L6 5 L5 6 Z", "several lines"),
            ("M0 0 L1 0 Q", "path"),
            ("", "three points"),
            ("M3 3", "three points"),
        ] {
            assert!(of(d).unwrap_err().contains(said), "{d}: {:?}", of(d));
        }
        assert!(drawn("<svg/>").unwrap_err().contains("0 paths"));
        assert!(
            drawn("<svg><g transform='scale(2)'><path d='M0 0 h1 v1 z'/></g></svg>")
                .unwrap_err()
                .contains("transform")
        );
        assert!(drawn("<svg").unwrap_err().contains("no SVG"));
    }
}
