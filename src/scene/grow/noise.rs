//! Periodic value noise for the drawn textures.

/// Smooth noise in \[0, 1\] on a lattice that repeats after `period` cells in x and y.
pub(crate) fn value(x: f32, y: f32, period: [i32; 2], seed: u32) -> f32 {
    let (fx, fy) = (x.floor(), y.floor());
    let (ix, iy) = (fx as i32, fy as i32);
    let (tx, ty) = (fade(x - fx), fade(y - fy));
    let corner = |dx: i32, dy: i32| {
        lattice(
            (ix + dx).rem_euclid(period[0]),
            (iy + dy).rem_euclid(period[1]),
            seed,
        )
    };
    let low = corner(0, 0) + (corner(1, 0) - corner(0, 0)) * tx;
    let high = corner(0, 1) + (corner(1, 1) - corner(0, 1)) * tx;
    low + (high - low) * ty
}

/// Sum of four octaves of [`value`], in \[0, 1\]; `u` and `v` in \[0, 1) span one period.
pub(crate) fn fractal(u: f32, v: f32, cells: [i32; 2], seed: u32) -> f32 {
    let mut sum = 0.0;
    let mut weight = 0.5;
    let mut cells = cells;
    for octave in 0..4 {
        sum += weight
            * value(
                u * cells[0] as f32,
                v * cells[1] as f32,
                cells,
                seed + octave,
            );
        weight *= 0.5;
        cells = cells.map(|c| c * 2);
    }
    sum / (1.0 - 0.0625)
}

fn fade(t: f32) -> f32 {
    t * t * (3.0 - 2.0 * t)
}

fn lattice(x: i32, y: i32, seed: u32) -> f32 {
    let mut h = (x as u32).wrapping_mul(0x9e37_79b1)
        ^ (y as u32).wrapping_mul(0x85eb_ca77)
        ^ seed.wrapping_mul(0xc2b2_ae3d);
    h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
    h = (h ^ (h >> 12)).wrapping_mul(0x297a_2d39);
    h ^= h >> 15;
    (h >> 8) as f32 / 16_777_216.0
}

/// A texture's pixels from a function of (u, v) at pixel centres to sRGB in \[0, 1\].
pub(super) fn draw(size: [u32; 2], color: impl Fn(f32, f32) -> [f32; 3]) -> Vec<u8> {
    let mut pixels = Vec::with_capacity((size[0] * size[1] * 4) as usize);
    for y in 0..size[1] {
        for x in 0..size[0] {
            let u = (x as f32 + 0.5) / size[0] as f32;
            let v = (y as f32 + 0.5) / size[1] as f32;
            let rgb = color(u, v);
            pixels.extend(rgb.map(|c| (c.clamp(0.0, 1.0) * 255.0 + 0.5) as u8));
            pixels.push(255);
        }
    }
    pixels
}

/// Between two colours.
pub(super) fn blend(a: [f32; 3], b: [f32; 3], t: f32) -> [f32; 3] {
    let t = t.clamp(0.0, 1.0);
    [0, 1, 2].map(|i| a[i] + (b[i] - a[i]) * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_repeats_and_stays_in_range() {
        for i in 0..100 {
            let t = i as f32 * 0.013;
            let a = fractal(t, 0.3, [4, 8], 5);
            assert!((0.0..=1.0).contains(&a));
            assert!((a - fractal(t + 1.0, 1.3, [4, 8], 5)).abs() < 1e-3);
        }
    }
}
