//! Arguments of `leaf` and its parts.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};

use super::ranges::{real, real32};
use crate::leaf::edit::{Change, Channels};
use crate::leaf::{Face, Mode};

/// Arguments of `leaf`.
#[derive(Debug, Clone, Args)]
#[command(subcommand_required = true, arg_required_else_help = true)]
pub struct LeafArgs {
    /// Which part.
    #[command(subcommand)]
    pub part: LeafPart,
}

impl LeafArgs {
    pub(super) const EXAMPLES: &str = "\
Examples:
  umbrage leaf species
  umbrage leaf show birch -o birch.png
  umbrage leaf edit birch --thickness 1.5x --sigma-a 1x,2x,1x -o thick.toml
  umbrage leaf fit --reflectance-upper r.png --transmittance t.png --mask m.png -o leaf.toml
  umbrage leaf slab --omega 0.9 --delta 1 --mu0 1";
}

/// Parts of `leaf`.
#[derive(Debug, Clone, Subcommand)]
pub enum LeafPart {
    /// List the leaves the program knows, with their measured colours
    #[command(after_help = "Examples:\n  umbrage leaf species\n  umbrage leaf species --json")]
    Species,
    /// Tell how a homogeneous slab shares out light
    #[command(after_help = SlabArgs::EXAMPLES)]
    Slab(SlabArgs),
    /// Draw a leaf: its maps, lit from both sides, and under edits
    #[command(after_help = ShowArgs::EXAMPLES)]
    Show(ShowArgs),
    /// Change a leaf and write it
    #[command(after_help = EditArgs::EXAMPLES)]
    Edit(Box<EditArgs>),
    /// Find the leaf that measured images show
    #[command(after_help = FitArgs::EXAMPLES)]
    Fit(Box<FitArgs>),
}

/// Arguments of `leaf slab`.
#[derive(Debug, Clone, Args)]
pub struct SlabArgs {
    /// Scattering albedo, 0 to 1
    #[arg(long, value_name = "W", allow_negative_numbers = true)]
    pub omega: f64,
    /// Optical thickness, >= 0
    #[arg(long, value_name = "D", allow_negative_numbers = true)]
    pub delta: f64,
    /// Cosine of the angle of incidence of a beam, above 0 to 1
    #[arg(
        long,
        value_name = "M",
        allow_negative_numbers = true,
        default_value_t = 1.0,
        conflicts_with = "diffuse"
    )]
    pub mu0: f64,
    /// Light from the whole hemisphere instead of a beam
    #[arg(long)]
    pub diffuse: bool,
}

impl SlabArgs {
    const EXAMPLES: &str = "\
Examples:
  umbrage leaf slab --omega 0.9 --delta 1
  umbrage leaf slab --omega 0.3675 --delta 2.757 --mu0 0.5 --json
  umbrage leaf slab --omega 1 --delta 10 --diffuse";
}

/// A leaf, wherever it comes from.
#[derive(Debug, Clone, Args)]
pub struct LeafInput {
    /// A leaf of `umbrage leaf species`, a leaf file (.toml), or a model with --material
    #[arg(value_name = "LEAF")]
    pub leaf: String,
    /// The material of a model that is taken for a leaf
    #[arg(long, value_name = "NAME")]
    pub material: Option<String>,
}

/// Arguments of `leaf show`.
#[derive(Debug, Clone, Args)]
pub struct ShowArgs {
    /// Which leaf.
    #[command(flatten)]
    pub input: LeafInput,
    /// Picture to write (PNG, or JPEG by its extension)
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// What is shown
    #[arg(long, default_value = "all")]
    pub sheet: Sheet,
    /// Height of one leaf in pixels
    #[arg(long, default_value_t = 320, value_parser = clap::value_parser!(u32).range(16..=2048))]
    pub size: u32,
}

/// Sheets of `leaf show`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Sheet {
    /// The maps of both sides (figure 3).
    Maps,
    /// Thickness and absorption edited, lit from the front and from behind (figure 7).
    Edits,
    /// One picture of the upper side in the sun.
    Front,
    /// One picture of the lower side with the sun behind.
    Back,
    /// Maps and edits.
    All,
}

impl ShowArgs {
    const EXAMPLES: &str = "\
Examples:
  umbrage leaf show birch -o birch.png
  umbrage leaf show leaf.toml --sheet edits -o edits.png
  umbrage leaf show oak.glb --material leaves -o oak-leaf.png";
}

/// Arguments of `leaf edit`.
#[derive(Debug, Clone, Args)]
pub struct EditArgs {
    /// Which leaf.
    #[command(flatten)]
    pub input: LeafInput,
    /// Leaf file to write (.toml, its maps beside it), or a model of one leaf (.glb)
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Thickness in millimetres, or a factor such as 1.5x
    #[arg(long, value_name = "MM|FACTORx", allow_hyphen_values = true)]
    pub thickness: Option<Change>,
    /// Absorption per channel in 1/mm or as factors: 0.5x or 1x,2x,1x
    #[arg(long, value_name = "R,G,B", allow_hyphen_values = true)]
    pub sigma_a: Option<Channels>,
    /// Scattering per channel in 1/mm or as factors
    #[arg(long, value_name = "R,G,B", allow_hyphen_values = true)]
    pub sigma_s: Option<Channels>,
    /// Factor on the glossy reflection, 0 to 1000
    #[arg(long, value_name = "FACTOR", value_parser = real32(0.0, 1000.0), allow_hyphen_values = true)]
    pub gloss: Option<f32>,
    /// Roughness m of the gloss, kept in 0.001 to 1, or a factor on it
    #[arg(long, value_name = "M|FACTORx", allow_hyphen_values = true)]
    pub roughness: Option<Change>,
    /// Where A and B come from: paper (constants of the leaf) or exact (the table)
    #[arg(long)]
    pub mode: Option<Mode>,
    /// Change only one side
    #[arg(long)]
    pub side: Option<SideName>,
    /// Width and height of the maps
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// How maps are written
    #[arg(long, default_value = "png")]
    pub maps: MapsName,
}

/// A side of a leaf.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SideName {
    /// The upper side.
    Upper,
    /// The lower side.
    Lower,
}

impl From<SideName> for Face {
    fn from(name: SideName) -> Self {
        match name {
            SideName::Upper => Self::Upper,
            SideName::Lower => Self::Lower,
        }
    }
}

/// Formats of maps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MapsName {
    /// 16-bit PNG.
    Png,
    /// 32-bit EXR.
    Exr,
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let wrong = || format!("{text:?} is not WIDTHxHEIGHT");
    let (w, h) = text.split_once(['x', 'X']).ok_or_else(wrong)?;
    Ok([
        w.parse().map_err(|_| wrong())?,
        h.parse().map_err(|_| wrong())?,
    ])
}

impl EditArgs {
    const EXAMPLES: &str = "\
Examples:
  umbrage leaf edit birch -o birch.toml
  umbrage leaf edit birch.toml --thickness 0.25 --sigma-a 0.5x -o pale.toml --maps exr
  umbrage leaf edit birch --size 720x540 -o birch.toml
  umbrage leaf edit birch -o birch.glb";
}

/// Arguments of `leaf fit`.
#[derive(Debug, Clone, Args)]
pub struct FitArgs {
    /// Image of the upper side's diffuse reflectance
    #[arg(long, value_name = "IMAGE")]
    pub reflectance_upper: PathBuf,
    /// Image of the lower side's; without it both sides are alike
    #[arg(long, value_name = "IMAGE")]
    pub reflectance_lower: Option<PathBuf>,
    /// Image of the transmittance
    #[arg(long, value_name = "IMAGE")]
    pub transmittance: PathBuf,
    /// Image of where the leaf is (white); without it the alpha of the reflectance
    #[arg(long, value_name = "IMAGE")]
    pub mask: Option<PathBuf>,
    /// Intensity of the upper side's gloss
    #[arg(long, value_name = "IMAGE")]
    pub specular_upper: Option<PathBuf>,
    /// Intensity of the lower side's gloss
    #[arg(long, value_name = "IMAGE")]
    pub specular_lower: Option<PathBuf>,
    /// Roughness of the upper side's gloss, m in 0..1
    #[arg(long, value_name = "IMAGE")]
    pub roughness_upper: Option<PathBuf>,
    /// Roughness of the lower side's gloss
    #[arg(long, value_name = "IMAGE")]
    pub roughness_lower: Option<PathBuf>,
    /// Mean thickness, millimetres, 1e-6 to 1000: a free scale
    #[arg(long, value_name = "MM", value_parser = real(1e-6, 1000.0), allow_hyphen_values = true, default_value_t = crate::leaf::appearance::USUAL_THICKNESS_MM)]
    pub thickness: f64,
    /// What the numbers of PNG and JPEG mean (EXR and HDR are linear, masks and roughness too)
    #[arg(long, default_value = "srgb")]
    pub encoding: EncodingName,
    /// Surface reflection that the reflectance contains, 0 to 0.5 (0.035 from an integrating sphere)
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, value_parser = real32(0.0, 0.5), allow_hyphen_values = true)]
    pub surface: f32,
    /// How it is fitted: paper (closed forms with constant A and B) or exact (the table)
    #[arg(long, default_value = "exact")]
    pub mode: Mode,
    /// Leaf file to write (.toml, its maps beside it)
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// How maps are written
    #[arg(long, default_value = "png")]
    pub maps: MapsName,
    /// Also write what the fit leaves over, as PNG: transmittance of the model minus the measured,
    /// times 4 around mid-grey
    #[arg(long, value_name = "FILE")]
    pub residuals: Option<PathBuf>,
}

/// Meaning of 8- and 16-bit numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum EncodingName {
    /// Colours.
    Srgb,
    /// Numbers.
    Linear,
}

impl FitArgs {
    const EXAMPLES: &str = "\
Examples:
  umbrage leaf fit --reflectance-upper r.png --transmittance t.png --mask m.png -o leaf.toml
  umbrage leaf fit --reflectance-upper ru.exr --reflectance-lower rl.exr --transmittance t.exr \\
      --mask m.png --thickness 0.17 --surface 0.035 --maps exr --residuals left.png -o leaf.toml";
}
