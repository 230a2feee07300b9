//! Arguments of drawings.

use clap::Args;

use crate::ink::shown::InkView;

/// How `render` draws in pen and ink.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Pen and ink")]
pub struct InkArgs {
    /// Draws instead of showing a view: full, half, minimal, mixed, normal-edges,
    /// normal-edges-original, outline, photo, pointillist, silhouette-hatching, smooth, toon,
    /// van-gogh, watercolour, or a style or mix file (.toml)
    #[arg(long, value_name = "STYLE|FILE", conflicts_with_all = ["view", "compare", "lighting"])]
    pub style: Option<String>,
    /// A second style: with --share, what lies between the two
    #[arg(long, value_name = "STYLE|FILE", requires = "style")]
    pub toward: Option<String>,
    /// How far towards it, 0 to 1; several stand side by side
    #[arg(
        long,
        value_name = "SHARE",
        value_delimiter = ',',
        default_value = "0.5",
        requires = "toward"
    )]
    pub share: Vec<f32>,
    /// Shows one attribute instead of the drawing: albedo, normal, depth, object, cluster, direction,
    /// hatch, tone, shadow, contour, silhouette, edges or wash
    #[arg(long, value_name = "ATTRIBUTE", requires = "style")]
    pub ink_view: Option<InkView>,
    /// Pixels drawn for one of the picture, along each axis, 1 to 4; 1 is the paper's
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=4))]
    pub ink_supersample: u32,
}
