//! The density field at query points and on a grid (Luft, Balzer, Deussen 2007, section 2.3).

use glam::DVec3;

use super::bins::{BinGrid, bin};
use super::generators::SortedGenerators;
use super::recorder::{Kernel, Recorder, Store, Use};
use super::settings::Norm;
use crate::abi;
use crate::gpu::shaders::foliage as shaders;
use crate::{Error, Result};

impl Norm {
    pub(super) fn constant(self) -> u32 {
        match self {
            Self::Euclidean => abi::NORM_EUCLIDEAN,
            Self::Manhattan => abi::NORM_MANHATTAN,
            Self::Maximum => abi::NORM_MAXIMUM,
        }
    }
}

/// Query points sorted so that neighbours in the order are neighbours in space.
#[derive(Debug)]
pub(super) struct Queries {
    pub(super) count: usize,
    /// Position and number, in Morton order.
    pub(super) sorted: Store,
}

impl Queries {
    /// Sorts `points` (four floats each) over the box `-half..half`.
    pub(super) fn sort(
        r: &mut Recorder<'_>,
        what: &str,
        points: &Store,
        count: usize,
        half: DVec3,
    ) -> Result<Self> {
        let grid = BinGrid::morton(half, count);
        let binned = bin(r, what, points, count, &grid)?;
        let sorted = r.array::<[f32; 4]>(&format!("{what} queries"), count)?;
        r.compute(
            &format!("emit {what}"),
            shaders::QUERY_EMIT_COMP,
            &[
                Use::Read(&binned.places),
                Use::Read(&binned.first),
                Use::Read(points),
                Use::Write(&sorted),
            ],
            &grid.push(count, 0.0),
            count,
        )?;
        Ok(Self { count, sorted })
    }
}

/// A field: sorted generators with one radius and norm.
#[derive(Debug, Clone, Copy)]
pub(super) struct Field<'a> {
    pub(super) generators: &'a SortedGenerators,
    pub(super) radius: f32,
    pub(super) norm: Norm,
}

impl Field<'_> {
    /// Density (1 float) or density and gradient (4 floats; the density is 0 for
    /// `FIELD_GRADIENT`) per query, by the query's number.
    pub(super) fn at_queries(
        &self,
        r: &mut Recorder<'_>,
        label: &str,
        queries: &Queries,
        terms: u32,
    ) -> Result<Store> {
        let floats = if terms == abi::FIELD_DENSITY { 1 } else { 4 };
        let result = r.array::<f32>(label, floats * queries.count)?;
        let grid = &self.generators.grid;
        let blocks = queries.count.div_ceil(abi::BLOCK_QUERIES as usize);
        r.compute(
            label,
            Kernel {
                shader: shaders::FIELD_COMP,
                constants: &[(0, self.norm.constant()), (1, terms)],
            },
            &[
                Use::Fetch(&self.generators.texels),
                Use::Read(&self.generators.first),
                Use::Read(&queries.sorted),
                Use::Write(&result),
            ],
            &abi::FieldQueries {
                bin_origin: grid.origin,
                bin_edge: grid.edge,
                bins: grid.bins,
                radius: self.radius,
                count: queries.count as u32,
            },
            blocks * abi::FIELD_SLOTS as usize,
        )?;
        Ok(result)
    }

    /// Density at every node of `grid`, x fastest.
    pub(super) fn on_grid(
        &self,
        r: &mut Recorder<'_>,
        label: &str,
        grid: &NodeGrid,
    ) -> Result<Store> {
        let density = r.array::<f32>(label, grid.node_count())?;
        let bins = &self.generators.grid;
        r.compute(
            label,
            Kernel {
                shader: shaders::DENSITY_COMP,
                constants: &[(0, self.norm.constant())],
            },
            &[
                Use::Fetch(&self.generators.texels),
                Use::Read(&self.generators.first),
                Use::Write(&density),
            ],
            &abi::DensityGrid {
                origin: grid.origin,
                cell: grid.cell,
                nodes: grid.nodes,
                radius: self.radius,
                bin_origin: bins.origin,
                bin_edge: bins.edge,
                bins: bins.bins,
            },
            grid.tile_count() * abi::FIELD_SLOTS as usize,
        )?;
        Ok(density)
    }
}

/// A regular grid with one cell size on all axes, in normalised coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NodeGrid {
    /// Position of node (0,0,0).
    pub origin: [f32; 3],
    /// Cell size.
    pub cell: f32,
    /// Nodes per axis (cells + 1).
    pub nodes: [u32; 3],
}

impl NodeGrid {
    /// The grid over the box `-half..half` padded by `radius` and one cell, so that the surface is
    /// always closed; `cells` (>= 3) along its longest side.
    ///
    /// # Errors
    /// A grid of more than `memory` MiB, with its size.
    pub fn around(half: DVec3, radius: f64, cells: u32, memory: u32) -> Result<Self> {
        if cells < 3 {
            return Err(Error::usage(format!(
                "cells = {cells} is outside 3 .. 1024"
            )));
        }
        let extent = 2.0 * half + 2.0 * radius;
        let coarse = extent.max_element() / f64::from(cells - 2);
        // A cell of 12 significant bits, and an origin in its units: positions of nodes are exact
        // in f32.
        let quantum = (coarse.log2().floor() - 11.0).exp2();
        let cell = (coarse / quantum).ceil() * quantum;
        // The small allowance keeps the longest side at exactly `cells` despite rounding.
        let counts = (extent / cell - 1e-9).ceil() + 2.0;
        let grid = Self {
            origin: ((-0.5 * cell * counts / quantum).floor() * quantum)
                .as_vec3()
                .to_array(),
            cell: cell as f32,
            nodes: counts.to_array().map(|c| c as u32 + 1),
        };
        let (bytes, bound) = (grid.bytes(), u64::from(memory) << 20);
        if bytes > bound {
            let [x, y, z] = grid.nodes;
            return Err(Error::usage(format!(
                "a grid of {x} x {y} x {z} nodes takes {bytes} bytes, more than the bound of \
                 {bound} bytes (memory = {memory} MiB); try fewer cells"
            )));
        }
        Ok(grid)
    }

    /// Number of nodes.
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.nodes.iter().map(|&n| n as usize).product()
    }

    /// Bytes of one float per node.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        4 * self.node_count() as u64
    }

    fn tile_count(&self) -> usize {
        self.nodes
            .iter()
            .map(|&n| n.div_ceil(abi::TILE_SIDE) as usize)
            .product()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::{Gpu, GpuOptions, Validation};
    use crate::math::sampling::uniform;

    #[test]
    fn sorting_loses_no_query_whatever_their_number() {
        let options = GpuOptions {
            validation: Validation::Required,
            ..Default::default()
        };
        let gpu = Gpu::new(&options).expect("a driver and the validation layer");
        let mut silent = |_: &str, _: f32| {};
        for count in [1usize, 100, 5000, 65_535, 65_536, 100_000] {
            let r = &mut Recorder::new(Some(&gpu), &mut silent);
            let at = |i: usize, a: usize| uniform(3, (3 * i + a) as u32) as f32 - 0.5;
            let points: Vec<[f32; 4]> = (0..count)
                .map(|i| [at(i, 0), at(i, 1), at(i, 2), 0.0])
                .collect();
            let store = r.upload("points", &points).unwrap();
            let queries = Queries::sort(r, "test", &store, count, DVec3::splat(0.5)).unwrap();
            let sorted: Vec<[f32; 4]> = r.fetch("sorted", &queries.sorted, Vec::new).unwrap();
            let mut seen = vec![0; count];
            let mut wrong = 0;
            for q in sorted.iter().take(count) {
                let i = q[3].to_bits() as usize;
                if i < count && q[..3] == points[i][..3] {
                    seen[i] += 1;
                } else {
                    wrong += 1;
                }
            }
            let missing = seen.iter().filter(|&&n| n != 1).count();
            assert_eq!(
                (wrong, missing),
                (0, 0),
                "{count} queries: not their own, not exactly once"
            );
        }
        assert_eq!(gpu.take_validation_messages(), Vec::<String>::new());
    }
}
