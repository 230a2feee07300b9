//! Arguments of every command.

use std::path::PathBuf;

use clap::{ArgAction, Args, Parser, Subcommand};
use log::LevelFilter;

/// Bakes, lights and draws foliage with Vulkan.
#[derive(Debug, Parser)]
#[command(version, about, long_about = None, after_help = EXAMPLES, max_term_width = 100)]
pub struct Cli {
    /// Options of every command.
    #[command(flatten)]
    pub global: GlobalArgs,
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

const EXAMPLES: &str = "\
Examples:
  umbrage conform                   check every kernel on this device against its CPU twin

Exit codes: 0 done, 1 a check failed, 2 wrong usage or input, 3 the device failed.";

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
    /// Folder of cached bakes and pipelines (`$XDG_CACHE_HOME/umbrage` unless given)
    #[arg(long, global = true, value_name = "FOLDER")]
    pub cache_dir: Option<PathBuf>,
    /// Say more (twice: everything)
    #[arg(short, long, global = true, action = ArgAction::Count)]
    pub verbose: u8,
    /// Say nothing but errors
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

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Check every kernel on the device against its CPU twin
    #[command(after_help = ConformArgs::EXAMPLES)]
    Conform(ConformArgs),
}

/// Arguments of `conform`.
#[derive(Debug, Clone, Default, Args)]
pub struct ConformArgs {
    /// Run only cases whose name contains this
    pub filter: Option<String>,
    /// List the cases and run none
    #[arg(long)]
    pub list: bool,
}

impl ConformArgs {
    const EXAMPLES: &str = "\
Examples:
  umbrage conform
  umbrage conform foliage.density
  umbrage --device swiftshader conform --json";
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    #[test]
    fn arguments_are_consistent() {
        super::Cli::command().debug_assert();
    }
}
