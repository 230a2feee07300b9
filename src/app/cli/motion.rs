//! Arguments of animations.

use clap::{Args, ValueEnum};

use crate::ink::motion::HatchMode;

/// How `render` draws many frames.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Animation")]
pub struct MotionArgs {
    /// Draws a frame for each place of the camera on a way: orbit, dolly or walk, with parameters
    /// as orbit:turns=2,frames=48, or a file (.toml, .json); the output's name has %04d in it
    #[arg(long, value_name = "WAY|FILE", conflicts_with_all = ["compare", "lighting"])]
    pub camera_path: Option<String>,
    /// Which frames, first and last; the first of a way is 0 [default: all]
    #[arg(long, value_name = "A..B", requires = "camera_path")]
    pub frames: Option<FrameRange>,
    /// Frames a second of keys that are given by time [default: the file's, or 24]
    #[arg(long, value_name = "N", requires = "camera_path")]
    pub fps: Option<f64>,
    /// How hatching follows the camera: replay (a frame alone is that of the sequence), accumulate
    /// (from the first frame that is drawn) or stateless (from each view; slips off level ways)
    #[arg(
        long,
        value_name = "MODE",
        default_value = "replay",
        requires = "camera_path"
    )]
    pub hatch_mode: HatchModeArg,
}

/// [`HatchMode`] on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum HatchModeArg {
    /// Sum over the frames that are drawn.
    Accumulate,
    /// Sum in fixed steps from frame 0.
    #[default]
    Replay,
    /// From each view alone.
    Stateless,
}

impl From<HatchModeArg> for HatchMode {
    fn from(mode: HatchModeArg) -> Self {
        match mode {
            HatchModeArg::Accumulate => Self::Accumulate,
            HatchModeArg::Replay => Self::Replay,
            HatchModeArg::Stateless => Self::Stateless,
        }
    }
}

/// First and last frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameRange {
    /// First.
    pub first: u32,
    /// Last.
    pub last: u32,
}

impl std::str::FromStr for FrameRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |t: &str| t.trim().parse::<u32>().ok();
        let (first, last) = match text.split_once("..") {
            Some((a, b)) => (number(a), number(b)),
            None => (number(text), number(text)),
        };
        match (first, last) {
            (Some(first), Some(last)) if first <= last => Ok(Self { first, last }),
            _ => Err("expected A..B, first and last frame, or one frame".into()),
        }
    }
}
