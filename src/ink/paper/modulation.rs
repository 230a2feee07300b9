//! What thresholds and widths are multiplied by from place to place (Deussen and Strothotte 2000,
//! section 3.4 and figure 4 c: "t(x, y) = T g(x, y)"): the shadow, any other buffer, a painted
//! mask, an expression of them.

use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use super::bounds::largest;
use super::expression::Program;
use super::style::PaperStyle;
use crate::abi::{PAPER_ADD, PAPER_MUL, PAPER_NUMBER, PAPER_VARIABLE, PaperOp};
use crate::scene::model::ImageSource;
use crate::scene::textures::decode;
use crate::{Error, Result};

/// Number of the variable `mask` of the first mask of a style.
const MASK: usize = 10;
/// Masks of a style at most: channels of one image.
const MASKS: usize = 4;

/// A factor that changes over the picture: `by`, or `1 + strength * by`.
///
/// In files a text is the expression alone.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Modulation {
    /// Expression of the factor ([`Program`]), of which the name of a buffer is the shortest.
    pub by: String,
    /// Picture (PNG, JPEG) that `mask` reads, stretched over the drawing: white 1, black and
    /// transparent 0. Relative to the style's file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mask: Option<PathBuf>,
    /// Growth of the threshold or width where the expression is 1, -1000 to 1000; without it the
    /// expression is the factor.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strength: Option<f64>,
}

/// As it may stand in files.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    by: Option<String>,
    mask: Option<PathBuf>,
    strength: Option<f64>,
}

impl<'de> Deserialize<'de> for Modulation {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = Modulation;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "an expression, or a table of by, mask and strength")
            }

            fn visit_str<E>(self, text: &str) -> std::result::Result<Modulation, E> {
                Ok(Modulation {
                    by: text.to_owned(),
                    mask: None,
                    strength: None,
                })
            }

            fn visit_map<A: MapAccess<'de>>(
                self,
                map: A,
            ) -> std::result::Result<Modulation, A::Error> {
                let w = Written::deserialize(MapAccessDeserializer::new(map))?;
                Ok(Modulation {
                    by: w.by.unwrap_or_else(|| "mask".into()),
                    mask: w.mask,
                    strength: w.strength,
                })
            }
        }
        deserializer.deserialize_any(Either)
    }
}

/// Factors of a style, in the order in which kernels have them: foliage's threshold and width,
/// stems' threshold and width.
fn keys(style: &PaperStyle) -> [(&'static str, Option<&Modulation>); 4] {
    let (f, s) = (&style.foliage, &style.stem);
    [
        ("foliage.threshold_by", f.threshold_by.as_ref()),
        ("foliage.width_by", f.width_by.as_ref()),
        ("stem.threshold_by", s.threshold_by.as_ref()),
        ("stem.width_by", s.width_by.as_ref()),
    ]
}

/// Programs of a style's factors, one after the other, and what they read.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Programs {
    /// Steps of all of them.
    pub ops: Vec<PaperOp>,
    /// Where each ends among the steps; one without steps is 1.
    pub ends: [u32; 4],
    /// Pictures of masks, at most four; in programs the variables from `mask` on.
    pub masks: Vec<PathBuf>,
    /// Whether one reads the shadow.
    pub shadow: bool,
    /// Whether one reads normals, light or objects of leaves.
    pub leaves: bool,
    /// Largest factor on widths, where that can be told; 0 where none changes them.
    pub widest: f32,
}

impl Programs {
    /// Of a style; none where it has no such factors.
    ///
    /// # Errors
    /// Key and column of what does not parse, a mask that is read and not given or given and not
    /// read, more than four masks.
    pub fn new(style: &PaperStyle) -> std::result::Result<Option<Self>, String> {
        let mut out = Self::default();
        for (n, (key, modulation)) in keys(style).into_iter().enumerate() {
            let first = out.ops.len();
            if let Some(m) = modulation {
                out.add(key, m)?;
                if n % 2 == 1 {
                    out.widest = out.widest.max(largest(&out.ops[first..]));
                }
            }
            out.ends[n] = out.ops.len() as u32;
        }
        Ok((!out.ops.is_empty()).then_some(out))
    }

    fn add(&mut self, key: &str, m: &Modulation) -> std::result::Result<(), String> {
        let mut program =
            Program::new(&m.by).map_err(|e| format!("{key} = \"{}\": {e}", cut(&m.by)))?;
        let reads = |name: &str| program.reads(name);
        if key.starts_with("stem") && reads("object") {
            return Err(format!("{key}: `object` is known of leaves only"));
        }
        self.shadow |= reads("shadow");
        self.leaves |= ["object", "tone", "nx", "ny", "nz"]
            .iter()
            .any(|v| reads(v));
        match (&m.mask, reads("mask")) {
            (Some(path), true) => {
                let known = self.masks.iter().position(|p| p == path);
                let number = known.unwrap_or(self.masks.len());
                if known.is_none() {
                    self.masks.push(path.clone());
                }
                if number >= MASKS {
                    return Err(format!("{key}.mask: a style has at most {MASKS} masks"));
                }
                for op in &mut program.ops {
                    if op.code == PAPER_VARIABLE && op.value == MASK as f32 {
                        op.value += number as f32;
                    }
                }
            }
            (None, true) => return Err(format!("{key}: `mask` is read, and no mask is given")),
            (Some(_), false) => return Err(format!("{key}: a mask is given, and `by` reads none")),
            (None, false) => {}
        }
        self.ops.extend(program.ops);
        if let Some(strength) = m.strength {
            if strength.is_nan() || strength.abs() > 1000.0 {
                return Err(format!(
                    "{key}.strength = {strength}: expected -1000 to 1000"
                ));
            }
            let step = |code, value| PaperOp { code, value };
            self.ops.extend([
                step(PAPER_NUMBER, strength as f32),
                step(PAPER_MUL, 0.0),
                step(PAPER_NUMBER, 1.0),
                step(PAPER_ADD, 0.0),
            ]);
        }
        Ok(())
    }

    /// The masks of a picture of `size` pixels as the four channels of an image, row by row.
    ///
    /// # Errors
    /// A file that cannot be read or is no picture.
    pub fn painted(&self, size: [u32; 2]) -> Result<Vec<[u8; 4]>> {
        let mut out = vec![[0; 4]; (size[0] * size[1]) as usize];
        for (channel, path) in self.masks.iter().enumerate() {
            for (texel, value) in out.iter_mut().zip(mask(path, size)?) {
                texel[channel] = value;
            }
        }
        Ok(out)
    }
}

/// What a message says of an expression.
fn cut(text: &str) -> String {
    const MOST: usize = 60;
    match text.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}..", &text[..end]),
        None => text.to_owned(),
    }
}

/// A painted picture stretched to `size` pixels.
fn mask(path: &Path, size: [u32; 2]) -> Result<Vec<u8>> {
    use image::imageops::{FilterType, resize};
    let (name, bytes) = read(path)?;
    let picture = decode(&ImageSource::Encoded {
        name: name.clone(),
        bytes: bytes.into(),
    })?;
    let value = |p: &[u8]| {
        let [r, g, b, a] = [p[0], p[1], p[2], p[3]].map(f32::from);
        ((0.2126 * r + 0.7152 * g + 0.0722 * b) * a / 255.0).round() as u8
    };
    let grey: Vec<u8> = picture.pixels.chunks_exact(4).map(value).collect();
    if [picture.width, picture.height] == size {
        return Ok(grey);
    }
    let grey = image::GrayImage::from_raw(picture.width, picture.height, grey)
        .ok_or_else(|| Error::file(name, "the picture has no pixels"))?;
    // Weighs by area where it is made smaller.
    Ok(resize(&grey, size[0], size[1], FilterType::Triangle).into_raw())
}

/// Makes the paths of masks relative to the folder of the style's file, and sees that they are there.
pub(super) fn resolve(style: &mut PaperStyle, folder: &Path) -> Result<()> {
    style.try_masks(|mask| {
        let path = folder.join(mask);
        fs::metadata(&path).map_err(|e| Error::file(&path, format!("cannot read: {e}")))?;
        Ok(path)
    })
}

impl PaperStyle {
    /// The name of every mask that is not in the style itself becomes what `change` makes of it.
    ///
    /// # Errors
    /// Those of `change`.
    pub fn try_masks<E>(
        &mut self,
        mut change: impl FnMut(&Path) -> std::result::Result<PathBuf, E>,
    ) -> std::result::Result<(), E> {
        let (f, s) = (&mut self.foliage, &mut self.stem);
        let all = [
            &mut f.threshold_by,
            &mut f.width_by,
            &mut s.threshold_by,
            &mut s.width_by,
        ];
        let masks = all.into_iter().flatten().filter_map(|m| m.mask.as_mut());
        for mask in masks.filter(|m| data(m).is_none()) {
            *mask = change(mask)?;
        }
        Ok(())
    }
}

/// What the name of a mask begins with that is the picture itself, as in a data URL.
const DATA: &str = "data:image;base64,";
/// Bytes of masks that drawings hold at most.
const LARGEST_HELD: usize = 256 * 1024;

/// The bytes of a mask whose name is the picture itself.
fn data(mask: &Path) -> Option<&str> {
    mask.to_str()?.strip_prefix(DATA)
}

/// The name of a mask that is the picture itself; none of pictures of more than 256 KiB.
///
/// # Errors
/// A file that cannot be read.
pub fn embedded(mask: &Path) -> Result<Option<PathBuf>> {
    use base64::Engine as _;
    let bytes = fs::read(mask).map_err(|e| Error::file(mask, format!("cannot read: {e}")))?;
    let held = bytes.len() <= LARGEST_HELD;
    let encode = || base64::engine::general_purpose::STANDARD.encode(&bytes);
    Ok(held.then(|| PathBuf::from(format!("{DATA}{}", encode()))))
}

/// Name for messages, and bytes.
fn read(mask: &Path) -> Result<(String, Vec<u8>)> {
    use base64::Engine as _;
    if let Some(text) = data(mask) {
        let bytes = base64::engine::general_purpose::STANDARD.decode(text);
        let bytes = bytes.map_err(|e| Error::usage(format!("mask: its data: {e}")))?;
        return Ok(("mask".to_owned(), bytes));
    }
    let bytes = fs::read(mask).map_err(|e| Error::file(mask, format!("cannot read: {e}")))?;
    Ok((mask.display().to_string(), bytes))
}
