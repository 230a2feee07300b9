//! Ray-traced ambient coefficients: the bake mode `ambient = traced`, and the truth that the other
//! modes are measured against.
//!
//! A vertex sees the share of its surroundings that no triangle hides. Leaves are lit from both
//! sides, so the whole sphere counts. Alpha-masked cards stop a ray only where their texture does.

use glam::{DVec2, Vec3};
use rayon::prelude::*;

use super::cutout::Cutout;
use crate::Result;
use crate::math::bvh::{Bvh, Hit, Ray};
use crate::math::sampling;
use crate::scene::{Geometry, Model};

/// A ray ignores hits nearer than this, in diagonals of the geometry: the leaf it starts on.
const SELF_HIT: f32 = 1e-4;

/// How directions are weighted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weighting {
    /// All directions of the sphere count equally: light arrives in a thin, translucent leaf.
    Sphere,
    /// By the cosine to the vertex normal, on both sides: irradiance on a flat two-sided leaf.
    Cosine,
}

/// How `ambient` samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rays {
    /// Rays per point; the standard error is at most 0.5 / sqrt(count).
    pub count: u32,
    /// Seed of the rotation of each point's directions.
    pub seed: u32,
    /// Weighting of the directions.
    pub weighting: Weighting,
}

/// Triangles that stop rays.
#[derive(Debug)]
pub struct Occluders {
    bvh: Bvh,
    indices: Vec<u32>,
    texcoords: Vec<[f32; 2]>,
    /// Cutout of each triangle's material, by index into `cutouts`.
    cutout_of: Vec<u32>,
    cutouts: Vec<Cutout>,
    /// Hits at or before this distance are ignored, metres.
    t_min: f32,
}

impl Occluders {
    /// All triangles of `geometry`, with the alpha textures of `model`.
    ///
    /// # Errors
    /// An alpha texture that cannot be decoded.
    pub fn new(model: &Model, geometry: &Geometry) -> Result<Self> {
        let cutouts = model
            .materials
            .iter()
            .map(|m| Cutout::new(model, m))
            .collect::<Result<Vec<_>>>()?;
        let cutout_of = geometry
            .parts
            .iter()
            .flat_map(|part| std::iter::repeat_n(part.material as u32, part.index_count / 3))
            .collect();
        Ok(Self {
            bvh: Bvh::new(&geometry.positions, &geometry.indices),
            indices: geometry.indices.clone(),
            texcoords: geometry.texcoords.clone(),
            cutout_of,
            cutouts,
            t_min: SELF_HIT * geometry.diagonal(),
        })
    }

    /// Whether nothing hides the direction `towards` from `origin` (relative to the geometry's
    /// origin, metres).
    #[must_use]
    pub fn visible(&self, origin: Vec3, towards: Vec3) -> bool {
        let ray = Ray {
            origin,
            direction: towards,
            t_min: self.t_min,
            t_max: f32::INFINITY,
        };
        !self.bvh.any(&ray, |hit| self.stops(hit))
    }

    fn stops(&self, hit: &Hit) -> bool {
        let triangle = hit.triangle as usize;
        let cutout = &self.cutouts[self.cutout_of[triangle] as usize];
        if cutout.is_solid() {
            return true;
        }
        let mut uv = [0.0; 2];
        for (weight, &i) in hit.weights.iter().zip(&self.indices[3 * triangle..]) {
            let corner = self.texcoords[i as usize];
            uv = [0, 1].map(|k| uv[k] + weight * corner[k]);
        }
        cutout.is_opaque(uv)
    }

    /// Share of the surroundings that each point sees, in \[0,1\]. `normals` (one per point) are
    /// read by [`Weighting::Cosine`] only.
    #[must_use]
    pub fn ambient(&self, points: &[Vec3], normals: &[Vec3], rays: &Rays) -> Vec<f32> {
        let one = |i: usize| {
            let seed = sampling::pcg(rays.seed) ^ i as u32;
            let shift = DVec2::new(sampling::uniform(seed, 0), sampling::uniform(seed, 1));
            let visible = (0..rays.count)
                .filter(|&k| {
                    let u = (shift + sampling::r2(k)).fract();
                    let w = match rays.weighting {
                        Weighting::Sphere => sampling::uniform_sphere(u),
                        Weighting::Cosine => two_sided_cosine(u, normals[i]),
                    };
                    self.visible(points[i], w.as_vec3())
                })
                .count();
            visible as f32 / rays.count as f32
        };
        (0..points.len()).into_par_iter().map(one).collect()
    }
}

/// Cosine-distributed about the normal or its opposite, with equal chances.
fn two_sided_cosine(u: DVec2, normal: Vec3) -> glam::DVec3 {
    let side = if u.x < 0.5 { 1.0 } else { -1.0 };
    let local = sampling::cosine_hemisphere(DVec2::new((2.0 * u.x).fract(), u.y));
    sampling::frame(side * normal.as_dvec3().normalize()) * local
}
