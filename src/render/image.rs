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

    /// The bytes of a PNG file that says how large it is and what it shows: pixels of a metre, and
    /// a text with its keyword (pHYs, iTXt).
    ///
    /// # Errors
    /// As [`Picture::to_png`].
    pub fn to_png_with(&self, of_a_metre: u32, (keyword, text): (&str, &str)) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.write_png(&mut bytes, of_a_metre, (keyword, text))
            .map_err(|e| crate::Error::usage(format!("the picture cannot be encoded: {e}")))?;
        Ok(bytes)
    }

    fn write_png(
        &self,
        bytes: &mut Vec<u8>,
        of_a_metre: u32,
        (keyword, text): (&str, &str),
    ) -> std::result::Result<(), png::EncodingError> {
        let mut encoder = png::Encoder::new(bytes, self.width, self.height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Fast);
        encoder.set_filter(png::Filter::Adaptive);
        encoder.set_pixel_dims(Some(png::PixelDimensions {
            xppu: of_a_metre,
            yppu: of_a_metre,
            unit: png::Unit::Meter,
        }));
        encoder.add_itxt_chunk(keyword.to_owned(), text.to_owned())?;
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.rgba)?;
        writer.finish()
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
