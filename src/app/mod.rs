//! The program: arguments, commands, progress, files.

pub mod conform;
