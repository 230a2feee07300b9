//! Where a style's tile, band and leaf shape come from: its files, its lists, or the program.

use std::path::Path;

use super::band::BandStrokes;
use super::fill::TileSettings;
use super::painted::{self, Band};
use super::tile::{Stroke, Tile};
use crate::abi::{INK_BAND_LENGTH, INK_BAND_WIDTH};
use crate::ink::shape_outline::Outline;
use crate::ink::style::{Painted, Style};
use crate::scene::ImageSource;
use crate::scene::textures::{self, Rgba8};
use crate::{Error, Result};

/// Borders this much rougher than the inside are told: strokes will be cut there.
const ROUGH: f32 = 2.0;

fn read(path: &Path) -> Result<Rgba8> {
    let bytes = std::fs::read(path).map_err(|e| Error::file(path, e))?;
    textures::decode(&ImageSource::Encoded {
        name: path.display().to_string(),
        bytes: bytes.into(),
    })
}

/// The hatching tile of a style.
///
/// # Errors
/// A file that cannot be read or does not fit, a stroke of the list out of its ranges.
pub fn tile_of(style: &Style) -> Result<Tile> {
    let h = &style.hatching;
    let tile = match &h.tile {
        Some(Painted::One(path)) => {
            painted::thresholds(&read(path)?).map_err(|e| Error::file(path, e))?
        }
        Some(Painted::Several(paths)) => {
            let images = paths.iter().map(|p| read(p)).collect::<Result<Vec<_>>>()?;
            painted::tones(&images).map_err(|(i, e)| Error::file(&paths[i], e))?
        }
        None if !h.strokes.is_empty() => {
            let one = |(i, &numbers)| {
                Stroke::listed(numbers)
                    .map_err(|e| Error::usage(format!("hatching.strokes[{i}]: {e}")))
            };
            let strokes = h.strokes.iter().enumerate().map(one);
            Tile::of_strokes(strokes.collect::<Result<_>>()?)
        }
        None => Tile::new(&TileSettings {
            seed: style.seed.wrapping_add(1),
            width: h.stroke_width,
            lengths: h.stroke_length,
            scatter: h.stroke_jitter.to_radians(),
            crossing: h.crossing,
            cross_angle: h.cross_angle.to_radians(),
            tones: h.tones,
        }),
    };
    if let Some(painted) = &h.tile {
        for (seam, border) in tile
            .seams()
            .into_iter()
            .zip(["left and right", "top and bottom"])
        {
            if seam > ROUGH {
                log::warn!(
                    "{}: does not repeat: {seam:.1} times rougher where {border} meet than within",
                    painted.first().display()
                );
            }
        }
    }
    Ok(tile)
}

/// The band of silhouette strokes of a style.
///
/// # Errors
/// A file that cannot be read or does not fit, a list that does not go from dark to light.
pub fn band_of(style: &Style) -> Result<Band> {
    let Some(path) = &style.silhouette.band else {
        let band = Band {
            extent: [INK_BAND_LENGTH, INK_BAND_WIDTH],
            texels: band_strokes(style).texels(),
        };
        let checked = band.checked();
        return checked.map_err(|e| Error::usage(format!("silhouette.strokes: {e}")));
    };
    let band = Band::new(&read(path)?).map_err(|e| Error::file(path, e))?;
    if band.seam() > ROUGH {
        log::warn!(
            "{}: does not repeat: {:.1} times rougher where its ends meet than within",
            path.display(),
            band.seam()
        );
    }
    Ok(band)
}

/// Strokes of a style's band that is not painted: its own, or the program's.
#[must_use]
pub fn band_strokes(style: &Style) -> BandStrokes {
    let s = &style.silhouette;
    if s.strokes.is_empty() && s.ticks.is_empty() {
        return BandStrokes::new(style.seed);
    }
    BandStrokes {
        lines: s.strokes.clone(),
        ticks: s.ticks.clone(),
    }
}

/// The shape that a style's leaves turn into, where it is no disc.
///
/// # Errors
/// A file that cannot be read or shows nothing.
pub fn outline_of(style: &Style) -> Result<Option<Outline>> {
    let of =
        |path: &std::path::PathBuf| Outline::new(&read(path)?).map_err(|e| Error::file(path, e));
    style.leaves.outline.as_ref().map(of).transpose()
}
