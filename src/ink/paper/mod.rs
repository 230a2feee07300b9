//! Pen-and-ink drawings on paper, as pixels at once or as vectors (Deussen and Strothotte 2000).
//!
//! Reading order: [`style`] says what is drawn, [`particles`] and [`polygon`] make primitives of
//! leaves, [`renderer`] draws depth and numbers, [`drawing`] finds lines in them ([`outline`],
//! [`trace`], [`whole`], [`diffusion`], [`anchored`], [`tiles`]; [`modulation`] changes them from
//! place to place), [`pen`] draws them, [`order`] sorts them, [`fit`] makes curves, [`svg`] and
//! [`pdf`] write them; [`laid`] puts strokes on bitmaps.

mod across;
pub mod anchored;
pub mod bounds;
pub mod clutter;
pub mod curve;
pub mod diffusion;
pub mod drawing;
pub mod expression;
mod eye;
mod factors;
pub mod fit;
mod grid;
mod inks;
pub mod laid;
pub mod limbs;
pub mod modulation;
pub mod order;
pub mod outline;
pub mod particles;
pub mod pdf;
pub mod pen;
pub mod polygon;
pub mod polygon_file;
pub mod presets;
pub mod progress;
pub mod ranges;
pub mod region;
pub mod renderer;
mod silhouette;
mod single;
mod sizes;
mod stem_strokes;
pub mod stems;
pub mod style;
pub mod style_table;
mod sun;
pub mod svg;
pub mod tiles;
mod tones;
pub mod trace;
pub mod vectors;
pub mod whole;
