//! Strokes as data, and the images made of them: hatching tiles (tonal art maps, Praun, Hoppe,
//! Webb, Finkelstein 2001, kept as thresholds, Webb et al. 2002) and bands of silhouette strokes.

mod band;
mod fill;
pub mod painted;
mod source;
mod tile;

pub use band::{BandStrokes, ListedLine, ListedTick, band};
pub use fill::TileSettings;
pub use source::{band_of, band_strokes, outline_of, tile_of};
pub use tile::{Listed, Stroke, Tile, level_size};
