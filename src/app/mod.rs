//! The program: arguments, commands, progress, files.

pub mod animation;
pub mod bake;
pub mod bake_file;
pub mod branches;
pub mod cache;
pub mod cli;
pub mod clusters;
pub mod coherence;
pub mod command;
pub mod conform;
pub mod console;
pub mod context;
pub mod differ;
pub mod drawing;
pub mod film;
pub mod input;
pub mod lit;
pub mod output;
pub mod prepared;
pub mod relight;
pub mod report;
pub mod settings;
pub mod timing;
pub mod tradeoff;

mod entry;

pub use context::Context;
pub use entry::run;
pub use report::Report;
