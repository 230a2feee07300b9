//! `umbrage leaf fit`: images to a leaf.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::json;

use super::edit::tissue;
use super::{map_format, write};
use crate::app::cli::leaf::{EncodingName, FitArgs};
use crate::app::output::{PendingFile, check_apart, check_ending};
use crate::app::report::Table;
use crate::app::{Report, console};
use crate::leaf::Face;
use crate::leaf::fit::{self, FitInput, FitOptions, Fitted, PaperFailure, SideImages};
use crate::scene::float_image::{FloatImage, Transfer};
use crate::scene::textures::encode_png;
use crate::{Error, Result};

pub(super) fn run(args: &FitArgs) -> Result<Report> {
    check_ending(&args.output, &["toml"])?;
    if let Some(residuals) = &args.residuals {
        check_ending(residuals, &["png"])?;
        check_apart(residuals, images(args))?;
    }
    // A wrong output is told before the work; the fit's own files follow at the end.
    drop(PendingFile::create(&args.output)?);
    let residuals = args
        .residuals
        .as_deref()
        .map(PendingFile::create)
        .transpose()?;
    let working = console::working("reading images");
    let input = read(args)?;
    let options = FitOptions {
        mode: args.mode,
        surface: args.surface,
        ..FitOptions::default()
    };
    let start = std::time::Instant::now();
    let last = std::sync::atomic::AtomicU64::new(0);
    let fitted = fit::fit(&input, &options, &|done, all| {
        let percent = (100 * done / all.max(1)) as u64;
        if last.swap(percent, std::sync::atomic::Ordering::Relaxed) != percent {
            let seconds = start.elapsed().as_secs_f64();
            let rate = done as f64 / seconds.max(1e-9);
            let rest = (all - done) as f64 / rate.max(1e-9);
            working.step(&format!(
                "fitting {percent} %, {rate:.0} texels/s, {rest:.0} s to go"
            ));
        }
    })?;
    let seconds = start.elapsed().as_secs_f64();
    let files = write(&fitted.material, &args.output, map_format(args.maps))?;
    if let Some(file) = residuals {
        file.commit(&residual_picture(&fitted, input.size)?)?;
    }
    drop(working);
    Ok(report(args, &fitted, &files, seconds))
}

/// Every image that is read.
fn images(args: &FitArgs) -> impl Iterator<Item = &Path> {
    let maybe = [
        &args.reflectance_lower,
        &args.mask,
        &args.specular_upper,
        &args.specular_lower,
        &args.roughness_upper,
        &args.roughness_lower,
    ];
    let always = [&args.reflectance_upper, &args.transmittance];
    let given = maybe.into_iter().filter_map(Option::as_ref);
    always.into_iter().chain(given).map(PathBuf::as_path)
}

fn read(args: &FitArgs) -> Result<FitInput> {
    let colour = match args.encoding {
        EncodingName::Srgb => Transfer::Srgb,
        EncodingName::Linear => Transfer::Linear,
    };
    let reflectance = image(&args.reflectance_upper, colour)?;
    let size = [reflectance.width, reflectance.height];
    let same = |path: &Path, image: FloatImage| {
        if [image.width, image.height] == size {
            return Ok(image);
        }
        Err(Error::file(
            path,
            format!(
                "is {}x{}; {} is {}x{}",
                image.width,
                image.height,
                args.reflectance_upper.display(),
                size[0],
                size[1]
            ),
        ))
    };
    let sized = |path: &PathBuf, transfer| same(path, image(path, transfer)?);
    let rgb = |image: FloatImage| -> Vec<[f32; 3]> {
        image.pixels.iter().map(|p| [p[0], p[1], p[2]]).collect()
    };
    let red = |image: FloatImage| -> Vec<f32> { image.pixels.iter().map(|p| p[0]).collect() };
    let colours = |path: &Option<PathBuf>| -> Result<Vec<[f32; 3]>> {
        path.as_ref()
            .map_or(Ok(Vec::new()), |p| sized(p, colour).map(rgb))
    };
    let numbers = |path: &Option<PathBuf>| -> Result<Vec<f32>> {
        path.as_ref()
            .map_or(Ok(Vec::new()), |p| sized(p, Transfer::Linear).map(red))
    };
    let mask = match &args.mask {
        Some(path) => red(sized(path, Transfer::Linear)?),
        None => alpha(&args.reflectance_upper, &reflectance)?,
    };
    Ok(FitInput {
        name: args
            .output
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned(),
        size,
        thickness_mm: args.thickness,
        mask: mask.iter().map(|m| m.clamp(0.0, 1.0)).collect(),
        transmittance: rgb(sized(&args.transmittance, colour)?),
        upper: SideImages {
            reflectance: rgb(reflectance),
            specular: colours(&args.specular_upper)?,
            roughness: numbers(&args.roughness_upper)?,
        },
        lower: SideImages {
            reflectance: colours(&args.reflectance_lower)?,
            specular: colours(&args.specular_lower)?,
            roughness: numbers(&args.roughness_lower)?,
        },
    })
}

/// The alpha of an image as the leaf mask, if it says anything.
fn alpha(path: &Path, image: &FloatImage) -> Result<Vec<f32>> {
    let mask: Vec<f32> = image.pixels.iter().map(|p| p[3]).collect();
    if mask.iter().all(|a| *a >= 1.0) {
        return Err(Error::file(
            path,
            "has no alpha to be the leaf mask, and --mask is missing",
        ));
    }
    Ok(mask)
}

fn image(path: &Path, transfer: Transfer) -> Result<FloatImage> {
    let bytes = fs::read(path).map_err(|e| Error::file(path, e))?;
    FloatImage::decode(&path.to_string_lossy(), &bytes, transfer)
}

/// Both sides' residuals beside each other, times 4 around mid-grey.
fn residual_picture(fitted: &Fitted, [w, h]: [u32; 2]) -> Result<Vec<u8>> {
    let mut pixels = Vec::with_capacity(8 * w as usize * h as usize);
    for y in 0..h as usize {
        for face in Face::ALL {
            let row = &fitted.residual(face).transmittance[y * w as usize..][..w as usize];
            for error in row {
                let level = |e: f32| ((0.5 + 4.0 * e).clamp(0.0, 1.0) * 255.0).round() as u8;
                pixels.extend(error.map(level));
                pixels.push(255);
            }
        }
    }
    encode_png(2 * w, h, &pixels)
}

fn report(args: &FitArgs, fitted: &Fitted, files: &[String], seconds: f64) -> Report {
    let leaf = &fitted.material;
    let mut table = Table::new(&["side", "omega", "Delta", "clamped", "limited", "RMS of T"]);
    let three = |v: [f64; 3], digits: usize| v.map(|x| format!("{x:.digits$}")).join(" ");
    let mut sides = Vec::new();
    for face in Face::ALL {
        let side = leaf.side(face);
        let residual = fitted.residual(face);
        table.row(&[
            &face.name(),
            &three([0, 1, 2].map(|c| side.omega(c)), 4),
            &three([0, 1, 2].map(|c| side.sigma_t(c) * leaf.thickness_mm), 3),
            &residual.clamped,
            &residual.limited,
            &three(residual.rms, 4),
        ]);
        sides.push(json!({
            "side": face.name(), "clamped": residual.clamped, "limited": residual.limited,
            "without_thickness": residual.without_thickness,
            "iteration_failures": residual.iteration_failures, "rms_transmittance": residual.rms,
        }));
    }
    let mut text = format!(
        "{}: {} texels of leaf, {seconds:.1} s\n{table}",
        args.output.display(),
        fitted.texels
    );
    for face in Face::ALL {
        let [above, none, slow] = fitted.residual(face).iteration_failures;
        if above + none + slow > 0 {
            text += &format!(
                "{}: the paper's iteration failed for {} of {} colours: {above} {}, {none} {}, \
                 {slow} {}\n",
                face.name(),
                above + none + slow,
                3 * fitted.texels,
                PaperFailure::AlbedoAboveOne,
                PaperFailure::NoThickness,
                PaperFailure::Slow,
            );
        }
        let lost = fitted.residual(face).without_thickness;
        if lost > 0 {
            text += &format!(
                "{}: the paper's closed form has no thickness for {lost} texels\n",
                face.name()
            );
        }
    }
    let json = json!({
        "output": args.output, "files": files, "texels": fitted.texels, "seconds": seconds,
        "sides": sides, "tissue": tissue(leaf),
    });
    Report::new(text, json)
}
