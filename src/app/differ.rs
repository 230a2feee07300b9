//! Two drawings of one view compared: attributes, lines, the picture.

use crate::ink::plan::Attribute;
use crate::ink::renderer::Drawing;
use crate::math::colour::linear_to_srgb8;
use crate::math::packing::f16_to_f32;

/// Steps of 255 up to which two pixels look alike.
pub const ALIKE: u8 = 2;

/// Pixels of two drawings that differ, as shares of those that are compared.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Share {
    /// Pixels that differ.
    pub differing: usize,
    /// Pixels that were compared.
    pub of: usize,
}

impl Share {
    /// 0 to 1; 0 of nothing.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.differing as f64 / self.of.max(1) as f64
    }
}

/// Pixels (row by row) at which two drawings show the same: their ids agree in every bit. All of
/// them where ids were not read back.
#[must_use]
pub fn same_surface(a: &Drawing, b: &Drawing) -> Vec<bool> {
    let find = |d: &Drawing| d.attributes.iter().position(|t| t.0 == Attribute::Ids);
    let pixels = (a.size[0] * a.size[1]) as usize;
    match (find(a), find(b)) {
        (Some(i), Some(j)) => {
            let (a, b) = (&a.attributes[i].1, &b.attributes[j].1);
            let pairs = a.chunks_exact(8).zip(b.chunks_exact(8));
            pairs.map(|(a, b)| a == b).collect()
        }
        _ => vec![true; pixels],
    }
}

/// Pixels about which all within `reach` pixels along both axes are in `of`.
#[must_use]
pub fn within(of: &[bool], [width, height]: [u32; 2], reach: usize) -> Vec<bool> {
    let (width, height) = (width as usize, height as usize);
    // A window all of whose pixels are set, along one axis and then along the other.
    let along = |set: &[bool], count: usize, lines: usize, step: usize, across: usize| {
        let mut out = vec![true; set.len()];
        for line in 0..lines {
            let at = |i: usize| line * across + i * step;
            for i in 0..count {
                let window = i.saturating_sub(reach)..(i + reach + 1).min(count);
                out[at(i)] = window.into_iter().all(|k| set[at(k)]);
            }
        }
        out
    };
    let rows = along(of, width, height, 1, width);
    along(&rows, height, width, width, 1)
}

/// Pixels of the picture that differ by more than [`ALIKE`] steps of 255, of those of `mask`.
#[must_use]
pub fn picture(a: &Drawing, b: &Drawing, mask: &[bool]) -> Share {
    share(&a.pixels, &b.pixels, 8, mask, |a, b| !alike(a, b))
}

/// Whether two pixels (16-bit floats, linear) are within [`ALIKE`] steps of 255 of each other.
#[must_use]
pub fn alike(a: &[u8], b: &[u8]) -> bool {
    let grey = |pixel: &[u8]| -> [u8; 3] {
        [0, 2, 4].map(|k| linear_to_srgb8(f16_to_f32(u16::from_le_bytes([pixel[k], pixel[k + 1]]))))
    };
    a == b
        || grey(a)
            .iter()
            .zip(grey(b))
            .all(|(a, b)| a.abs_diff(b) <= ALIKE)
}

/// Pixels of two images of `texel` bytes that are not the same in every bit, of those of `mask`.
#[must_use]
pub fn bits(a: &[u8], b: &[u8], texel: usize, mask: &[bool]) -> Share {
    share(a, b, texel, mask, |a, b| a != b)
}

/// Pixels at which an attribute differs by more than `most` of its own unit, of those of `mask`.
/// Depths are compared by their ratio, places in tiles round the tile.
#[must_use]
pub fn attribute(which: Attribute, a: &[u8], b: &[u8], most: f32, mask: &[bool]) -> Share {
    let texel = which.format().bytes() as usize;
    let apart = |a: &[u8], b: &[u8]| {
        let pairs = values(which, a).into_iter().zip(values(which, b));
        let mut channel = pairs.enumerate();
        channel.any(|(k, (a, b))| {
            let away = (a - b).abs();
            let away = match which {
                Attribute::Depth => away / a.abs().max(b.abs()).max(1e-30),
                Attribute::Hatch if k < 2 => away.min((1.0 - away).abs()),
                _ => away,
            };
            away > most
        })
    };
    share(a, b, texel, mask, apart)
}

/// The numbers of a pixel of an attribute.
fn values(which: Attribute, pixel: &[u8]) -> Vec<f32> {
    let halves = |pixel: &[u8]| -> Vec<f32> {
        let pairs = pixel.chunks_exact(2);
        pairs
            .map(|h| f16_to_f32(u16::from_le_bytes([h[0], h[1]])))
            .collect()
    };
    match which {
        Attribute::Albedo => pixel.iter().map(|&v| f32::from(v) / 255.0).collect(),
        Attribute::Depth | Attribute::Ids => bytemuck::pod_collect_to_vec(pixel),
        Attribute::Normal | Attribute::Direction => halves(pixel),
        // The fourth holds nothing.
        Attribute::Hatch => bytemuck::pod_collect_to_vec(&pixel[..12]),
    }
}

fn share(
    a: &[u8],
    b: &[u8],
    texel: usize,
    mask: &[bool],
    apart: impl Fn(&[u8], &[u8]) -> bool,
) -> Share {
    let pixels = a.chunks_exact(texel).zip(b.chunks_exact(texel)).zip(mask);
    let compared = pixels.filter(|(_, within)| **within);
    compared.fold(Share::default(), |sum, ((a, b), _)| Share {
        differing: sum.differing + usize::from(apart(a, b)),
        of: sum.of + 1,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawing(ids: &[[f32; 2]], pixels: &[[u16; 4]]) -> Drawing {
        Drawing {
            size: [ids.len() as u32, 1],
            pixels: bytemuck::cast_slice(pixels).to_vec(),
            passes: Vec::new(),
            attributes: vec![(Attribute::Ids, bytemuck::cast_slice(ids).to_vec())],
            lines: Vec::new(),
            light: Vec::new(),
        }
    }

    #[test]
    fn only_pixels_that_show_the_same_are_compared() {
        let (white, black) = ([0x3c00; 4], [0, 0, 0, 0x3c00]);
        let a = drawing(&[[1.0, 1.0], [1.0, 2.0], [2.0, 1.0]], &[white; 3]);
        let b = drawing(
            &[[1.0, 1.0], [1.0, 3.0], [2.0, 1.0]],
            &[white, black, black],
        );
        let same = same_surface(&a, &b);
        assert_eq!(same, [true, false, true]);
        let all = Share {
            differing: 2,
            of: 3,
        };
        assert_eq!(picture(&a, &b, &[true; 3]), all);
        let some = Share {
            differing: 1,
            of: 2,
        };
        assert_eq!(picture(&a, &b, &same), some);
        assert_eq!(picture(&a, &b, &within(&same, a.size, 1)).of, 0);
        assert_eq!(picture(&a, &a, &same).share(), 0.0);
    }

    #[test]
    fn places_are_compared_round_the_tile_and_depths_by_their_ratio() {
        let place = |u: f32| bytemuck::cast_slice::<f32, u8>(&[u, 0.0, 0.0, 0.0]).to_vec();
        // They lie beside each other in the tile.
        let (low, high) = (place(0.001), place(0.9995));
        let near = attribute(Attribute::Hatch, &low, &high, 0.01, &[true]);
        assert_eq!(near.differing, 0);
        let metres = |v: f32| v.to_le_bytes().to_vec();
        let depth =
            |b: f32| attribute(Attribute::Depth, &metres(1000.0), &metres(b), 1e-3, &[true]);
        assert_eq!((depth(1000.5).differing, depth(1002.0).differing), (0, 1));
    }
}
