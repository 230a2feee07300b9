//! The implicit surface D(q) = tau on a grid (Lorensen and Cline 1987).
//!
//! Twin of the surface kernels: vertices are numbered by (node, axis) in order, triangles by
//! cell and by the case table.

use std::collections::HashMap;

use glam::DVec3;

use super::density::{Field, Grid};
use crate::math::marching_cubes_table::{edge_owner, table};

/// An indexed triangle mesh, counter-clockwise from outside.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Surface {
    /// Positions.
    pub vertices: Vec<DVec3>,
    /// Vertex indices, three per triangle.
    pub triangles: Vec<[u32; 3]>,
}

/// Extracts the surface where `values` (one per node) cross `tau`; inside is strictly above.
#[must_use]
pub fn marching_cubes(grid: &Grid, values: &[f64], tau: f64) -> Surface {
    let mut surface = Surface::default();
    let mut vertex_of: HashMap<(usize, u8), u32> = HashMap::new();
    for i in 0..grid.node_count() {
        let node = grid.node(i);
        for axis in 0..3u8 {
            if let Some(q) = edge_crossing(grid, values, tau, node, axis) {
                vertex_of.insert((i, axis), surface.vertices.len() as u32);
                surface.vertices.push(q);
            }
        }
    }
    for i in 0..grid.node_count() {
        let node = grid.node(i);
        if (0..3).any(|a| node[a] + 1 >= grid.nodes[a]) {
            continue;
        }
        for t in table()
            .case(cell_case(grid, values, tau, node))
            .chunks_exact(3)
        {
            surface.triangles.push([t[0], t[1], t[2]].map(|edge| {
                let (corner, axis) = edge_owner(edge);
                vertex_of[&(grid.index(corner_node(node, corner)), axis)]
            }));
        }
    }
    surface
}

/// Node of a cell's corner.
fn corner_node(cell: [u32; 3], corner: u8) -> [u32; 3] {
    [0, 1, 2].map(|axis| cell[axis] + u32::from(corner >> axis & 1))
}

/// Bit set of the cell's corners that are inside.
fn cell_case(grid: &Grid, values: &[f64], tau: f64, cell: [u32; 3]) -> u8 {
    (0..8u8)
        .filter(|&corner| values[grid.index(corner_node(cell, corner))] > tau)
        .fold(0, |case, corner| case | 1 << corner)
}

/// Where the edge from `node` along `axis` crosses the surface, linearly interpolated.
fn edge_crossing(grid: &Grid, values: &[f64], tau: f64, node: [u32; 3], axis: u8) -> Option<DVec3> {
    let a = usize::from(axis);
    if node[a] + 1 >= grid.nodes[a] {
        return None;
    }
    let mut end = node;
    end[a] += 1;
    let (v0, v1) = (values[grid.index(node)], values[grid.index(end)]);
    if (v0 > tau) == (v1 > tau) {
        return None;
    }
    let t = (tau - v0) / (v1 - v0);
    let mut q = grid.position(node);
    q[a] += t * f64::from(grid.cell);
    Some(q)
}

impl Surface {
    /// Unit outward normals from the field's gradient; the faces' mean where it vanishes.
    #[must_use]
    pub fn gradient_normals(&self, field: &Field) -> Vec<DVec3> {
        let faces = self.face_normals();
        self.vertices
            .iter()
            .zip(faces)
            .map(|(&q, face)| {
                (-field.density_and_gradient(q).1)
                    .try_normalize()
                    .unwrap_or(face)
            })
            .collect()
    }

    /// Unit vertex normals as the area-weighted mean of the faces around; +z where that vanishes.
    #[must_use]
    pub fn face_normals(&self) -> Vec<DVec3> {
        let mut sums = vec![DVec3::ZERO; self.vertices.len()];
        for &t in &self.triangles {
            let [a, b, c] = t.map(|i| self.vertices[i as usize]);
            for i in t {
                sums[i as usize] += (b - a).cross(c - a);
            }
        }
        sums.iter()
            .map(|n| n.try_normalize().unwrap_or(DVec3::Z))
            .collect()
    }

    /// Total area.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.corners()
            .map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length())
            .sum()
    }

    /// Enclosed volume (divergence theorem); positive when the triangles face outwards.
    #[must_use]
    pub fn volume(&self) -> f64 {
        self.corners()
            .map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
            .sum()
    }

    /// V - E + F.
    #[must_use]
    pub fn euler_characteristic(&self) -> i64 {
        self.vertices.len() as i64 - self.edges().len() as i64 + self.triangles.len() as i64
    }

    /// Whether every edge belongs to exactly two triangles that pass it in opposite directions.
    #[must_use]
    pub fn is_watertight(&self) -> bool {
        self.edges()
            .values()
            .all(|&(forward, backward)| (forward, backward) == (1, 1))
    }

    /// How often every undirected edge (lower index first) is passed forwards and backwards.
    #[must_use]
    pub fn edges(&self) -> HashMap<(u32, u32), (u32, u32)> {
        let mut edges = HashMap::new();
        for t in &self.triangles {
            for i in 0..3 {
                let (a, b) = (t[i], t[(i + 1) % 3]);
                let entry: &mut (u32, u32) = edges.entry((a.min(b), a.max(b))).or_default();
                if a < b { entry.0 += 1 } else { entry.1 += 1 }
            }
        }
        edges
    }

    /// Corner positions of every triangle.
    pub fn corners(&self) -> impl Iterator<Item = [DVec3; 3]> {
        self.triangles
            .iter()
            .map(|t| t.map(|i| self.vertices[i as usize]))
    }
}
