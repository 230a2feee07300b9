//! Decoding PNG and JPEG images to RGBA8, and encoding PNG.

use std::io::Cursor;

use image::{ExtendedColorType, ImageDecoder, ImageEncoder, ImageReader, Limits};

use super::model::{ImageSource, Model};
use crate::{Error, Result};

/// Longest side of an image in pixels.
pub const MAX_SIDE: u32 = 16_384;
/// Most bytes a decoder may allocate.
const MAX_BYTES: u64 = 2 << 30;

/// A decoded image: rows from the top, `width * height` pixels of four bytes.
#[derive(Clone, PartialEq, Eq)]
pub struct Rgba8 {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// RGBA, as encoded in the file (usually sRGB colour, linear alpha).
    pub pixels: Vec<u8>,
}

impl std::fmt::Debug for Rgba8 {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Rgba8({}x{})", self.width, self.height)
    }
}

/// Width and height of the image `index` of `model`, from its header.
///
/// # Errors
/// As [`decode_of`].
pub fn dimensions_of(model: &Model, index: usize) -> Result<[u32; 2]> {
    match &model.images[index] {
        ImageSource::Rgba8 { width, height, .. } => Ok([*width, *height]),
        ImageSource::Encoded { name, bytes } => decoder(bytes)
            .map(|decoder| decoder.dimensions().into())
            .map_err(|reason| damaged(model, index, name, &reason)),
    }
}

/// Decodes the image `index` of `model` as [`decode`] does.
///
/// # Errors
/// As [`decode`], with the model's file, the image's index and its name.
pub fn decode_of(model: &Model, index: usize) -> Result<Rgba8> {
    match &model.images[index] {
        ImageSource::Encoded { name, bytes } => {
            decode_bytes(bytes).map_err(|reason| damaged(model, index, name, &reason))
        }
        made @ ImageSource::Rgba8 { .. } => decode(made),
    }
}

fn damaged(model: &Model, index: usize, name: &str, reason: &str) -> Error {
    let unnamed = format!("image {index}");
    let image = if name == unnamed {
        unnamed
    } else {
        format!("{unnamed} ({name})")
    };
    let file = model.path.clone().unwrap_or_else(|| (&model.name).into());
    Error::file(file, format!("{image}: {reason}"))
}

/// Decodes an image; 16-bit channels become 8-bit, grey becomes RGB, alpha is 255 where absent.
///
/// # Errors
/// Neither PNG nor JPEG, damaged, or larger than [`MAX_SIDE`]; the error names the image.
pub fn decode(source: &ImageSource) -> Result<Rgba8> {
    match source {
        ImageSource::Rgba8 {
            name,
            width,
            height,
            pixels,
        } => {
            let wanted = *width as usize * *height as usize * 4;
            if pixels.len() != wanted {
                return Err(Error::file(
                    name,
                    format!(
                        "{width}x{height} needs {wanted} bytes, there are {}",
                        pixels.len()
                    ),
                ));
            }
            Ok(Rgba8 {
                width: *width,
                height: *height,
                pixels: pixels.to_vec(),
            })
        }
        ImageSource::Encoded { name, bytes } => {
            decode_bytes(bytes).map_err(|reason| Error::file(name, reason))
        }
    }
}

/// `image/png` or `image/jpeg` by the first bytes.
#[must_use]
pub fn media_type(bytes: &[u8]) -> Option<&'static str> {
    if bytes.starts_with(b"\x89PNG\r\n\x1a\n") {
        Some("image/png")
    } else if bytes.starts_with(b"\xFF\xD8\xFF") {
        Some("image/jpeg")
    } else {
        None
    }
}

fn decode_bytes(bytes: &[u8]) -> Result<Rgba8, String> {
    let decoder = decoder(bytes)?;
    let (width, height) = decoder.dimensions();
    let image = image::DynamicImage::from_decoder(decoder).map_err(undecodable)?;
    Ok(Rgba8 {
        width,
        height,
        pixels: image.into_rgba8().into_raw(),
    })
}

/// A decoder that has read the header and found pixels.
fn decoder(bytes: &[u8]) -> Result<impl ImageDecoder + '_, String> {
    let format = match media_type(bytes) {
        Some("image/png") => image::ImageFormat::Png,
        Some(_) => image::ImageFormat::Jpeg,
        None => return Err("the image is neither PNG nor JPEG".into()),
    };
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    reader.limits(limits(MAX_BYTES));
    let decoder = reader.into_decoder().map_err(undecodable)?;
    match decoder.dimensions() {
        (0, _) | (_, 0) => Err("the image has no pixels".into()),
        _ => Ok(decoder),
    }
}

/// What a decoder may do: [`MAX_SIDE`] pixels along a side, `bytes` of memory.
pub(super) fn limits(bytes: u64) -> Limits {
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(bytes);
    limits
}

#[expect(clippy::needless_pass_by_value, reason = "the form that map_err takes")]
fn undecodable(error: image::ImageError) -> String {
    format!("the image cannot be decoded: {error}")
}

/// Encodes RGBA8 rows from the top as PNG. The same input always gives the same bytes.
///
/// # Errors
/// `pixels` is not `width * height * 4` long, or the image is empty.
pub fn encode_png(width: u32, height: u32, pixels: &[u8]) -> Result<Vec<u8>> {
    if width == 0 || height == 0 || pixels.len() != width as usize * height as usize * 4 {
        return Err(Error::usage(format!(
            "{width}x{height} pixels do not have {} bytes",
            pixels.len()
        )));
    }
    let mut out = Vec::new();
    image::codecs::png::PngEncoder::new(&mut out)
        .write_image(pixels, width, height, ExtendedColorType::Rgba8)
        .map_err(|e| Error::usage(format!("PNG: {e}")))?;
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    fn source(bytes: Vec<u8>) -> ImageSource {
        ImageSource::Encoded {
            name: "leaf.png".into(),
            bytes: Arc::from(bytes),
        }
    }

    #[test]
    fn a_png_comes_back_and_damage_is_named() {
        let pixels: Vec<u8> = (0..2 * 3 * 4).collect();
        let png = encode_png(2, 3, &pixels).unwrap();
        assert_eq!(png, encode_png(2, 3, &pixels).unwrap());
        let back = decode(&source(png.clone())).unwrap();
        assert_eq!((back.width, back.height, &back.pixels), (2, 3, &pixels));
        for broken in [png[..30].to_vec(), b"RIFF....WEBP".to_vec(), vec![]] {
            let e = decode(&source(broken)).unwrap_err().to_string();
            assert!(e.starts_with("leaf.png: "), "{e}");
        }
        assert!(encode_png(2, 2, &pixels).is_err() && encode_png(0, 0, &[]).is_err());
    }

    #[test]
    fn damage_is_told_by_file_image_and_name() {
        let mut model = Model {
            name: "oak".into(),
            images: vec![source(vec![1, 2, 3])],
            ..Model::default()
        };
        let told = |model: &Model| {
            let header = dimensions_of(model, 0).unwrap_err().to_string();
            assert_eq!(decode_of(model, 0).unwrap_err().to_string(), header, "both");
            header
        };
        let reason = "the image is neither PNG nor JPEG";
        assert_eq!(told(&model), format!("oak: image 0 (leaf.png): {reason}"));
        model.path = Some("a/oak.glb".into());
        model.images[0] = ImageSource::Encoded {
            name: "image 0".into(),
            bytes: Arc::from([]),
        };
        assert_eq!(told(&model), format!("a/oak.glb: image 0: {reason}"));
    }

    #[test]
    fn a_header_that_claims_a_huge_size_is_refused() {
        let mut png = encode_png(1, 1, &[1, 2, 3, 4]).unwrap();
        png[16..20].copy_from_slice(&1_000_000u32.to_be_bytes());
        assert!(decode(&source(png)).is_err());
    }
}
