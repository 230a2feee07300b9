//! Files and lists of a style: what its tile, band and outline are made from.

use std::path::Path;

use super::strokes::{Stroke, band_of, band_strokes, outline_of, tile_of};
use super::style::{Hatching, Painted, Style};
use crate::Result;

impl Style {
    /// Makes the names of its files relative to where the program runs; they are given relative to
    /// the style's folder.
    pub(super) fn resolve(&mut self, folder: &Path) {
        let tile = match &mut self.hatching.tile {
            Some(Painted::One(path)) => std::slice::from_mut(path),
            Some(Painted::Several(paths)) => paths,
            None => &mut [],
        };
        let others = [&mut self.silhouette.band, &mut self.leaves.outline];
        for path in tile.iter_mut().chain(others.into_iter().flatten()) {
            *path = folder.join(&*path);
        }
    }

    /// Reads its files, so that what is wrong with them is told before a model is read.
    pub(super) fn check_files(&self) -> Result<()> {
        if self.hatching.tile.is_some() {
            tile_of(self)?;
        }
        let s = &self.silhouette;
        if s.band.is_some() || !s.strokes.is_empty() || !s.ticks.is_empty() {
            band_of(self)?;
        }
        outline_of(self).map(|_| ())
    }

    pub(super) fn check_strokes(&self) -> std::result::Result<(), String> {
        let h = &self.hatching;
        if h.tile.is_some() && !h.strokes.is_empty() {
            return Err("hatching.tile and hatching.strokes: only one can make the tile".into());
        }
        let s = &self.silhouette;
        if s.band.is_some() && !(s.strokes.is_empty() && s.ticks.is_empty()) {
            return Err(
                "silhouette.band and silhouette.strokes: only one can make the band".into(),
            );
        }
        band_strokes(self).check()?;
        if let Some(Painted::Several(paths)) = &h.tile
            && !(1..=16).contains(&paths.len())
        {
            return Err(format!(
                "hatching.tile: {} pictures: expected 1 to 16",
                paths.len()
            ));
        }
        if h.stroke_length[0] > h.stroke_length[1] {
            return Err(format!(
                "hatching.stroke_length = {:?}: expected the shortest first",
                h.stroke_length
            ));
        }
        for (i, &numbers) in h.strokes.iter().enumerate() {
            Stroke::listed(numbers).map_err(|e| format!("hatching.strokes[{i}]: {e}"))?;
        }
        Ok(())
    }

    /// Whether tile, band and outline of both are the same pictures.
    #[must_use]
    pub fn has_pictures_of(&self, other: &Self) -> bool {
        let outline = |s: &Self| {
            let shape = s.leaves.outline.as_ref().map(|_| s.leaves.shape);
            (s.leaves.outline.clone(), shape)
        };
        // What is no stroke of the tile is left out.
        let tile = |s: &Self| Hatching {
            tile: s.hatching.tile.clone(),
            strokes: s.hatching.strokes.clone(),
            stroke_width: s.hatching.stroke_width,
            stroke_length: s.hatching.stroke_length,
            stroke_jitter: s.hatching.stroke_jitter,
            crossing: s.hatching.crossing,
            cross_angle: s.hatching.cross_angle,
            tones: s.hatching.tones,
            ..Hatching::default()
        };
        let band = |s: &Self| {
            let s = &s.silhouette;
            (s.band.clone(), s.strokes.clone(), s.ticks.clone())
        };
        self.seed == other.seed
            && band(self) == band(other)
            && tile(self) == tile(other)
            && outline(self) == outline(other)
    }
}
