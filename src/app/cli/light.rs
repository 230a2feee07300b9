//! Arguments of `light`, and of pictures lit by it.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::commands::InputArgs;
use super::ranges::{channels, real, real32};
use crate::Result;
use crate::leaf::glossy::Shadowing;
use crate::leaf::optics::Optics;
use crate::leaf::{LeafMaterial, LeafSpecies, files};

/// Three numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triple(pub [f64; 3]);

impl std::str::FromStr for Triple {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let numbers: Option<Vec<f64>> = text
            .split(',')
            .map(|n| n.trim().parse().ok().filter(|v: &f64| v.is_finite()))
            .collect();
        match numbers.as_deref() {
            Some(&[v]) => Ok(Self([v; 3])),
            Some(&[a, b, c]) => Ok(Self([a, b, c])),
            _ => Err("expected three numbers or one".into()),
        }
    }
}

/// Which axis of the model points up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Up {
    /// +y, as in glTF.
    #[default]
    Y,
    /// +z.
    Z,
}

/// What leaves make of light, where the model does not say it.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Leaves")]
pub struct OpticsArgs {
    /// Axis of the model that points up
    #[arg(long, default_value = "y")]
    pub up: Up,
    /// The leaf: a measured species (`umbrage leaf species` lists them) or a leaf file (TOML)
    #[arg(long, value_name = "SPECIES|FILE")]
    pub leaf: Option<String>,
    /// Diffuse reflectance of the upper side, 0 to 1 per channel
    #[arg(long, value_name = "R,G,B", value_parser = channels(0.0, 1.0), allow_hyphen_values = true)]
    pub reflectance: Option<Triple>,
    /// Diffuse reflectance of the lower side [default: that of the upper side]
    #[arg(long, value_name = "R,G,B", value_parser = channels(0.0, 1.0), allow_hyphen_values = true)]
    pub reflectance_below: Option<Triple>,
    /// Diffuse transmittance, 0 to 1 per channel
    #[arg(long, value_name = "R,G,B", value_parser = channels(0.0, 1.0), allow_hyphen_values = true)]
    pub transmittance: Option<Triple>,
    /// Specular intensity `rho_s`, 0 to 1 per channel
    #[arg(long, value_name = "R,G,B", value_parser = channels(0.0, 1.0), allow_hyphen_values = true)]
    pub gloss: Option<Triple>,
    /// Roughness m of the specular term, 0.001 to 1
    #[arg(long, value_name = "M", value_parser = real(0.001, 1.0), allow_hyphen_values = true)]
    pub roughness: Option<f64>,
    /// Form of the specular term in pictures
    #[arg(long, default_value = "paper")]
    pub gloss_form: GlossForm,
}

impl OpticsArgs {
    /// The leaf that was named.
    ///
    /// # Errors
    /// No such species, or a wrong file.
    pub fn leaf(&self) -> Result<Option<LeafMaterial>> {
        let Some(name) = &self.leaf else {
            return Ok(None);
        };
        let path = std::path::Path::new(name);
        if path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("toml"))
        {
            return files::read(path).map(Some);
        }
        Ok(Some(LeafSpecies::parse(name)?.plain()))
    }

    /// Whether numbers are told that replace those of a leaf.
    #[must_use]
    pub fn told(&self) -> bool {
        let colours = [
            self.reflectance,
            self.reflectance_below,
            self.transmittance,
            self.gloss,
        ];
        colours.iter().any(Option::is_some) || self.roughness.is_some()
    }

    /// Replaces what was told.
    pub fn apply(&self, optics: &mut Optics) {
        let rgb = |t: Triple| t.0.map(|v| v as f32);
        if let Some(upper) = self.reflectance {
            optics.rho_d_front = rgb(upper);
            optics.rho_d_back = rgb(upper);
        }
        if let Some(lower) = self.reflectance_below {
            optics.rho_d_back = rgb(lower);
        }
        if let Some(through) = self.transmittance {
            optics.rho_t = rgb(through);
        }
        if let Some(gloss) = self.gloss {
            optics.rho_s = rgb(gloss);
        }
        if let Some(m) = self.roughness {
            optics.roughness = m as f32;
        }
        optics.shadowing = match self.gloss_form {
            GlossForm::Paper => Shadowing::Paper,
            GlossForm::Safe => Shadowing::Safe,
        };
    }
}

/// For which directions of the sun visibility is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SunDirections {
    /// The sun's way over a day.
    Day,
    /// A cube map over all directions (Wang et al. 2005 use 32 x 32 x 6).
    Cube,
    /// One direction.
    Sun,
    /// None.
    None,
}

/// What of transfer is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum TransferKind {
    /// Vectors of each side: exact for diffuse leaves, gloss counts as diffuse.
    #[default]
    Vector,
    /// Matrices of each vertex (Wang et al. 2005): any reflection, by the view.
    Matrix,
    /// Vectors without gloss, and matrices for it.
    Both,
}

impl TransferKind {
    /// Whether vectors are computed.
    #[must_use]
    pub fn vectors(self) -> bool {
        self != Self::Matrix
    }

    /// Whether matrices are computed.
    #[must_use]
    pub fn matrices(self) -> bool {
        self != Self::Vector
    }
}

/// Which transfer of a light file a picture takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum RenderTransfer {
    /// Vectors for what is diffuse and matrices for gloss, or what there is.
    #[default]
    Auto,
    /// Vectors.
    Vector,
    /// Matrices.
    Matrix,
}

/// Form of the specular term.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum GlossForm {
    /// That of Wang et al. 2005: gives back more than comes in at grazing angles.
    #[default]
    Paper,
    /// With Smith's masking and shadowing, which keep the energy.
    Safe,
}

/// How transfer matrices reflect the surroundings in gloss.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum SkyGloss {
    /// By the lobe, as the sun's gloss.
    #[default]
    Lobe,
    /// As diffuse reflection.
    Diffuse,
    /// Not at all.
    None,
}

/// Where the sun stands.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Sun")]
pub struct SunArgs {
    /// Unit-free vector to the sun, +y up [default: azimuth -28, elevation 50 degrees]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub sun_direction: Option<Triple>,
    /// Angular radius of the sun, degrees, 0 (a point) to 44
    #[arg(long, value_name = "DEGREES", default_value_t = crate::leaf::lvc::SUN_RADIUS_DEGREES, value_parser = real(0.0, 44.0), allow_hyphen_values = true)]
    pub sun_radius: f64,
}

/// Arguments of `light`.
#[derive(Debug, Clone, Args)]
pub struct LightArgs {
    /// What is lit.
    #[command(flatten)]
    pub input: InputArgs,
    /// Light file to write
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Paths of each side of each vertex, at most 16,777,216; 0 computes no transfer
    #[arg(long, default_value_t = 1024, value_parser = clap::value_parser!(u32).range(0..=1 << 24))]
    pub paths: u32,
    /// Bands of the transfer, 1 to 6; the square of it are coefficients
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=6))]
    pub order: u32,
    /// Vectors are exact for diffuse leaves and small; matrices also reflect the sky in gloss
    #[arg(long, default_value = "vector")]
    pub transfer: TransferKind,
    /// Colours of transfer matrices: mono (as small as the paper's) or rgb
    #[arg(long, default_value = "mono")]
    pub matrix_colours: String,
    /// Bounces of a path at most, 1 to 65,536
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=1 << 16))]
    pub bounces: u32,
    /// How transfer vectors and matrices are stored: f32, f16 or 8bit
    #[arg(long, default_value = "f16")]
    pub storage: String,
    /// Distance of the vertices that keep transfer vectors, in diagonals of the model, 0 to 1; 0:
    /// all do. Several, ascending, make levels of detail
    #[arg(
        long,
        value_name = "E,E,..",
        value_delimiter = ',',
        default_value = "0",
        value_parser = real32(0.0, 1.0),
        allow_hyphen_values = true
    )]
    pub lod: Vec<f32>,
    /// For which directions of the sun visibility is computed
    #[arg(long, default_value = "day")]
    pub directions: SunDirections,
    /// Texels along an edge of the cube, 1 to 256
    #[arg(long, default_value_t = 32, value_parser = clap::value_parser!(u32).range(1..=256))]
    pub cube_side: u32,
    /// Latitude of the day, degrees, -90 to 90
    #[arg(long, default_value_t = 50.0, value_parser = real(-90.0, 90.0), allow_hyphen_values = true)]
    pub latitude: f64,
    /// Day of the year, 1 to 366
    #[arg(long, default_value_t = 172, value_parser = clap::value_parser!(u32).range(1..=366))]
    pub day: u32,
    /// Minutes between two directions of the day, 0.01 to 720
    #[arg(long, default_value_t = 5.0, value_parser = real(0.01, 720.0), allow_hyphen_values = true)]
    pub minutes: f64,
    /// Times that every triangle is split into four for the sun's shadows, 0 to 4
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u32).range(0..=4))]
    pub splits: u32,
    /// Points of the sun's disc, 1 to 255
    #[arg(long, default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=255))]
    pub samples: u32,
    /// Try all points everywhere; otherwise the four outermost decide where the rest is tried
    #[arg(long)]
    pub exhaustive: bool,
    /// A ray starts so far from its surface, in diagonals of the model, 0 to 0.01
    #[arg(long, default_value_t = 1e-5, value_parser = real32(0.0, 0.01), allow_hyphen_values = true)]
    pub offset: f32,
    /// Same seed, same result
    #[arg(long, default_value_t = 1)]
    pub seed: u32,
    /// Largest light in memory, bytes; more is refused before the work
    #[arg(long, default_value_t = 2 << 30)]
    pub max_bytes: u64,
    /// Seconds between two savings of what is done so far, 0 to 86,400; Ctrl-C loses no more
    #[arg(long, value_name = "SECONDS", default_value_t = 20.0, value_parser = real(0.0, 86_400.0), allow_hyphen_values = true)]
    pub checkpoint: f64,
    /// Keeps the visibility maps of a light file of the same model: leaves of other optics need
    /// new transfer vectors only
    #[arg(long, value_name = "FILE")]
    pub keep: Option<PathBuf>,
    /// Go on from what an interrupted run left beside the output
    #[arg(long)]
    pub resume: bool,
    /// Where the sun stands.
    #[command(flatten)]
    pub sun: SunArgs,
    /// What leaves make of light.
    #[command(flatten)]
    pub optics: OpticsArgs,
}

impl LightArgs {
    pub(super) const EXAMPLES: &str = "\
Examples:
  umbrage light oak.glb -o oak.light
  umbrage light oak.glb -o oak.light --paths 4096 --storage 8bit
  umbrage light oak.glb -o oak.light --lod 0,0.02,0.05        three levels of detail
  umbrage light oak.glb -o oak.light --transfer both          the sky in glossy leaves
  umbrage light oak.glb -o oak.light --order 3 --paths 256   less of all: quicker, softer
  umbrage light oak.glb -o oak.light --directions cube        every direction of the sun
  umbrage light oak.glb -o oak.light --latitude 35 --day 80 --minutes 10
  umbrage light oak.glb -o oak.light --leaf birch --keep old.light
  umbrage light oak.glb -o oak.light --resume                 go on after Ctrl-C";
}

/// How leaves are lit in a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Lighting {
    /// Sky and light between leaves by transfer, the sun by visibility: two passes.
    Leaf,
    /// All by transfer.
    Prt,
    /// The sun alone, by visibility.
    Lvc,
    /// The sun with hard shadows and a constant for the rest.
    Ambient,
    /// The sun by a shadow map (--shadow-size, --shadow-radius) and a constant for the rest.
    Shadow,
    /// Sky and light between leaves by transfer, the sun by a shadow map.
    ShadowPrt,
    /// Path traced.
    Truth,
}

/// How `render` lights leaves.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Leaf light")]
pub struct LitArgs {
    /// Lights leaves instead of showing a view; several make a sheet and, with truth among them,
    /// a table of their errors
    #[arg(long, value_name = "LIGHTING,LIGHTING,..", value_delimiter = ',', conflicts_with_all = ["view", "compare"])]
    pub lighting: Vec<Lighting>,
    /// Light file of the model (umbrage light); for a scene one for each of its plants
    #[arg(long, value_name = "FILE")]
    pub light: Vec<PathBuf>,
    /// constant:R,G,B, linear:R,G,B/R,G,B (horizon, and what the zenith has more), clear:TURBIDITY,
    /// or a panorama (EXR, HDR)
    #[arg(
        long,
        value_name = "SKY",
        default_value = "linear:0.24,0.27,0.30/0.12,0.135,0.15"
    )]
    pub environment: String,
    /// Irradiance of the sun on a surface that faces it
    #[arg(
        long,
        value_name = "R,G,B",
        default_value = "3.0,2.85,2.55",
        value_parser = channels(0.0, 1e6),
        allow_hyphen_values = true
    )]
    pub sun_irradiance: Triple,
    /// An image of the sun in place of an even disc (the square about it): a partial eclipse
    #[arg(long, value_name = "FILE")]
    pub sun_shape: Option<PathBuf>,
    /// A lamp near the scene, several times for several: disc:X,Y,Z/NX,NY,NZ/RADIUS/R,G,B (place,
    /// direction of its face, metres, irradiance at one metre), quad:../WIDTHxHEIGHT/R,G,B or
    /// mask:../WIDTHxHEIGHT/R,G,B/FILE (the brighter the image, the more light); for example
    /// --lamp disc:0,3,1/0,-1,0/0.1/6,5,4
    #[arg(long, value_name = "LAMP", allow_hyphen_values = true)]
    pub lamp: Vec<String>,
    /// Points of each lamp that are looked for from every vertex, 1 to 4096
    #[arg(long, default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub lamp_samples: u32,
    /// Points of each lamp whose light a pixel's leaf scatters, 1 to 64; 1 is right for small lamps
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub lamp_points: u32,
    /// Leaves reflect more of oblique light and transmit less, as their slab does; otherwise they
    /// take light from everywhere as if it came straight down. For the sun, lamps and the truth
    #[arg(long)]
    pub directional: bool,
    /// Which transfer of the light file is used
    #[arg(long, default_value = "auto")]
    pub transfer: RenderTransfer,
    /// How transfer matrices reflect the surroundings in gloss
    #[arg(long, default_value = "lobe")]
    pub sky_gloss: SkyGloss,
    /// Rays of each drawn pixel of glossy leaves by which they mirror the sky and other leaves, 0 (such
    /// light counts as diffuse) to 4096; as many more find what was counted as diffuse. For
    /// leaf, prt and shadow-prt where matrices do not bring the gloss
    #[arg(long, value_name = "RAYS", default_value_t = 4, value_parser = clap::value_parser!(u32).range(0..=4096))]
    pub gloss_rays: u32,
    /// Bands of the transfer that are used at most, 1 to 6
    #[arg(long, default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=6))]
    pub order: u32,
    /// Pixels between the vertices of the level of detail that a leaf takes, 0 (always the finest)
    /// to 1000
    #[arg(long, value_name = "PIXELS", default_value_t = 4.0, value_parser = real(0.0, 1e3), allow_hyphen_values = true)]
    pub lod_pixels: f64,
    /// Strength of the window against ringing on the sun's indirect light, 0 (none) to 1
    #[arg(long, default_value_t = 0.002, value_parser = real(0.0, 1.0), allow_hyphen_values = true)]
    pub window: f64,
    /// Reads the nearest stored map instead of computing one for the sun's place
    #[arg(long)]
    pub stored: bool,
    /// Blends the stored maps about the sun's place
    #[arg(long)]
    pub blended: bool,
    /// Times that every triangle is split into four for the sun's shadows, 0 to 4 [default: as in
    /// the light file, or 2]
    #[arg(long, value_parser = clap::value_parser!(u32).range(0..=4))]
    pub splits: Option<u32>,
    /// Pixels drawn for one of the picture, along each axis, 1 to 8
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=8))]
    pub supersample: u32,
    /// Paths through every pixel of the truth, 1 to 65,536
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=1 << 16))]
    pub truth_samples: u32,
    /// Times that the frame is drawn, for the medians of `--timings`
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub repeat: u32,
    /// Factor on the light, 1e-9 to 1e9 [default: the brightest leaves are white]
    #[arg(long, value_parser = real32(1e-9, 1e9), allow_hyphen_values = true)]
    pub light_exposure: Option<f32>,
    /// Adds a row of differences: red where too bright, blue where too dark; to --reference, the truth
    /// or the last picture. At full colour they are this share, 1e-6 to 1e6, of
    /// the reference's mean
    #[arg(
        long,
        value_name = "SHARE",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "0.5",
        value_parser = real32(1e-6, 1e6)
    )]
    pub difference: Option<f32>,
    /// Compares with pictures of linear light, `PREFIX_full.exr` and `PREFIX_sun_direct.exr`
    #[arg(long, value_name = "PREFIX")]
    pub reference: Option<PathBuf>,
    /// Where the sun stands.
    #[command(flatten)]
    pub sun: SunArgs,
    /// What leaves make of light.
    #[command(flatten)]
    pub optics: OpticsArgs,
}
