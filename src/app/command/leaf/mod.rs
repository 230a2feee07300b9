//! `umbrage leaf`: the appearance of leaves.

mod card;
mod edit;
mod fit;
mod show;
mod slab;
mod species;

use std::path::Path;

use crate::app::cli::leaf::{LeafArgs, LeafInput, LeafPart, MapsName};
use crate::app::input::{Input, Source};
use crate::app::output::PendingFile;
use crate::app::{Context, Report};
use crate::leaf::files::{self, MapFormat};
use crate::leaf::species::{DRAWN_SIZE, LeafSpecies};
use crate::leaf::{LeafMaterial, import};
use crate::{Error, Result};

/// Runs one part.
///
/// # Errors
/// Wrong input, an unwritable output.
pub fn run(_context: &Context, args: &LeafArgs) -> Result<Report> {
    match &args.part {
        LeafPart::Species => Ok(species::run()),
        LeafPart::Slab(args) => slab::run(args),
        LeafPart::Show(args) => show::run(args),
        LeafPart::Edit(args) => edit::run(args),
        LeafPart::Fit(args) => fit::run(args),
    }
}

/// The leaf that was named.
fn load(input: &LeafInput) -> Result<LeafMaterial> {
    let path = Path::new(&input.leaf);
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    let is_model = ["glb", "gltf", "obj"].iter().any(|e| ending == *e);
    if !is_model && !input.leaf.starts_with("grow:") {
        if input.material.is_some() {
            return Err(Error::usage(format!(
                "--material names a material of a model; {:?} is none",
                input.leaf
            )));
        }
        return if ending == "toml" {
            files::read(path)
        } else {
            Ok(LeafSpecies::parse(&input.leaf)?.drawn(DRAWN_SIZE))
        };
    }
    let source: Source = input.leaf.parse()?;
    let model = Input::load(&source, &[])?.model;
    let names = || {
        let names: Vec<&str> = model.materials.iter().map(|m| m.name.as_str()).collect();
        names.join(", ")
    };
    let Some(wanted) = &input.material else {
        return Err(Error::usage(format!(
            "{}: --material is missing; there are {}",
            input.leaf,
            names()
        )));
    };
    let material = model.materials.iter().find(|m| &m.name == wanted);
    let material = material.ok_or_else(|| {
        Error::file(
            &input.leaf,
            format!("has no material {wanted:?}; there are {}", names()),
        )
    })?;
    import::leaf_of_material(&model, material)
}

fn map_format(name: MapsName) -> MapFormat {
    match name {
        MapsName::Png => MapFormat::Png,
        MapsName::Exr => MapFormat::Exr,
    }
}

/// Writes a leaf file and its maps: all reserved first, the file that names the others last.
/// Returns the names.
fn write(leaf: &LeafMaterial, path: &Path, format: MapFormat) -> Result<Vec<String>> {
    let stem = path
        .file_stem()
        .filter(|_| {
            path.extension()
                .is_some_and(|e| e.eq_ignore_ascii_case("toml"))
        })
        .ok_or_else(|| Error::file(path, "output: a leaf file ends in .toml"))?
        .to_string_lossy();
    let beyond = files::beyond_png(leaf);
    if format == MapFormat::Png && beyond > 0 {
        log::warn!(
            "{beyond} texels have a gamma above {0} or are thicker than {0} times the mean, which \
             PNG cuts off; --maps exr keeps them",
            files::PNG_RANGE
        );
    }
    let encoded = files::encode(leaf, &stem, format)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut pending = Vec::new();
    for (name, bytes) in encoded {
        // The leaf's own file keeps the name it was given.
        let target = if name == format!("{stem}.toml") {
            path.to_owned()
        } else {
            folder.join(&name)
        };
        pending.push((PendingFile::create(&target)?, bytes, name));
    }
    let mut names = Vec::new();
    for (file, bytes, name) in pending {
        file.commit(&bytes)?;
        names.push(name);
    }
    Ok(names)
}
