//! Arguments of drawings.

use clap::Args;

/// How `render` draws in pen and ink.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Pen and ink")]
pub struct InkArgs {
    /// Draws instead of showing a view: full, minimal, mixed, outline, silhouette-hatching,
    /// smooth, or a style or mix file (.toml)
    #[arg(long, value_name = "STYLE|FILE", conflicts_with_all = ["view", "compare", "lighting"])]
    pub style: Option<String>,
    /// Pixels drawn for one of the picture, along each axis, 1 to 4; 1 is the paper's
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=4))]
    pub ink_supersample: u32,
}
