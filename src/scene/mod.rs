//! What is drawn: models, their materials, and the files they come from.

pub mod camera;
pub mod camera_path;
pub mod camera_spec;
pub mod export;
pub mod extensions;
pub mod float_image;
pub mod geometry;
pub mod gltf_document;
pub mod grow;
pub mod import;
pub mod light;
pub mod model;
pub mod population;
pub mod scene_file;
pub mod textures;

pub use camera::{Camera, Lens, LightView, Pose};
pub use camera_path::CameraPath;
pub use camera_spec::CameraSpec;
pub use geometry::{Geometry, Part};
pub use light::{Sky, Sun};
pub use model::*;
pub use population::Population;
pub use scene_file::SceneFile;
