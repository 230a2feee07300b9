//! Decoding PNG and JPEG images to RGBA8, and encoding PNG.

use std::io::Cursor;

use image::{ExtendedColorType, ImageDecoder, ImageEncoder, ImageReader, Limits};

use super::model::ImageSource;
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
    let format = match media_type(bytes) {
        Some("image/png") => image::ImageFormat::Png,
        Some(_) => image::ImageFormat::Jpeg,
        None => return Err("the image is neither PNG nor JPEG".into()),
    };
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_BYTES);
    reader.limits(limits);
    let damaged = |e: image::ImageError| format!("the image cannot be decoded: {e}");
    let decoder = reader.into_decoder().map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    if width == 0 || height == 0 {
        return Err("the image has no pixels".into());
    }
    let image = image::DynamicImage::from_decoder(decoder).map_err(damaged)?;
    Ok(Rgba8 {
        width,
        height,
        pixels: image.into_rgba8().into_raw(),
    })
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
    fn a_header_that_claims_a_huge_size_is_refused() {
        let mut png = encode_png(1, 1, &[1, 2, 3, 4]).unwrap();
        png[16..20].copy_from_slice(&1_000_000u32.to_be_bytes());
        assert!(decode(&source(png)).is_err());
    }
}
