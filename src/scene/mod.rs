//! What is drawn: models, their materials, and the files they come from.

pub mod geometry;
pub mod gltf_document;
pub mod model;
pub mod population;
pub mod scene_file;

pub use geometry::{Geometry, Part};
pub use model::*;
pub use population::Population;
pub use scene_file::SceneFile;
