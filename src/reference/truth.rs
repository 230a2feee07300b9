//! Paths of light from the camera, by the same random numbers as on the device.
//!
//! Twin of `shaders/leaf/truth_start.comp`, `truth_bounce.comp`, `truth_add.comp` and
//! `truth_gather.comp`.

use std::f64::consts::PI;

use glam::{DVec2, DVec3, Vec3};

use super::lamps::lamp_falloff;
use super::lit::{leaf_for_light, leaf_scatters, slope_distribution};
use super::rays::Triangles;
use crate::abi::{LAMP_REACH, LEAF_TURN_NODES, LampRecord, LeafSides, LeafTurn, TruthFrame};
use crate::math::sampling::{cosine_hemisphere, even_numbers, frame, path_key, random};

/// What paths meet and see.
pub struct Scene<'a> {
    /// Camera, sun and seed.
    pub frame: &'a TruthFrame,
    /// Everything that stops rays.
    pub triangles: &'a Triangles,
    /// Unit normal and material of every triangle.
    pub faces: &'a [[f32; 4]],
    /// Three vertices a triangle.
    pub indices: &'a [u32],
    /// Shading normal of every vertex.
    pub normals: &'a [Vec3],
    /// What materials make of light.
    pub materials: &'a [LeafSides],
    /// Specular intensity and roughness of every material.
    pub gloss: &'a [[f32; 4]],
    /// Factors of oblique light of every material; none: those of straight light hold.
    pub turns: &'a [LeafTurn],
    /// Lamps.
    pub lamps: &'a [LampRecord],
    /// Points of the sun's shape and of the lamps.
    pub points: &'a [[f32; 3]],
    /// Radiance of the sky from a unit direction.
    pub sky: &'a dyn Fn(DVec3) -> DVec3,
    /// Bounces at most.
    pub bounces: u32,
}

impl std::fmt::Debug for Scene<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Scene").finish_non_exhaustive()
    }
}

/// What one path brings to its pixel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Light {
    /// Sun and lamps on what the camera sees.
    pub direct: DVec3,
    /// Sun and lamps over other leaves.
    pub indirect: DVec3,
    /// Sky.
    pub sky: DVec3,
    /// 1 where the camera's ray met the model.
    pub covered: f64,
}

/// Where a path stands, and from where it came.
struct Meeting {
    at: DVec3,
    face: DVec3,
    normal: DVec3,
    to_eye: DVec3,
    material: usize,
}

impl Scene<'_> {
    /// Light of sample `number` of `pixel`, by row and column.
    #[must_use]
    pub fn path(&self, pixel: u32, number: u32) -> Light {
        let f = self.frame;
        let [u, v, _] = even_numbers(pixel, number, f.seed);
        let on_film = |at: u32, u: f64, of: u32| 2.0 * (f64::from(at) + u) / f64::from(of) - 1.0;
        let x = on_film(pixel % f.width, u, f.width);
        let y = on_film(pixel / f.width, v, f.height);
        let forward = vector(f.forward) + x * vector(f.right) - y * vector(f.up);
        let mut direction = forward.normalize();
        let eye = vector(f.eye);
        let skip = (-eye.dot(direction) - 1.0).max(0.0);
        let mut origin = eye + skip * direction;
        let mut weight = DVec3::ONE;
        let mut light = Light::default();
        let key = path_key(pixel, number, f.seed.wrapping_add(1));
        for bounce in 0..=self.bounces {
            let Some(hit) = self.triangles.nearest(origin, direction, 1e30, |_| true) else {
                if bounce > 0 {
                    light.sky += weight * (self.sky)(direction);
                }
                break;
            };
            if bounce == self.bounces {
                break;
            }
            let met = self.meeting(origin + hit.t * direction, direction, hit.triangle);
            let random = |k: u32| random(key, 8 * bounce + k);
            let sun = weight * self.light(&met, [0, 1, 6, 7].map(random));
            if bounce == 0 {
                light.covered = 1.0;
                light.direct = sun;
            } else {
                light.indirect += sun;
            }
            let u = [2, 3, 4, 5].map(random);
            let Some((next, factor)) = self.scatter(&met, bounce, u) else {
                break;
            };
            weight *= factor;
            origin = self.off(&met, next);
            direction = next;
        }
        light
    }

    fn meeting(&self, at: DVec3, direction: DVec3, triangle: u32) -> Meeting {
        let [x, y, z, material] = self.faces[triangle as usize];
        let face = vector([x, y, z]);
        let [a, b, c] = self.triangles.corners(triangle).map(|p| p - at);
        let weights = [b.cross(c), c.cross(a), a.cross(b)].map(|v| v.dot(face));
        let corners = &self.indices[3 * triangle as usize..][..3];
        let normals = corners.iter().map(|&i| self.normals[i as usize].as_dvec3());
        let sum: DVec3 = normals.zip(weights).map(|(n, w)| w * n).sum();
        let normal = if sum.length_squared() > 0.0 {
            sum.normalize()
        } else {
            face
        };
        Meeting {
            at,
            face,
            normal: if normal.dot(face) < 0.0 {
                -normal
            } else {
                normal
            },
            to_eye: -direction,
            material: material.to_bits() as usize,
        }
    }

    /// Start of a ray that leaves in direction `to`.
    fn off(&self, met: &Meeting, to: DVec3) -> DVec3 {
        let offset = f64::from(self.frame.offset);
        let side = if met.face.dot(to) < 0.0 {
            -offset
        } else {
            offset
        };
        met.at + side * met.face
    }

    /// Light of a point of the sun or of a lamp that is scattered back along the path.
    fn light(&self, met: &Meeting, [u, v, which, point]: [f64; 4]) -> DVec3 {
        let f = self.frame;
        let lights = f.suns + f.lamps;
        let chosen = (which * f64::from(lights)) as u32;
        let (to, far, irradiance) = if chosen < f.suns {
            (self.to_sun([u, v]), 1e30, vector(f.irradiance))
        } else if lights == 0 {
            return DVec3::ZERO;
        } else {
            let lamp = &self.lamps[(chosen - f.suns) as usize];
            let number = ((point * f64::from(lamp.points)) as u32).min(lamp.points - 1);
            let to = vector(self.points[(lamp.first_point + number) as usize]) - met.at;
            let all = f64::from(lamp.points) * lamp_falloff(to, lamp);
            (to, f64::from(LAMP_REACH), vector(lamp.intensity) * all)
        };
        if irradiance == DVec3::ZERO {
            return irradiance;
        }
        let start = self.off(met, to);
        let ray = if far < 1.0 { met.at + to - start } else { to };
        if self.triangles.nearest(start, ray, far, |_| true).is_some() {
            return DVec3::ZERO;
        }
        f64::from(lights) * irradiance * self.scatters(met, to.normalize())
    }

    fn to_sun(&self, [u, v]: [f64; 2]) -> DVec3 {
        let f = self.frame;
        let sin_radius = f64::from(f.sin_radius);
        let radius = sin_radius * u.sqrt();
        let (sin, cos) = (2.0 * PI * v).sin_cos();
        let mut local = DVec3::new(radius * cos, radius * sin, 1.0);
        if f.sun_points > 0 {
            let number = ((u * f64::from(f.sun_points)) as u32).min(f.sun_points - 1);
            let [x, y, _] = self.points[number as usize].map(|c| sin_radius * f64::from(c));
            local = DVec3::new(x, y, 1.0);
        }
        (frame(vector(f.sun)) * local).normalize()
    }

    fn scatters(&self, met: &Meeting, to_light: DVec3) -> DVec3 {
        let (leaf, gloss) = (&self.materials[met.material], self.gloss[met.material]);
        let nodes = LEAF_TURN_NODES as usize;
        let own = self.turns.chunks_exact(nodes).nth(met.material);
        let leaf = leaf_for_light(leaf, own.unwrap_or(&[]), met.normal.dot(to_light));
        leaf_scatters(&leaf, gloss, met.normal, (to_light, met.to_eye))
    }

    /// The next direction, from one of three lobes, and what light from there counts; nothing where
    /// the path ends.
    fn scatter(&self, met: &Meeting, bounce: u32, u: [f64; 4]) -> Option<(DVec3, DVec3)> {
        let leaf = &self.materials[met.material];
        let [r, g, b, m] = self.gloss[met.material].map(f64::from);
        let front = met.normal.dot(met.to_eye) > 0.0;
        let rho_d = if front {
            leaf.rho_d_front
        } else {
            leaf.rho_d_back
        };
        let mean = |v: DVec3| v.element_sum() / 3.0;
        let lobes = [
            mean(vector(rho_d)),
            mean(vector(leaf.rho_t)),
            (r + g + b) / 3.0,
        ];
        let total: f64 = lobes.iter().sum();
        let survives = if bounce > 1 {
            (1.6 * total).min(1.0)
        } else {
            1.0
        };
        let outward = if front { met.normal } else { -met.normal };
        let [choice, x, y, end] = u;
        let choice = choice * total;
        let around = |z: DVec3| frame(z) * cosine_hemisphere(DVec2::new(x, y));
        let next = if choice >= lobes[0] + lobes[1] {
            let tan2 = -m * m * (1.0 - x).max(1e-12).ln();
            let z = 1.0 / (1.0 + tan2).sqrt();
            let (sin, cos) = (2.0 * PI * y).sin_cos();
            let flat = (1.0 - z * z).max(0.0).sqrt();
            let middle = frame(outward) * DVec3::new(flat * cos, flat * sin, z);
            2.0 * middle.dot(met.to_eye) * middle - met.to_eye
        } else {
            around(if choice < lobes[0] { outward } else { -outward })
        };
        let along = outward.dot(next);
        let mut density = if along > 0.0 { lobes[0] } else { lobes[1] } * along.abs() / PI;
        // The glossy lobe also finds directions on the other side, and they count.
        if lobes[2] > 0.0 {
            let middle = (next + met.to_eye).normalize();
            let cos_h = outward.dot(middle).abs();
            density += lobes[2] * slope_distribution(cos_h, m) * cos_h
                / (4.0 * middle.dot(next).abs().max(1e-6));
        }
        if total <= 0.0 || density <= 0.0 || end >= survives {
            return None;
        }
        let factor = total / (density * survives);
        Some((next, factor * self.scatters(met, next)))
    }
}

fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from(v.map(f64::from))
}
