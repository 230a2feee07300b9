//! A finished picture in host memory.

use crate::Result;

/// Quality of JPEG files, 1..100: no visible blocks around leaves.
const JPEG_QUALITY: u8 = 90;

/// 8-bit sRGB colour with linear alpha, row by row from the top left.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// `width * height * 4` bytes.
    pub rgba: Vec<u8>,
}

impl Picture {
    /// A picture of one colour.
    #[must_use]
    pub fn filled(width: u32, height: u32, rgba: [u8; 4]) -> Self {
        Self {
            width,
            height,
            rgba: rgba.repeat(width as usize * height as usize),
        }
    }

    /// The pixel at column `x`, row `y`.
    #[must_use]
    pub fn pixel(&self, x: u32, y: u32) -> [u8; 4] {
        let at = (y as usize * self.width as usize + x as usize) * 4;
        [0, 1, 2, 3].map(|c| self.rgba[at + c])
    }

    /// The bytes of a PNG file.
    ///
    /// # Errors
    /// When the encoder fails, which only a picture without pixels makes it do.
    pub fn to_png(&self) -> Result<Vec<u8>> {
        use ::image::codecs::png::{CompressionType, FilterType, PngEncoder};
        use ::image::{ExtendedColorType, ImageEncoder};
        let mut bytes = Vec::new();
        PngEncoder::new_with_quality(&mut bytes, CompressionType::Fast, FilterType::Adaptive)
            .write_image(
                &self.rgba,
                self.width,
                self.height,
                ExtendedColorType::Rgba8,
            )
            .map_err(|e| crate::Error::usage(format!("the picture cannot be encoded: {e}")))?;
        Ok(bytes)
    }

    /// The bytes of a JPEG file; alpha is left out.
    ///
    /// # Errors
    /// When the encoder fails, as for a picture of more than 65535 pixels across or down.
    pub fn to_jpeg(&self) -> Result<Vec<u8>> {
        use ::image::ExtendedColorType;
        use ::image::codecs::jpeg::JpegEncoder;
        let rgb: Vec<u8> = self
            .rgba
            .chunks_exact(4)
            .flat_map(|p| [p[0], p[1], p[2]])
            .collect();
        let mut bytes = Vec::new();
        JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY)
            .encode(&rgb, self.width, self.height, ExtendedColorType::Rgb8)
            .map_err(|e| crate::Error::usage(format!("the picture cannot be encoded: {e}")))?;
        Ok(bytes)
    }
}
