//! Surroundings in a glossy pixel by rays.
//!
//! Twin of `shaders/leaf/gloss_rays.comp` and `gloss_gather.comp`.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};

use super::leaf_glossy::lambda;
use super::lit::{Pixel, position_of_pixel, view_of_pixel};
use super::rays::Triangles;
use crate::abi::{
    GLOSS_RAY_OFFSET, GLOSS_RAY_PIXELS, GLOSSY_MIN_COSINE, GLOSSY_MIN_ROUGHNESS, LeafSides,
    LitFrame,
};
use crate::math::sampling::{cosine_hemisphere, even_numbers, frame};

/// What rays meet and see.
pub struct Scene<'a> {
    /// Camera.
    pub frame: &'a LitFrame,
    /// Metres to units of the triangles.
    pub scale: f64,
    /// Everything that stops rays.
    pub triangles: &'a Triangles,
    /// Unit normal and material of every triangle.
    pub faces: &'a [[f32; 4]],
    /// Three vertices a triangle.
    pub indices: &'a [u32],
    /// Light that leaves the front and the back of every vertex.
    pub leaving: &'a [[f32; 3]],
    /// What materials make of light.
    pub materials: &'a [LeafSides],
    /// What of their gloss the light of the vertices takes for diffuse reflection.
    pub counted: &'a [LeafSides],
    /// Radiance of the sky from a unit direction.
    pub sky: &'a dyn Fn(DVec3) -> DVec3,
    /// Samples of a pixel.
    pub samples: u32,
    /// Seed of the random numbers.
    pub seed: u32,
}

impl std::fmt::Debug for Scene<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Scene").finish_non_exhaustive()
    }
}

/// A direction of the lobe about `outward` that sends light to the eye, and its weight.
#[must_use]
pub fn lobe_direction(
    outward: DVec3,
    to_eye: DVec3,
    roughness: f64,
    u: DVec2,
) -> Option<(DVec3, f64)> {
    let m = roughness.abs().max(f64::from(GLOSSY_MIN_ROUGHNESS));
    let tan2 = -m * m * (1.0 - u.x).max(1e-12).ln();
    let z = 1.0 / (1.0 + tan2).sqrt();
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (2.0 * PI * u.y).sin_cos();
    let middle = frame(outward) * DVec3::new(r * cos, r * sin, z);
    let along = middle.dot(to_eye);
    let direction = 2.0 * along * middle - to_eye;
    let (light, eye) = (outward.dot(direction), outward.dot(to_eye));
    if !(along > 0.0 && light > 0.0 && eye > 0.0) {
        return None;
    }
    let kept = if roughness < 0.0 {
        1.0 / (1.0 + lambda(light, m) + lambda(eye, m))
    } else {
        1.0
    };
    let weight = kept * along / (z * eye.max(f64::from(GLOSSY_MIN_COSINE)));
    Some((direction, weight))
}

impl Scene<'_> {
    /// What gloss adds to pixel `at` with `pixel` at `depth`, of material number `material`.
    #[must_use]
    pub fn gloss(&self, at: (u32, u32), pixel: &Pixel, material: usize, depth: f64) -> DVec3 {
        let front = pixel.surface > 0.0;
        let (known, means) = (&self.counted[material], &self.materials[material]);
        let side = |leaf: &LeafSides| {
            vector(if front {
                leaf.rho_d_front
            } else {
                leaf.rho_d_back
            })
        };
        let mean = vector(means.rho_t) + side(means);
        let own = vector(pixel.leaf.rho_d_front) + vector(pixel.leaf.rho_t);
        let share = |c: usize| {
            if mean[c] > 1e-6 {
                own[c] / mean[c]
            } else {
                1.0
            }
        };
        let diffuse = side(known);
        let shine = vector([pixel.shine[0], pixel.shine[1], pixel.shine[2]]);
        let view = view_of_pixel(self.frame, at).normalize();
        let towards = |positive: bool| {
            if positive {
                pixel.normal
            } else {
                -pixel.normal
            }
        };
        let number = at.1 * self.frame.width + at.0;
        let (mut lobe, mut cosine) = (DVec3::ZERO, DVec3::ZERO);
        for sample in 0..self.samples {
            let u = |seed: u32| {
                let [x, y, _] = even_numbers(number, sample, seed);
                DVec2::new(x, y)
            };
            let start = |direction| self.start(at, depth, pixel.face.dot(direction) < 0.0);
            if shine.max_element() > 0.0 {
                let outward = towards(pixel.normal.dot(view) < 0.0);
                let roughness = f64::from(pixel.shine[3]);
                let next = lobe_direction(outward, -view, roughness, u(self.seed.wrapping_add(1)));
                if let Some((direction, weight)) = next {
                    lobe += weight * self.light(start(direction), direction);
                }
            }
            if diffuse.max_element() > 0.0 {
                let direction = frame(towards(front)) * cosine_hemisphere(u(self.seed));
                cosine += self.light(start(direction), direction);
            }
        }
        let share = DVec3::new(share(0), share(1), share(2));
        (shine * lobe - share * diffuse * cosine) / f64::from(self.samples)
    }

    /// Where rays start, a little before the surface or behind it.
    fn start(&self, at: (u32, u32), depth: f64, behind: bool) -> DVec3 {
        let f = self.frame;
        let across = vector(f.right).length() / f64::from(f.width);
        let down = vector(f.up).length() / f64::from(f.height);
        let extent = 2.0 * across.max(down) * f64::from(f.near) / depth;
        let pixel = f64::from(GLOSS_RAY_PIXELS) * self.scale * extent;
        let away = f64::from(GLOSS_RAY_OFFSET).max(pixel);
        let side = if behind { away } else { -away };
        self.scale * position_of_pixel(f, at, depth) + side * view_of_pixel(f, at).normalize()
    }

    /// Light against the direction of a ray.
    fn light(&self, start: DVec3, direction: DVec3) -> DVec3 {
        let Some(hit) = self.triangles.nearest(start, direction, 1e30, |_| true) else {
            return (self.sky)(direction);
        };
        let [x, y, z, _] = self.faces[hit.triangle as usize];
        let side = usize::from(vector([x, y, z]).dot(direction) >= 0.0);
        let corners = &self.indices[3 * hit.triangle as usize..][..3];
        let light = corners
            .iter()
            .map(|&i| vector(self.leaving[2 * i as usize + side]));
        light.zip(hit.weights).map(|(l, w)| w * l).sum()
    }
}

fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from(v.map(f64::from))
}
