//! Encodings of a unit normal with an ambient coefficient.

use glam::{DVec2, DVec3};

/// Smallest coefficient of the length form: a zero vector has no direction.
pub const SMALLEST_AMBIENT: f64 = 1.0 / 255.0;

/// The paper's form (section 3.2): the normal scaled by `k_a`, which is clamped to
/// [`SMALLEST_AMBIENT`] from below.
#[must_use]
pub fn encode_length(normal: DVec3, ambient: f64) -> [f32; 3] {
    (normal * ambient.clamp(SMALLEST_AMBIENT, 1.0))
        .as_vec3()
        .to_array()
}

/// Normal and coefficient of the length form; (+z, 0) for the zero vector.
#[must_use]
pub fn decode_length(encoded: [f32; 3]) -> (DVec3, f64) {
    let v = DVec3::from(encoded.map(f64::from));
    let ambient = v.length();
    (v.try_normalize().unwrap_or(DVec3::Z), ambient)
}

/// Unit vector to the square \[-1,1\]^2 (Meyer et al. 2010, On Floating-Point Normal Vectors).
#[must_use]
pub fn encode_octahedral(n: DVec3) -> DVec2 {
    let p = n.truncate() / n.abs().element_sum();
    if n.z >= 0.0 {
        p
    } else {
        DVec2::new(
            (1.0 - p.y.abs()) * 1.0_f64.copysign(p.x),
            (1.0 - p.x.abs()) * 1.0_f64.copysign(p.y),
        )
    }
}

/// Inverse of [`encode_octahedral`].
#[must_use]
pub fn decode_octahedral(p: DVec2) -> DVec3 {
    let z = 1.0 - p.x.abs() - p.y.abs();
    let fold = (-z).max(0.0);
    DVec3::new(p.x - fold.copysign(p.x), p.y - fold.copysign(p.y), z).normalize()
}

/// Two words: octahedral normal as 2 x snorm16 (x low), ambient as unorm16 in the low half.
#[must_use]
pub fn encode_packed16(normal: DVec3, ambient: f64) -> [u32; 2] {
    let p = encode_octahedral(normal);
    [snorm(p.x, 16) | snorm(p.y, 16) << 16, unorm(ambient, 16)]
}

/// Inverse of [`encode_packed16`].
#[must_use]
pub fn decode_packed16(words: [u32; 2]) -> (DVec3, f64) {
    let p = DVec2::new(
        from_snorm(words[0] & 0xffff, 16),
        from_snorm(words[0] >> 16, 16),
    );
    (decode_octahedral(p), f64::from(words[1] & 0xffff) / 65535.0)
}

/// One word: octahedral normal as 2 x snorm8, ambient as unorm8 above them; the top byte is 0.
#[must_use]
pub fn encode_packed8(normal: DVec3, ambient: f64) -> u32 {
    let p = encode_octahedral(normal);
    snorm(p.x, 8) | snorm(p.y, 8) << 8 | unorm(ambient, 8) << 16
}

/// Inverse of [`encode_packed8`].
#[must_use]
pub fn decode_packed8(word: u32) -> (DVec3, f64) {
    let p = DVec2::new(from_snorm(word & 0xff, 8), from_snorm(word >> 8 & 0xff, 8));
    (decode_octahedral(p), f64::from(word >> 16 & 0xff) / 255.0)
}

/// Signed normalised integer of `bits` bits in two's complement, rounded half away from zero.
fn snorm(value: f64, bits: u32) -> u32 {
    let limit = f64::from((1u32 << (bits - 1)) - 1);
    let integer = (value.clamp(-1.0, 1.0) * limit).round() as i32;
    integer as u32 & ((1 << bits) - 1)
}

fn from_snorm(word: u32, bits: u32) -> f64 {
    let limit = f64::from((1u32 << (bits - 1)) - 1);
    let shift = 32 - bits;
    let integer = (word << shift) as i32 >> shift;
    (f64::from(integer) / limit).max(-1.0)
}

fn unorm(value: f64, bits: u32) -> u32 {
    (value.clamp(0.0, 1.0) * f64::from((1u32 << bits) - 1)).round() as u32
}
