//! Bins of points and the order of the points in them.
//!
//! Twin of `shaders/foliage/bin_count.comp` and of the radix sort (`radix_count.comp`,
//! `radix_scatter.comp`).

use glam::DVec3;

/// Cubic bins in rows, x fastest.
#[derive(Debug, Clone, Copy)]
pub struct Bins {
    /// Corner of bin (0,0,0).
    pub origin: DVec3,
    /// Edge of a bin.
    pub edge: f64,
    /// Bins per axis.
    pub bins: [u32; 3],
}

impl Bins {
    /// How far `p` lies outside bin `number`, in edges; points outside the box belong to the bins
    /// at its border, so nothing is outside beyond them.
    #[must_use]
    pub fn outside(&self, p: DVec3, number: u32) -> f64 {
        let [nx, ny, _] = self.bins;
        let bin = [number % nx, number / nx % ny, number / (nx * ny)];
        let q = ((p - self.origin) / self.edge).to_array();
        let mut worst = 0.0f64;
        for axis in 0..3 {
            let low = f64::from(bin[axis]);
            if bin[axis] > 0 {
                worst = worst.max(low - q[axis]);
            }
            if bin[axis] + 1 < self.bins[axis] {
                worst = worst.max(q[axis] - (low + 1.0));
            }
        }
        worst
    }
}

/// Numbers of the points in the order of their bins, ascending inside a bin.
#[must_use]
pub fn order(bin_of_point: &[u32]) -> Vec<u32> {
    let mut numbers: Vec<u32> = (0u32..).take(bin_of_point.len()).collect();
    numbers.sort_by_key(|&i| bin_of_point[i as usize]);
    numbers
}
