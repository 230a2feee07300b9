//! Sorting points into uniform bins: count, scan, emit.

use glam::DVec3;

use super::recorder::{Recorder, Store, Use};
use crate::Result;
use crate::abi;
use crate::gpu::shaders::foliage as shaders;

/// Bins at most: bounds memory and the scan, whatever the radius.
const MOST_BINS: f64 = 262_144.0;

/// A box of cubic bins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BinGrid {
    pub(super) origin: [f32; 3],
    pub(super) edge: f32,
    pub(super) bins: [u32; 3],
    morton: bool,
}

impl BinGrid {
    /// Bins of about `edge` over the box `-half..half`, x fastest.
    pub(super) fn rows(half: DVec3, edge: f64) -> Self {
        let mut edge = edge;
        loop {
            let bins = (2.0 * half / edge).floor() + 1.0;
            if bins.element_product() <= MOST_BINS {
                return Self {
                    origin: (-half).as_vec3().to_array(),
                    edge: edge as f32,
                    bins: bins.to_array().map(|b| b as u32),
                    morton: false,
                };
            }
            edge *= 1.1;
        }
    }

    /// Bins for generators: the support's cross-section holds a few rows, a row enough generators
    /// to keep the slots busy, and the smallest radius still skips most of them.
    pub(super) fn for_generators(half: DVec3, count: usize, radii: &[f32]) -> Self {
        let radius = |pick: fn(f64, f64) -> f64| radii.iter().map(|&r| f64::from(r)).reduce(pick);
        let small = radius(f64::min).unwrap_or(0.1);
        let large = radius(f64::max).unwrap_or(0.1);
        let volume = (2.0 * half).max(DVec3::splat(0.05)).element_product();
        // Generators per row of the large support, about: density * edge^2 * 2 radius.
        let busy = 4.0 * f64::from(abi::FIELD_SLOTS);
        let edge = (busy * volume / (count.max(1) as f64 * 2.0 * large)).sqrt();
        Self::rows(half, edge.clamp(large / 4.0, large).max(small / 4.0))
    }

    /// Cubic bins in Morton order over the box `-half..half` for `count` points.
    pub(super) fn morton(half: DVec3, count: usize) -> Self {
        let side = match count {
            0..4096 => 16u32,
            4096..65_536 => 32,
            _ => 64,
        };
        let extent = (2.0 * half.max_element()).max(1e-6);
        Self {
            origin: (-half).as_vec3().to_array(),
            edge: (extent / f64::from(side) * 1.000_01) as f32,
            bins: [side; 3],
            morton: true,
        }
    }

    /// Number of bins.
    pub(super) fn len(&self) -> usize {
        self.bins.iter().map(|&b| b as usize).product()
    }

    pub(super) fn push(&self, count: usize, area_scale: f32) -> abi::BinPoints {
        abi::BinPoints {
            origin: self.origin,
            inverse_edge: 1.0 / self.edge,
            bins: self.bins,
            count: count as u32,
            morton: u32::from(self.morton),
            area_scale,
        }
    }
}

/// Points counted into bins.
#[derive(Debug, Clone)]
pub(super) struct Binned {
    /// First sorted point of every bin, closed by the total.
    pub(super) first: Store,
    /// Bin and place of every point.
    pub(super) places: Store,
}

/// Counts and scans `count` points (four floats each) of `what`.
pub(super) fn bin(
    r: &mut Recorder<'_>,
    what: &str,
    points: &Store,
    count: usize,
    grid: &BinGrid,
) -> Result<Binned> {
    let counts = r.array::<u32>(&format!("{what} bin counts"), grid.len())?;
    let places = r.array::<[u32; 2]>(&format!("{what} places"), count)?;
    r.fill(&format!("clear {what} bins"), &counts, 0)?;
    r.compute(
        &format!("count {what}"),
        shaders::BIN_COUNT_COMP,
        &[
            Use::Read(points),
            Use::ReadWrite(&counts),
            Use::Write(&places),
        ],
        &grid.push(count, 0.0),
        count,
    )?;
    let first = scan(r, what, &counts, grid.len())?;
    Ok(Binned { first, places })
}

/// Numbers of `count` points in the order of their bins, ascending inside a bin, so that sums over
/// a bin have one order whatever the atomics of [`bin`] did.
///
/// Stable radix sort: bounded loops also where all points share one bin.
pub(super) fn order(
    r: &mut Recorder<'_>,
    what: &str,
    places: &Store,
    count: usize,
    bins: usize,
) -> Result<Store> {
    let blocks = count.div_ceil(abi::RADIX_BLOCK as usize);
    let table = blocks << abi::RADIX_BITS;
    let mut sorted = r.array::<u32>(&format!("{what} order"), count)?;
    let mut before = r.array::<u32>(&format!("{what} order, one digit before"), count)?;
    let label = format!("order {what}");
    let bits = usize::BITS - bins.saturating_sub(1).leading_zeros();
    for shift in (0..bits.max(1)).step_by(abi::RADIX_BITS as usize) {
        std::mem::swap(&mut sorted, &mut before);
        let push = abi::Radix {
            count: count as u32,
            blocks: blocks as u32,
            shift,
        };
        let counts = r.array::<u32>(&format!("{what} digit counts"), table)?;
        r.fill(&label, &counts, 0)?;
        r.compute(
            &label,
            shaders::RADIX_COUNT_COMP,
            &[
                Use::Read(places),
                Use::Read(&before),
                Use::ReadWrite(&counts),
            ],
            &push,
            blocks,
        )?;
        let offsets = scan(r, &format!("{what} digits"), &counts, table)?;
        r.compute(
            &label,
            shaders::RADIX_SCATTER_COMP,
            &[
                Use::Read(places),
                Use::Read(&before),
                Use::ReadWrite(&offsets),
                Use::Write(&sorted),
            ],
            &push,
            blocks,
        )?;
    }
    Ok(sorted)
}

/// Most points in any box of `window` bins, from the bins' first points (rows, x fastest).
///
/// Summed-area table (Crow 1984) in three dimensions.
pub(super) fn most_in_window(first: &[u32], bins: [u32; 3], window: [u32; 3]) -> u64 {
    let [nx, ny, nz] = bins.map(|b| b as usize);
    let at = |x: usize, y: usize, z: usize| x + (nx + 1) * (y + (ny + 1) * z);
    let mut sums = vec![0u64; (nx + 1) * (ny + 1) * (nz + 1)];
    for z in 0..nz {
        for y in 0..ny {
            let mut row = 0;
            for x in 0..nx {
                let bin = x + nx * (y + ny * z);
                row += u64::from(first[bin + 1] - first[bin]);
                sums[at(x + 1, y + 1, z + 1)] =
                    row + sums[at(x + 1, y, z + 1)] + sums[at(x + 1, y + 1, z)]
                        - sums[at(x + 1, y, z)];
            }
        }
    }
    let [wx, wy, wz] = [0, 1, 2].map(|a| window[a].min(bins[a]) as usize);
    let mut most = 0;
    for z in wz..=nz {
        for y in wy..=ny {
            for x in wx..=nx {
                let s = |a: usize, b: usize, c: usize| sums[at(a, b, c)];
                let plus =
                    s(x, y, z) + s(x - wx, y - wy, z) + s(x - wx, y, z - wz) + s(x, y - wy, z - wz);
                let minus =
                    s(x - wx, y, z) + s(x, y - wy, z) + s(x, y, z - wz) + s(x - wx, y - wy, z - wz);
                most = most.max(plus - minus);
            }
        }
    }
    most
}

/// Exclusive prefix sum of `count` words, closed by the total.
pub(super) fn scan(
    r: &mut Recorder<'_>,
    what: &str,
    values: &Store,
    count: usize,
) -> Result<Store> {
    let chunks = count.div_ceil(abi::SCAN_CHUNK as usize);
    let label = format!("scan {what}");
    let bases = if chunks > 1 {
        let sums = r.array::<u32>(&format!("{what} chunk sums"), chunks)?;
        r.compute(
            &label,
            shaders::SCAN_SUMS_COMP,
            &[Use::Read(values), Use::Write(&sums)],
            &abi::Scan {
                count: count as u32,
                has_bases: 0,
            },
            chunks,
        )?;
        Some(scan(r, what, &sums, chunks)?)
    } else {
        None
    };
    let firsts = r.array::<u32>(&format!("{what} firsts"), count + 1)?;
    r.compute(
        &label,
        shaders::SCAN_APPLY_COMP,
        &[
            Use::Read(values),
            Use::Read(bases.as_ref().unwrap_or(values)),
            Use::Write(&firsts),
        ],
        &abi::Scan {
            count: count as u32,
            has_bases: u32::from(bases.is_some()),
        },
        chunks,
    )?;
    Ok(firsts)
}

#[cfg(test)]
mod tests {
    use super::most_in_window;

    #[test]
    fn the_fullest_window_is_found() {
        // 3 x 2 x 1 bins with 1, 0, 5 / 2, 7, 0 points.
        let first = [0, 1, 1, 6, 8, 15, 15];
        assert_eq!(most_in_window(&first, [3, 2, 1], [1, 1, 1]), 7);
        assert_eq!(most_in_window(&first, [3, 2, 1], [2, 2, 1]), 12);
        assert_eq!(most_in_window(&first, [3, 2, 1], [9, 9, 9]), 15);
    }
}
