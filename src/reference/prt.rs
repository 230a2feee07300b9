//! Transfer vectors by the same paths as on the device.
//!
//! Twin of `shaders/leaf/prt_start.comp`, `prt_bounce.comp` and `prt_gather.comp`.

use glam::{DVec2, DVec3};

use super::rays::Triangles;
use crate::abi::{LeafSides, Receiver, SH_MAX_COEFFICIENTS};
use crate::math::sampling::{cosine_hemisphere, even_numbers, frame, path_key, random};
use crate::math::sh;

/// Coefficients of a vector: all that kernels may be asked for.
const COEFFICIENTS: usize = SH_MAX_COEFFICIENTS as usize;

/// Direct and indirect transfer of one side: RGB for each coefficient.
pub type Transfer = [[DVec3; COEFFICIENTS]; 2];

/// What paths meet and how they are made.
#[derive(Debug, Clone, Copy)]
pub struct Scene<'a> {
    /// Everything.
    pub triangles: &'a Triangles,
    /// Unit normal and material of every triangle.
    pub faces: &'a [[f32; 4]],
    /// What materials make of light.
    pub materials: &'a [LeafSides],
    /// Seed of the random numbers.
    pub seed: u32,
    /// A ray starts so far from its surface.
    pub offset: f64,
    /// Chance of going on, in albedos of what was met.
    pub survival: f64,
    /// Bounces at most.
    pub bounces: u32,
}

/// A material as seen from one side: reflectance, transmittance and their means.
struct Side {
    rho_d: DVec3,
    rho_t: DVec3,
    reflects: f64,
    transmits: f64,
}

impl Side {
    fn new(material: &LeafSides, front: bool) -> Self {
        let rho_d = vector(if front {
            material.rho_d_front
        } else {
            material.rho_d_back
        });
        let rho_t = vector(material.rho_t);
        Self {
            rho_d,
            rho_t,
            reflects: rho_d.element_sum() / 3.0,
            transmits: rho_t.element_sum() / 3.0,
        }
    }

    fn total(&self) -> f64 {
        self.reflects + self.transmits
    }

    /// Whether a path is reflected, and its weight.
    fn choose(&self, u: f64) -> (bool, DVec3) {
        if u * self.total() < self.reflects {
            (true, self.rho_d * (self.total() / self.reflects))
        } else {
            (false, self.rho_t * (self.total() / self.transmits))
        }
    }
}

impl Scene<'_> {
    /// Transfer of one side (0 front, 1 back) of receiver `number` by `paths` paths.
    #[must_use]
    pub fn transfer(&self, receiver: &Receiver, number: u32, side: u32, paths: u32) -> Transfer {
        let mut sums = [[DVec3::ZERO; COEFFICIENTS]; 2];
        for sample in 0..paths {
            if let Some((part, direction, weight)) =
                self.path(receiver, (2 * number + side, side == 0), sample)
            {
                let y = sh::evaluate(direction);
                for (sum, y) in sums[part].iter_mut().zip(y) {
                    *sum += y * weight / f64::from(paths);
                }
            }
        }
        sums
    }

    /// Whether a path escaped late, where to and with which weight; nothing when absorbed.
    fn path(
        &self,
        receiver: &Receiver,
        (global, front): (u32, bool),
        sample: u32,
    ) -> Option<(usize, DVec3, DVec3)> {
        let side = Side::new(&self.materials[receiver.material as usize], front);
        if side.total() <= 0.0 {
            return None;
        }
        let u = even_numbers(global, sample, self.seed);
        let (reflected, weight) = side.choose(u[2]);
        let sign = if front == reflected { 1.0 } else { -1.0 };
        let direction = around(sign * vector(receiver.normal), u[0], u[1]);
        let origin = self.origin(receiver, direction);
        self.follow((origin, direction, weight), global, sample)
    }

    /// Where a ray starts from `receiver` into `direction`.
    pub(super) fn origin(&self, receiver: &Receiver, direction: DVec3) -> DVec3 {
        let facing = vector(receiver.facing);
        let leaves = if direction.dot(facing) < 0.0 {
            -self.offset
        } else {
            self.offset
        };
        vector(receiver.position) + leaves * facing
    }

    /// A path from its first ray on: whether it escaped late, where to and with which weight.
    pub(super) fn follow(
        &self,
        (mut origin, mut direction, mut weight): (DVec3, DVec3, DVec3),
        global: u32,
        sample: u32,
    ) -> Option<(usize, DVec3, DVec3)> {
        let key = path_key(global, sample, self.seed);
        for bounce in 0..self.bounces {
            let Some(hit) = self.triangles.nearest(origin, direction, 1e30, |_| true) else {
                return Some((usize::from(bounce > 0), direction, weight));
            };
            let [x, y, z, material] = self.faces[hit.triangle as usize];
            let face = vector([x, y, z]);
            let front = face.dot(direction) < 0.0;
            let normal = if front { face } else { -face };
            let side = Side::new(&self.materials[material.to_bits() as usize], front);
            let counter = 4 * bounce;
            let survives = if bounce > 0 {
                (self.survival * side.total()).min(1.0)
            } else {
                1.0
            };
            if side.total() <= 0.0 || random(key, counter) >= survives {
                return None;
            }
            let (reflected, factor) = side.choose(random(key, counter + 1));
            let outward = if reflected { normal } else { -normal };
            let next = around(outward, random(key, counter + 2), random(key, counter + 3));
            origin += hit.t * direction + self.offset * outward;
            direction = next;
            weight *= factor / survives;
        }
        None
    }
}

fn around(normal: DVec3, u: f64, v: f64) -> DVec3 {
    frame(normal) * cosine_hemisphere(DVec2::new(u, v))
}

fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::new(f64::from(v[0]), f64::from(v[1]), f64::from(v[2]))
}
