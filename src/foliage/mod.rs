//! Expressive illumination of foliage by implicit surfaces (Luft, Balzer, Deussen 2007).

pub mod cutout;
pub mod settings;
pub mod split;
pub mod table;
pub mod traced;

pub use settings::{
    AmbientMode, BackFaces, Encoding, Norm, NormalsMode, Primitive, Sampling, Settings,
    SurfaceNormals, Threshold,
};
pub use split::Split;
pub use table::{SETTINGS, SettingInfo};
