//! Sheets of lit pictures (Wang et al. 2005, figure 8): side by side, their differences below them,
//! their errors in numbers.

use std::path::{Path, PathBuf};

use crate::app::cli::light::{Lighting, LitArgs};
use crate::leaf::radiance_map::{Difference, RadianceMap};
use crate::render::{self, Picture};
use crate::scene::float_image::{FloatImage, Transfer};
use crate::{Error, Result};

/// Background of lit pictures, linear.
const BEHIND: [f32; 3] = [0.80, 0.82, 0.84];
/// Share of the leaves that may be brighter than white.
const WHITE: f64 = 0.995;
/// Too bright, equal, too dark, sRGB.
const SIGNS: [[u8; 3]; 3] = [[178, 24, 43], [247, 247, 247], [33, 102, 172]];
/// Paper of the sheet, sRGB.
const PAPER: [u8; 4] = [250, 250, 249, 255];

/// A picture with the name of what lit it.
pub(super) struct Drawn {
    pub(super) name: String,
    pub(super) lighting: Lighting,
    pub(super) map: RadianceMap,
    /// Of the truth: light of sun and lamps on what the camera sees.
    pub(super) direct: Option<RadianceMap>,
}

/// A picture beside what it is measured against.
pub(super) struct Compared {
    /// Number of the picture.
    picture: usize,
    /// What the row of the table is called.
    pub(super) name: String,
    /// What the reference is called.
    against: String,
    /// Pixels of the picture.
    own: Vec<[f32; 4]>,
    reference: RadianceMap,
    pub(super) difference: Difference,
}

/// Each picture against the truth among them and against pictures of a file; where there is
/// neither and differences are wanted, against the last.
pub(super) fn compare(drawn: &[Drawn], args: &LitArgs) -> Result<Vec<Compared>> {
    let mut out = Vec::new();
    let truth = drawn.iter().position(|d| d.lighting == Lighting::Truth);
    let last = drawn.len().checked_sub(1);
    let among = match (truth, args.reference.is_some(), args.difference.is_some()) {
        (None, false, true) => last,
        _ => truth,
    };
    if let Some(own) = among {
        for (picture, d) in drawn.iter().enumerate().filter(|(i, _)| *i != own) {
            // The sun's part alone against its part of the truth.
            let part = match (&drawn[own].direct, d.lighting) {
                (Some(direct), Lighting::Lvc) => direct,
                _ => &drawn[own].map,
            };
            out.push(Compared {
                picture,
                name: d.name.clone(),
                against: drawn[own].name.clone(),
                own: d.map.pixels.clone(),
                reference: part.clone(),
                difference: d.map.difference(part)?,
            });
        }
    }
    if let Some(prefix) = &args.reference {
        for (picture, d) in drawn.iter().enumerate() {
            let path = reference_path(prefix, d.lighting);
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            let reference = read_map(&path)?;
            let difference = d.map.difference(&reference);
            out.push(Compared {
                picture,
                name: format!("{} to {name}", d.name),
                against: name.into_owned(),
                own: d.map.pixels.clone(),
                reference,
                difference: difference.map_err(|e| Error::file(&path, e))?,
            });
        }
    }
    Ok(out)
}

/// The picture that one lighting is compared with.
pub(super) fn reference_path(prefix: &Path, lighting: Lighting) -> PathBuf {
    let part = if lighting == Lighting::Lvc {
        "sun_direct"
    } else {
        "full"
    };
    let name = prefix.file_name().unwrap_or_default().to_string_lossy();
    prefix.with_file_name(format!("{name}_{part}.exr"))
}

/// A picture of linear light; black is background.
fn read_map(path: &Path) -> Result<RadianceMap> {
    let bytes = std::fs::read(path).map_err(|e| Error::file(path, e))?;
    let image = FloatImage::decode(&path.to_string_lossy(), &bytes, Transfer::Srgb)?;
    let pixel = |&[r, g, b, _]: &[f32; 4]| {
        let covered = f32::from(u8::from(r > 0.0 || g > 0.0 || b > 0.0));
        [r, g, b, covered]
    };
    Ok(RadianceMap {
        width: image.width as usize,
        height: image.height as usize,
        pixels: image.pixels.iter().map(pixel).collect(),
    })
}

/// All pictures on one sheet; one alone is itself.
pub(super) fn sheet(drawn: &[Drawn], compared: &[Compared], args: &LitArgs) -> Picture {
    let exposure = args.light_exposure.unwrap_or_else(|| {
        let brightest = drawn.iter().map(|d| d.map.quantile(WHITE));
        0.95 / brightest.fold(0.0, f32::max).max(1e-9)
    });
    let mut all: Vec<(String, Picture)> = drawn
        .iter()
        .map(|d| (d.name.clone(), lit(&d.map, exposure)))
        .collect();
    match (args.difference, all.len()) {
        (Some(scale), _) if !compared.is_empty() => {
            add_differences(&mut all, compared, (scale, exposure));
            let columns = all.len() / 2;
            render::sheet(&all, columns)
        }
        (_, 1) => all.swap_remove(0).1,
        (_, columns) => render::sheet(&all, columns),
    }
}

fn lit(map: &RadianceMap, exposure: f32) -> Picture {
    Picture {
        width: map.width as u32,
        height: map.height as u32,
        rgba: map.to_rgba8(exposure, BEHIND),
    }
}

/// A second row: under each picture how far it is from its reference, under the reference the
/// scale. A reference that was read becomes the last picture of the first row.
fn add_differences(
    all: &mut Vec<(String, Picture)>,
    compared: &[Compared],
    (scale, exposure): (f32, f32),
) {
    let pictures = all.len();
    let of = |i: usize| compared.iter().rev().find(|c| c.picture == i);
    let mut row: Vec<Option<(String, Picture)>> = (0..pictures)
        .map(|i| {
            of(i).map(|c| {
                let blocks = 100.0 * c.difference.block_rmse;
                let label = format!("- {}: blocks {blocks:.1} %", c.against);
                (label, signed(&all[i].1, c, scale))
            })
        })
        .collect();
    if row.iter().all(Option::is_some) {
        let first = &compared[0];
        all.push((first.against.clone(), lit(&first.reference, exposure)));
        row.push(None);
    }
    let [w, h] = [all[0].1.width, all[0].1.height];
    let percent = 100.0 * scale;
    all.extend(row.into_iter().map(|cell| {
        cell.unwrap_or_else(|| {
            let label = format!("-{percent:.0} % .. +{percent:.0} % of the mean");
            (label, bar(w, h))
        })
    }));
}

/// Colour of a share of the scale: blue where too dark, red where too bright.
fn sign(t: f32) -> [u8; 3] {
    let end = if t < 0.0 { SIGNS[2] } else { SIGNS[0] };
    let t = t.abs().min(1.0);
    [0, 1, 2].map(|c| {
        let [from, to] = [SIGNS[1][c], end[c]].map(f32::from);
        (from + t * (to - from)).round() as u8
    })
}

/// Signed differences of grey, in shares of the reference's mean times `scale`. Where neither
/// covers anything the lit picture's background stays.
fn signed(lit: &Picture, c: &Compared, scale: f32) -> Picture {
    let unit = (c.difference.mean as f32 * scale).max(1e-12);
    let mut out = lit.clone();
    for (i, pixel) in out.rgba.chunks_exact_mut(4).enumerate() {
        let (d, covered) = c.at(i);
        if covered {
            pixel[..3].copy_from_slice(&sign(d / unit));
        }
    }
    out
}

/// The scale: from too dark to too bright.
fn bar(width: u32, height: u32) -> Picture {
    let mut out = Picture::filled(width, height, PAPER);
    let (left, right) = (width / 10, width - width / 10);
    for y in height * 9 / 20..height * 11 / 20 {
        for x in left..right {
            let t = (x - left) as f32 / (right - left).max(1) as f32;
            let at = 4 * (y * width + x) as usize;
            out.rgba[at..at + 3].copy_from_slice(&sign(2.0 * t - 1.0));
        }
    }
    out
}

impl Compared {
    /// Difference of grey at a pixel, and whether the picture or the reference covers it.
    fn at(&self, i: usize) -> (f32, bool) {
        let grey = |p: [f32; 4]| (p[0] + p[1] + p[2]) / 3.0;
        let (own, reference) = (self.own[i], self.reference.pixels[i]);
        (
            grey(own) - grey(reference),
            own[3] > 0.0 || reference[3] > 0.0,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_are_told_by_colour() {
        assert_eq!(sign(0.0), SIGNS[1]);
        assert_eq!((sign(2.0), sign(-1.0)), (SIGNS[0], SIGNS[2]));
        let strip = bar(40, 40);
        let dark = strip.pixel(4, 20);
        let bright = strip.pixel(35, 20);
        assert!(
            dark[2] > dark[0] && bright[0] > bright[2],
            "{dark:?} {bright:?}"
        );
    }
}
