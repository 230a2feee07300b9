//! What is drawn: models, their materials, and the files they come from.

pub mod geometry;
pub mod gltf_document;
pub mod model;

pub use geometry::{Geometry, Part};
pub use model::*;
