//! `umbrage grow`: a plant of the generator as a model file.

use serde_json::json;

use crate::app::cli::GrowArgs;
use crate::app::output::{PendingFile, check_ending};
use crate::app::report::Table;
use crate::app::{Context, Report, console};
use crate::scene::Geometry;
use crate::scene::export::{self, ExportOptions};
use crate::scene::grow::{self, GrowOptions, Species};
use crate::{Error, Result};

/// Grows a plant, or lists the species.
///
/// # Errors
/// An unknown species, options outside their range, an unwritable output.
pub fn run(_context: &Context, args: &GrowArgs) -> Result<Report> {
    let Some(species) = &args.species else {
        return Ok(list());
    };
    let body = species.eq_ignore_ascii_case(grow::RABBIT);
    let species = if body {
        None
    } else {
        Some(Species::parse(species)?)
    };
    let name = species.map_or(grow::RABBIT, Species::name);
    let path = args.output.as_deref().ok_or_else(|| {
        Error::usage("grow: --output FILE is missing: where shall the plant be written?")
    })?;
    let options = GrowOptions {
        seed: args.seed,
        leaves: args.leaves,
        detail: args.detail,
    };
    check_ending(path, &["glb"])?;
    let output = PendingFile::create(path)?;
    let working = console::working(format!("growing {name}"));
    let model = match species {
        Some(species) => grow::grow(species, &options)?,
        None => grow::rabbit(),
    };
    let geometry = Geometry::flatten(&model);
    let bytes = export::gltf(&model, &[], &ExportOptions::default())?;
    output.commit(&bytes)?;
    drop(working);
    let leaves: usize = model
        .meshes
        .iter()
        .flat_map(|m| &m.primitives)
        .filter_map(|p| p.botany.as_ref())
        .map(|b| b.leaves.len())
        .sum();
    let triangles = geometry.indices.len() / 3;
    let height = geometry.max.y - geometry.min.y;
    let text = format!(
        "{}: {} seed {}, {leaves} leaves, {triangles} triangles, {height:.2} m high\n",
        path.display(),
        name,
        args.seed
    );
    let json = json!({
        "output": path, "species": name, "seed": args.seed, "leaves": leaves,
        "triangles": triangles, "vertices": geometry.positions.len(), "height_m": height,
        "bytes": bytes.len(),
    });
    Ok(Report::new(text, json))
}

fn list() -> Report {
    let mut table = Table::new(&["species", "what"]);
    for species in Species::ALL {
        table.row(&[&species.name(), &species.description()]);
    }
    table.row(&[
        &grow::RABBIT,
        &"a sitting rabbit of 0.5 m without leaves, for smooth bodies; seed and leaves do not matter",
    ]);
    let names = Species::ALL.map(|s| json!({ "name": s.name(), "what": s.description() }));
    Report::new(table.to_string(), json!({ "species": names }))
}
