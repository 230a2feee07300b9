//! The picture: plan, G-buffer, shadow map, shading by eq. 1, sheets of views.
//!
//! Illumination model: Luft, Balzer, Deussen 2007, Expressive Illumination of Foliage Based on
//! Implicit Surfaces, eq. 1. The whole frame is the function [`frame`](mod@frame) reads like.

pub mod image;
pub mod plan;
pub mod renderer;
pub mod settings;
pub mod sheet;
pub mod slice;
pub mod subject;
pub mod texture;
pub mod view;

pub use crate::scene::{CameraSpec, Sky, Sun};
pub use image::Picture;
pub use plan::{Attribute, Channel, Plan};
pub use renderer::{Rendered, Renderer};
pub use settings::{Background, Encoding, RenderSettings, SETTINGS, SettingInfo};
pub use sheet::sheet;
pub use subject::{Baked, FieldGrid, Subject, SurfaceMesh};
pub use view::View;
