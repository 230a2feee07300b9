//! One file per command.

pub mod conform;
