//! One file per command.

pub mod conform;
pub mod grow;
pub mod info;
pub mod settings;
