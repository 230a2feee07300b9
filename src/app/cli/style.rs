//! Arguments of `style`.

use std::path::PathBuf;

use clap::Args;

/// Arguments of `style`.
#[derive(Debug, Clone, Default, Args)]
pub struct StyleArgs {
    /// A built-in style, or a file of a style on paper (.toml); without it the styles are listed
    #[arg(value_name = "STYLE|FILE")]
    pub name: Option<String>,
    /// Style file to write (.toml) [default: printed]
    #[arg(short, long, value_name = "FILE", requires = "name")]
    pub output: Option<PathBuf>,
    /// Print every key of styles on paper with unit, values and default, as a Markdown table
    #[arg(long, conflicts_with = "name")]
    pub keys: bool,
}

impl StyleArgs {
    pub(super) const EXAMPLES: &str = "\
Examples:
  umbrage style                             list the styles
  umbrage style ds00-fig3a -o own.toml      every key and its value, to be changed
  umbrage render oak.glb -o oak.svg --style own.toml
  umbrage style --keys                      what the keys of styles on paper mean";
}
