//! Every approximation of the foliage bake as a setting: unit, range, default, what it trades and
//! its exact end.
//!
//! Lengths are relative to the diagonal of the foliage box, so that a model and its copy at
//! another scale have the same settings. `SETTINGS` in [`super::table`] describes the fields for
//! command lines, scene files and sweeps.

use std::fmt;

use super::table;
use crate::{Error, Result};

/// Declares an enum whose variants have names on the command line.
macro_rules! named {
    ($(#[$doc:meta])* $name:ident { $( $(#[$vdoc:meta])* $variant:ident = $text:literal ),* $(,)? }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum $name { $( $(#[$vdoc])* $variant ),* }

        impl $name {
            /// Every value, in order.
            pub const ALL: &'static [Self] = &[$( Self::$variant ),*];

            /// Name on the command line.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $( Self::$variant => $text ),* }
            }

            /// The value with this name.
            ///
            /// # Errors
            /// Lists the names.
            pub fn parse(text: &str) -> Result<Self> {
                match text {
                    $( $text => Ok(Self::$variant), )*
                    _ => Err(Error::usage(format!(
                        "{text:?} is none of {}",
                        [$( $text ),*].join(", ")
                    ))),
                }
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(self.name())
            }
        }
    };
}

named! {
    /// What makes one generator (\[LBD\] 3.1: "a generator point for each geometric primitive").
    Primitive {
        /// `triangle` where the leaves are few and large, `leaf` otherwise ([`super::split::Leaves`]
        /// has the rule).
        Auto = "auto",
        /// A connected component of the foliage mesh, joined by equal positions.
        Leaf = "leaf",
        /// Every triangle, so that a card of two triangles counts twice.
        Triangle = "triangle",
    }
}

named! {
    /// How a fraction of the generators is chosen.
    Sampling {
        /// Those of one voxel are merged to their mean, weights added up.
        Stratified = "stratified",
        /// A seeded random subset (the paper's), weights divided by the fraction.
        Plain = "plain",
    }
}

named! {
    /// Vector norm of equation 2.
    Norm {
        /// L2, spherical influence.
        Euclidean = "euclidean",
        /// L1, octahedral influence.
        Manhattan = "manhattan",
        /// L-infinity, cubic influence.
        Maximum = "maximum",
    }
}

named! {
    /// How the ambient coefficient follows from the foliage.
    AmbientMode {
        /// The paper's transfer function of the density (equation 4).
        Eq4 = "eq4",
        /// Mean Beer-Lambert transmittance through the leaf-area field.
        Transmittance = "transmittance",
        /// Ray-traced visibility of the sky.
        Traced = "traced",
        /// 1 everywhere; nothing is computed.
        None = "none",
    }
}

named! {
    /// How normals are realigned (specification, section 6).
    NormalsMode {
        /// Normal of the nearest surface vertex (the paper's).
        Vertex = "vertex",
        /// Normal at the nearest point of the surface's triangles.
        Face = "face",
        /// Normal at the nearest point of F = 0 itself.
        Exact = "exact",
        /// -grad F at the vertex.
        Gradient = "gradient",
        /// Mean of the directions of -grad F at one and two radii.
        Multiscale = "multiscale",
        /// Mean open direction through the leaf-area field.
        Open = "open",
        /// The model's own normals; nothing is computed.
        Original = "original",
    }
}

named! {
    /// Where the normals of the surface's vertices come from.
    SurfaceNormals {
        /// -grad F at the vertex.
        Gradient = "gradient",
        /// Area-weighted mean of the faces around (the paper's usual reading).
        Faces = "faces",
    }
}

named! {
    /// How a normal and an ambient coefficient are stored together.
    Encoding {
        /// The paper's: the normal's length is the coefficient, three floats.
        Length = "length",
        /// Octahedral 2 x snorm16 and unorm16 in 8 bytes.
        Packed16 = "packed16",
        /// Octahedral 2 x snorm8 and unorm8 in 4 bytes.
        Packed8 = "packed8",
        /// Separate floats.
        None = "none",
    }
}

named! {
    /// What happens to a realigned normal on the back of a double-sided leaf.
    BackFaces {
        /// It stays: light follows the crown, not the leaf.
        Unflipped = "unflipped",
        /// It is turned over, as glTF says of double-sided materials.
        Flipped = "flipped",
        /// On export every face is stored twice, so that other programs do not flip either.
        Duplicate = "duplicate",
    }
}

/// A threshold, given as such or as a quantile of the density at the foliage vertices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Threshold {
    /// The quantile, in \[0,1\]; written as a percentage (`4%`).
    Quantile(f32),
    /// The density itself.
    Absolute(f32),
}

impl fmt::Display for Threshold {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Quantile(q) => write!(f, "{}%", percent(*q)),
            Self::Absolute(v) => write!(f, "{v}"),
        }
    }
}

/// The shortest percentage that reads back as this share.
fn percent(share: f32) -> String {
    let exact = f64::from(share) * 100.0;
    (0..=9)
        .map(|digits| format!("{exact:.digits$}"))
        .find(|text| {
            let back = text.parse::<f64>().map(|p| (p / 100.0) as f32);
            back == Ok(share)
        })
        .unwrap_or_else(|| exact.to_string())
}

/// Settings of the foliage bake.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// What makes one generator.
    pub primitive: Primitive,
    /// Share of the generators that is used, in (0,1].
    pub fraction: f32,
    /// Generators at most, >= 1; with more the share is lowered to keep this number. In one crown
    /// every vertex meets a fixed share of the generators, so that without a bound time grows
    /// with the square of the leaves.
    pub most_generators: u32,
    /// How that share is chosen.
    pub sampling: Sampling,
    /// Seed of `sampling`.
    pub seed: u32,
    /// Norm of equation 2.
    pub norm: Norm,
    /// Radius of influence for normals and surface, in diagonals, > 0.
    pub rho: f32,
    /// Radius of influence for the ambient coefficient, in diagonals, > 0.
    pub rho_ambient: f32,
    /// Threshold of equation 3, >= 0, for both radii.
    pub tau: Threshold,
    /// Cells along the longest side of the grids, 3..=1024.
    pub cells: u32,
    /// Bound of the bytes of a grid in MiB, >= 1.
    pub memory: u32,
    /// Where surface normals come from.
    pub surface_normals: SurfaceNormals,
    /// Largest error of the optimised surface in cells; 0 leaves the surface as it is.
    pub surface_error: f32,
    /// How the ambient coefficient is computed.
    pub ambient: AmbientMode,
    /// Smallest coefficient of equation 4, in \[0,1\].
    pub k_min: f32,
    /// Exponent n of equation 4, > 0.
    pub exponent: f32,
    /// Density from which on equation 4 is `k_min`.
    pub d_min: Threshold,
    /// Directions of `transmittance`, `traced` and `open`, 1..=1024.
    pub directions: u32,
    /// How normals are realigned.
    pub normals: NormalsMode,
    /// Share b of the realigned normal in N' = normalize((1-b) N + b N_s), in \[0,1\].
    pub blend: f32,
    /// How the result is stored.
    pub encoding: Encoding,
    /// Normals on the back of leaves.
    pub back_faces: BackFaces,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            primitive: Primitive::Auto,
            fraction: 1.0,
            most_generators: 8_000,
            sampling: Sampling::Stratified,
            seed: 1,
            norm: Norm::Euclidean,
            rho: 0.1,
            rho_ambient: 0.03,
            tau: Threshold::Quantile(0.04),
            cells: 96,
            memory: 512,
            surface_normals: SurfaceNormals::Gradient,
            surface_error: 0.0,
            ambient: AmbientMode::Eq4,
            k_min: 0.2,
            exponent: 1.0,
            d_min: Threshold::Quantile(0.9),
            directions: 16,
            // More meaning and less roughness than `gradient`: docs/foliage-measures.md.
            normals: NormalsMode::Multiscale,
            blend: 1.0,
            encoding: Encoding::Packed16,
            back_faces: BackFaces::Unflipped,
        }
    }
}

impl Settings {
    /// Checks every range.
    ///
    /// # Errors
    /// Names the first setting that is outside its range, and the range.
    pub fn check(&self) -> Result<()> {
        match table::SETTINGS.iter().find(|info| !(info.valid)(self)) {
            None => Ok(()),
            Some(info) => Err(Error::usage(format!(
                "{}: must be {}, not {}",
                info.name,
                info.range,
                (info.get)(self)
            ))),
        }
    }

    /// Text of the setting `name`, as [`Settings::set`] takes it.
    ///
    /// # Errors
    /// Unknown name.
    pub fn get(&self, name: &str) -> Result<String> {
        Ok((table::find(name)?.get)(self))
    }

    /// Sets `name` from text and checks its range.
    ///
    /// # Errors
    /// Unknown name, a value that cannot be read, or one outside the range.
    pub fn set(&mut self, name: &str, text: &str) -> Result<()> {
        let info = table::find(name)?;
        self.put(info, text)
            .map_err(|e| Error::usage(format!("{}: {e}", info.name)))
    }

    /// Sets one row of the table. The caller names the setting as the user wrote it.
    ///
    /// # Errors
    /// What is wrong with the value, without the setting's name.
    pub fn put(&mut self, info: &table::SettingInfo, text: &str) -> Result<()> {
        let mut changed = *self;
        (info.set)(&mut changed, text.trim())?;
        if !(info.valid)(&changed) {
            let range = info.range;
            return Err(Error::usage(format!("must be {range}, not {text}")));
        }
        *self = changed;
        Ok(())
    }

    /// Whether an implicit surface is extracted.
    #[must_use]
    pub fn needs_surface(&self) -> bool {
        matches!(
            self.normals,
            NormalsMode::Vertex | NormalsMode::Face | NormalsMode::Exact
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_setting_survives_its_own_text() {
        let defaults = Settings::default();
        defaults.check().unwrap();
        for info in table::SETTINGS {
            let mut other = defaults;
            let text = defaults.get(info.name).unwrap();
            other.set(info.name, &text).unwrap();
            assert_eq!(other, defaults, "{} = {text}", info.name);
            assert_eq!(info.default(), text, "{}", info.name);
        }
    }

    #[test]
    fn values_outside_the_range_are_refused_with_the_range() {
        for (name, text) in [
            ("rho", "0"),
            ("rho", "-1"),
            ("rho", "nan"),
            ("rho_ambient", "0"),
            ("tau", "-0.1"),
            ("tau", "101%"),
            ("cells", "0"),
            ("cells", "100000"),
            ("fraction", "0"),
            ("fraction", "1.5"),
            ("most_generators", "0"),
            ("k_min", "2"),
            ("exponent", "0"),
            ("blend", "-1"),
            ("directions", "0"),
            ("normals", "sideways"),
        ] {
            let mut s = Settings::default();
            let message = s.set(name, text).unwrap_err().to_string();
            assert!(message.contains(name), "{name} = {text}: {message}");
            assert_eq!(s, Settings::default(), "{name} stays as it was");
        }
        let unknown = Settings::default().set("roh", "1").unwrap_err().to_string();
        assert!(unknown.contains("rho"), "lists the names: {unknown}");
    }

    #[test]
    fn quantiles_are_percentages() {
        let mut s = Settings::default();
        s.set("tau", "3.5%").unwrap();
        assert_eq!(s.tau, Threshold::Quantile(0.035), "percent");
        s.set("tau", "0.3").unwrap();
        assert_eq!(s.tau, Threshold::Absolute(0.3), "absolute");
        s.set("tau", "0").unwrap();
        assert_eq!(s.get("tau").unwrap(), "0", "support boundary");
        assert_eq!(
            Settings::default().get("d_min").unwrap(),
            "90%",
            "as it was written"
        );
        for share in [0.1f32, 1.0 / 3.0, 1e-6, 0.999_999_9] {
            let text = Threshold::Quantile(share).to_string();
            s.set("tau", &text).unwrap();
            assert_eq!(s.tau, Threshold::Quantile(share), "{text}");
        }
    }
}
