//! Elementary functions from additions and multiplications only.
//!
//! The standard library's `sin`, `powf` and friends differ in the last bit between platforms; one
//! such bit can move a count. IEEE 754 fixes `+ - * / sqrt floor`, so what is built from them here
//! gives the same bits everywhere.

use std::f64::consts::{FRAC_PI_2, LN_2, PI};

/// Sine and cosine of an angle in radians, |angle| below about 1e6.
pub(super) fn sin_cos(angle: f64) -> (f64, f64) {
    let turns = (angle / FRAC_PI_2 + 0.5).floor();
    let x = angle - turns * FRAC_PI_2;
    let (s, c) = small_sin_cos(x);
    match turns.rem_euclid(4.0) {
        q if q < 0.5 => (s, c),
        q if q < 1.5 => (c, -s),
        q if q < 2.5 => (-s, -c),
        _ => (-c, s),
    }
}

/// Taylor series on \[-pi/4, pi/4\], to the last bits of f64.
fn small_sin_cos(x: f64) -> (f64, f64) {
    let x2 = x * x;
    let (mut sine, mut cosine) = (0.0, 0.0);
    for k in (1..=9).rev() {
        let n = 2.0 * f64::from(k);
        cosine = -(1.0 + cosine) * x2 / (n * (n - 1.0));
        sine = -(1.0 + sine) * x2 / (n * (n + 1.0));
    }
    (x * (1.0 + sine), 1.0 + cosine)
}

/// Sine and cosine of an angle in degrees.
pub(super) fn sin_cos_degrees(angle: f64) -> (f64, f64) {
    sin_cos(angle * (PI / 180.0))
}

/// Natural logarithm of a positive normal number.
pub(super) fn ln(x: f64) -> f64 {
    let bits = x.to_bits();
    let mut exponent = f64::from((bits >> 52) as u16 & 0x7ff) - 1023.0;
    let mut mantissa = f64::from_bits((bits & 0x000f_ffff_ffff_ffff) | 0x3ff0_0000_0000_0000);
    if mantissa > std::f64::consts::SQRT_2 {
        mantissa *= 0.5;
        exponent += 1.0;
    }
    // ln m = 2 artanh((m-1)/(m+1)), |argument| below 0.172
    let y = (mantissa - 1.0) / (mantissa + 1.0);
    let y2 = y * y;
    let mut sum = 0.0;
    for k in (0..=11).rev() {
        sum = sum * y2 + 1.0 / (2.0 * f64::from(k) + 1.0);
    }
    exponent * LN_2 + 2.0 * y * sum
}

/// Exponential function, argument within ±700.
pub(super) fn exp(x: f64) -> f64 {
    let n = (x / LN_2 + 0.5).floor();
    let y = x - n * LN_2;
    let mut sum = 1.0;
    for k in (1..=16).rev() {
        sum = 1.0 + sum * y / f64::from(k);
    }
    let exponent = (n as i64 + 1023).clamp(1, 2046) as u64;
    sum * f64::from_bits(exponent << 52)
}

/// `base` to the power `exponent` for `base >= 0`.
pub(super) fn pow(base: f64, exponent: f64) -> f64 {
    if base <= f64::MIN_POSITIVE {
        return if exponent == 0.0 { 1.0 } else { 0.0 };
    }
    exp(exponent * ln(base))
}

/// Cubic step from 0 at `low` to 1 at `high`.
pub(super) fn smoothstep(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_standard_library() {
        for i in -2000..2000 {
            let x = f64::from(i) * 0.0137;
            let (s, c) = sin_cos(x);
            assert!((s - x.sin()).abs() < 1e-14, "sin {x}");
            assert!((c - x.cos()).abs() < 1e-14, "cos {x}");
            assert!((exp(x) / x.exp() - 1.0).abs() < 1e-13, "exp {x}");
        }
        for i in 1..2000 {
            let x = f64::from(i) * 0.0173;
            assert!(
                (ln(x) - x.ln()).abs() < 1e-14 * (1.0 + x.ln().abs()),
                "ln {x}"
            );
            assert!((pow(x, 1.3) / x.powf(1.3) - 1.0).abs() < 1e-13, "pow {x}");
        }
        assert_eq!(pow(0.0, 1.2), 0.0);
    }
}
