//! The modes that go through the implicit surface: `vertex`, `face` and `exact`, and the surface
//! as a mesh of its own.

use super::ambient::threshold;
use super::bake::Stats;
use super::field::{Field, NodeGrid};
use super::nearest::{self, Target};
use super::recorder::{Recorder, Store};
use super::settings::{NormalsMode, Threshold};
use super::stages::{Scene, Sources, Vertices};
use super::surface::{self, DensityGrid, DeviceSurface, Surface};
use crate::abi;
use crate::gpu::shaders::foliage as shaders;
use crate::{Error, Result};

/// Extracts the surface of the scene's foliage; `foliage` decides the threshold where that is a
/// quantile.
pub(super) fn device_surface(
    r: &mut Recorder<'_>,
    scene: &Scene<'_>,
    field: &Field<'_>,
    foliage: &Vertices<'_>,
    stats: &mut Stats,
) -> Result<DeviceSurface> {
    let s = scene.settings;
    let half = scene.frame.half;
    let grid = NodeGrid::around(half, f64::from(s.rho), s.cells, s.memory)?;
    let density = field.on_grid(r, "density grid", &grid)?;
    stats.tau = match s.tau {
        Threshold::Absolute(tau) => tau,
        quantile @ Threshold::Quantile(_) => {
            let mut at_foliage = sampled(r, &grid, &density, foliage)?;
            threshold(quantile, &mut at_foliage)
        }
    };
    let found = surface::extract(
        r,
        field,
        (&grid, &density),
        stats.tau,
        s.surface_normals,
        half,
    )?;
    if found.triangle_count == 0 {
        return Err(Error::usage(format!(
            "the implicit surface is empty: tau = {} is nowhere exceeded on {} cells; \
             try a smaller tau or more cells",
            stats.tau, s.cells
        )));
    }
    let found = if s.surface_error > 0.0 {
        let mesh = found.download(r)?.optimised(s.surface_error * grid.cell);
        DeviceSurface::upload(r, &mesh)?
    } else {
        found
    };
    stats.surface_vertices = found.vertex_count;
    stats.surface_triangles = found.triangle_count;
    Ok(found)
}

/// Density at the foliage's vertices, interpolated on the grid: good enough for a quantile and
/// far cheaper than summing over the generators once more.
fn sampled(
    r: &mut Recorder<'_>,
    grid: &NodeGrid,
    density: &Store,
    foliage: &Vertices<'_>,
) -> Result<Vec<f32>> {
    use super::recorder::Use;
    let count = foliage.numbers.len();
    let result = r.array::<f32>("density at foliage", count)?;
    r.compute(
        "density at foliage",
        shaders::SAMPLE_COMP,
        &[
            Use::Read(density),
            Use::Read(&foliage.points),
            Use::Write(&result),
        ],
        &abi::SurfaceGrid {
            origin: grid.origin,
            cell: grid.cell,
            nodes: grid.nodes,
            tau: 0.0,
            count: count as u32,
            radius: 0.0,
        },
        count,
    )?;
    let mut values = r.fetch::<f32>("density at foliage", &result, || vec![1.0])?;
    values.truncate(count);
    Ok(values)
}

/// Directions of the foliage's vertices by the settings' mode.
pub(super) fn directions(
    r: &mut Recorder<'_>,
    scene: &Scene<'_>,
    sources: &Sources,
    foliage: &Vertices<'_>,
    stats: &mut Stats,
) -> Result<Store> {
    let s = scene.settings;
    let field = sources.field(s.rho, s.norm);
    let surface = device_surface(r, scene, &field, foliage, stats)?;
    let target = match s.normals {
        NormalsMode::Vertex => Target::Vertices,
        _ => Target::Faces,
    };
    let reach = scene.frame.half + f64::from(s.rho);
    let nearest = nearest::nearest(r, &surface, &foliage.queries, target, reach)?;
    let found = nearest::normals(r, &surface, &nearest, foliage.numbers.len())?;
    if s.normals == NormalsMode::Exact {
        let on = (&field, stats.tau);
        stats.unsettled_normals =
            nearest::exact(r, on, &surface, &foliage.queries, &nearest, &found)?;
    }
    Ok(found)
}

/// The surface of the scene's foliage in metres, relative to the geometry's origin.
pub(super) fn mesh(
    r: &mut Recorder<'_>,
    scene: &Scene<'_>,
    sources: &Sources,
    foliage: &Vertices<'_>,
    stats: &mut Stats,
) -> Result<Surface> {
    let field = sources.field(scene.settings.rho, scene.settings.norm);
    let mut mesh = device_surface(r, scene, &field, foliage, stats)?.download(r)?;
    for p in &mut mesh.positions {
        *p = scene.frame.restore(*p);
    }
    Ok(mesh)
}

/// Density at the nodes of the surface's grid, in metres, relative to the geometry's origin.
pub(super) fn density(
    r: &mut Recorder<'_>,
    scene: &Scene<'_>,
    sources: &Sources,
) -> Result<DensityGrid> {
    let s = scene.settings;
    let grid = NodeGrid::around(scene.frame.half, f64::from(s.rho), s.cells, s.memory)?;
    let on_device = sources
        .field(s.rho, s.norm)
        .on_grid(r, "density grid", &grid)?;
    let mut values = r.fetch::<f32>("density grid", &on_device, || vec![0.0])?;
    values.truncate(grid.node_count());
    Ok(DensityGrid {
        min: scene.frame.restore(grid.origin.into()),
        cell: (f64::from(grid.cell) * scene.frame.diagonal) as f32,
        nodes: grid.nodes.map(|n| n as usize),
        values,
    })
}
