//! Arguments of one command each.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::chosen::Chosen;
use super::ink::InkArgs;
use super::light::LitArgs;
use super::motion::MotionArgs;
use super::tables::{ExportTable, FoliageTable, PictureTable};
use crate::app::input::Source;
use crate::render::View;

/// What a command works on.
#[derive(Debug, Clone, Args)]
pub struct InputArgs {
    /// glTF, GLB or OBJ file, grow:SPECIES:SEED:LEAVES (the last two may be left out), or
    /// a scene file (.toml)
    #[arg(value_name = "MODEL|SCENE")]
    pub input: Source,
    /// Options of models.
    #[command(flatten)]
    pub model: ModelArgs,
}

/// The same, with the embedded plant where nothing is named.
#[derive(Debug, Clone, Args)]
pub struct DefaultInputArgs {
    /// glTF, GLB or OBJ file, grow:SPECIES:SEED:LEAVES (the last two may be left out), or
    /// a scene file (.toml)
    #[arg(value_name = "MODEL|SCENE", default_value = EMBEDDED)]
    pub input: Source,
    /// Options of models.
    #[command(flatten)]
    pub model: ModelArgs,
}

/// The plant that is drawn when none is named.
const EMBEDDED: &str = "grow:broadleaf";

/// How a model is read.
#[derive(Debug, Clone, Default, Args)]
pub struct ModelArgs {
    /// Base colour texture of a material, for models that name none
    #[arg(long = "texture", value_name = "MATERIAL=FILE", value_parser = material_file)]
    pub textures: Vec<(String, PathBuf)>,
    /// Which materials, nodes and meshes are foliage, by name (a regular expression)
    #[arg(long, value_name = "REGEX")]
    pub foliage: Option<String>,
}

fn material_file(text: &str) -> Result<(String, PathBuf), String> {
    let (material, file) = text.split_once('=').ok_or("expected MATERIAL=FILE")?;
    Ok((material.to_owned(), PathBuf::from(file)))
}

/// Arguments of `render`.
#[derive(Debug, Clone, Args)]
pub struct RenderArgs {
    /// glTF, GLB or OBJ files, grow:SPECIES:SEED:LEAVES, scene files (.toml), or a drawing of this
    /// program (.svg), which is drawn again with the options given here in place of its own; several
    /// models make a sheet with one row each
    #[arg(value_name = "MODEL|SCENE", default_value = EMBEDDED)]
    pub inputs: Vec<Source>,
    /// Options of models.
    #[command(flatten)]
    pub model: ModelArgs,
    /// Picture to write (PNG, or JPEG by its extension; a drawing on paper also as SVG or PDF)
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// What is shown: textured (the finished picture), standard, ambient, direct, combined,
    /// shadowed, normals, depth, slice or surface
    #[arg(long, default_value = "textured")]
    pub view: View,
    /// Several views side by side on one labelled sheet
    #[arg(
        long,
        value_name = "VIEW,VIEW,..",
        value_delimiter = ',',
        conflicts_with = "view"
    )]
    pub compare: Vec<View>,
    /// Light of leaves.
    #[command(flatten)]
    pub lit: LitArgs,
    /// Pen and ink.
    #[command(flatten)]
    pub ink: InkArgs,
    /// Many frames.
    #[command(flatten)]
    pub motion: MotionArgs,
    /// Settings of the picture.
    #[command(flatten)]
    pub picture: Chosen<PictureTable>,
    /// Settings of the foliage.
    #[command(flatten)]
    pub settings: Chosen<FoliageTable>,
}

impl RenderArgs {
    pub(super) const EXAMPLES: &str = "\
Examples:
  umbrage render oak.glb -o oak.png
  umbrage render oak.glb -o sheet.png --compare standard,textured --size 640x640
  umbrage render oak.glb ash.glb pine.glb -o trees.jpg --compare standard,textured
  umbrage render oak.glb -o oak.png --camera 40,12 --sun -60,30 --normals vertex
  umbrage render Tree_3.obj -o tree.png --texture Tree_Bark=bark.jpg
  umbrage render wood.toml -o wood.png --timings
  umbrage render oak.glb -o oak.png --lighting leaf --light oak.light
  umbrage render oak.glb -o sheet.png --lighting prt,leaf,truth --light oak.light --difference
  umbrage render oak.glb -o lamp.png --lighting lvc --lamp disc:0,4,3/0,-0.6,-0.8/0.2/60,50,40
  umbrage render oak.glb -o oak.png --style silhouette-hatching
  umbrage render oak.glb -o frame-%04d.png --style full --camera-path orbit:turns=1,frames=96
  umbrage render oak.glb -o oak.svg --style ds00-fig3a --paper a3
  umbrage render oak.svg -o again.svg                     draws it again
  umbrage render oak.svg -o plot.svg --profile plotter    the same with other options";
}

/// Arguments of `bake`.
#[derive(Debug, Clone, Args)]
pub struct BakeArgs {
    /// What is baked.
    #[command(flatten)]
    pub input: InputArgs,
    /// Model to write (GLB); for a scene, the folder of one GLB per plant
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Also write the ambient coefficient into a channel of the vertex colours: a, since viewers
    /// multiply the colour of the leaves by r, g and b
    #[arg(long, value_name = "CHANNEL")]
    pub ambient_channel: Option<ColorChannel>,
    /// Also write the ambient coefficient as an occlusion texture
    #[arg(long)]
    pub occlusion_texture: bool,
    /// Settings of the foliage.
    #[command(flatten)]
    pub settings: Chosen<ExportTable>,
}

/// A channel of `COLOR_0`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ColorChannel {
    /// Red.
    R,
    /// Green.
    G,
    /// Blue.
    B,
    /// Alpha.
    A,
}

impl BakeArgs {
    pub(super) const EXAMPLES: &str = "\
Examples:
  umbrage bake oak.glb -o oak.baked.glb
  umbrage bake oak.glb -o oak.baked.glb --normals vertex --cells 64 --ambient-channel a
  umbrage bake beech.glb -o beech.baked.glb --foliage crown
  umbrage bake grow:lime -o lime.glb --back-faces duplicate
  umbrage bake wood.toml -o baked/        one field over all plants, one file per plant";
}

/// Arguments of `surface`.
#[derive(Debug, Clone, Args)]
pub struct SurfaceArgs {
    /// Whose surface.
    #[command(flatten)]
    pub input: InputArgs,
    /// Mesh to write (GLB)
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Settings of the foliage.
    #[command(flatten)]
    pub settings: Chosen<FoliageTable>,
}

impl SurfaceArgs {
    pub(super) const EXAMPLES: &str = "\
Examples:
  umbrage surface oak.glb -o shell.glb
  umbrage surface oak.glb -o shell.glb --cells 48 --rho 0.15 --surface-error 0.5";
}

/// Arguments of `grow`.
#[derive(Debug, Clone, Args)]
pub struct GrowArgs {
    /// Which plant; without it the species are listed
    pub species: Option<String>,
    /// Same seed, same plant
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Number of leaves (their size follows, so that the leaf area stays); 0 grows a bare plant
    /// [default: the species']
    #[arg(long)]
    pub leaves: Option<u32>,
    /// Fineness of the wood's mesh, 0.25 to 4
    #[arg(long, default_value_t = 1.0)]
    pub detail: f32,
    /// Model to write (GLB)
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

impl GrowArgs {
    pub(super) const EXAMPLES: &str = "\
Examples:
  umbrage grow                                         list the species
  umbrage grow lime -o lime.glb
  umbrage grow broadleaf --seed 7 --leaves 200000 -o big.glb";
}

/// Arguments of `info`.
#[derive(Debug, Clone, Args)]
pub struct InfoArgs {
    /// Model or scene; without it the Vulkan devices are listed
    #[arg(value_name = "MODEL|SCENE")]
    pub input: Option<Source>,
    /// Options of models.
    #[command(flatten)]
    pub model: ModelArgs,
    /// Views the plan is for
    #[arg(
        long,
        value_name = "VIEW,VIEW,..",
        value_delimiter = ',',
        default_value = "textured"
    )]
    pub view: Vec<View>,
    /// Style or mix whose drawing the plan is for, instead of views
    #[arg(long, value_name = "STYLE|FILE", conflicts_with = "view")]
    pub style: Option<String>,
    /// Pixels drawn for one of a drawing, along each axis, 1 to 4
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=4))]
    pub ink_supersample: u32,
    /// Settings of the picture.
    #[command(flatten)]
    pub picture: Chosen<PictureTable>,
    /// Settings of the foliage.
    #[command(flatten)]
    pub settings: Chosen<FoliageTable>,
}

impl InfoArgs {
    pub(super) const EXAMPLES: &str = "\
Examples:
  umbrage info
  umbrage info oak.glb
  umbrage info oak.glb --view ambient,normals --size 1920x1080 --json
  umbrage info oak.glb --style mixed";
}

/// Arguments of `bench`.
#[derive(Debug, Clone, Args)]
pub struct BenchArgs {
    /// What is timed
    pub what: BenchWhat,
    /// On which model.
    #[command(flatten)]
    pub input: DefaultInputArgs,
    /// Runs that count
    #[arg(long, short = 'n', default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..))]
    pub runs: u32,
    /// Runs before them that do not count
    #[arg(long, default_value_t = 2)]
    pub warm_up: u32,
    /// View of `bench render`
    #[arg(long, default_value = "textured")]
    pub view: View,
    /// Styles of `bench ink`, the style of `bench coherence`, styles of `bench paper` (its default
    /// is ds00-fig6a)
    #[arg(
        long,
        value_name = "STYLE|FILE,..",
        value_delimiter = ',',
        default_value = "silhouette-hatching"
    )]
    pub style: Vec<String>,
    /// Settings of the picture.
    #[command(flatten)]
    pub picture: Chosen<PictureTable>,
    /// Settings of the foliage.
    #[command(flatten)]
    pub settings: Chosen<FoliageTable>,
}

/// What `bench` times.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum BenchWhat {
    /// The foliage bake.
    Bake,
    /// One frame.
    Render,
    /// Precomputing and drawing the light of leaves.
    Light,
    /// Rays from the leaves into all directions.
    Rays,
    /// Frames in pen and ink beside the photo-like picture.
    Ink,
    /// Stages of drawings on paper, as bitmaps and as vectors.
    Paper,
    /// How hatching stays on what moves and keeps its look on the screen.
    Coherence,
}

impl BenchArgs {
    pub(super) const EXAMPLES: &str = "\
Examples:
  umbrage bench bake oak.glb
  umbrage bench bake oak.glb --normals vertex --cells 96 --json
  umbrage bench render oak.glb --size 800x600 -n 20
  umbrage bench light oak.glb --size 800x600
  umbrage bench rays oak.glb
  umbrage bench ink oak.glb --style outline,silhouette-hatching
  umbrage bench paper oak.glb --style ds00-fig3a,ds00-fig6f
  umbrage bench coherence oak.glb --size 480x360";
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
    pub(super) const EXAMPLES: &str = "\
Examples:
  umbrage conform
  umbrage conform foliage.density
  umbrage --device swiftshader conform --json";
}

/// Arguments of `settings`.
#[derive(Debug, Clone, Default, Args)]
pub struct SettingsArgs {
    /// Only settings whose name contains this
    pub filter: Option<String>,
}

impl SettingsArgs {
    pub(super) const EXAMPLES: &str = "\
Examples:
  umbrage settings
  umbrage settings shadow --json";
}
