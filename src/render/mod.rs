//! The picture: plan, G-buffer, shadow map, shading by eq. 1, sheets of views.
//!
//! Illumination model: Luft, Balzer, Deussen 2007, Expressive Illumination of Foliage Based on
//! Implicit Surfaces, eq. 1. `frame.rs` lists the passes in order.

mod areas;
mod batch;
mod frame;
pub mod gbuffer;
pub mod image;
pub mod mips;
pub mod order;
mod outline;
mod pipelines;
pub mod plan;
pub mod planned;
pub mod renderer;
pub mod setting_table;
pub mod settings;
pub mod setup;
pub mod sheet;
pub mod slice;
pub mod subject;
pub mod texture;
mod upload;
pub mod view;

pub use crate::scene::{CameraSpec, Sky, Sun};
pub use gbuffer::GBuffer;
pub use image::Picture;
pub use plan::{Attribute, Channel, Plan};
pub use renderer::{Rendered, Renderer};
pub use setting_table::{SETTINGS, SettingInfo};
pub use settings::{Background, Encoding, RenderSettings, ShadowFit};
pub use sheet::sheet;
pub use subject::{Baked, FieldGrid, Subject, SurfaceMesh};
pub use view::View;
