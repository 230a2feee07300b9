//! Expressive illumination of foliage by implicit surfaces (Luft, Balzer, Deussen 2007).

mod ambient;
pub mod bake;
mod bins;
pub mod cutout;
pub mod field;
pub mod frame;
mod generators;
mod implicit;
mod nearest;
mod openness;
pub mod probe;
pub mod probe_field;
mod realign;
mod recorder;
pub mod settings;
pub mod split;
mod stages;
mod subset;
pub mod surface;
pub mod table;
pub mod traced;

pub use bake::{Bake, Baked, Recipe, Stats};
pub use field::NodeGrid;
pub use frame::Frame;
pub use recorder::{PlannedResource, Progress};
pub use settings::{
    AmbientMode, BackFaces, Encoding, Norm, NormalsMode, Primitive, Sampling, Settings,
    SurfaceNormals, Threshold,
};
pub use split::{Leaves, Split};
pub use surface::{DensityGrid, Surface, Surfaced};
pub use table::{SETTINGS, SettingInfo};
