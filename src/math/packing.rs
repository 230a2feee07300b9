//! Unit vectors and coefficients in few bits.
//!
//! Octahedral map: Cigolle et al. 2014, A Survey of Efficient Representations for Independent Unit
//! Vectors. `shaders/include/packing.glsl` is the other half.

use glam::{Vec2, Vec3};

/// Steps of a 16-bit signed normalised component.
const SNORM16: f32 = 32767.0;
/// Steps of an 8-bit signed normalised component.
const SNORM8: f32 = 127.0;
/// Steps of a 16-bit unsigned normalised component.
const UNORM16: f32 = 65535.0;

fn sign_not_zero(v: Vec2) -> Vec2 {
    Vec2::new(1f32.copysign(v.x), 1f32.copysign(v.y))
}

/// Unit vector to the square \[-1,1\]^2. The zero vector maps to +y's pole like any other
/// degenerate input, so that decoding never yields NaN.
#[must_use]
pub fn octahedral_encode(v: Vec3) -> Vec2 {
    let sum = v.x.abs() + v.y.abs() + v.z.abs();
    if !(sum > 0.0 && sum.is_finite()) {
        return octahedral_encode(Vec3::Y);
    }
    let p = Vec2::new(v.x, v.y) / sum;
    if v.z < 0.0 {
        (Vec2::ONE - Vec2::new(p.y, p.x).abs()) * sign_not_zero(p)
    } else {
        p
    }
}

/// Square \[-1,1\]^2 to unit vector.
#[must_use]
pub fn octahedral_decode(e: Vec2) -> Vec3 {
    let z = 1.0 - e.x.abs() - e.y.abs();
    let fold = (-z).max(0.0);
    let p = e - sign_not_zero(e) * fold;
    Vec3::new(p.x, p.y, z).normalize()
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "clamped to the range of the integer before the cast"
)]
fn snorm(v: f32, steps: f32) -> i32 {
    (v.clamp(-1.0, 1.0) * steps).round() as i32
}

/// 2 x 16-bit signed normalised octahedral normal; x in the low half. Angular error below
/// 0.004 degrees.
#[must_use]
pub fn pack_normal16(v: Vec3) -> u32 {
    let e = octahedral_encode(v);
    let half = |c: f32| (snorm(c, SNORM16) as u32) & 0xffff;
    half(e.x) | (half(e.y) << 16)
}

/// Inverse of [`pack_normal16`].
#[must_use]
pub fn unpack_normal16(bits: u32) -> Vec3 {
    let half = |h: u32| (f32::from((h & 0xffff) as u16 as i16) / SNORM16).max(-1.0);
    octahedral_decode(Vec2::new(half(bits), half(bits >> 16)))
}

/// 2 x 8-bit signed normalised octahedral normal in the low 16 bits. Angular error below 1 degree.
#[must_use]
pub fn pack_normal8(v: Vec3) -> u32 {
    let e = octahedral_encode(v);
    let byte = |c: f32| (snorm(c, SNORM8) as u32) & 0xff;
    byte(e.x) | (byte(e.y) << 8)
}

/// Inverse of [`pack_normal8`].
#[must_use]
pub fn unpack_normal8(bits: u32) -> Vec3 {
    let byte = |h: u32| (f32::from((h & 0xff) as u8 as i8) / SNORM8).max(-1.0);
    octahedral_decode(Vec2::new(byte(bits), byte(bits >> 8)))
}

/// Coefficient in \[0,1\] to 16 bits; NaN gives 0.
#[must_use]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped to the range of the integer before the cast"
)]
pub fn pack_unorm16(v: f32) -> u32 {
    (v.clamp(0.0, 1.0) * UNORM16).round() as u32
}

/// Inverse of [`pack_unorm16`]; bits above the lowest 16 are ignored.
#[must_use]
pub fn unpack_unorm16(bits: u32) -> f32 {
    (bits & 0xffff) as f32 / UNORM16
}

/// Nearest 16-bit float (IEEE 754 binary16), ties to even; too large becomes infinity.
#[must_use]
pub fn f32_to_f16(v: f32) -> u16 {
    let bits = v.to_bits();
    let sign = ((bits >> 16) & 0x8000) as u16;
    let magnitude = bits & 0x7fff_ffff;
    if magnitude > 0x7f80_0000 {
        return sign | 0x7e00; // NaN
    }
    if magnitude >= 0x4780_0000 {
        return sign | 0x7c00; // 65536 and more
    }
    // Adding a power of two lets the f32 unit itself round to the 10 bits that remain: for normal
    // halves one 13 binary places above the value, for subnormal ones always 0.5 (2^-1).
    let exponent = (magnitude >> 23).max(113);
    let magic = f32::from_bits((exponent + 13) << 23);
    let rounded = f32::from_bits(magnitude) + magic;
    let mantissa = rounded.to_bits() - magic.to_bits();
    // A mantissa of 2^10 or more carries the implicit one into the exponent field.
    sign | (((exponent - 113) << 10) + mantissa) as u16
}

/// Value of a 16-bit float.
#[must_use]
pub fn f16_to_f32(bits: u16) -> f32 {
    let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
    let exponent = i32::from((bits >> 10) & 0x1f);
    let mantissa = f32::from(bits & 0x3ff);
    sign * match exponent {
        0 => mantissa * 2f32.powi(-24),
        31 if mantissa == 0.0 => f32::INFINITY,
        31 => f32::NAN,
        _ => (1.0 + mantissa / 1024.0) * 2f32.powi(exponent - 15),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Evenly spread directions (Fibonacci spiral) plus every axis and diagonal.
    fn directions() -> impl Iterator<Item = Vec3> {
        let spiral = (0..20_000).map(|i| {
            let z = 1.0 - (2.0 * i as f32 + 1.0) / 20_000.0;
            let a = i as f32 * 2.399_963;
            let r = (1.0 - z * z).max(0.0).sqrt();
            Vec3::new(r * a.cos(), r * a.sin(), z)
        });
        let corners = (0..27)
            .map(|i| {
                Vec3::new(
                    (i % 3 - 1) as f32,
                    (i / 3 % 3 - 1) as f32,
                    (i / 9 - 1) as f32,
                )
            })
            .filter(|v| *v != Vec3::ZERO)
            .map(Vec3::normalize);
        spiral.chain(corners)
    }

    fn worst_degrees(round_trip: impl Fn(Vec3) -> Vec3) -> f64 {
        directions()
            .map(|v| {
                let (a, b) = (v.as_dvec3(), round_trip(v).as_dvec3());
                a.cross(b).length().atan2(a.dot(b)).to_degrees()
            })
            .fold(0.0, f64::max)
    }

    #[test]
    fn stated_angular_errors_hold() {
        let wide = worst_degrees(|v| unpack_normal16(pack_normal16(v)));
        let narrow = worst_degrees(|v| unpack_normal8(pack_normal8(v)));
        assert!(wide < 0.004, "2x16: {wide} degrees");
        assert!(narrow < 1.0, "2x8: {narrow} degrees");
    }

    #[test]
    fn degenerate_vectors_decode_to_unit_vectors() {
        for v in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
            assert!(unpack_normal16(pack_normal16(v)).is_normalized(), "{v}");
        }
    }

    #[test]
    fn coefficients_round_within_half_a_step() {
        for i in 0..=1000 {
            let v = i as f32 / 1000.0;
            let back = unpack_unorm16(pack_unorm16(v));
            assert!((back - v).abs() <= 0.5 / UNORM16 + 1e-7, "{v} -> {back}");
        }
        assert_eq!(pack_unorm16(f32::NAN), 0, "NaN has no coefficient");
    }

    #[test]
    fn halves_survive_the_way_to_f32_and_back() {
        for bits in (0..=u16::MAX).filter(|b| !f16_to_f32(*b).is_nan()) {
            assert_eq!(f32_to_f16(f16_to_f32(bits)), bits, "{bits:#x}");
        }
        assert_eq!(
            f16_to_f32(f32_to_f16(1.0 + 1.0 / 4096.0)),
            1.0,
            "rounds down"
        );
        assert_eq!(
            f16_to_f32(f32_to_f16(1.0 + 3.0 / 4096.0)),
            1.0 + 1.0 / 1024.0
        );
        assert!(f16_to_f32(f32_to_f16(f32::NAN)).is_nan());
        assert_eq!(f16_to_f32(f32_to_f16(1e9)), f32::INFINITY);
    }
}
