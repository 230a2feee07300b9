//! The one table of settings: what command lines, scene files and sweeps know about them.

use super::settings::{
    AmbientMode, BackFaces, Encoding, Norm, NormalsMode, Primitive, Sampling, Settings,
    SurfaceNormals, Threshold,
};
use crate::{Error, Result};

/// One setting: how it is named, read, written and explained.
#[derive(Debug, Clone, Copy)]
pub struct SettingInfo {
    /// Name of the field; command lines write `-` for `_`.
    pub name: &'static str,
    /// Unit of the value; empty for names.
    pub unit: &'static str,
    /// Allowed values.
    pub range: &'static str,
    /// What it is.
    pub help: &'static str,
    /// What it trades for what.
    pub trades: &'static str,
    /// The value at which nothing is approximated, or that it changes the meaning, not the error.
    pub exact_end: &'static str,
    /// Text of the current value.
    pub get: fn(&Settings) -> String,
    /// Reads a value from text; the range is checked by [`Settings::set`].
    pub set: fn(&mut Settings, &str) -> Result<()>,
    /// Whether the current value is in the range.
    pub valid: fn(&Settings) -> bool,
}

impl SettingInfo {
    /// Text of the default value.
    #[must_use]
    pub fn default(&self) -> String {
        (self.get)(&Settings::default())
    }
}

/// The setting called `name`; `-` and `_` are the same.
///
/// # Errors
/// Lists the names.
pub fn find(name: &str) -> Result<&'static SettingInfo> {
    let wanted = name.replace('-', "_");
    SETTINGS.iter().find(|s| s.name == wanted).ok_or_else(|| {
        let names: Vec<&str> = SETTINGS.iter().map(|s| s.name).collect();
        Error::usage(format!(
            "{name:?} is no foliage setting; there are {}",
            names.join(", ")
        ))
    })
}

fn real<T: std::str::FromStr>(text: &str) -> Result<T> {
    text.parse()
        .map_err(|_| Error::usage(format!("{text:?} is not a number")))
}

fn whole(text: &str) -> Result<u32> {
    text.parse().map_err(|_| {
        Error::usage(format!(
            "{text:?} is not a whole number from 0 to {}",
            u32::MAX
        ))
    })
}

fn threshold(text: &str) -> Result<Threshold> {
    match text.strip_suffix('%') {
        Some(percent) => {
            let percent: f64 = real(percent.trim())?;
            Ok(Threshold::Quantile((percent / 100.0) as f32))
        }
        None => Ok(Threshold::Absolute(real(text)?)),
    }
}

fn threshold_valid(t: Threshold) -> bool {
    match t {
        Threshold::Quantile(q) => (0.0..=1.0).contains(&q),
        Threshold::Absolute(v) => v >= 0.0 && v.is_finite(),
    }
}

fn positive(v: f32) -> bool {
    v > 0.0 && v.is_finite()
}

/// A field that is read with `$read`, written with `Display`, and in range when `$ok`.
macro_rules! setting {
    ($field:ident, $unit:literal, $range:literal, $read:expr, $ok:expr,
     $help:literal, $trades:literal, $exact:literal) => {
        SettingInfo {
            name: stringify!($field),
            unit: $unit,
            range: $range,
            help: $help,
            trades: $trades,
            exact_end: $exact,
            get: |s| s.$field.to_string(),
            set: |s, text| {
                s.$field = $read(text)?;
                Ok(())
            },
            valid: |s| $ok(s.$field),
        }
    };
}

/// Every setting, in the order of the pipeline.
pub const SETTINGS: &[SettingInfo] = &[
    setting!(
        primitive,
        "",
        "auto, leaf, triangle",
        Primitive::parse,
        |_| true,
        "What makes one generator: a connected leaf, every triangle, or triangles of few large leaves",
        "triangle needs no connectivity but counts a card of two triangles twice",
        "changes the meaning, not the error"
    ),
    setting!(
        fraction,
        "share",
        "above 0, at most 1",
        real,
        |v: f32| v > 0.0 && v <= 1.0,
        "Share of the generators that is used",
        "time of every field evaluation against the direction of the normals",
        "1"
    ),
    setting!(
        most_generators,
        "generators",
        "1 to 2^32-1",
        whole,
        |v: u32| v >= 1,
        "Generators at most: beyond, the fraction is lowered to keep them",
        "time, which otherwise grows with the square of the leaves, against the direction of the normals",
        "any number that is not below the number of leaves"
    ),
    setting!(
        sampling,
        "",
        "stratified, plain",
        Sampling::parse,
        |_| true,
        "How a fraction of the generators is chosen",
        "plain is the paper's and noisier at the same count",
        "any, with fraction 1"
    ),
    setting!(
        seed,
        "number",
        "0 to 2^32-1",
        whole,
        |_| true,
        "Seed of the sampling",
        "nothing",
        "any, with fraction 1"
    ),
    setting!(
        norm,
        "",
        "euclidean, manhattan, maximum",
        Norm::parse,
        |_| true,
        "Vector norm of the distance in equation 2",
        "shape of the influence: ball, octahedron, cube",
        "changes the meaning, not the error"
    ),
    setting!(
        rho,
        "diagonals of the foliage box",
        "above 0",
        real,
        positive,
        "Radius of influence for normals and surface",
        "detail against abstraction; time grows with its cube",
        "changes the meaning, not the error"
    ),
    setting!(
        rho_ambient,
        "diagonals of the foliage box",
        "above 0",
        real,
        positive,
        "Radius of influence for the ambient coefficient",
        "local against global density",
        "changes the meaning, not the error"
    ),
    setting!(
        tau,
        "density, or % of the foliage vertices below it",
        "0 or above, or 0% to 100%",
        threshold,
        threshold_valid,
        "Threshold of equation 3: where the implicit surface lies",
        "closeness of the surface to the leaves",
        "changes the meaning, not the error"
    ),
    setting!(
        cells,
        "cells",
        "3 to 1024",
        whole,
        |v: u32| (3..=1024).contains(&v),
        "Cells of the grids along their longest side",
        "time and memory (cube) against angle of the normals and depth of the light",
        "normals = exact, or none of vertex, face, open, transmittance"
    ),
    setting!(
        memory,
        "MiB",
        "1 to 65536",
        whole,
        |v: u32| (1..=65536).contains(&v),
        "Largest grid that is allocated",
        "nothing: more is an error before any allocation",
        "any"
    ),
    setting!(
        surface_normals,
        "",
        "gradient, faces",
        SurfaceNormals::parse,
        |_| true,
        "Normals at the surface's vertices",
        "faces costs less and is noisier",
        "gradient"
    ),
    setting!(
        surface_error,
        "cells",
        "0 to 16",
        real,
        |v: f32| (0.0..=16.0).contains(&v),
        "Largest error of the optimised surface mesh; 0 keeps the mesh",
        "size of the surface against its shape",
        "0"
    ),
    setting!(
        ambient,
        "",
        "eq4, transmittance, traced, none",
        AmbientMode::parse,
        |_| true,
        "How the ambient coefficient is computed",
        "time against agreement with ray-traced occlusion",
        "traced"
    ),
    setting!(
        k_min,
        "coefficient",
        "0 to 1",
        real,
        |v: f32| (0.0..=1.0).contains(&v),
        "Smallest ambient coefficient of equation 4",
        "contrast",
        "changes the meaning, not the error"
    ),
    setting!(
        exponent,
        "number",
        "above 0",
        real,
        positive,
        "Exponent n of equation 4",
        "how fast the core darkens",
        "changes the meaning, not the error"
    ),
    setting!(
        d_min,
        "density, or % of the foliage vertices below it",
        "0 or above, or 0% to 100%",
        threshold,
        threshold_valid,
        "Density from which on the coefficient is k_min",
        "size of the dark core",
        "changes the meaning, not the error"
    ),
    setting!(
        directions,
        "directions",
        "1 to 1024",
        whole,
        |v: u32| (1..=1024).contains(&v),
        "Directions of transmittance, traced and open",
        "time against noise",
        "1024"
    ),
    setting!(
        normals,
        "",
        "vertex, face, exact, gradient, multiscale, open, original",
        NormalsMode::parse,
        |_| true,
        "How the normals of the foliage are realigned",
        "time, roughness and agreement with the open sky",
        "exact for the surface's normals"
    ),
    setting!(
        blend,
        "share",
        "0 to 1",
        real,
        |v: f32| (0.0..=1.0).contains(&v),
        "Share of the realigned normal against the model's own",
        "calm against sparkle",
        "changes the meaning, not the error"
    ),
    setting!(
        encoding,
        "",
        "length, packed16, packed8, none",
        Encoding::parse,
        |_| true,
        "How normal and coefficient are stored together",
        "bytes against angle",
        "none"
    ),
    setting!(
        back_faces,
        "",
        "unflipped, flipped, duplicate",
        BackFaces::parse,
        |_| true,
        "Realigned normals on the back of double-sided leaves",
        "duplicate doubles the faces of the exported foliage",
        "changes the meaning, not the error"
    ),
];
