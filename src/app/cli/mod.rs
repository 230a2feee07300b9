//! Arguments of every command.

pub mod chosen;
pub mod commands;
pub mod global;
pub mod ink;
pub mod ink_strokes;
pub mod leaf;
pub mod light;
pub mod motion;
mod ranges;
pub mod style;
pub mod tables;

use clap::{Parser, Subcommand};

pub use commands::{
    BakeArgs, BenchArgs, BenchWhat, ConformArgs, GrowArgs, InfoArgs, InputArgs, RenderArgs,
    SettingsArgs, SurfaceArgs,
};
pub use global::GlobalArgs;
pub use ink_strokes::InkCommandArgs;
pub use leaf::LeafArgs;
pub use light::LightArgs;
pub use style::StyleArgs;

use super::tradeoff::TradeoffArgs;

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
  umbrage render tree.glb -o tree.png       a picture
  umbrage bake tree.glb -o tree.baked.glb   the same model with better normals and ambient light
  umbrage render -o picture.png             a picture of a plant that the program grows itself
  umbrage conform                           check every kernel on this device

A MODEL is a glTF, GLB or OBJ file, or grow:SPECIES[:SEED[:LEAVES]]; a SCENE is a TOML file that
places several. `umbrage COMMAND --help` tells every option, `-h` the common ones.

Exit codes: 0 done, 1 a check failed, 2 wrong usage or input, 3 the device failed.";

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Draw a picture
    #[command(after_help = RenderArgs::EXAMPLES)]
    Render(Box<RenderArgs>),
    /// Write the model with realigned normals and ambient coefficients
    #[command(after_help = BakeArgs::EXAMPLES)]
    Bake(Box<BakeArgs>),
    /// Write the implicit surface around the foliage as a mesh
    #[command(after_help = SurfaceArgs::EXAMPLES)]
    Surface(Box<SurfaceArgs>),
    /// Precompute the light of leaves: sky, light between leaves, soft shadows of the sun
    #[command(after_help = LightArgs::EXAMPLES)]
    Light(Box<LightArgs>),
    /// Grow a plant and write it as a model
    #[command(after_help = GrowArgs::EXAMPLES)]
    Grow(GrowArgs),
    /// Tell what a model holds and what drawing it would need, or which devices there are
    #[command(after_help = InfoArgs::EXAMPLES)]
    Info(Box<InfoArgs>),
    /// Leaves: measured species, fit, edit, pictures, the scattering slab
    #[command(after_help = LeafArgs::EXAMPLES)]
    Leaf(LeafArgs),
    /// Time every pass
    #[command(after_help = BenchArgs::EXAMPLES)]
    Bench(Box<BenchArgs>),
    /// Check every kernel on the device against its CPU twin
    #[command(after_help = ConformArgs::EXAMPLES)]
    Conform(ConformArgs),
    /// Write the strokes of a style, to be painted over
    #[command(after_help = InkCommandArgs::EXAMPLES)]
    Ink(InkCommandArgs),
    /// List the styles of drawings, or write one as a file with every key
    #[command(after_help = StyleArgs::EXAMPLES)]
    Style(StyleArgs),
    /// List every setting with unit, range, default and what it trades
    #[command(after_help = SettingsArgs::EXAMPLES)]
    Settings(SettingsArgs),
    /// Measure what every approximation of the foliage bake costs and how far it is from the truth
    #[command(after_help = TradeoffArgs::EXAMPLES)]
    Tradeoff(TradeoffArgs),
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    #[test]
    fn arguments_are_consistent() {
        super::Cli::command().debug_assert();
    }
}
