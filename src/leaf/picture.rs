//! A single leaf as a picture: its maps, and lit from the front and from behind.

use rayon::prelude::*;

use super::appearance::{Face, LeafMaterial, Texel};
use super::glossy::{Shadowing, glossy};
use glam::Vec3;

/// How a leaf is lit and seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lit {
    /// The side that is seen.
    pub face: Face,
    /// Whether the sun is on the other side.
    pub from_behind: bool,
    /// Light of the sun on a plane towards it over that of the sky from each side.
    pub sun: f32,
    /// Irradiance of the sky on either side.
    pub sky: f32,
    /// Masking of the glossy lobe.
    pub shadowing: Shadowing,
}

impl Lit {
    /// A leaf in the sun.
    #[must_use]
    pub fn new(face: Face, from_behind: bool) -> Self {
        Self {
            face,
            from_behind,
            sun: 8.0,
            sky: 1.1,
            shadowing: Shadowing::Safe,
        }
    }
}

/// How far veins stand out, as a slope per texel of a 512-texel map.
const RELIEF: f32 = 26.0;

/// Linear radiance and coverage of every pixel, rows from the top. The leaf lies in the picture's
/// plane, its tip up, a little folded along the midrib; the sun stands at the upper left.
#[must_use]
pub fn lit(leaf: &LeafMaterial, light: &Lit, size: [u32; 2]) -> Vec<[f32; 4]> {
    let other = match light.face {
        Face::Upper => Face::Lower,
        Face::Lower => Face::Upper,
    };
    let seen = leaf.sampler(light.face);
    let back = leaf.sampler(other);
    let side = if light.from_behind { -1.0 } else { 1.0 };
    let to_sun = Vec3::new(-0.52, 0.58, 0.63 * side).normalize();
    let to_viewer = Vec3::Z;
    pixels(size, |uv| {
        let cover = coverage(leaf, uv, 1.0 / size[1] as f32);
        if cover <= 0.0 {
            return [0.0; 4];
        }
        let front = seen.at(uv);
        let rear = back.at(uv);
        let n = normal(leaf, light.face, uv);
        let cos_sun = n.dot(to_sun);
        let mut rgb = [0.0; 3];
        for (c, value) in rgb.iter_mut().enumerate() {
            let sky = light.sky * (front.rho_d[c] + rear.rho_t[c]);
            let sun = if cos_sun > 0.0 {
                let half = (to_sun + to_viewer).normalize();
                let cosines = [cos_sun, n.dot(to_viewer), n.dot(half)].map(f64::from);
                let lobe = glossy(
                    cosines[0],
                    cosines[1],
                    cosines[2],
                    f64::from(front.m),
                    light.shadowing,
                );
                front.rho_d[c] / std::f32::consts::PI * cos_sun + front.rho_s[c] * lobe as f32
            } else {
                rear.rho_t[c] / std::f32::consts::PI * -cos_sun
            };
            *value = sky / std::f32::consts::PI + light.sun * sun;
        }
        [rgb[0], rgb[1], rgb[2], cover]
    })
}

/// Every pixel's colour from its place, (0, 0) at the top left to (1, 1).
fn pixels(size: [u32; 2], colour: impl Fn([f32; 2]) -> [f32; 4] + Sync) -> Vec<[f32; 4]> {
    (0..size[0] as usize * size[1] as usize)
        .into_par_iter()
        .with_min_len(size[0] as usize)
        .map(|i| {
            let (x, y) = (i % size[0] as usize, i / size[0] as usize);
            colour([
                (x as f32 + 0.5) / size[0] as f32,
                (y as f32 + 0.5) / size[1] as f32,
            ])
        })
        .collect()
}

/// What of a map is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MapView {
    /// gamma, half of it as grey or colour: 1 is mid-grey.
    Gamma,
    /// Deviation of the thickness: -1 black, 0 mid-grey, 1 white.
    Thickness,
    /// Intensity of the gloss, times 10.
    Gloss,
    /// Roughness.
    Roughness,
    /// Diffuse reflectance.
    Reflectance,
    /// Diffuse transmittance.
    Transmittance,
}

/// Linear values and coverage of a map, rows from the top.
#[must_use]
pub fn map(leaf: &LeafMaterial, face: Face, view: MapView, size: [u32; 2]) -> Vec<[f32; 4]> {
    let sampler = leaf.sampler(face);
    pixels(size, |uv| {
        let cover = coverage(leaf, uv, 1.0 / size[1] as f32);
        let texel = nearest(leaf, face, uv);
        let rgb = match view {
            // Shown as numbers: grey levels in sRGB are the values.
            MapView::Gamma => texel.gamma.map(|g| level(0.5 * g)),
            MapView::Thickness => [level(0.5 + 0.5 * texel.delta); 3],
            MapView::Gloss => texel.rho_s.map(|s| level(10.0 * s)),
            MapView::Roughness => [level(texel.m); 3],
            MapView::Reflectance => sampler.at(uv).rho_d.map(|v| 2.5 * v),
            MapView::Transmittance => sampler.at(uv).rho_t.map(|v| 2.5 * v),
        };
        [rgb[0], rgb[1], rgb[2], cover]
    })
}

/// A number that is to be read off a picture: its sRGB value.
fn level(v: f32) -> f32 {
    crate::math::colour::srgb_to_linear(v.clamp(0.0, 1.0))
}

fn index(leaf: &LeafMaterial, uv: [f32; 2]) -> usize {
    let Some(size) = leaf.size() else { return 0 };
    let at = |t: f32, n: u32| ((t.clamp(0.0, 1.0) * n as f32) as u32).min(n - 1) as usize;
    at(uv[1], size[1]) * size[0] as usize + at(uv[0], size[0])
}

fn nearest(leaf: &LeafMaterial, face: Face, uv: [f32; 2]) -> Texel {
    leaf.side(face).texel(index(leaf, uv))
}

/// Coverage over a pixel of the given height, from 3 x 3 places.
fn coverage(leaf: &LeafMaterial, uv: [f32; 2], pixel: f32) -> f32 {
    if leaf.mask.is_none() {
        return 1.0;
    }
    let mut sum = 0.0;
    for j in [-0.33, 0.0, 0.33] {
        for i in [-0.33, 0.0, 0.33] {
            sum += leaf.coverage(index(leaf, [uv[0] + i * pixel, uv[1] + j * pixel]));
        }
    }
    sum / 9.0
}

/// The normal towards the viewer: a fold along the midrib, and veins as the thickness has them:
/// furrows above, ridges below.
fn normal(leaf: &LeafMaterial, face: Face, uv: [f32; 2]) -> Vec3 {
    let step = leaf
        .size()
        .map_or(1.0 / 512.0, |s| 1.0 / s[1].max(2) as f32);
    let height =
        |du: f32, dv: f32| nearest(leaf, face, [uv[0] + du * step, uv[1] + dv * step]).delta;
    let ridge = match face {
        Face::Upper => -0.35,
        Face::Lower => 1.0,
    };
    let slope = |a: f32, b: f32| ridge * RELIEF * 0.5 * (a - b) * step;
    let dx = slope(height(1.5, 0.0), height(-1.5, 0.0));
    let dy = slope(height(0.0, -1.5), height(0.0, 1.5));
    let fold = 0.14 * ((uv[0] - 0.5) * 9.0).clamp(-1.0, 1.0);
    let arch = 0.4 * (uv[1] - 0.5);
    Vec3::new(fold - dx, arch - dy, 1.0).normalize()
}

/// Over a background of one linear colour, as sRGB bytes with alpha 255.
#[must_use]
pub fn over(pixels: &[[f32; 4]], background: f32) -> Vec<u8> {
    pixels
        .iter()
        .flat_map(|p| {
            let mix =
                |v: f32| crate::math::colour::linear_to_srgb8(v * p[3] + background * (1.0 - p[3]));
            [mix(p[0]), mix(p[1]), mix(p[2]), 255]
        })
        .collect()
}
