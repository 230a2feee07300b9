//! Generators of the density field on the device (Luft, Balzer, Deussen 2007, section 3.1).

use super::bins::{BinGrid, Binned, bin};
use super::recorder::{Picture, Recorder, Store, Use};
use super::split::Leaves;
use crate::Result;
use crate::abi;
use crate::gpu::shaders::foliage as shaders;

/// Centres and areas of all generators, unsorted.
#[derive(Debug)]
pub(super) struct Generators {
    pub(super) count: usize,
    /// Position and weight.
    pub(super) centres: Store,
    /// One-sided area, in squared diagonals.
    pub(super) areas: Store,
}

/// Generators sorted into bins, ready for the field kernels.
#[derive(Debug)]
pub(super) struct SortedGenerators {
    pub(super) grid: BinGrid,
    /// First generator of every bin.
    pub(super) first: Store,
    /// Position and root of the weight, in bin order.
    pub(super) texels: Picture,
}

/// Computes centre of mass and area of every leaf of `points` (normalised, all vertices).
pub(super) fn generators(
    r: &mut Recorder<'_>,
    points: &Store,
    indices: &[u32],
    leaves: &Leaves,
) -> Result<Generators> {
    let count = leaves.len();
    let triangles = r.upload("foliage indices", indices)?;
    let first = r.upload("leaf firsts", &leaves.first)?;
    let order = r.upload("leaf triangles", &leaves.triangles)?;
    let centres = r.array::<[f32; 4]>("generator centres", count)?;
    let areas = r.array::<f32>("generator areas", count)?;
    r.compute(
        "generators",
        shaders::GENERATORS_COMP,
        &[
            Use::Read(points),
            Use::Read(&triangles),
            Use::Read(&first),
            Use::Read(&order),
            Use::Write(&centres),
            Use::Write(&areas),
        ],
        &abi::LeafCentres {
            count: count as u32,
        },
        count,
    )?;
    Ok(Generators {
        count,
        centres,
        areas,
    })
}

/// Generators in bin order, their numbers only.
#[derive(Debug)]
pub(super) struct BinnedGenerators {
    grid: BinGrid,
    binned: Binned,
    sorted: Store,
}

impl Generators {
    /// Sorts the generators into `grid`, ascending inside a bin.
    pub(super) fn bin(&self, r: &mut Recorder<'_>, grid: BinGrid) -> Result<BinnedGenerators> {
        let binned = bin(r, "generator", &self.centres, self.count, &grid)?;
        let sorted = r.array::<u32>("generator order", self.count)?;
        let push = grid.push(self.count, 0.0);
        r.compute(
            "emit generators",
            shaders::BIN_EMIT_COMP,
            &[
                Use::Read(&binned.places),
                Use::Read(&binned.first),
                Use::Write(&sorted),
            ],
            &push,
            self.count,
        )?;
        r.compute(
            "order generators",
            shaders::BIN_ORDER_COMP,
            &[Use::Read(&binned.first), Use::ReadWrite(&sorted)],
            &push,
            grid.len(),
        )?;
        Ok(BinnedGenerators {
            grid,
            binned,
            sorted,
        })
    }

    /// The image that the field kernels fetch: weights as they are, or areas times `area_scale`.
    pub(super) fn texels(
        &self,
        r: &mut Recorder<'_>,
        binned: &BinnedGenerators,
        area_scale: f32,
    ) -> Result<SortedGenerators> {
        let texels = r.picture(
            if area_scale == 0.0 {
                "generator texels"
            } else {
                "leaf area texels"
            },
            self.count,
            abi::GENERATOR_COLUMN_BITS,
        )?;
        r.compute(
            "write generators",
            shaders::GENERATOR_EMIT_COMP,
            &[
                Use::Read(&binned.sorted),
                Use::Read(&self.centres),
                Use::Read(&self.areas),
                Use::Draw(&texels),
            ],
            &binned.grid.push(self.count, area_scale),
            self.count,
        )?;
        Ok(SortedGenerators {
            grid: binned.grid,
            first: binned.binned.first.clone(),
            texels,
        })
    }
}
