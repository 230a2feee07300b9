//! The implicit surface F = 0 by marching cubes on the device (Lorensen and Cline 1987; Luft,
//! Balzer, Deussen 2007, section 2.3): count, scan, emit. Indexed, closed, facing outwards.

use glam::{DVec3, Vec3};

use super::bake::Stats;
use super::field::{Field, NodeGrid, Queries};
use super::recorder::{Kernel, Progress, Recorder, Store, Use};
use super::settings::{Settings, SurfaceNormals};
use super::split::Split;
use super::stages;
use crate::Result;
use crate::abi;
use crate::gpu::shaders::foliage as shaders;
use crate::gpu::{Gpu, PassTime};
use crate::math::marching_cubes_table::table;
use crate::scene::Geometry;

/// An indexed mesh, counter-clockwise from outside.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Surface {
    /// Position per vertex.
    pub positions: Vec<Vec3>,
    /// Unit outward normal per vertex.
    pub normals: Vec<Vec3>,
    /// Three vertex numbers per triangle.
    pub indices: Vec<u32>,
}

/// Density `F + tau` at the nodes of a grid.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DensityGrid {
    /// Node (0,0,0), metres relative to the geometry's origin.
    pub min: Vec3,
    /// Edge of a cell, metres.
    pub cell: f32,
    /// Nodes along x, y, z.
    pub nodes: [usize; 3],
    /// Values, x fastest.
    pub values: Vec<f32>,
}

/// A surface with what it ran.
#[derive(Debug, Clone)]
pub struct Surfaced {
    /// The mesh in metres, relative to the geometry's origin.
    pub surface: Surface,
    /// What was found on the way.
    pub stats: Stats,
    /// The grid it was found on, where [`Surface::compute_with_density`] was asked.
    pub density: Option<DensityGrid>,
    /// Device time of every pass, in order.
    pub times: Vec<PassTime>,
}

impl Surface {
    /// Extracts the implicit surface of `geometry`'s foliage on the compute queue.
    ///
    /// # Errors
    /// As [`super::Bake::compute`]; an empty surface.
    pub fn compute(
        gpu: &Gpu,
        geometry: &Geometry,
        split: &Split,
        settings: &Settings,
        progress: Progress<'_>,
    ) -> Result<Surfaced> {
        Self::extract(gpu, geometry, split, settings, (progress, false))
    }

    /// As [`Surface::compute`], with the density grid read back, for looking at it.
    ///
    /// # Errors
    /// As [`Surface::compute`].
    pub fn compute_with_density(
        gpu: &Gpu,
        geometry: &Geometry,
        split: &Split,
        settings: &Settings,
        progress: Progress<'_>,
    ) -> Result<Surfaced> {
        Self::extract(gpu, geometry, split, settings, (progress, true))
    }

    fn extract(
        gpu: &Gpu,
        geometry: &Geometry,
        split: &Split,
        settings: &Settings,
        (progress, with_density): (Progress<'_>, bool),
    ) -> Result<Surfaced> {
        let mut r = Recorder::new(Some(gpu), progress);
        let (surface, stats, density) =
            stages::surface(&mut r, geometry, split, settings, with_density)?;
        Ok(Surfaced {
            surface,
            stats,
            density,
            times: r.times,
        })
    }
}

/// The surface on the device, in normalised coordinates.
#[derive(Debug)]
pub(super) struct DeviceSurface {
    pub(super) vertex_count: usize,
    pub(super) triangle_count: usize,
    /// Position; the fourth component names the edge that the vertex is on.
    pub(super) vertices: Store,
    /// Outward normal.
    pub(super) normals: Store,
    pub(super) indices: Store,
}

impl DeviceSurface {
    /// Puts a mesh that the host has changed back on the device.
    pub(super) fn upload(r: &mut Recorder<'_>, surface: &Surface) -> Result<Self> {
        let padded = |v: &[Vec3]| {
            v.iter()
                .map(|p| p.extend(0.0).to_array())
                .collect::<Vec<_>>()
        };
        Ok(Self {
            vertex_count: surface.positions.len(),
            triangle_count: surface.indices.len() / 3,
            vertices: r.upload("optimised vertices", &padded(&surface.positions))?,
            normals: r.upload("optimised normals", &padded(&surface.normals))?,
            indices: r.upload("optimised indices", &surface.indices)?,
        })
    }

    /// Copies the mesh to the host, still in normalised coordinates.
    pub(super) fn download(&self, r: &mut Recorder<'_>) -> Result<Surface> {
        let zero = || vec![[0.0f32; 4]; self.vertex_count];
        let mut both = r.fetch_all("surface", &[&self.vertices, &self.normals], zero)?;
        let mut indices = r.fetch("surface indices", &self.indices, || {
            vec![0u32; 3 * self.triangle_count]
        })?;
        let xyz = |v: Vec<[f32; 4]>| {
            v.iter()
                .take(self.vertex_count)
                .map(|p| Vec3::new(p[0], p[1], p[2]))
                .collect()
        };
        let normals = both.pop().expect("two were asked for");
        let positions = both.pop().expect("two were asked for");
        indices.truncate(3 * self.triangle_count);
        Ok(Surface {
            positions: xyz(positions),
            normals: xyz(normals),
            indices,
        })
    }
}

/// Extracts the surface where `density` (on `grid`) crosses `tau`.
pub(super) fn extract(
    r: &mut Recorder<'_>,
    field: &Field<'_>,
    (grid, density): (&NodeGrid, &Store),
    tau: f32,
    normals: SurfaceNormals,
    half: DVec3,
) -> Result<DeviceSurface> {
    let mut push = abi::SurfaceGrid {
        origin: grid.origin,
        cell: grid.cell,
        nodes: grid.nodes,
        tau,
        count: 0,
        radius: field.radius,
    };
    let rows = (grid.nodes[1] * grid.nodes[2]) as usize;
    let cases = r.upload("marching cubes cases", &table().words())?;
    let vertex_counts = r.array::<u32>("row vertices", rows)?;
    let triangle_counts = r.array::<u32>("row triangles", rows)?;
    r.compute(
        "count surface",
        shaders::SURFACE_COUNT_COMP,
        &[
            Use::Read(density),
            Use::Read(&cases),
            Use::Write(&vertex_counts),
            Use::Write(&triangle_counts),
        ],
        &push,
        rows,
    )?;
    let vertex_first = super::bins::scan(r, "row vertices", &vertex_counts, rows)?;
    let triangle_first = super::bins::scan(r, "row triangles", &triangle_counts, rows)?;
    let totals = r.fetch_all("surface counts", &[&vertex_first, &triangle_first], || {
        estimate(grid, rows)
    })?;
    let [vertex_count, triangle_count] = [&totals[0], &totals[1]].map(|t| t[rows] as usize);
    r.estimated = true;
    let vertices = r.array::<[f32; 4]>("surface vertices", vertex_count)?;
    let node_first = r.array::<u32>("node vertices", grid.node_count())?;
    let indices = r.array::<[u32; 3]>("surface indices", triangle_count)?;
    r.compute(
        "surface vertices",
        shaders::SURFACE_VERTICES_COMP,
        &[
            Use::Read(density),
            Use::Read(&vertex_first),
            Use::Write(&node_first),
            Use::Write(&vertices),
        ],
        &push,
        rows,
    )?;
    r.compute(
        "surface triangles",
        shaders::SURFACE_TRIANGLES_COMP,
        &[
            Use::Read(density),
            Use::Read(&cases),
            Use::Read(&triangle_first),
            Use::Read(&node_first),
            Use::Write(&indices),
        ],
        &push,
        rows,
    )?;
    push.count = vertex_count as u32;
    let unit_normals = r.array::<[f32; 4]>("surface normals", vertex_count)?;
    let from_gradient = normals == SurfaceNormals::Gradient;
    let gradients = if from_gradient && vertex_count > 0 {
        let reach = half + f64::from(field.radius);
        let queries = Queries::sort(r, "surface", &vertices, vertex_count, reach)?;
        Some(field.at_queries(r, "field at surface", &queries, abi::FIELD_GRADIENT)?)
    } else {
        None
    };
    r.compute(
        "surface normals",
        Kernel {
            shader: shaders::SURFACE_NORMALS_COMP,
            constants: &[(0, u32::from(gradients.is_some()))],
        },
        &[
            Use::Read(density),
            Use::Read(&cases),
            Use::Read(&node_first),
            Use::Read(&vertices),
            Use::Read(gradients.as_ref().unwrap_or(&vertices)),
            Use::Write(&unit_normals),
        ],
        &push,
        vertex_count,
    )?;
    Ok(DeviceSurface {
        vertex_count,
        triangle_count,
        vertices,
        normals: unit_normals,
        indices,
    })
}

/// A guess for plans: a closed surface crosses about as many cells as three faces of the grid's
/// box hold; marching cubes makes a vertex and two triangles of each.
fn estimate(grid: &NodeGrid, rows: usize) -> Vec<u32> {
    let [x, y, z] = grid.nodes;
    let faces = x * y + y * z + z * x;
    let mut totals = vec![0; rows + 1];
    totals[rows] = 2 * faces;
    totals
}

impl Surface {
    /// Simplifies to within `error` (in units of the positions, exact end 0) and evens the
    /// triangles out by tangential relaxation, after Luft, Balzer, Deussen 2007 (report, section
    /// 2.3: a homogeneous mesh of fewer primitives has more consistent normals).
    #[must_use]
    pub fn optimised(&self, error: f32) -> Self {
        if error <= 0.0 || self.indices.is_empty() {
            return self.clone();
        }
        let bytes: &[u8] = bytemuck::cast_slice(&self.positions);
        let vertices = meshopt::VertexDataAdapter::new(bytes, size_of::<Vec3>(), 0)
            .expect("positions are whole vectors of three floats");
        let indices = meshopt::simplify(
            &self.indices,
            &vertices,
            3,
            error,
            meshopt::SimplifyOptions::ErrorAbsolute,
            None,
        );
        let mut out = self.compacted(&indices);
        out.relax(RELAXATION_STEPS);
        out
    }

    /// The vertices that `indices` use, in their old order.
    fn compacted(&self, indices: &[u32]) -> Self {
        let mut number = vec![u32::MAX; self.positions.len()];
        for &i in indices {
            number[i as usize] = 0;
        }
        let mut out = Self::default();
        for (i, n) in number.iter_mut().enumerate().filter(|(_, n)| **n == 0) {
            *n = out.positions.len() as u32;
            out.positions.push(self.positions[i]);
            out.normals.push(self.normals[i]);
        }
        out.indices = indices.iter().map(|&i| number[i as usize]).collect();
        out
    }

    /// Moves every vertex in its tangent plane half way to the mean of its neighbours.
    fn relax(&mut self, steps: usize) {
        for _ in 0..steps {
            let mut sums = vec![(DVec3::ZERO, 0.0f64); self.positions.len()];
            for t in self.indices.chunks_exact(3) {
                for k in 0..3 {
                    let (a, b) = (t[k] as usize, t[(k + 1) % 3] as usize);
                    // Every edge of a closed mesh is passed once in each direction.
                    sums[a].0 += self.positions[b].as_dvec3();
                    sums[a].1 += 1.0;
                }
            }
            for ((p, n), (sum, count)) in self.positions.iter_mut().zip(&self.normals).zip(sums) {
                if count > 0.0 {
                    let (n, here) = (n.as_dvec3(), p.as_dvec3());
                    let offset = sum / count - here;
                    *p = (here + 0.5 * (offset - offset.dot(n) * n)).as_vec3();
                }
            }
        }
    }
}

/// Relaxation converges quickly and each step shrinks details a little: three even out slivers.
const RELAXATION_STEPS: usize = 3;

#[cfg(test)]
mod tests {
    use super::*;

    /// A closed octahedron subdivided onto the unit sphere.
    fn sphere(levels: u32) -> Surface {
        let mut positions = vec![
            Vec3::X,
            Vec3::Y,
            Vec3::Z,
            Vec3::NEG_X,
            Vec3::NEG_Y,
            Vec3::NEG_Z,
        ];
        let mut triangles: Vec<[u32; 3]> = vec![
            [0, 1, 2],
            [1, 3, 2],
            [3, 4, 2],
            [4, 0, 2],
            [1, 0, 5],
            [3, 1, 5],
            [4, 3, 5],
            [0, 4, 5],
        ];
        for _ in 0..levels {
            let mut middle = std::collections::BTreeMap::new();
            let mut next = Vec::new();
            for t in &triangles {
                let m = [0, 1, 2].map(|k| {
                    let (a, b) = (t[k], t[(k + 1) % 3]);
                    *middle.entry((a.min(b), a.max(b))).or_insert_with(|| {
                        positions.push((positions[a as usize] + positions[b as usize]).normalize());
                        positions.len() as u32 - 1
                    })
                });
                next.extend([
                    [t[0], m[0], m[2]],
                    [m[0], t[1], m[1]],
                    [m[2], m[1], t[2]],
                    m,
                ]);
            }
            triangles = next;
        }
        Surface {
            normals: positions.clone(),
            positions,
            indices: triangles.concat(),
        }
    }

    #[test]
    fn no_error_changes_nothing() {
        let surface = sphere(3);
        assert_eq!(surface.optimised(0.0), surface);
        assert_eq!(Surface::default().optimised(0.1), Surface::default());
    }

    #[test]
    fn optimising_drops_triangles_stays_closed_and_near() {
        let surface = sphere(5);
        let fewer = surface.optimised(0.01);
        assert!(
            fewer.indices.len() * 4 < surface.indices.len(),
            "{} indices",
            fewer.indices.len()
        );
        let mut edges = std::collections::BTreeMap::new();
        for t in fewer.indices.chunks_exact(3) {
            for k in 0..3 {
                *edges.entry((t[k], t[(k + 1) % 3])).or_insert(0) += 1;
            }
        }
        assert!(
            edges
                .iter()
                .all(|(&(a, b), &n)| n == 1 && edges.get(&(b, a)) == Some(&1)),
            "closed"
        );
        for p in &fewer.positions {
            assert!((p.length() - 1.0).abs() < 0.05, "{p} left the sphere");
        }
    }
}
