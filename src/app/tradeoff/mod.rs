//! `umbrage tradeoff`: what each approximation of the foliage bake costs and how far it is from the
//! truth, measured on real models.

pub mod document;
pub mod sweep;
mod sweep_normals;
pub mod truth;

use std::path::PathBuf;

use clap::Args;

use self::sweep::{Record, Sweep};
use self::truth::Truth;
use super::output::PendingFile;
use super::{Context, Report};
use crate::Result;
use crate::foliage::Split;
use crate::gpu::Gpu;
use crate::scene::{Geometry, import};

/// Arguments of `tradeoff`.
#[derive(Debug, Clone, Args)]
pub struct TradeoffArgs {
    /// Models to measure (glTF, GLB, OBJ)
    #[arg(required = true, value_name = "MODEL")]
    pub models: Vec<PathBuf>,
    /// Write the tables as Markdown
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Foliage vertices that are compared with ray-traced truth
    #[arg(long, default_value_t = 1500, value_name = "COUNT",
          value_parser = clap::value_parser!(u32).range(16..))]
    pub sample: u32,
    /// Which materials or nodes are foliage, as a regular expression
    #[arg(long, value_name = "REGEX")]
    pub foliage: Option<String>,
}

impl TradeoffArgs {
    /// Shown below the help.
    pub const EXAMPLES: &str = "\
Examples:
  umbrage tradeoff oak.glb ash.glb -o measures.md
  umbrage tradeoff oak.glb --json > measures.json";
}

/// Measures every approximation on every model.
///
/// # Errors
/// A model cannot be read or has no foliage, a bake fails, the output cannot be written.
pub fn run(context: &Context, args: &TradeoffArgs) -> Result<Report> {
    let output = args
        .output
        .as_deref()
        .map(PendingFile::create)
        .transpose()?;
    let gpu = context.gpu()?;
    let mut records = Vec::new();
    for path in &args.models {
        records.extend(measure(gpu, path, args)?);
    }
    let info = gpu.info();
    let device = format!("{} ({})", info.name, info.driver_info);
    let text = document::markdown(&records, &device, &command(args));
    if let Some(file) = output {
        file.commit(text.as_bytes())?;
    }
    let json = serde_json::json!({ "device": device, "records": records });
    Ok(Report::new(text, json))
}

fn measure(gpu: &Gpu, path: &PathBuf, args: &TradeoffArgs) -> Result<Vec<Record>> {
    let model = import::load(path, &import::LoadOptions::default())?;
    let geometry = Geometry::flatten(&model);
    let split = Split::new(&model, &geometry, args.foliage.as_deref())?;
    let truth = Truth::trace(&model, &geometry, &split, args.sample as usize)?;
    Sweep::new(gpu, &model, &geometry, &split, &truth).run()
}

/// The command line that makes the document, with file names only.
fn command(args: &TradeoffArgs) -> String {
    let names = args.models.iter().map(|p| {
        let name = p.file_name().unwrap_or(p.as_os_str());
        format!(" {}", name.to_string_lossy())
    });
    format!("umbrage tradeoff{}", names.collect::<String>())
}
