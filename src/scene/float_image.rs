//! Images of linear floating-point light: EXR and Radiance HDR as they are, PNG and JPEG decoded.

use std::io::Cursor;

use image::{
    DynamicImage, ExtendedColorType, ImageBuffer, ImageEncoder, ImageFormat, ImageReader, Rgba,
};

use super::textures::limits;
use crate::math::colour::srgb_to_linear;
use crate::{Error, Result};

/// Most bytes a decoder may allocate.
const MAX_BYTES: u64 = 4 << 30;

/// What the numbers of a PNG or JPEG mean. EXR and HDR are always linear.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Transfer {
    /// Colour in sRGB (alpha is linear).
    Srgb,
    /// Numbers.
    Linear,
}

/// Linear RGBA, rows from the top; alpha is 1 where the file has none.
#[derive(Clone, PartialEq)]
pub struct FloatImage {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// `width * height` pixels.
    pub pixels: Vec<[f32; 4]>,
}

impl std::fmt::Debug for FloatImage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "FloatImage({}x{})", self.width, self.height)
    }
}

impl FloatImage {
    /// Decodes PNG (8 or 16 bits), JPEG, EXR or HDR; `name` is for messages.
    ///
    /// # Errors
    /// Another format, damage, or more than [`super::textures::MAX_SIDE`] pixels across or down.
    pub fn decode(name: &str, bytes: &[u8], transfer: Transfer) -> Result<Self> {
        let damaged =
            |e: image::ImageError| Error::file(name, format!("the image cannot be decoded: {e}"));
        let format = image::guess_format(bytes)
            .map_err(|_| Error::file(name, "the image is neither PNG, JPEG, EXR nor HDR"))?;
        let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
        reader.limits(limits(MAX_BYTES));
        let image: DynamicImage = reader.decode().map_err(damaged)?;
        let decode =
            matches!(format, ImageFormat::Png | ImageFormat::Jpeg) && transfer == Transfer::Srgb;
        let image = image.into_rgba32f();
        let pixels = image
            .pixels()
            .map(|p| {
                let [r, g, b, a] = p.0;
                if decode {
                    let [r, g, b] = [r, g, b].map(srgb_to_linear);
                    [r, g, b, a]
                } else {
                    [r, g, b, a]
                }
            })
            .collect();
        Ok(Self {
            width: image.width(),
            height: image.height(),
            pixels,
        })
    }

    /// The bytes of an EXR file of 32-bit floats.
    ///
    /// # Errors
    /// The image has no pixels.
    pub fn to_exr(&self) -> Result<Vec<u8>> {
        let flat: Vec<f32> = self.pixels.iter().flatten().copied().collect();
        let buffer: ImageBuffer<Rgba<f32>, Vec<f32>> =
            ImageBuffer::from_raw(self.width, self.height, flat)
                .ok_or_else(|| Error::usage("EXR: the image does not have its size"))?;
        let mut out = Cursor::new(Vec::new());
        buffer
            .write_to(&mut out, ImageFormat::OpenExr)
            .map_err(|e| Error::usage(format!("EXR: {e}")))?;
        Ok(out.into_inner())
    }

    /// The bytes of a PNG file of 16-bit numbers, value times 65535, clamped to \[0, 1\].
    ///
    /// # Errors
    /// The image has no pixels.
    pub fn to_png16(&self) -> Result<Vec<u8>> {
        let samples: Vec<u8> = self
            .pixels
            .iter()
            .flatten()
            .flat_map(|v| unorm16(*v).to_ne_bytes())
            .collect();
        let mut out = Vec::new();
        image::codecs::png::PngEncoder::new(&mut out)
            .write_image(&samples, self.width, self.height, ExtendedColorType::Rgba16)
            .map_err(|e| Error::usage(format!("PNG: {e}")))?;
        Ok(out)
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped to the range of the integer before the cast"
)]
fn unorm16(v: f32) -> u16 {
    (v.clamp(0.0, 1.0) * 65535.0).round() as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floats_and_sixteen_bits_come_back() {
        let pixels: Vec<[f32; 4]> = (0..6)
            .map(|i| [0.1 * i as f32, 0.5, 7.0 * i as f32, 0.25])
            .collect();
        let image = FloatImage {
            width: 3,
            height: 2,
            pixels,
        };
        let exr = image.to_exr().unwrap();
        let back = FloatImage::decode("a.exr", &exr, Transfer::Srgb).unwrap();
        assert_eq!(back, image, "EXR is exact and never sRGB");
        let png = image.to_png16().unwrap();
        let back = FloatImage::decode("a.png", &png, Transfer::Linear).unwrap();
        for (a, b) in image
            .pixels
            .iter()
            .flatten()
            .zip(back.pixels.iter().flatten())
        {
            assert!((a.clamp(0.0, 1.0) - b).abs() < 1e-5, "{a} {b}");
        }
        let srgb = FloatImage::decode("a.png", &png, Transfer::Srgb).unwrap();
        assert!((srgb.pixels[0][1] - srgb_to_linear(0.5)).abs() < 1e-4);
        assert_eq!(srgb.pixels[0][3], back.pixels[0][3], "alpha is linear");
    }

    #[test]
    fn damage_is_named() {
        for bytes in [&b"not an image"[..], b"", b"\x89PNG\r\n\x1a\nxx"] {
            let e = FloatImage::decode("sky.hdr", bytes, Transfer::Linear)
                .unwrap_err()
                .to_string();
            assert!(e.starts_with("sky.hdr: "), "{e}");
        }
    }
}
