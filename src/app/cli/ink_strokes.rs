//! Arguments of `ink`.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};

/// Arguments of `ink`.
#[derive(Debug, Args)]
pub struct InkCommandArgs {
    /// What to do.
    #[command(subcommand)]
    pub part: InkPart,
}

impl InkCommandArgs {
    pub(super) const EXAMPLES: &str = "\
Examples:
  umbrage ink strokes silhouette-hatching -o tile.png            thresholds, to be painted over
  umbrage ink strokes silhouette-hatching -o band.png --what band
  umbrage ink strokes my-style.toml -o tones.png --what tones    to look at
  umbrage ink strokes silhouette-hatching -o own.toml            the style with its tile's and band's
                                                                 strokes listed

A style reads them back: hatching.tile = \"tile.png\", silhouette.band = \"band.png\".";
}

/// Parts of `ink`.
#[derive(Debug, Subcommand)]
pub enum InkPart {
    /// Write the strokes of a style as a picture, or listed in a style file
    Strokes(StrokesArgs),
}

/// Arguments of `ink strokes`.
#[derive(Debug, Args)]
pub struct StrokesArgs {
    /// A built-in style, or a style file (.toml)
    pub style: String,
    /// Picture (.png), or style file (.toml)
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// What the picture shows
    #[arg(long, value_enum, default_value_t = StrokesWhat::Tile)]
    pub what: StrokesWhat,
}

/// Pictures of strokes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum StrokesWhat {
    /// The hatching tile's thresholds: the darker, the lighter the tone from which it is ink
    Tile,
    /// The band along silhouettes: four rows from dark to light
    Band,
    /// The tile's ink at six tones and three levels
    Tones,
}
