//! Ways of a camera through time: built in, or keyframes of a file.

mod file;
mod spec;
mod way;

pub use spec::PathSpec;
pub use way::CameraPath;
