//! One file per command.

pub mod bake;
pub mod bench;
pub mod conform;
pub mod grow;
pub mod info;
pub mod leaf;
pub mod render;
pub mod settings;
pub mod surface;
