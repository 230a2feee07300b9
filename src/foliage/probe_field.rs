//! Single kernels on given inputs, for the comparison with their twins. Everything is in
//! normalised coordinates, as inside a bake.

use glam::{DVec3, Vec3};

use super::ambient;
use super::bake::{Bake, Stats};
use super::bins::{self, BinGrid};
use super::field::{Field, NodeGrid, Queries};
use super::generators::{self, Generators, SortedGenerators};
use super::realign;
use super::recorder::{Recorder, Store};
use super::settings::{Encoding, Norm, Primitive, Settings};
use super::split::Leaves;
use super::stages;
use super::subset;
use crate::Result;
use crate::abi;
use crate::gpu::Gpu;

/// A field made of given generators.
#[derive(Debug, Clone, Copy)]
pub struct FieldInput<'a> {
    /// Position and weight.
    pub generators: &'a [[f32; 4]],
    /// Radius of influence.
    pub radius: f32,
    /// Norm of equation 2.
    pub norm: Norm,
    /// Half the extent of a box about zero that holds the generators.
    pub half: DVec3,
}

/// Points sorted into bins.
#[derive(Debug, Clone)]
pub struct BinnedPoints {
    /// Corner of bin (0,0,0).
    pub origin: [f32; 3],
    /// Edge of a bin.
    pub edge: f32,
    /// Bins per axis, x fastest.
    pub bins: [u32; 3],
    /// Bin of every point.
    pub bin_of_point: Vec<u32>,
    /// Numbers of the points in the order of their bins, ascending inside a bin.
    pub order: Vec<u32>,
}

/// Runs `make` on a recorder and returns the `count` elements of the store that it leaves.
fn run<T: bytemuck::Pod>(
    gpu: &Gpu,
    count: usize,
    make: impl FnOnce(&mut Recorder<'_>) -> Result<Store>,
) -> Result<Vec<T>> {
    let mut silent = |_: &str, _: f32| {};
    let mut r = Recorder::new(Some(gpu), &mut silent);
    let store = make(&mut r)?;
    let mut out = r.fetch("probe", &store, Vec::new)?;
    out.truncate(count);
    Ok(out)
}

impl FieldInput<'_> {
    fn sort(&self, r: &mut Recorder<'_>) -> Result<SortedGenerators> {
        let count = self.generators.len();
        let all = Generators {
            count,
            centres: r.upload("centres", self.generators)?,
            areas: r.upload("areas", &vec![0.0f32; count])?,
        };
        let grid = BinGrid::for_generators(self.half, count, &[self.radius]);
        let binned = all.bin(r, grid, self.radius)?;
        all.texels(r, &binned, 0.0)
    }

    fn with<'a>(&self, generators: &'a SortedGenerators) -> Field<'a> {
        Field {
            generators,
            radius: self.radius,
            norm: self.norm,
        }
    }

    /// Density at every node of `grid`, x fastest.
    ///
    /// # Errors
    /// A failing device.
    pub fn on_grid(&self, gpu: &Gpu, grid: &NodeGrid) -> Result<Vec<f32>> {
        run(gpu, grid.node_count(), |r| {
            let sorted = self.sort(r)?;
            self.with(&sorted).on_grid(r, "density grid", grid)
        })
    }

    /// Density and gradient at every point.
    ///
    /// # Errors
    /// A failing device.
    pub fn at(&self, gpu: &Gpu, points: &[[f32; 4]]) -> Result<Vec<[f32; 4]>> {
        run(gpu, points.len(), |r| {
            let sorted = self.sort(r)?;
            let queries = self.queries(r, points)?;
            self.with(&sorted)
                .at_queries(r, "field", &queries, abi::FIELD_BOTH)
        })
    }

    /// Density alone at every point.
    ///
    /// # Errors
    /// A failing device.
    pub fn density_at(&self, gpu: &Gpu, points: &[[f32; 4]]) -> Result<Vec<f32>> {
        run(gpu, points.len(), |r| {
            let sorted = self.sort(r)?;
            let queries = self.queries(r, points)?;
            self.with(&sorted)
                .at_queries(r, "field", &queries, abi::FIELD_DENSITY)
        })
    }

    /// Bin of every generator, and the generators in the order of the bins.
    ///
    /// # Errors
    /// A failing device.
    pub fn binned(&self, gpu: &Gpu) -> Result<BinnedPoints> {
        let mut silent = |_: &str, _: f32| {};
        let r = &mut Recorder::new(Some(gpu), &mut silent);
        let count = self.generators.len();
        let grid = BinGrid::for_generators(self.half, count, &[self.radius]);
        let points = r.upload("points", self.generators)?;
        let binned = bins::bin(r, "point", &points, count, &grid)?;
        let order = bins::order(r, "points", &binned.places, count, grid.len())?;
        let places: Vec<[u32; 2]> = r.fetch("places", &binned.places, Vec::new)?;
        let mut order = r.fetch("order", &order, Vec::new)?;
        order.truncate(count);
        Ok(BinnedPoints {
            origin: grid.origin,
            edge: grid.edge,
            bins: grid.bins,
            bin_of_point: places.iter().take(count).map(|p| p[0]).collect(),
            order,
        })
    }

    fn queries(&self, r: &mut Recorder<'_>, points: &[[f32; 4]]) -> Result<Queries> {
        let store = r.upload("points", points)?;
        Queries::sort(r, "probe", &store, points.len(), self.half)
    }
}

/// Centres (three floats, then the weight 1) of the leaves of a mesh.
///
/// # Errors
/// A failing device.
pub fn generators(
    gpu: &Gpu,
    positions: &[Vec3],
    indices: &[u32],
    primitive: Primitive,
) -> Result<Vec<[f32; 4]>> {
    let leaves = Leaves::new(positions, indices, primitive);
    run(gpu, leaves.len(), |r| {
        Ok(mesh_generators(r, positions, indices, &leaves)?.centres)
    })
}

/// One-sided areas of the leaves of a mesh.
///
/// # Errors
/// A failing device.
pub fn areas(
    gpu: &Gpu,
    positions: &[Vec3],
    indices: &[u32],
    primitive: Primitive,
) -> Result<Vec<f32>> {
    let leaves = Leaves::new(positions, indices, primitive);
    run(gpu, leaves.len(), |r| {
        Ok(mesh_generators(r, positions, indices, &leaves)?.areas)
    })
}

/// A subset of generators (position and weight 1, and area): position, weight and area of each.
///
/// # Errors
/// A failing device.
pub fn subset(
    gpu: &Gpu,
    (centres, areas): (&[[f32; 4]], &[f32]),
    settings: &Settings,
) -> Result<Vec<([f32; 4], f32)>> {
    let mut silent = |_: &str, _: f32| {};
    let mut r = Recorder::new(Some(gpu), &mut silent);
    let all = Generators {
        count: centres.len(),
        centres: r.upload("centres", centres)?,
        areas: r.upload("areas", areas)?,
    };
    let kept = subset::subset(&mut r, all, settings)?;
    let centres = r.fetch::<[f32; 4]>("centres", &kept.centres, Vec::new)?;
    let areas = r.fetch::<f32>("areas", &kept.areas, Vec::new)?;
    Ok(centres.into_iter().zip(areas).take(kept.count).collect())
}

fn mesh_generators(
    r: &mut Recorder<'_>,
    positions: &[Vec3],
    indices: &[u32],
    leaves: &Leaves,
) -> Result<Generators> {
    let points: Vec<[f32; 4]> = positions.iter().map(|p| p.extend(0.0).to_array()).collect();
    let points = r.upload("points", &points)?;
    generators::generators(r, &points, indices, leaves)
}

/// Equation 4 of every density.
///
/// # Errors
/// A failing device.
pub fn transfer(gpu: &Gpu, density: &[f32], push: abi::AmbientTransfer) -> Result<Vec<f32>> {
    run(gpu, density.len(), |r| {
        let store = r.upload("density", density)?;
        ambient::apply(r, "probe", &store, density.len(), push)
    })
}

/// Directions of two gradients (density first) in a mode of `directions.comp`, and how many are
/// missing.
///
/// # Errors
/// A failing device.
pub fn directions(
    gpu: &Gpu,
    mode: u32,
    gradients: (&[[f32; 4]], &[[f32; 4]]),
    radius: f32,
) -> Result<(Vec<[f32; 4]>, usize)> {
    directions_in_steps(gpu, &[mode], gradients, radius)
}

/// Directions of the first gradient, the gaps filled from the second, and how many are left.
///
/// # Errors
/// A failing device.
pub fn filled_directions(
    gpu: &Gpu,
    gradients: (&[[f32; 4]], &[[f32; 4]]),
    radius: f32,
) -> Result<(Vec<[f32; 4]>, usize)> {
    let modes = [abi::DIRECTIONS_SINGLE, abi::DIRECTIONS_FILL];
    directions_in_steps(gpu, &modes, gradients, radius)
}

fn directions_in_steps(
    gpu: &Gpu,
    modes: &[u32],
    (near, wide): (&[[f32; 4]], &[[f32; 4]]),
    radius: f32,
) -> Result<(Vec<[f32; 4]>, usize)> {
    let mut missing = 0;
    let found = run(gpu, near.len(), |r| {
        let near_store = r.upload("near", near)?;
        let wide_store = r.upload("wide", wide)?;
        let steps = realign::Steps::new(r, near.len(), radius)?;
        for &mode in modes {
            missing = steps.run(r, mode, &near_store, &wide_store)?;
        }
        Ok(steps.found)
    })?;
    Ok((found, missing))
}

/// Normals blended with directions.
///
/// # Errors
/// A failing device.
pub fn blend(gpu: &Gpu, own: &[[f32; 3]], found: &[[f32; 4]], blend: f32) -> Result<Vec<[f32; 3]>> {
    run(gpu, own.len(), |r| {
        let found = r.upload("found", found)?;
        realign::blend(r, own, &found, blend)
    })
}

/// Words of `encode.comp`.
///
/// # Errors
/// A failing device.
pub fn encode(
    gpu: &Gpu,
    encoding: Encoding,
    normals: &[Vec3],
    ambient: &[f32],
) -> Result<Vec<u32>> {
    let mut silent = |_: &str, _: f32| {};
    let mut r = Recorder::new(Some(gpu), &mut silent);
    let bake = Bake {
        normals: normals.to_vec(),
        ambient: ambient.to_vec(),
        stats: Stats::default(),
        ..Bake::default()
    };
    stages::encode(&mut r, encoding, &bake)
}
