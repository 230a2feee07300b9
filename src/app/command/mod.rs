//! One file per command.

pub mod conform;
pub mod info;
pub mod settings;
