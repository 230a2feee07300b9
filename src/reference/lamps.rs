//! Visibility of lamps, and their light on a pixel.
//!
//! Twin of `shaders/leaf/lamp_rays.comp`, `lamp_count.comp`, `lit_lamps.comp` and
//! `shaders/include/lamp.glsl`.

use glam::DVec3;

use super::lit::{leaf_for_light, leaf_scatters};
use super::rays::Triangles;
use crate::abi::{LAMP_REACH, LampRecord, LeafSides, LeafTurn, Receiver};

/// Cosine at the lamp over the squared distance; `to` leads from the surface to a point of it.
#[must_use]
pub fn lamp_falloff(to: DVec3, lamp: &LampRecord) -> f64 {
    let squared = to.length_squared().max(1e-30);
    let cosine = -to.dot(vector(lamp.normal)) / squared.sqrt();
    cosine.max(0.0) / squared.max(f64::from(lamp.least))
}

/// Share of the lamp's light that reaches `receiver`, by all of its points.
#[must_use]
pub fn visibility(
    triangles: &Triangles,
    receiver: &Receiver,
    (lamp, points): (&LampRecord, &[[f32; 3]]),
    offset: f64,
) -> f64 {
    let (place, facing) = (vector(receiver.position), vector(receiver.facing));
    let (mut open, mut all) = (0.0, 0.0);
    for &point in points {
        let point = vector(point);
        let to = point - place;
        let side = if to.dot(facing) < 0.0 {
            -offset
        } else {
            offset
        };
        let origin = place + side * facing;
        let cosine = to.dot(vector(receiver.normal)).abs() / to.length();
        let weight = cosine * lamp_falloff(to, lamp);
        let hit = triangles.nearest(origin, point - origin, f64::from(LAMP_REACH), |_| true);
        all += weight;
        open += if hit.is_none() { weight } else { 0.0 };
    }
    if all > 0.0 { open / all } else { 0.0 }
}

/// Light of a lamp that a leaf scatters to the eye where nothing hides the lamp.
#[must_use]
pub fn scattered(
    (lamp, points): (&LampRecord, &[[f32; 3]]),
    (leaf, gloss, turns): (&LeafSides, [f32; 4], &[LeafTurn]),
    (place, normal, to_eye): (DVec3, DVec3, DVec3),
) -> DVec3 {
    let first = lamp.first_point as usize;
    let own = &points[first..first + lamp.points as usize];
    let light = own.iter().map(|&point| {
        let to = vector(point) - place;
        let towards = to / to.length().max(1e-15);
        let leaf = leaf_for_light(leaf, turns, normal.dot(towards));
        lamp_falloff(to, lamp) * leaf_scatters(&leaf, gloss, normal, (towards, to_eye))
    });
    vector(lamp.intensity) * light.sum::<DVec3>()
}

fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from(v.map(f64::from))
}
