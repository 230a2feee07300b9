//! Arguments of `ink`.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};

use super::InputArgs;
use super::chosen::Chosen;
use super::tables::{FoliageTable, PictureTable};

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
  umbrage ink differ grow:shrub --style mixed --other swiftshader

A style reads them back: hatching.tile = \"tile.png\", silhouette.band = \"band.png\".";
}

/// Parts of `ink`.
#[derive(Debug, Subcommand)]
pub enum InkPart {
    /// Write the strokes of a style as a picture, or listed in a style file
    Strokes(StrokesArgs),
    /// Draw one picture on two devices and tell where it differs
    Differ(Box<DifferArgs>),
}

/// Arguments of `ink differ`.
#[derive(Debug, Args)]
pub struct DifferArgs {
    /// Of which model.
    #[command(flatten)]
    pub input: InputArgs,
    /// A style or mix, built in or a file
    #[arg(long, value_name = "STYLE|FILE", default_value = "silhouette-hatching")]
    pub style: String,
    /// The second device, as --device names the first
    #[arg(long, value_name = "DEVICE", default_value = "swiftshader")]
    pub other: String,
    /// Pixels drawn for one of the picture, along each axis, 1 to 4
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=4))]
    pub ink_supersample: u32,
    /// Settings of the picture.
    #[command(flatten)]
    pub picture: Chosen<PictureTable>,
    /// Settings of the foliage.
    #[command(flatten)]
    pub settings: Chosen<FoliageTable>,
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
