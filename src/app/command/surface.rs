//! `umbrage surface`: the implicit surface around the foliage as a mesh of its own.

use serde_json::json;

use crate::Result;
use crate::app::cli::SurfaceArgs;
use crate::app::output::{PendingFile, check_apart, check_ending};
use crate::app::prepared::Prepared;
use crate::app::timing::Timings;
use crate::app::{Context, Report, console};
use crate::foliage::Surface;
use crate::scene::export::{self, SurfaceMesh};

/// Extracts the surface and writes it.
///
/// # Errors
/// Wrong input or settings, an empty surface, an unwritable output, a failing device.
pub fn run(context: &Context, args: &SurfaceArgs) -> Result<Report> {
    let model = &args.input.model;
    check_ending(&args.output, &["glb"])?;
    check_apart(&args.output, args.input.input.files(&model.textures))?;
    let output = PendingFile::create(&args.output)?;
    let mut timings = Timings::default();
    let prepared = Prepared::new(&args.input.input, model, &args.settings, &mut timings)?;
    let split = timings.measure("split", || prepared.split())?;
    let gpu = context.gpu()?;
    let working = console::working("finding the surface");
    let (geometry, settings) = (&prepared.geometry, &prepared.settings);
    let found = timings.measure("surface", || {
        Surface::compute(gpu, geometry, &split, settings, &mut |label, _| {
            working.step(label);
        })
    })?;
    timings.add_passes(&found.times);
    let surface = &found.surface;
    let bytes = timings.measure("export", || {
        export::surface(&SurfaceMesh {
            name: "surface",
            origin: geometry.origin,
            positions: &surface.positions,
            normals: &surface.normals,
            indices: &surface.indices,
        })
    })?;
    output.commit(&bytes)?;
    drop(working);
    let (vertices, triangles) = (surface.positions.len(), surface.indices.len() / 3);
    let path = args.output.display();
    let mut text = format!("{path}: {vertices} vertices, {triangles} triangles\n");
    if context.timings() {
        text += &format!("\n{}", timings.table());
    }
    let json = json!({
        "output": args.output, "vertices": vertices, "triangles": triangles,
        "generators": found.stats.generators, "tau": found.stats.tau,
        "diagonal_m": found.stats.diagonal, "bytes": bytes.len(), "times": timings.json(),
    });
    Ok(Report::new(text, json))
}
