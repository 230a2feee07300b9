//! Generators of the density field on the device (Luft, Balzer, Deussen 2007, section 3.1).

use super::bins::{BinGrid, Binned, bin, most_in_window, order};
use super::recorder::{Picture, Recorder, Store, Use};
use super::split::Leaves;
use crate::abi;
use crate::gpu::shaders::foliage as shaders;
use crate::{Error, Result};

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
    pub(super) count: usize,
    pub(super) grid: BinGrid,
    /// First generator of every bin.
    pub(super) first: Store,
    /// Position and root of the weight, in bin order.
    pub(super) texels: Picture,
}

/// Triangles that one leaf may have, for the same reason as [`MOST_IN_REACH`].
const MOST_IN_LEAF: u32 = 60_000;

/// Computes centre of mass and area of every leaf of `points` (normalised, all vertices).
///
/// # Errors
/// A leaf of more than [`MOST_IN_LEAF`] triangles; a failing device.
pub(super) fn generators(
    r: &mut Recorder<'_>,
    points: &Store,
    indices: &[u32],
    leaves: &Leaves,
) -> Result<Generators> {
    let count = leaves.len();
    let most = leaves.first.windows(2).map(|w| w[1] - w[0]).max();
    if let Some(most) = most.filter(|&most| most > MOST_IN_LEAF) {
        return Err(Error::Unsupported(format!(
            "a connected leaf of {most} triangles, at most {MOST_IN_LEAF} can be summed; \
             try primitive = triangle"
        )));
    }
    let triangles = r.upload("foliage indices", indices)?;
    let first = r.upload("leaf firsts", &leaves.first)?;
    let order = r.upload("leaf triangles", &leaves.triangles)?;
    let generators = Generators::new(r, "generator", count)?;
    r.compute(
        "generators",
        shaders::GENERATORS_COMP,
        &[
            Use::Read(points),
            Use::Read(&triangles),
            Use::Read(&first),
            Use::Read(&order),
            Use::Write(&generators.centres),
            Use::Write(&generators.areas),
        ],
        &abi::Count {
            count: count as u32,
        },
        count,
    )?;
    Ok(generators)
}

/// Generators that one sum may have: Mesa's software driver ends the loops of an invocation, all
/// together, after 65,535 rounds, and `FIELD_SLOTS` invocations share a sum; the rest is for the
/// rows of bins.
const MOST_IN_REACH: u64 = 60_000 * abi::FIELD_SLOTS as u64;

/// Generators in bin order, their numbers only.
#[derive(Debug)]
pub(super) struct BinnedGenerators {
    grid: BinGrid,
    binned: Binned,
    sorted: Store,
}

impl Generators {
    /// Room for `count` of them.
    pub(super) fn new(r: &mut Recorder<'_>, what: &str, count: usize) -> Result<Self> {
        Ok(Self {
            count,
            centres: r.array::<[f32; 4]>(&format!("{what} centres"), count)?,
            areas: r.array::<f32>(&format!("{what} areas"), count)?,
        })
    }

    /// Sorts the generators into `grid`, ascending inside a bin.
    ///
    /// # Errors
    /// When more than [`MOST_IN_REACH`] of them may act on one point within `reach`.
    pub(super) fn bin(
        &self,
        r: &mut Recorder<'_>,
        grid: BinGrid,
        reach: f32,
    ) -> Result<BinnedGenerators> {
        let binned = bin(r, "generator", &self.centres, self.count, &grid)?;
        self.check_reach(r, &grid, &binned, reach)?;
        let sorted = order(r, "generators", &binned.places, self.count, grid.len())?;
        Ok(BinnedGenerators {
            grid,
            binned,
            sorted,
        })
    }

    /// The image that the field kernels fetch: weights as they are, or areas times `area_scale`.
    /// Refuses what would silently be summed short (see [`MOST_IN_REACH`]).
    fn check_reach(
        &self,
        r: &mut Recorder<'_>,
        grid: &BinGrid,
        binned: &Binned,
        reach: f32,
    ) -> Result<()> {
        if self.count <= MOST_IN_REACH as usize || r.is_plan() {
            return Ok(());
        }
        let first = r.fetch::<u32>("generator firsts", &binned.first, Vec::new)?;
        // Both sides of a point or a small block of them, with the bins that are cut.
        let window = (2.0 * f64::from(reach) / f64::from(grid.edge)).ceil() as u32 + 3;
        let most = most_in_window(&first, grid.bins, [window; 3]);
        if most > MOST_IN_REACH {
            return Err(Error::Unsupported(format!(
                "{most} generators lie within one radius of influence, at most {MOST_IN_REACH} can \
                 be summed; try a smaller radius (rho, rho_ambient) or a fraction of the generators"
            )));
        }
        Ok(())
    }

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
            count: self.count,
            grid: binned.grid,
            first: binned.binned.first.clone(),
            texels,
        })
    }
}
