//! Leaves as files: a TOML with the tissue, and images of the maps beside it.
//!
//! | image | R, G, B | A | as 16-bit PNG |
//! |---|---|---|---|
//! | `gamma_delta` | gamma | deviation of the thickness d | gamma / 4, (d + 1) / 4 |
//! | `specular` | intensity of the gloss | roughness m | as they are |
//! | `mask` | R: how much of the texel is leaf | | as it is |
//!
//! EXR holds the values themselves. Eight-bit PNGs are read too, with the same meaning.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::appearance::{Face, LeafMaterial, Mode, Side};
use super::maps::SideMaps;
use crate::scene::float_image::{FloatImage, Transfer};
use crate::{Error, Result};

/// Version of the file.
const VERSION: u32 = 1;
/// Range of gamma and of `d + 1` in a PNG.
pub const PNG_RANGE: f32 = 4.0;

/// How the maps are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MapFormat {
    /// 16-bit PNG: gamma up to 4, thickness 0 to 4 times the mean.
    #[default]
    Png,
    /// 32-bit EXR: every value.
    Exr,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct LeafFile {
    umbrage_leaf: u32,
    name: String,
    /// Millimetres.
    thickness: f64,
    #[serde(default)]
    mode: ModeName,
    #[serde(skip_serializing_if = "Option::is_none")]
    mask: Option<PathBuf>,
    upper: SideFile,
    #[serde(skip_serializing_if = "Option::is_none")]
    lower: Option<SideFile>,
}

#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum ModeName {
    Paper,
    #[default]
    Exact,
}

#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SideFile {
    /// 1/mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    sigma_a: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    sigma_s: Option<[f64; 3]>,
    /// Instead of the coefficients: what the side reflects and lets through.
    #[serde(skip_serializing_if = "Option::is_none")]
    reflectance: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    transmittance: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    gamma: Option<[f32; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    rho_s: Option<[f32; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    roughness: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    gloss: Option<f32>,
    /// The paper's constants.
    #[serde(skip_serializing_if = "Option::is_none")]
    a: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    b: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    gamma_delta: Option<PathBuf>,
    #[serde(skip_serializing_if = "Option::is_none")]
    specular: Option<PathBuf>,
}

/// Reads a leaf and its maps.
///
/// # Errors
/// Names the file and what is wrong: syntax, unknown keys, values out of range, an image that is
/// missing or of another size than the others.
pub fn read(path: &Path) -> Result<LeafMaterial> {
    let text = fs::read_to_string(path).map_err(|e| Error::file(path, e))?;
    let file: LeafFile = toml::from_str(&text).map_err(|e| Error::file(path, e.message()))?;
    if file.umbrage_leaf != VERSION {
        return Err(Error::file(
            path,
            format!(
                "is version {} of the leaf file; this program reads {VERSION}",
                file.umbrage_leaf
            ),
        ));
    }
    let reader = Reader {
        path,
        folder: path.parent().unwrap_or(Path::new("")),
        thickness: file.thickness,
    };
    // What the sides need to be positive is checked before they are made from it.
    if !(file.thickness > 0.0 && file.thickness.is_finite()) {
        return Err(Error::file(
            path,
            format!("thickness {} mm is not a number > 0", file.thickness),
        ));
    }
    let upper = reader.side(&file.upper, Face::Upper)?;
    let lower = match &file.lower {
        Some(side) => reader.side(side, Face::Lower)?,
        None => upper.clone(),
    };
    let size = upper.maps.as_ref().or(lower.maps.as_ref()).map(|m| m.size);
    let mask = file.mask.map(|mask| reader.mask(&mask, size)).transpose()?;
    let leaf = LeafMaterial {
        name: file.name,
        thickness_mm: file.thickness,
        mode: match file.mode {
            ModeName::Paper => Mode::Paper,
            ModeName::Exact => Mode::Exact,
        },
        upper,
        lower,
        mask,
    };
    leaf.check().map_err(|e| Error::file(path, e))?;
    Ok(leaf)
}

struct Reader<'a> {
    path: &'a Path,
    folder: &'a Path,
    thickness: f64,
}

impl Reader<'_> {
    fn wrong<T>(&self, face: Face, what: impl std::fmt::Display) -> Result<T> {
        Err(Error::file(self.path, format!("[{}] {what}", face.name())))
    }

    fn side(&self, file: &SideFile, face: Face) -> Result<Side> {
        let mut side = match (
            file.sigma_a,
            file.sigma_s,
            file.reflectance,
            file.transmittance,
        ) {
            (Some(a), Some(s), None, None) => {
                if let Some(bad) = a.iter().chain(&s).find(|v| !(**v >= 0.0 && v.is_finite())) {
                    return self.wrong(face, format!("coefficient {bad} is not a number >= 0"));
                }
                Side::of_tissue(a, s, self.thickness)
            }
            (None, None, Some(r), Some(t)) => {
                for c in 0..3 {
                    if !(r[c] >= 0.0 && t[c] >= 0.0 && r[c] + t[c] <= 1.0) {
                        return self.wrong(
                            face,
                            format!(
                                "reflectance {} and transmittance {} of channel {c} are not shares \
                                 of the light",
                                r[c], t[c]
                            ),
                        );
                    }
                }
                Side::of_albedo(r, t, self.thickness).0
            }
            _ => {
                return self.wrong(
                    face,
                    "needs sigma_a and sigma_s, or reflectance and transmittance",
                );
            }
        };
        side.gamma = file.gamma.unwrap_or(side.gamma);
        side.rho_s = file.rho_s.unwrap_or(side.rho_s);
        side.m = file.roughness.unwrap_or(side.m);
        side.gloss = file.gloss.unwrap_or(side.gloss);
        if let (Some(a), Some(b)) = (file.a, file.b) {
            side.constants = std::array::from_fn(|c| [a[c], b[c]]);
        }
        side.maps = self.maps(file, &side)?.map(Arc::new);
        Ok(side)
    }

    fn maps(&self, file: &SideFile, side: &Side) -> Result<Option<SideMaps>> {
        let first = file
            .gamma_delta
            .as_ref()
            .map(|p| self.image(p))
            .transpose()?;
        let second = file.specular.as_ref().map(|p| self.image(p)).transpose()?;
        let Some(size) = first
            .as_ref()
            .or(second.as_ref())
            .map(|i| size_of_image(&i.0))
        else {
            return Ok(None);
        };
        let mut maps = SideMaps::plain(size, 0.0, side.m);
        let fits = |image: &FloatImage, path: &PathBuf| {
            if size_of_image(image) == size {
                return Ok(());
            }
            let ([w, h], [a, b]) = (size, size_of_image(image));
            Err(Error::file(
                self.folder.join(path),
                format!("is {a}x{b}; the side's other map is {w}x{h}"),
            ))
        };
        match (&first, &file.gamma_delta) {
            (Some((image, encoded)), Some(path)) => {
                fits(image, path)?;
                maps.gamma_delta.clone_from(&image.pixels);
                if *encoded {
                    for t in &mut maps.gamma_delta {
                        *t = t.map(|v| v * PNG_RANGE);
                        t[3] -= 1.0;
                    }
                }
            }
            _ => {
                let [r, g, b] = side.gamma;
                maps.gamma_delta.fill([r, g, b, 0.0]);
            }
        }
        match (&second, &file.specular) {
            (Some((image, _)), Some(path)) => {
                fits(image, path)?;
                maps.specular.clone_from(&image.pixels);
            }
            _ => {
                let [r, g, b] = side.rho_s;
                maps.specular.fill([r, g, b, side.m]);
            }
        }
        Ok(Some(maps))
    }

    fn mask(&self, path: &Path, size: Option<[u32; 2]>) -> Result<Arc<[f32]>> {
        let (image, _) = self.image(path)?;
        if let Some([w, h]) = size
            && size_of_image(&image) != [w, h]
        {
            return Err(Error::file(
                self.folder.join(path),
                format!(
                    "the mask is {}x{}, the maps are {w}x{h}",
                    image.width, image.height
                ),
            ));
        }
        Ok(image.pixels.iter().map(|p| p[0].clamp(0.0, 1.0)).collect())
    }

    /// An image, and whether its numbers are those of a PNG.
    fn image(&self, path: &Path) -> Result<(FloatImage, bool)> {
        let path = self.folder.join(path);
        let bytes = fs::read(&path).map_err(|e| Error::file(&path, e))?;
        let name = path.to_string_lossy();
        let image = FloatImage::decode(&name, &bytes, Transfer::Linear)?;
        Ok((image, bytes.starts_with(b"\x89PNG")))
    }
}

/// The files of a leaf, the maps first: (name, bytes), all in one folder. `stem` is the name of the
/// TOML without its ending.
///
/// # Errors
/// The leaf is not sound, or an image cannot be encoded.
pub fn encode(
    leaf: &LeafMaterial,
    stem: &str,
    format: MapFormat,
) -> Result<Vec<(String, Vec<u8>)>> {
    leaf.check()?;
    let ending = match format {
        MapFormat::Png => "png",
        MapFormat::Exr => "exr",
    };
    let mut files = Vec::new();
    let mut sides = Vec::new();
    for face in Face::ALL {
        let side = leaf.side(face);
        let mut file = SideFile {
            sigma_a: Some(side.sigma_a),
            sigma_s: Some(side.sigma_s),
            gamma: Some(side.gamma),
            rho_s: Some(side.rho_s),
            roughness: Some(side.m),
            gloss: Some(side.gloss),
            a: Some(side.constants.map(|c| c[0])),
            b: Some(side.constants.map(|c| c[1])),
            ..SideFile::default()
        };
        if let Some(maps) = &side.maps {
            let first = format!("{stem}.{}.gamma_delta.{ending}", face.name());
            let second = format!("{stem}.{}.specular.{ending}", face.name());
            files.push((first.clone(), gamma_delta(maps, format)?));
            files.push((
                second.clone(),
                image(maps.size, maps.specular.clone(), format)?,
            ));
            file.gamma_delta = Some(first.into());
            file.specular = Some(second.into());
        }
        sides.push(file);
    }
    let mut mask_name = None;
    if let (Some(mask), Some(size)) = (&leaf.mask, leaf.size()) {
        let name = format!("{stem}.mask.{ending}");
        let pixels = mask.iter().map(|&v| [v, v, v, 1.0]).collect();
        files.push((name.clone(), image(size, pixels, format)?));
        mask_name = Some(name.into());
    }
    let lower = sides.pop();
    let file = LeafFile {
        umbrage_leaf: VERSION,
        name: leaf.name.clone(),
        thickness: leaf.thickness_mm,
        mode: match leaf.mode {
            Mode::Paper => ModeName::Paper,
            Mode::Exact => ModeName::Exact,
        },
        mask: mask_name,
        upper: sides.pop().unwrap_or_default(),
        lower,
    };
    let text = toml::to_string(&file)
        .map_err(|e| Error::usage(format!("leaf {:?} cannot be written: {e}", leaf.name)))?;
    files.push((format!("{stem}.toml"), text.into_bytes()));
    Ok(files)
}

/// Texels whose gamma or thickness a PNG cannot hold.
#[must_use]
pub fn beyond_png(leaf: &LeafMaterial) -> usize {
    let maps = Face::ALL
        .into_iter()
        .filter_map(|f| leaf.side(f).maps.as_ref());
    maps.flat_map(|m| &m.gamma_delta)
        .filter(|t| t[..3].iter().any(|g| *g > PNG_RANGE) || t[3] > PNG_RANGE - 1.0)
        .count()
}

fn gamma_delta(maps: &SideMaps, format: MapFormat) -> Result<Vec<u8>> {
    let mut pixels = maps.gamma_delta.clone();
    if format == MapFormat::Png {
        for t in &mut pixels {
            t[3] += 1.0;
            *t = t.map(|v| v / PNG_RANGE);
        }
    }
    image(maps.size, pixels, format)
}

fn image(size: [u32; 2], pixels: Vec<[f32; 4]>, format: MapFormat) -> Result<Vec<u8>> {
    let image = FloatImage {
        width: size[0],
        height: size[1],
        pixels,
    };
    match format {
        MapFormat::Png => image.to_png16(),
        MapFormat::Exr => image.to_exr(),
    }
}

fn size_of_image(image: &FloatImage) -> [u32; 2] {
    [image.width, image.height]
}
