//! The surface kernels on given generators, one result each, as `umbrage conform` compares them
//! with their twins.

use glam::DVec3;

use super::bins::BinGrid;
use super::field::{Field, NodeGrid, Queries};
use super::generators::Generators;
use super::nearest::{self, Target};
use super::recorder::Recorder;
use super::settings::{Norm, SurfaceNormals};
use super::surface::{self, Surface};
use crate::Result;
use crate::gpu::Gpu;

/// What the surface of some generators is asked.
#[derive(Debug, Clone, Copy)]
pub struct SurfaceQuestion<'a> {
    /// Position and weight of every generator, normalised coordinates.
    pub generators: &'a [[f32; 4]],
    /// Half the extent of a box around generators and queries.
    pub half: DVec3,
    /// Radius of influence.
    pub radius: f32,
    /// Norm of the distance.
    pub norm: Norm,
    /// Cells along the longest side.
    pub cells: u32,
    /// Threshold.
    pub tau: f32,
    /// Where the surface's normals come from.
    pub normals: SurfaceNormals,
    /// Points whose nearest surface is sought; the fourth component is ignored.
    pub queries: &'a [[f32; 4]],
}

/// The answers.
#[derive(Debug, Clone)]
pub struct SurfaceAnswer {
    /// The grid.
    pub grid: NodeGrid,
    /// Density at its nodes, x fastest.
    pub density: Vec<f32>,
    /// The surface.
    pub surface: Surface,
    /// Nearest surface vertex per query; empty without a surface, like the rest.
    pub nearest_vertex: Vec<u32>,
    /// Direction per query in mode `vertex`.
    pub vertex: Vec<[f32; 4]>,
    /// Direction per query in mode `face`.
    pub face: Vec<[f32; 4]>,
    /// Direction per query in mode `exact`.
    pub exact: Vec<[f32; 4]>,
}

/// Runs grid, surface and nearest search.
///
/// # Errors
/// As [`super::Bake::compute`].
pub fn surface(gpu: &Gpu, q: &SurfaceQuestion<'_>) -> Result<SurfaceAnswer> {
    let mut silent = |_: &str, _: f32| {};
    let r = &mut Recorder::new(Some(gpu), &mut silent);
    let count = q.generators.len();
    let generators = Generators {
        count,
        centres: r.upload("generator centres", q.generators)?,
        areas: r.upload("generator areas", &vec![0.0f32; count])?,
    };
    let bins = BinGrid::for_generators(q.half, count, &[q.radius]);
    let sorted = {
        let binned = generators.bin(r, bins, q.radius)?;
        generators.texels(r, &binned, 0.0)?
    };
    let field = Field {
        generators: &sorted,
        radius: q.radius,
        norm: q.norm,
    };
    let grid = NodeGrid::around(q.half, f64::from(q.radius), q.cells, 1024)?;
    let density = field.on_grid(r, "density grid", &grid)?;
    let device = surface::extract(r, &field, (&grid, &density), q.tau, q.normals, q.half)?;
    let mut answer = SurfaceAnswer {
        grid,
        density: r.fetch("density grid", &density, Vec::new)?,
        surface: device.download(r)?,
        nearest_vertex: Vec::new(),
        vertex: Vec::new(),
        face: Vec::new(),
        exact: Vec::new(),
    };
    if device.triangle_count == 0 {
        return Ok(answer);
    }
    let points = r.upload("query points", q.queries)?;
    let n = q.queries.len();
    let queries = Queries::sort(r, "query", &points, n, q.half)?;
    let reach = q.half + f64::from(q.radius);
    let by_vertex = nearest::nearest(r, &device, &queries, Target::Vertices, reach)?;
    let vertex = nearest::normals(r, &device, &by_vertex, n)?;
    let by_face = nearest::nearest(r, &device, &queries, Target::Faces, reach)?;
    let face = nearest::normals(r, &device, &by_face, n)?;
    let numbers: Vec<[f32; 4]> = r.fetch("nearest", &by_vertex.found, Vec::new)?;
    // An empty buffer still has room for one.
    answer.nearest_vertex = numbers.iter().take(n).map(|v| v[0].to_bits()).collect();
    answer.vertex = r.fetch("vertex normals", &vertex, Vec::new)?;
    answer.vertex.truncate(n);
    answer.face = r.fetch("face normals", &face, Vec::new)?;
    answer.face.truncate(n);
    nearest::exact(r, (&field, q.tau), &device, &queries, &by_face, &face)?;
    answer.exact = r.fetch("exact normals", &face, Vec::new)?;
    answer.exact.truncate(n);
    Ok(answer)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::{GpuOptions, Validation};

    /// Software drivers end long loops silently: too many generators in one place are refused,
    /// never summed short.
    #[test]
    fn a_million_coincident_generators_are_refused_and_what_is_allowed_is_summed() {
        let options = GpuOptions {
            validation: Validation::Required,
            ..Default::default()
        };
        let gpu = Gpu::new(&options).expect("a driver and the validation layer");
        let question = |generators| SurfaceQuestion {
            generators,
            half: DVec3::splat(0.05),
            radius: 0.1,
            norm: Norm::Euclidean,
            cells: 8,
            tau: 1e9,
            normals: SurfaceNormals::Faces,
            queries: &[],
        };
        let many = vec![[0.0f32, 0.0, 0.0, 1.0]; 1_000_000];
        let error = surface(&gpu, &question(&many)).expect_err("too many in one place");
        assert!(
            error.to_string().contains("1000000 generators lie within"),
            "{error}"
        );
        assert_eq!(error.exit_code(), 2);
        let allowed = 400_000;
        let answer = surface(&gpu, &question(&many[..allowed])).expect("within the bound");
        let most = answer.density.iter().copied().fold(0.0, f32::max);
        let nearest = answer.density.iter().zip(0u32..).map(|(&d, i)| {
            let [nx, ny, _] = answer.grid.nodes;
            let node = [i % nx, i / nx % ny, i / (nx * ny)];
            let q = [0, 1, 2].map(|a| {
                f64::from(answer.grid.origin[a]) + f64::from(answer.grid.cell) * f64::from(node[a])
            });
            let s = q.iter().map(|c| c * c).sum::<f64>() / 0.01;
            let expected = if s < 1.0 {
                allowed as f64 * (1.0 - s).powi(2)
            } else {
                0.0
            };
            (f64::from(d) - expected).abs()
        });
        let worst = nearest.fold(0.0, f64::max);
        assert!(most > 0.5 * allowed as f32, "the middle is full: {most}");
        assert!(worst < 1e-4 * f64::from(most), "{worst} of {most}");
    }
}
