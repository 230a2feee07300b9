//! Visibility of a disc of light.
//!
//! Twin of `shaders/leaf/lvc_rays.comp` and `lvc_count.comp`.

use glam::DVec3;

use super::rays::Triangles;
use crate::abi::Receiver;
use crate::math::sampling::frame;

/// Golden angle, radians.
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

/// Direction number `sample` of `samples` that fill a disc about `centre` evenly.
#[must_use]
pub fn disc_direction(centre: DVec3, sin_radius: f64, sample: u32, samples: u32) -> DVec3 {
    let along = f64::from(sample) + 0.5;
    let radius = sin_radius * (along / f64::from(samples)).sqrt();
    let (sin, cos) = (along * GOLDEN_ANGLE).sin_cos();
    (frame(centre) * DVec3::new(radius * cos, radius * sin, 1.0)).normalize()
}

/// Share of the disc that `receiver` sees, by all samples.
#[must_use]
pub fn visibility(
    triangles: &Triangles,
    receiver: &Receiver,
    centre: DVec3,
    (sin_radius, samples, offset): (f64, u32, f64),
) -> f64 {
    let vector = |v: [f32; 3]| DVec3::from(v.map(f64::from));
    let facing = vector(receiver.facing);
    let side = if centre.dot(facing) < 0.0 {
        -offset
    } else {
        offset
    };
    let origin = vector(receiver.position) + side * facing;
    let open = (0..samples)
        .map(|i| disc_direction(centre, sin_radius, i, samples))
        .filter(|&d| triangles.nearest(origin, d, 1e30, |_| true).is_none())
        .count();
    open as f64 / f64::from(samples)
}
