//! `umbrage bake`: the model again, with realigned normals and ambient coefficients.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use crate::app::cli::commands::{BakeArgs, ColorChannel};
use crate::app::output::{PendingFile, check_apart, check_ending};
use crate::app::prepared::Prepared;
use crate::app::timing::Timings;
use crate::app::{Context, Report, console};
use crate::foliage::{self, bake::Bake};
use crate::scene::export::{self, BackFaces, BakedPart, Channel, ExportOptions};
use crate::scene::geometry::counted;
use crate::scene::{Geometry, Model, SceneFile};
use crate::{Error, Result};

/// Endings of files that hold one model.
const MODELS: &[&str] = &["glb", "gltf", "obj"];

/// Bakes a model into a file, or the plants of a scene into a folder.
///
/// # Errors
/// Wrong input or settings, an unwritable output, a failing device.
pub fn run(context: &Context, args: &BakeArgs) -> Result<Report> {
    let mut timings = Timings::default();
    // An unwritable file is told before the work; a scene's files are known after reading it.
    let one_file = if args.input.input.is_model() {
        check_ending(&args.output, &["glb"])?;
        check_apart(
            &args.output,
            args.input.input.files(&args.input.model.textures),
        )?;
        Some(PendingFile::create(&args.output)?)
    } else if !args.output.is_dir() && check_ending(&args.output, MODELS).is_ok() {
        let reason = "output: is named like one model, and a scene is baked into a folder";
        return Err(Error::file(&args.output, reason));
    } else if args.output.exists() && !args.output.is_dir() {
        let reason = "output: is a file, and a scene is baked into a folder";
        return Err(Error::file(&args.output, reason));
    } else {
        None
    };
    let model = &args.input.model;
    let prepared = Prepared::new(&args.input.input, model, &args.settings, &mut timings)?;
    let files = match one_file {
        Some(file) => vec![file],
        None => files_of_plants(&prepared, &args.output)?,
    };
    let baked = prepared.bake(context, &mut timings)?;
    let options = export_options(args, &prepared.settings);
    let working = console::working("writing");
    let contents = timings.measure("export", || export(&prepared, &baked.bake, &options))?;
    let mut outputs = Vec::new();
    for (file, bytes) in files.into_iter().zip(contents) {
        outputs.push((file.path().to_owned(), bytes.len()));
        file.commit(&bytes)?;
    }
    drop(working);
    Ok(report(context, &outputs, &baked.bake, &timings))
}

/// Reserves `FOLDER/NAME.glb` for every plant of the scene.
fn files_of_plants(prepared: &Prepared, folder: &Path) -> Result<Vec<PendingFile>> {
    std::fs::create_dir_all(folder).map_err(|e| {
        Error::file(
            folder,
            format!("output: a scene is baked into a folder: {e}"),
        )
    })?;
    let scene = prepared.input.scene.iter();
    let inputs: Vec<&Path> = scene.flat_map(SceneFile::files).collect();
    let plants = prepared.input.plants.iter();
    plants
        .map(|plant| {
            let path = folder.join(format!("{}.glb", plant.name));
            check_apart(&path, inputs.iter().copied())?;
            PendingFile::create(&path)
        })
        .collect()
}

fn export_options(args: &BakeArgs, settings: &foliage::Settings) -> ExportOptions {
    ExportOptions {
        ambient_attribute: settings.ambient != foliage::AmbientMode::None,
        color_channel: args.ambient_channel.map(|channel| match channel {
            ColorChannel::R => Channel::R,
            ColorChannel::G => Channel::G,
            ColorChannel::B => Channel::B,
            ColorChannel::A => Channel::A,
        }),
        occlusion_texture: args.occlusion_texture,
        back_faces: match settings.back_faces {
            foliage::BackFaces::Unflipped => BackFaces::Unflipped,
            foliage::BackFaces::Flipped => BackFaces::Flipped,
            foliage::BackFaces::Duplicate => BackFaces::Duplicate,
        },
    }
}

/// The contents of every output, in order.
fn export(prepared: &Prepared, bake: &Bake, options: &ExportOptions) -> Result<Vec<Vec<u8>>> {
    let split = |geometry: &Geometry| {
        BakedPart::split(geometry, &bake.normals, &bake.ambient, &bake.foliage_parts)
    };
    let parts = split(&prepared.geometry);
    if prepared.input.plants.is_empty() {
        return Ok(vec![export::gltf(&prepared.input.model, &parts, options)?]);
    }
    let plants = prepared.input.plants.iter();
    plants
        .map(|plant| {
            let own = parts
                .iter()
                .filter(|part| plant.instances.contains(&part.instance));
            // Back from the scene's frame to the plant's: its file stands where it stood.
            let to_plant = plant.to_scene.matrix3.inverse();
            let own: Vec<BakedPart> = own
                .cloned()
                .map(|mut part| {
                    part.instance -= plant.instances.start;
                    for normal in part.normals.iter_mut().flatten() {
                        *normal = (to_plant * normal.as_dvec3()).normalize().as_vec3();
                    }
                    part
                })
                .collect();
            let model: &Model = &plant.model;
            export::gltf(model, &own, options)
        })
        .collect()
}

fn report(
    context: &Context,
    outputs: &[(PathBuf, usize)],
    bake: &Bake,
    timings: &Timings,
) -> Report {
    let s = &bake.stats;
    let mut text: String = outputs
        .iter()
        .map(|(path, bytes)| {
            format!(
                "{}: {}\n",
                path.display(),
                crate::render::plan::human_bytes(*bytes as u64)
            )
        })
        .collect();
    text += &format!(
        "{}, {} covered, {}\n",
        counted(s.foliage_vertices, "foliage vertex", "foliage vertices"),
        s.covered_vertices,
        counted(s.generators, "generator", "generators")
    );
    if context.timings() {
        text += &format!("\n{}", timings.table());
    }
    let files: Value = outputs
        .iter()
        .map(|(path, bytes)| json!({ "file": path, "bytes": bytes }))
        .collect();
    let json = json!({
        "outputs": files, "foliage_vertices": s.foliage_vertices,
        "covered_vertices": s.covered_vertices, "generators": s.generators,
        "diagonal_m": s.diagonal, "tau": s.tau, "d_min": s.d_min,
        "kept_normals": s.kept_normals, "unsettled_normals": s.unsettled_normals, "times": timings.json(),
    });
    Report::new(text, json)
}
