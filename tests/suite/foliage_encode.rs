//! Encodings of normal and ambient: their errors, stated.

use glam::DVec3;
use umbrage::math::sampling::{fibonacci_directions, uniform};
use umbrage::reference::encode::{
    SMALLEST_AMBIENT, decode_length, decode_octahedral, decode_packed8, decode_packed16,
    encode_length, encode_octahedral, encode_packed8, encode_packed16,
};

/// Largest error of (normal in degrees, ambient) of an encoding over many pairs.
fn largest_error(round_trip: impl Fn(DVec3, f64) -> (DVec3, f64)) -> (f64, f64) {
    let mut directions = fibonacci_directions(20_000);
    for x in -1i8..=1 {
        for y in -1i8..=1 {
            for z in -1i8..=1 {
                let d = DVec3::new(f64::from(x), f64::from(y), f64::from(z));
                directions.extend(d.try_normalize());
            }
        }
    }
    let (mut angle, mut ambient) = (0.0_f64, 0.0_f64);
    for (i, n) in directions.into_iter().enumerate() {
        let k = uniform(1, i as u32).max(SMALLEST_AMBIENT);
        let (m, l) = round_trip(n, k);
        assert!((m.length() - 1.0).abs() < 1e-12);
        angle = angle.max(n.cross(m).length().atan2(n.dot(m)).to_degrees());
        ambient = ambient.max((k - l).abs());
    }
    (angle, ambient)
}

#[test]
fn errors_stay_below_what_the_docs_state() {
    let (angle, ambient) = largest_error(|n, k| decode_length(encode_length(n, k)));
    println!("length     {angle:.2e} degrees {ambient:.2e}");
    assert!(angle < 6e-6 && ambient < 1e-7, "length {angle} {ambient}");

    let (angle, ambient) = largest_error(|n, k| decode_packed16(encode_packed16(n, k)));
    println!("packed16   {angle:.2e} degrees {ambient:.2e}");
    assert!(
        angle < 4e-3 && ambient < 7.7e-6,
        "packed16 {angle} {ambient}"
    );

    let (angle, ambient) = largest_error(|n, k| decode_packed8(encode_packed8(n, k)));
    println!("packed8    {angle:.2e} degrees {ambient:.2e}");
    assert!(
        angle < 1.0 && ambient < 1.97e-3,
        "packed8 {angle} {ambient}"
    );
}

#[test]
fn the_octahedral_map_is_its_own_inverse() {
    for n in fibonacci_directions(2000) {
        let p = encode_octahedral(n);
        assert!(p.abs().max_element() <= 1.0);
        assert!(decode_octahedral(p).distance(n) < 1e-12);
    }
    for n in [
        DVec3::X,
        DVec3::Y,
        DVec3::Z,
        -DVec3::X,
        -DVec3::Y,
        -DVec3::Z,
    ] {
        assert_eq!(decode_packed16(encode_packed16(n, 1.0)), (n, 1.0));
        assert_eq!(decode_packed8(encode_packed8(n, 0.0)), (n, 0.0));
    }
}

#[test]
fn the_length_form_keeps_a_direction_at_zero_ambient() {
    let (n, k) = decode_length(encode_length(DVec3::Y, 0.0));
    assert_eq!(n, DVec3::Y);
    assert!((k - SMALLEST_AMBIENT).abs() < 1e-9);
    assert_eq!(decode_length([0.0; 3]), (DVec3::Z, 0.0));
}

/// Why decoding stands before interpolation: the mean of encoded vectors is too short.
#[test]
fn averaging_encoded_vectors_darkens() {
    let encoded = [DVec3::X, DVec3::Y].map(|n| encode_length(n, 0.8));
    let mean = [0, 1, 2].map(|a| 0.5 * (encoded[0][a] + encoded[1][a]));
    let (_, k) = decode_length(mean);
    assert!(
        (k - 0.8 * 0.5_f64.sqrt()).abs() < 1e-6,
        "30 % too dark at right angles: {k}"
    );
}
