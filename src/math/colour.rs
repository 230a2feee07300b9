//! Transfer functions of sRGB (IEC 61966-2-1) and a heat map.

use std::sync::LazyLock;

/// sRGB component in \[0,1\] to linear light.
#[must_use]
pub fn srgb_to_linear(s: f32) -> f32 {
    if s <= 0.040_45 {
        s / 12.92
    } else {
        ((s + 0.055) / 1.055).powf(2.4)
    }
}

/// Linear light to an sRGB component; the result is in \[0,1\] when the input is.
#[must_use]
pub fn linear_to_srgb(l: f32) -> f32 {
    if l <= 0.003_130_8 {
        l * 12.92
    } else {
        1.055 * l.powf(1.0 / 2.4) - 0.055
    }
}

static LINEAR_OF_BYTE: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|i| srgb_to_linear(i as f32 / 255.0)));

/// sRGB byte to linear light, by table.
#[must_use]
pub fn srgb8_to_linear(byte: u8) -> f32 {
    LINEAR_OF_BYTE[usize::from(byte)]
}

/// Number of intervals of the table behind [`linear_to_srgb8`].
const BYTE_TABLE: usize = 4096;

/// For equal steps of linear light: the byte at the step's lower end.
static BYTE_OF_LINEAR: LazyLock<Vec<u8>> = LazyLock::new(|| {
    (0..=BYTE_TABLE)
        .map(|i| exact_byte(i as f32 / BYTE_TABLE as f32))
        .collect()
});

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped to a byte's range"
)]
fn exact_byte(l: f32) -> u8 {
    (linear_to_srgb(l.clamp(0.0, 1.0)) * 255.0).round() as u8
}

/// Linear light to the nearest sRGB byte (rounding in sRGB); clamps to \[0,1\].
#[must_use]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped to the table's range"
)]
pub fn linear_to_srgb8(l: f32) -> u8 {
    let l = if l > 0.0 { l.min(1.0) } else { 0.0 };
    let at = (l * BYTE_TABLE as f32) as usize;
    let table = &*BYTE_OF_LINEAR;
    let (low, high) = (table[at], table[(at + 1).min(BYTE_TABLE)]);
    // Most intervals hold one byte value; only where two meet is the curve itself needed.
    if low == high { low } else { exact_byte(l) }
}

/// Heat map for values in \[0,1\]: dark violet through red and orange to pale yellow, of rising
/// lightness, so that it also reads in grey. Returns sRGB in \[0,1\].
#[must_use]
pub fn heat(value: f32) -> [f32; 3] {
    const STOPS: [[f32; 3]; 6] = [
        [0.04, 0.03, 0.12],
        [0.29, 0.08, 0.42],
        [0.60, 0.16, 0.40],
        [0.87, 0.33, 0.23],
        [0.98, 0.62, 0.15],
        [0.98, 0.98, 0.68],
    ];
    let at = if value.is_nan() {
        0.0
    } else {
        value.clamp(0.0, 1.0)
    } * (STOPS.len() - 1) as f32;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 0 and the number of stops"
    )]
    let i = (at as usize).min(STOPS.len() - 2);
    let t = at - i as f32;
    std::array::from_fn(|c| STOPS[i][c] * (1.0 - t) + STOPS[i + 1][c] * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_survive_the_way_to_linear_and_back() {
        for byte in 0..=255 {
            assert_eq!(linear_to_srgb8(srgb8_to_linear(byte)), byte);
        }
    }

    #[test]
    fn table_agrees_with_the_curve() {
        for i in 0..=100_000 {
            let l = i as f32 / 100_000.0;
            assert_eq!(linear_to_srgb8(l), exact_byte(l), "{l}");
        }
        assert_eq!(linear_to_srgb8(f32::NAN), 0);
        assert_eq!(linear_to_srgb8(7.0), 255);
    }

    #[test]
    fn heat_map_rises_in_lightness() {
        let light = |v| {
            let [r, g, b] = heat(v).map(srgb_to_linear);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        for i in 0..50 {
            assert!(light(i as f32 / 50.0) < light((i + 1) as f32 / 50.0), "{i}");
        }
    }
}
