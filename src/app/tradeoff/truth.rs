//! Ray-traced truth at a sample of foliage vertices, and how well a bake agrees with it.

use glam::Vec3;
use rayon::prelude::*;

use crate::Result;
use crate::foliage::Split;
use crate::foliage::traced::Occluders;
use crate::math::{sampling, stats};
use crate::scene::{Geometry, Model};

/// Directions that are traced from every sampled vertex.
pub const DIRECTIONS: u32 = 128;

/// Visibility of the same directions from every sampled vertex.
#[derive(Debug)]
pub struct Truth {
    /// Sampled vertices, as indices into the geometry, ascending.
    pub sample: Vec<usize>,
    directions: Vec<Vec3>,
    /// Vertex by vertex, direction by direction.
    visible: Vec<bool>,
    /// Share of directions that each sampled vertex sees.
    ambient: Vec<f64>,
    /// Position of every vertex of the foliage, for roughness.
    foliage: Vec<usize>,
}

impl Truth {
    /// Traces [`DIRECTIONS`] rays from about `count` foliage vertices.
    ///
    /// # Errors
    /// An alpha texture that cannot be decoded.
    pub fn trace(model: &Model, geometry: &Geometry, split: &Split, count: usize) -> Result<Self> {
        let occluders = Occluders::new(model, geometry)?;
        let directions: Vec<Vec3> = sampling::fibonacci_directions(DIRECTIONS)
            .iter()
            .map(|w| w.as_vec3())
            .collect();
        let foliage: Vec<usize> = split.foliage_vertices.iter().map(|&v| v as usize).collect();
        let share = count as f64 / foliage.len() as f64;
        let sample: Vec<usize> = foliage
            .iter()
            .copied()
            .filter(|&v| sampling::uniform(1, v as u32) < share)
            .collect();
        let visible: Vec<bool> = sample
            .par_iter()
            .flat_map_iter(|&v| {
                let q = geometry.positions[v];
                let occluders = &occluders;
                directions.iter().map(move |&w| occluders.visible(q, w))
            })
            .collect();
        let ambient = visible
            .chunks_exact(directions.len())
            .map(|seen| seen.iter().filter(|&&s| s).count() as f64 / seen.len() as f64)
            .collect();
        Ok(Self {
            sample,
            directions,
            visible,
            ambient,
            foliage,
        })
    }

    /// Mean share of the surroundings that the sampled vertices see.
    #[must_use]
    pub fn mean_ambient(&self) -> f64 {
        stats::mean(&self.ambient)
    }

    /// Rank correlation of `ambient` (one per vertex of the geometry) with the traced one.
    #[must_use]
    pub fn spearman(&self, ambient: &[f32]) -> f64 {
        let baked: Vec<f64> = self.sample.iter().map(|&v| f64::from(ambient[v])).collect();
        stats::spearman(&baked, &self.ambient)
    }

    /// Area under the curve of N.w as a guess of whether direction w is visible, over all pairs of
    /// a sampled vertex and a direction: 0.5 knows nothing, 1 knows all.
    #[must_use]
    pub fn auc(&self, normals: &[Vec3]) -> f64 {
        let scores: Vec<f64> = self
            .sample
            .iter()
            .flat_map(|&v| {
                let n = normals[v];
                self.directions.iter().map(move |w| f64::from(n.dot(*w)))
            })
            .collect();
        stats::auc(&scores, &self.visible)
    }

    /// The best normals for [`Self::auc`] that one vector per vertex can be: the mean visible
    /// direction, where anything is visible. One per vertex of the geometry, zero if not sampled.
    #[must_use]
    pub fn open_directions(&self, vertex_count: usize) -> Vec<Vec3> {
        let mut out = vec![Vec3::ZERO; vertex_count];
        let seen = self.visible.chunks_exact(self.directions.len());
        for (&v, seen) in self.sample.iter().zip(seen) {
            let open = self.directions.iter().zip(seen).filter(|(_, s)| **s);
            out[v] = open.map(|(w, _)| *w).sum::<Vec3>().normalize_or_zero();
        }
        out
    }

    /// Roughness in degrees of normals, one per vertex of the geometry, among the foliage.
    #[must_use]
    pub fn roughness(&self, geometry: &Geometry, normals: &[Vec3]) -> f64 {
        let positions: Vec<Vec3> = self
            .foliage
            .iter()
            .map(|&v| geometry.positions[v])
            .collect();
        let normals: Vec<Vec3> = self.foliage.iter().map(|&v| normals[v]).collect();
        let sample: Vec<usize> = self
            .sample
            .iter()
            .map(|v| {
                self.foliage
                    .binary_search(v)
                    .expect("sampled from the foliage")
            })
            .collect();
        stats::roughness(&positions, &normals, &sample)
    }

    /// Angles in degrees between two sets of normals at the sampled vertices.
    #[must_use]
    pub fn angles(&self, a: &[Vec3], b: &[Vec3]) -> Vec<f64> {
        self.sample
            .iter()
            .map(|&v| stats::angle_degrees(a[v], b[v]))
            .collect()
    }
}
