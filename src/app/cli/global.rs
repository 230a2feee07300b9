//! Options of every command.

use std::path::PathBuf;

use clap::{ArgAction, Args};
use log::LevelFilter;

/// Options that every command takes.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Global options")]
pub struct GlobalArgs {
    /// Vulkan device: a part of its name, or its index
    #[arg(long, global = true, value_name = "NAME|INDEX")]
    pub device: Option<String>,
    /// Write machine-readable results to standard output
    #[arg(long, global = true)]
    pub json: bool,
    /// Print GPU time per pass
    #[arg(long, global = true)]
    pub timings: bool,
    /// Run under the Vulkan validation layer with synchronisation validation
    #[arg(long, global = true)]
    pub validate: bool,
    /// Neither read nor write cached bakes and pipelines
    #[arg(long, global = true)]
    pub no_cache: bool,
    /// Folder of cached bakes and pipelines (`$XDG_CACHE_HOME/umbrage` unless given); bakes take at
    /// most 1 GiB of it, those used longest ago go first
    #[arg(long, global = true, value_name = "FOLDER")]
    pub cache_dir: Option<PathBuf>,
    /// Say more (twice: everything)
    #[arg(short, long, global = true, action = ArgAction::Count)]
    pub verbose: u8,
    /// Print results and errors, and nothing else
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub quiet: bool,
}

impl GlobalArgs {
    /// Which log messages are shown.
    #[must_use]
    pub fn verbosity(&self) -> LevelFilter {
        match (self.quiet, self.verbose) {
            (true, _) => LevelFilter::Error,
            (false, 0) => LevelFilter::Warn,
            (false, 1) => LevelFilter::Info,
            (false, _) => LevelFilter::Debug,
        }
    }
}
