//! Light from all directions through the leaf-area field, on the nodes of its grid.
//!
//! Twin of `shaders/foliage/sky_depth.comp` and `sky_light.comp`. The optical depth from every node
//! to the edge of the grid is found slab by slab along a direction's largest axis: the depth at
//! the next slab, where the ray meets it, plus the way there (Kunasz and Auer 1988, Short
//! characteristic integration of radiative transfer problems). One value per node and direction
//! replaces a march of the whole ray.

use glam::DVec3;
use rayon::prelude::*;

use super::density::Grid;

/// Integral of `leaf_area` (one value per node) from every node along the unit direction `w`.
#[must_use]
pub fn sky_depth(grid: &Grid, leaf_area: &[f64], w: DVec3) -> Vec<f64> {
    let axis = w.abs().max_position();
    let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
    let forward = w[axis] > 0.0;
    let shift = [w[b] / w[axis].abs(), w[c] / w[axis].abs()];
    let length = f64::from(grid.cell) / w[axis].abs();
    let slabs = grid.nodes[axis];
    let mut depth = vec![0.0; grid.node_count()];
    // The last slab towards the light lies outside of the support: its depth is 0.
    for step in 1..slabs {
        let slab = if forward { slabs - 1 - step } else { step };
        let next = if forward { slab + 1 } else { slab - 1 };
        for v in 0..grid.nodes[c] {
            for u in 0..grid.nodes[b] {
                let mut node = [0; 3];
                (node[axis], node[b], node[c]) = (slab, u, v);
                let at = grid.index(node);
                let hit = Meeting::new(
                    grid,
                    axis,
                    next,
                    [f64::from(u) + shift[0], f64::from(v) + shift[1]],
                );
                let way = 0.5 * length * (leaf_area[at] + hit.sample(leaf_area));
                depth[at] = way + hit.sample(&depth);
            }
        }
    }
    depth
}

/// Where a ray meets a slab: four nodes and their weights; weights outside of the grid are 0.
struct Meeting {
    nodes: [usize; 4],
    weights: [f64; 4],
}

impl Meeting {
    fn new(grid: &Grid, axis: usize, slab: u32, at: [f64; 2]) -> Self {
        let others = [(axis + 1) % 3, (axis + 2) % 3];
        let low = at.map(f64::floor);
        let t = [at[0] - low[0], at[1] - low[1]];
        let (mut nodes, mut weights) = ([0; 4], [0.0; 4]);
        for corner in 0..4 {
            let bits = [corner & 1, corner >> 1];
            let mut node = [slab; 3];
            let mut weight = 1.0;
            for k in 0..2 {
                let x = low[k] + bits[k] as f64;
                weight *= if bits[k] == 1 { t[k] } else { 1.0 - t[k] };
                if x < 0.0 || x >= f64::from(grid.nodes[others[k]]) {
                    weight = 0.0;
                }
                node[others[k]] = (x.max(0.0) as u32).min(grid.nodes[others[k]] - 1);
            }
            nodes[corner] = grid.index(node);
            weights[corner] = weight;
        }
        Self { nodes, weights }
    }

    fn sample(&self, values: &[f64]) -> f64 {
        (0..4)
            .map(|i| self.weights[i] * values[self.nodes[i]])
            .sum()
    }
}

/// What arrives at every node: the mean over `directions` of transmittance times direction, and of
/// transmittance alone, with the Beer-Lambert law exp(-`extinction` * depth). `extinction` is 0.5
/// for leaves at random angles (the mean projection of a unit area).
#[must_use]
pub fn sky_light(
    grid: &Grid,
    leaf_area: &[f64],
    directions: &[DVec3],
    extinction: f64,
) -> Vec<(DVec3, f64)> {
    let depths: Vec<Vec<f64>> = directions
        .par_iter()
        .map(|&w| sky_depth(grid, leaf_area, w))
        .collect();
    let share = 1.0 / directions.len() as f64;
    (0..grid.node_count())
        .map(|node| {
            let mut light = (DVec3::ZERO, 0.0);
            for (w, depth) in directions.iter().zip(&depths) {
                let t = share * (-extinction * depth[node]).exp();
                light.0 += t * *w;
                light.1 += t;
            }
            light
        })
        .collect()
}

/// Light at `q` by trilinear interpolation: (mean open direction, not normalised; mean
/// transmittance).
#[must_use]
pub fn light_at(grid: &Grid, light: &[(DVec3, f64)], q: DVec3) -> (DVec3, f64) {
    let mut sum = (DVec3::ZERO, 0.0);
    for (node, weight) in grid.corners(q) {
        sum.0 += weight * light[node].0;
        sum.1 += weight * light[node].1;
    }
    sum
}
