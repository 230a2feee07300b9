//! What of the implicit surface is nearest to a vertex, and the normal there (Luft, Balzer,
//! Deussen 2007, section 3.3): its nearest vertex (the paper), the nearest point of its
//! triangles, or of F = 0 itself.
//!
//! The search is exact: a hierarchy of boxes over the surface in Morton order, walked without a
//! stack.

use glam::DVec3;

use super::field::{Field, Queries};
use super::recorder::{Kernel, Recorder, Store, Use};
use super::surface::DeviceSurface;
use crate::abi;
use crate::gpu::shaders::foliage as shaders;
use crate::{Error, Result};

/// What is searched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Target {
    /// Vertices of the surface.
    Vertices,
    /// Points of its triangles.
    Faces,
}

impl Target {
    /// Queries that one invocation takes.
    fn block(self) -> u32 {
        match self {
            Self::Vertices => abi::NEAREST_QUERIES,
            Self::Faces => abi::NEAREST_FACE_QUERIES,
        }
    }

    fn constant(self) -> u32 {
        u32::from(self == Self::Faces)
    }
}

/// Nearest item per query: number and barycentric weights, by the query's own number.
#[derive(Debug)]
pub(super) struct Nearest {
    target: Target,
    pub(super) found: Store,
}

/// Boxes per level, the lowest first; the last level has at most `BOX_CHILDREN`.
fn level_counts(items: usize) -> Vec<u32> {
    let fan = abi::BOX_CHILDREN as usize;
    let mut counts = vec![items.div_ceil(fan)];
    while *counts.last().expect("one at least") > fan {
        counts.push(counts.last().expect("one at least").div_ceil(fan));
    }
    counts.iter().map(|&c| c as u32).collect()
}

/// Boxes of one level that one dispatch walks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Roots {
    /// Counted from 1.
    level: u32,
    first: u32,
    last: u32,
}

/// Levels below a root: 8^4 = 4,096 items, whose boxes and items together stay far below the
/// 65,535 rounds after which Mesa's software driver ends an invocation's loops.
const SLICE_LEVELS: u32 = 4;
/// Roots of one dispatch; with them at most 32,768 items, about 42,000 rounds.
const SLICE_ROOTS: u32 = 8;

/// Splits the hierarchy into dispatches that no driver cuts short.
fn slices(counts: &[u32]) -> Vec<Roots> {
    let level = SLICE_LEVELS.min(counts.len() as u32);
    let count = counts[level as usize - 1];
    (0..count)
        .step_by(SLICE_ROOTS as usize)
        .map(|first| Roots {
            level,
            first,
            last: count.min(first + SLICE_ROOTS),
        })
        .collect()
}

/// Finds what of `surface` (which must not be empty) is nearest to each query.
pub(super) fn nearest(
    r: &mut Recorder<'_>,
    surface: &DeviceSurface,
    queries: &Queries,
    target: Target,
    reach: DVec3,
) -> Result<Nearest> {
    let constants = [(0, target.constant())];
    let (points, items) = match target {
        Target::Vertices => (surface.vertices.clone(), surface.vertex_count),
        Target::Faces => (centres(r, surface)?, surface.triangle_count),
    };
    let sorted = Queries::sort(r, "surface items", &points, items, reach)?;
    let counts = level_counts(items);
    let total: u32 = counts.iter().sum();
    let boxes = r.array::<[f32; 6]>("surface boxes", total as usize)?;
    let mut levels: Vec<[u32; 2]> = Vec::new();
    let mut first = 0;
    for (level, &count) in (0u32..).zip(&counts) {
        let below = levels.last().copied().unwrap_or([0, items as u32]);
        r.compute(
            "surface boxes",
            Kernel {
                shader: shaders::SURFACE_BOXES_COMP,
                constants: &constants,
            },
            &[
                Use::Read(&sorted.sorted),
                Use::Read(&surface.vertices),
                Use::Read(&surface.indices),
                Use::ReadWrite(&boxes),
            ],
            &abi::BoxLevel {
                count,
                children: below[1],
                level,
                first,
                child_first: below[0],
            },
            count as usize,
        )?;
        levels.push([first, count]);
        first += count;
    }
    let level_table = r.upload("surface levels", &levels)?;
    let found = r.array::<[f32; 4]>("nearest", queries.count)?;
    for (slice, roots) in slices(&counts).into_iter().enumerate() {
        r.compute(
            "nearest",
            Kernel {
                shader: shaders::NEAREST_COMP,
                constants: &[constants[0], (1, target.block())],
            },
            &[
                Use::Read(&queries.sorted),
                Use::Read(&sorted.sorted),
                Use::Read(&surface.vertices),
                Use::Read(&surface.indices),
                Use::Read(&boxes),
                Use::Read(&level_table),
                Use::ReadWrite(&found),
            ],
            &abi::NearestQueries {
                count: queries.count as u32,
                items: items as u32,
                levels: levels.len() as u32,
                root_level: roots.level,
                root_first: roots.first,
                root_last: roots.last,
                continues: u32::from(slice > 0),
            },
            queries.count.div_ceil(target.block() as usize),
        )?;
    }
    Ok(Nearest { target, found })
}

fn centres(r: &mut Recorder<'_>, surface: &DeviceSurface) -> Result<Store> {
    let centres = r.array::<[f32; 4]>("triangle centres", surface.triangle_count)?;
    r.compute(
        "triangle centres",
        shaders::SURFACE_CENTRES_COMP,
        &[
            Use::Read(&surface.vertices),
            Use::Read(&surface.indices),
            Use::Write(&centres),
        ],
        &abi::Count {
            count: surface.triangle_count as u32,
        },
        surface.triangle_count,
    )?;
    Ok(centres)
}

/// The surface's normals there; the fourth component is 1 (there always is one).
pub(super) fn normals(
    r: &mut Recorder<'_>,
    surface: &DeviceSurface,
    nearest: &Nearest,
    count: usize,
) -> Result<Store> {
    let found = r.array::<[f32; 4]>("directions", count)?;
    r.compute(
        "nearest normals",
        Kernel {
            shader: shaders::NEAREST_NORMALS_COMP,
            constants: &[(0, nearest.target.constant())],
        },
        &[
            Use::Read(&nearest.found),
            Use::Read(&surface.indices),
            Use::Read(&surface.normals),
            Use::Write(&found),
        ],
        &abi::Count {
            count: count as u32,
        },
        count,
    )?;
    Ok(found)
}

/// Dispatches of `exact.comp` between two looks at how many queries are finished.
const EXACT_DISPATCHES: u64 = 4;

/// Dispatches after which `exact.comp` must have finished: every Newton and every descent step
/// may sum over all generators, one turn sums `EXACT_ROUNDS` batches or empty rows.
fn most_exact_dispatches(generators: usize, bins: usize) -> u64 {
    let rounds = generators as u64 / u64::from(abi::EXACT_BATCH) + 2 * bins as u64;
    let turns_per_sum = rounds / u64::from(abi::EXACT_ROUNDS) + 1;
    let sums = u64::from(abi::EXACT_DESCENT_STEPS + 1) * u64::from(abi::EXACT_NEWTON_STEPS + 1);
    sums * turns_per_sum / u64::from(abi::EXACT_TURNS) + EXACT_DISPATCHES
}

/// Replaces `directions` by the normals of F = 0 at its points nearest to the queries, sought
/// from the nearest points of the triangles. Where no point of F = 0 is found they stay. Returns
/// how many queries took the most descent steps without coming to rest.
///
/// # Errors
/// When queries are left after as many dispatches as all steps can take; a failing device.
pub(super) fn exact(
    r: &mut Recorder<'_>,
    (field, tau): (&Field<'_>, f32),
    surface: &DeviceSurface,
    queries: &Queries,
    nearest: &Nearest,
    directions: &Store,
) -> Result<usize> {
    assert_eq!(
        nearest.target,
        Target::Faces,
        "the search starts on the triangles"
    );
    let grid = &field.generators.grid;
    let states = r.array::<abi::ExactState>("exact states", queries.count)?;
    let counters = r.array::<u32>("exact counters", 2)?;
    r.fill("clear exact counters", &counters, 0)?;
    let mut push = abi::ExactQueries {
        bin_origin: grid.origin,
        bin_edge: grid.edge,
        bins: grid.bins,
        radius: field.radius,
        count: queries.count as u32,
        tau,
        continues: 0,
    };
    let most = most_exact_dispatches(field.generators.count, grid.len());
    let mut dispatches = 0;
    loop {
        for _ in 0..EXACT_DISPATCHES {
            r.compute(
                "exact normals",
                Kernel {
                    shader: shaders::EXACT_COMP,
                    constants: &[(0, field.norm.constant())],
                },
                &[
                    Use::Fetch(&field.generators.texels),
                    Use::Read(&field.generators.first),
                    Use::Read(&queries.sorted),
                    Use::Read(&nearest.found),
                    Use::Read(&surface.vertices),
                    Use::Read(&surface.indices),
                    Use::ReadWrite(&states),
                    Use::ReadWrite(directions),
                    Use::ReadWrite(&counters),
                ],
                &push,
                queries.count,
            )?;
            push.continues = 1;
        }
        dispatches += EXACT_DISPATCHES;
        let counted = r.fetch::<u32>("exact counters", &counters, || vec![push.count, 0])?;
        let left = queries.count - counted[0] as usize;
        if left == 0 {
            return Ok(counted[1] as usize);
        }
        if dispatches >= most {
            return Err(Error::Unsupported(format!(
                "exact normals: {left} of {} vertices are not finished after {dispatches} \
                 dispatches, more than all steps take; try normals = face",
                queries.count
            )));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_top_level_is_small_and_every_level_covers_the_one_below() {
        for items in [1usize, 7, 8, 9, 64, 65, 4097, 34_294, 1_000_000] {
            let counts = level_counts(items);
            assert!(
                *counts.last().unwrap() <= abi::BOX_CHILDREN,
                "{items}: {counts:?}"
            );
            let roots = slices(&counts);
            let level = roots[0].level;
            assert!(
                roots
                    .windows(2)
                    .all(|w| w[0].last == w[1].first && w[1].level == level)
            );
            assert_eq!(
                (roots[0].first, roots[roots.len() - 1].last),
                (0, counts[level as usize - 1])
            );
            let mut below = items as u32;
            for count in counts {
                assert!(
                    count * abi::BOX_CHILDREN >= below && (count - 1) * abi::BOX_CHILDREN < below
                );
                below = count;
            }
        }
    }
}
