//! A fraction of the generators (Luft, Balzer, Deussen 2007, section 3.1: "randomly selecting just
//! a fraction"), chosen and merged on the device.
//!
//! Stratified: voxels on an integer lattice. Their edge is found by halving, each time counting the
//! occupied voxels in a hash table; then every voxel's generators become one. Plain: a number is
//! drawn for every generator.

use super::bins::scan;
use super::generators::Generators;
use super::recorder::{Kernel, Recorder, Store, Use};
use super::settings::{Sampling, Settings};
use crate::abi;
use crate::gpu::shaders::foliage as shaders;
use crate::math::sampling;
use crate::{Error, Result};

/// Steps of the voxel sizes per doubling: neighbouring sizes differ by half a percent.
const SIZES_PER_OCTAVE: u32 = 128;
/// The smallest voxels are 1/4096 of the frame's diagonal.
const FINEST_BITS: u32 = abi::SUBSET_LATTICE_BITS - 12;
/// The largest ones hold the whole frame wherever they begin.
const COARSEST_BITS: u32 = abi::SUBSET_LATTICE_BITS + 2;

/// Edges of voxels in lattice steps, ascending.
fn edges() -> Vec<u32> {
    let octaves = COARSEST_BITS - FINEST_BITS;
    let edge = |k: u32| {
        let exponent = f64::from(FINEST_BITS) + f64::from(k) / f64::from(SIZES_PER_OCTAVE);
        exponent.exp2().round() as u32
    };
    (0..=octaves * SIZES_PER_OCTAVE).map(edge).collect()
}

/// About `fraction` of the generators and at most `most_generators`, never none.
pub(super) fn subset(
    r: &mut Recorder<'_>,
    all: Generators,
    settings: &Settings,
) -> Result<Generators> {
    let bound = f64::from(settings.most_generators) / all.count.max(1) as f64;
    let fraction = f64::from(settings.fraction).min(bound);
    if fraction >= 1.0 || all.count < 2 {
        return Ok(all);
    }
    let target = ((fraction * all.count as f64).round() as usize).max(1);
    // How many are left shows on the device.
    r.estimated = true;
    match settings.sampling {
        Sampling::Plain => plain(r, &all, (fraction, target), settings.seed),
        Sampling::Stratified => stratified(r, &all, target, settings.seed),
    }
}

/// Those that draw a number below `fraction`, or the one that draws the least; a recipe expects
/// `target` of them.
fn plain(
    r: &mut Recorder<'_>,
    all: &Generators,
    (fraction, target): (f64, usize),
    seed: u32,
) -> Result<Generators> {
    let draw = r.upload("subset draw", &[u32::MAX, 0])?;
    let flags = r.array::<u32>("subset flags", all.count)?;
    let push = abi::SubsetDraw {
        count: all.count as u32,
        hashed_seed: sampling::pcg(seed),
        threshold: (fraction * 4_294_967_296.0).ceil() as u32,
    };
    for last in [0, 1] {
        r.compute(
            "draw subset",
            Kernel {
                shader: shaders::SUBSET_DRAW_COMP,
                constants: &[(0, last)],
            },
            &[Use::ReadWrite(&draw), Use::Write(&flags)],
            &push,
            all.count,
        )?;
    }
    let firsts = scan(r, "subset", &flags, all.count)?;
    let drawn = r.fetch::<u32>("subset draw", &draw, || vec![0, target as u32])?;
    let kept = Generators::new(r, "subset", drawn[1] as usize)?;
    r.compute(
        "emit subset",
        shaders::SUBSET_EMIT_COMP,
        &[
            Use::Read(&all.centres),
            Use::Read(&all.areas),
            Use::Read(&firsts),
            Use::Write(&kept.centres),
            Use::Write(&kept.areas),
        ],
        &abi::SubsetEmit {
            count: all.count as u32,
            scale: (1.0 / fraction) as f32,
        },
        all.count,
    )?;
    Ok(kept)
}

/// The hash table of voxels and the search for their size.
struct Voxels<'a> {
    all: &'a Generators,
    edges: Store,
    search: Store,
    table: Store,
    /// Place in the table of every generator.
    places: Store,
    /// First generator of every place.
    leaders: Store,
    push: abi::SubsetVoxels,
}

impl<'a> Voxels<'a> {
    fn new(r: &mut Recorder<'_>, all: &'a Generators, seed: u32) -> Result<Self> {
        let edges = edges();
        let places = (2 * all.count).next_power_of_two();
        let search = abi::SubsetSearch {
            high: edges.len() as u32 - 1,
            ..Default::default()
        };
        Ok(Self {
            all,
            edges: r.upload("subset edges", &edges)?,
            search: r.upload("subset search", &[search])?,
            table: r.array::<u32>("subset table", places)?,
            places: r.array::<u32>("subset places", all.count)?,
            leaders: r.array::<u32>("subset leaders", places)?,
            push: abi::SubsetVoxels {
                count: all.count as u32,
                table_mask: places as u32 - 1,
                shift: [0, 1, 2].map(|axis| sampling::pcg(axis ^ sampling::pcg(seed)) >> 22),
            },
        })
    }

    /// Counts the voxels of the size that the search has come to, or of the one that it found.
    fn count(&self, r: &mut Recorder<'_>, found: bool) -> Result<()> {
        r.fill("clear subset table", &self.table, abi::SUBSET_NONE)?;
        r.compute(
            "count voxels",
            Kernel {
                shader: shaders::SUBSET_VOXELS_COMP,
                constants: &[(0, u32::from(found))],
            },
            &[
                Use::Read(&self.all.centres),
                Use::Read(&self.edges),
                Use::ReadWrite(&self.search),
                Use::ReadWrite(&self.table),
                Use::Write(&self.places),
                Use::ReadWrite(&self.leaders),
            ],
            &self.push,
            self.all.count,
        )
    }

    /// Finds the smallest voxels of which at most `target` are occupied.
    fn find(&self, r: &mut Recorder<'_>, target: usize) -> Result<()> {
        let sizes = (COARSEST_BITS - FINEST_BITS) * SIZES_PER_OCTAVE + 1;
        for _ in 0..u32::BITS - (sizes - 1).leading_zeros() {
            self.count(r, false)?;
            r.compute(
                "choose voxels",
                shaders::SUBSET_DECIDE_COMP,
                &[Use::ReadWrite(&self.search)],
                &abi::Count {
                    count: target as u32,
                },
                1,
            )?;
        }
        r.fill("clear subset leaders", &self.leaders, abi::SUBSET_NONE)?;
        self.count(r, true)
    }
}

/// Merges the generators of every voxel; the voxels are so large that at most `target` are left.
fn stratified(
    r: &mut Recorder<'_>,
    all: &Generators,
    target: usize,
    seed: u32,
) -> Result<Generators> {
    let voxels = Voxels::new(r, all, seed)?;
    voxels.find(r, target)?;
    let (
        Voxels {
            places, leaders, ..
        },
        count,
    ) = (&voxels, all.count);
    let flags = r.array::<u32>("subset flags", count)?;
    let push = abi::Count {
        count: count as u32,
    };
    r.compute(
        "lead voxels",
        shaders::SUBSET_LEAD_COMP,
        &[Use::Read(places), Use::Read(leaders), Use::Write(&flags)],
        &push,
        count,
    )?;
    let firsts = scan(r, "subset", &flags, count)?;
    let search = r.fetch("subset search", &voxels.search, || {
        vec![abi::SubsetSearch {
            voxels: target as u32,
            ..Default::default()
        }]
    })?[0];
    if search.lost > 0 {
        return Err(Error::Unsupported(format!(
            "{} of {count} generators found no place in the table of voxels; try another seed, or \
             sampling = plain",
            search.lost
        )));
    }
    let merged = Generators::new(r, "subset", search.voxels as usize)?;
    let words = abi::SUBSET_SUM_WORDS as usize * merged.count;
    let sums = r.array::<u32>("subset sums", words)?;
    r.fill("clear subset sums", &sums, 0)?;
    r.compute(
        "merge subset",
        shaders::SUBSET_MERGE_COMP,
        &[
            Use::Read(&all.centres),
            Use::Read(&all.areas),
            Use::Read(places),
            Use::Read(leaders),
            Use::Read(&firsts),
            Use::ReadWrite(&sums),
        ],
        &push,
        count,
    )?;
    r.compute(
        "emit subset",
        shaders::SUBSET_MEAN_COMP,
        &[
            Use::Read(&sums),
            Use::Write(&merged.centres),
            Use::Write(&merged.areas),
        ],
        &abi::Count {
            count: merged.count as u32,
        },
        merged.count,
    )?;
    Ok(merged)
}
