//! Pen and ink: foliage as drawn clusters of leaves (Coconu, Deussen, Hege 2006; Deussen,
//! Strothotte 2000).

pub mod blend;
pub mod bodies;
pub mod branches;
pub mod clusters;
mod images;
pub mod leaves;
pub mod lod;
pub mod mix;
pub mod motion;
pub mod paper;
pub mod plan;
pub mod plant;
pub mod renderer;
pub mod shape;
pub mod shape_outline;
pub mod shown;
pub mod strokes;
pub mod style;
mod style_files;
mod style_looks;
pub mod view;
