//! What stage 1 leaves per pixel, in host memory, and pictures of it.

use glam::{Vec3, Vec4};

use super::image::Picture;
use super::plan::Channel;
use crate::math::colour::srgb8_to_linear;
use crate::math::packing::f16_to_f32;

/// Decoded channels, row by row from the top left; those that were not planned are empty.
#[derive(Debug, Clone, Default)]
pub struct GBuffer {
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Unit shading normal (world) and ambient coefficient; zero where nothing is.
    pub normal: Vec<Vec4>,
    /// Linear eye depth, metres; 0 where nothing is.
    pub depth: Vec<f32>,
    /// Linear base colour, and 1 in w where something is.
    pub albedo: Vec<Vec4>,
    /// Light by eq. 1, linear, without exposure, and the sun's shadow term.
    pub shade: Vec<Vec4>,
}

/// Background of attribute pictures, sRGB.
const PAPER: [u8; 4] = [236, 236, 233, 255];

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped to a byte's range"
)]
fn byte(v: f32) -> u8 {
    (v.clamp(0.0, 1.0) * 255.0).round() as u8
}

impl GBuffer {
    pub(super) fn new(size: [u32; 2]) -> Self {
        Self {
            size,
            ..Self::default()
        }
    }

    /// Takes the bytes of one channel's image.
    pub(super) fn decode(&mut self, channel: Channel, bytes: &[u8]) {
        let halves = || {
            bytes
                .chunks_exact(8)
                .map(|p| {
                    Vec4::from_array(
                        [0, 2, 4, 6].map(|i| f16_to_f32(u16::from_le_bytes([p[i], p[i + 1]]))),
                    )
                })
                .collect()
        };
        match channel {
            Channel::Normal => self.normal = halves(),
            Channel::Shade => self.shade = halves(),
            Channel::Depth => {
                self.depth = bytes
                    .chunks_exact(4)
                    .map(|p| f32::from_le_bytes([p[0], p[1], p[2], p[3]]))
                    .collect();
            }
            Channel::Albedo => {
                self.albedo = bytes
                    .chunks_exact(4)
                    .map(|p| {
                        let [r, g, b] = [p[0], p[1], p[2]].map(srgb8_to_linear);
                        Vec4::new(r, g, b, f32::from(p[3]) / 255.0)
                    })
                    .collect();
            }
        }
    }

    fn picture(&self, pixels: impl Iterator<Item = Option<[u8; 3]>>) -> Picture {
        let rgba = pixels
            .flat_map(|p| p.map_or(PAPER, |[r, g, b]| [r, g, b, 255]))
            .collect();
        Picture {
            width: self.size[0],
            height: self.size[1],
            rgba,
        }
    }

    /// Normals as colours, -1..1 mapped to 0..255 (figure 7 of the paper).
    #[must_use]
    pub fn normals_picture(&self) -> Picture {
        self.picture(self.normal.iter().map(|n| {
            let n = n.truncate();
            (n != Vec3::ZERO).then(|| (n * 0.5 + 0.5).to_array().map(byte))
        }))
    }

    /// Eye depth from white (nearest) to dark (farthest) over the range that occurs.
    #[must_use]
    pub fn depth_picture(&self) -> Picture {
        let seen = || self.depth.iter().copied().filter(|d| *d > 0.0);
        let (near, far) = seen().fold((f32::INFINITY, 0.0f32), |(a, b), d| (a.min(d), b.max(d)));
        let span = (far - near).max(f32::MIN_POSITIVE);
        self.picture(
            self.depth
                .iter()
                .map(|&d| (d > 0.0).then(|| [byte(1.0 - 0.88 * (d - near) / span); 3])),
        )
    }
}
