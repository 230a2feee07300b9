//! The sun on a pixel.
//!
//! Twin of `shaders/leaf/lit_sun.comp` and `shaders/include/leaf_brdf.glsl`.

use std::f64::consts::PI;

use glam::DVec3;

use super::leaf_glossy::lambda;
use crate::abi::{LEAF_TURN_NODES, LeafSides, LeafTurn, LitFrame};

/// What the first pass leaves for a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pixel {
    /// Light so far.
    pub light: DVec3,
    /// Unit normal of the front.
    pub normal: DVec3,
    /// Visibility of the sun plus 1, negative on the back.
    pub surface: f64,
    /// What the leaf makes of light there; both sides are as the one that is seen.
    pub leaf: LeafSides,
    /// Specular intensity and roughness, below 0 where the lobe keeps the energy.
    pub shine: [f32; 4],
    /// Unit normal of the triangle, towards the eye.
    pub face: DVec3,
}

/// `leaf` for light at `cosine` to the normal of its front, by the factors of its material; none: as
/// it is.
#[must_use]
pub fn leaf_for_light(leaf: &LeafSides, turns: &[LeafTurn], cosine: f64) -> LeafSides {
    if turns.is_empty() {
        return *leaf;
    }
    let cells = f64::from(LEAF_TURN_NODES - 1);
    let at = cosine.abs().min(1.0) * cells;
    let cell = at.floor().min(cells - 1.0);
    let (low, high) = (turns[cell as usize], turns[cell as usize + 1]);
    let mix = |a: [f32; 3], b: [f32; 3]| vector(a).lerp(vector(b), at - cell);
    let times = |rho: [f32; 3], f: DVec3| (vector(rho) * f).as_vec3().to_array();
    let through = if cosine > 0.0 {
        mix(low.down, high.down)
    } else {
        mix(low.up, high.up)
    };
    LeafSides {
        rho_d_front: times(leaf.rho_d_front, mix(low.front, high.front)),
        rho_d_back: times(leaf.rho_d_back, mix(low.back, high.back)),
        rho_t: times(leaf.rho_t, through),
    }
}

/// Beckmann's distribution of slopes over cos^4.
pub(super) fn slope_distribution(cos_h: f64, m: f64) -> f64 {
    let c2 = (cos_h * cos_h).max(1e-8);
    ((1.0 - 1.0 / c2) / (m * m)).exp() / (PI * m * m * c2 * c2)
}

/// Light scattered towards `to_eye` from `to_light`, times the cosine of the light.
#[must_use]
pub fn leaf_scatters(
    leaf: &LeafSides,
    gloss: [f32; 4],
    normal: DVec3,
    (to_light, to_eye): (DVec3, DVec3),
) -> DVec3 {
    let (light, eye) = (normal.dot(to_light), normal.dot(to_eye));
    if light * eye <= 0.0 {
        return vector(leaf.rho_t) * (light.abs() / PI);
    }
    let rho_d = if eye > 0.0 {
        leaf.rho_d_front
    } else {
        leaf.rho_d_back
    };
    let [r, g, b, m] = gloss.map(f64::from);
    let middle = to_light + to_eye;
    let cos_h = normal.dot(middle).abs() / middle.length_squared().max(1e-12).sqrt();
    // A roughness below 0 asks for masking and shadowing, which keep the energy.
    let kept = if m < 0.0 {
        1.0 / (1.0 + lambda(light.abs(), -m) + lambda(eye.abs(), -m))
    } else {
        1.0
    };
    let shine = kept * slope_distribution(cos_h, m) / (4.0 * eye.abs().max(1e-3));
    vector(rho_d) * (light.abs() / PI) + DVec3::new(r, g, b) * shine
}

/// From the eye through the middle of a pixel, of length 1 along the direction of view.
#[must_use]
pub fn view_of_pixel(frame: &LitFrame, (x, y): (u32, u32)) -> DVec3 {
    let on_film = |at: u32, of: u32| 2.0 * (f64::from(at) + 0.5) / f64::from(of) - 1.0;
    vector(frame.forward) + on_film(x, frame.width) * vector(frame.right)
        - on_film(y, frame.height) * vector(frame.up)
}

/// Where the surface of a pixel lies; `depth` is reversed, infinitely far at 0.
#[must_use]
pub fn position_of_pixel(frame: &LitFrame, at: (u32, u32), depth: f64) -> DVec3 {
    vector(frame.eye) + f64::from(frame.near) / depth * view_of_pixel(frame, at)
}

/// Unit vector from the surface of a pixel to the eye, on the side that the sign of `side` tells.
#[must_use]
pub fn to_eye_of_pixel(frame: &LitFrame, at: (u32, u32), normal: DVec3, side: f64) -> DVec3 {
    let to_eye = -view_of_pixel(frame, at).normalize();
    let facing = normal.dot(to_eye);
    if facing * side < 0.0 {
        (to_eye - (1.0 + 1e-3) * facing * normal).normalize()
    } else {
        to_eye
    }
}

/// Light of pixel (`x`, `y`) with the sun.
#[must_use]
pub fn lit_sun(frame: &LitFrame, (x, y): (u32, u32), pixel: &Pixel, turns: &[LeafTurn]) -> DVec3 {
    let to_eye = to_eye_of_pixel(frame, (x, y), pixel.normal, pixel.surface);
    let sun = vector(frame.sun);
    let leaf = leaf_for_light(&pixel.leaf, turns, pixel.normal.dot(sun));
    let scattered = leaf_scatters(&leaf, pixel.shine, pixel.normal, (sun, to_eye));
    let seen = pixel.surface.abs() - 1.0;
    pixel.light + vector(frame.irradiance) * seen * scattered
}

fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from(v.map(f64::from))
}
