//! The density field (Luft, Balzer, Deussen 2007, equations 2 and 3) and its grid.
//!
//! Twin of `shaders/foliage/density.comp`: generators lie in bins of one radius, and a point
//! gathers from the 27 bins around it, z outermost, generators of a bin in ascending order.

use glam::DVec3;
use rayon::prelude::*;

use super::generators::{Generator, bounds};

/// Vector norm of equation 2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Norm {
    /// L2, the paper's.
    Euclidean,
    /// L1: octahedral influence.
    Manhattan,
    /// L-infinity: cubic influence.
    Maximum,
}

impl Norm {
    /// Length of `d`.
    #[must_use]
    pub fn length(self, d: DVec3) -> f64 {
        match self {
            Self::Euclidean => d.length(),
            Self::Manhattan => d.abs().element_sum(),
            Self::Maximum => d.abs().max_element(),
        }
    }

    /// Gradient of the length; zero at the origin, the lowest axis where axes tie.
    #[must_use]
    pub fn gradient(self, d: DVec3) -> DVec3 {
        let sign = DVec3::from(
            d.to_array()
                .map(|c| if c == 0.0 { 0.0 } else { c.signum() }),
        );
        match self {
            Self::Euclidean => d.normalize_or_zero(),
            Self::Manhattan => sign,
            Self::Maximum => {
                let a = d.abs();
                if a.x >= a.y && a.x >= a.z {
                    DVec3::new(sign.x, 0.0, 0.0)
                } else if a.y >= a.z {
                    DVec3::new(0.0, sign.y, 0.0)
                } else {
                    DVec3::new(0.0, 0.0, sign.z)
                }
            }
        }
    }
}

/// Integral over space of the Euclidean `D_i` with radius 1: 4 pi (1/3 - 2/5 + 1/7).
pub const KERNEL_VOLUME: f64 = 32.0 * std::f64::consts::PI / 105.0;

/// `D_i` at the offset `d` from its generator (equation 2), without the weight.
#[must_use]
pub fn kernel_density(d: DVec3, radius: f64, norm: Norm) -> f64 {
    let s = norm.length(d) / radius;
    if s < 1.0 { (1.0 - s * s).powi(2) } else { 0.0 }
}

/// grad `D_i` at the offset `d` from its generator.
#[must_use]
pub fn kernel_gradient(d: DVec3, radius: f64, norm: Norm) -> DVec3 {
    let s = norm.length(d) / radius;
    if s < 1.0 {
        -4.0 * (1.0 - s * s) * (s / radius) * norm.gradient(d)
    } else {
        DVec3::ZERO
    }
}

/// Generators sorted into cubic bins whose side is the radius of influence.
#[derive(Debug, Clone)]
struct Bins {
    origin: DVec3,
    size: f64,
    count: [i64; 3],
    /// First entry of each bin in `entries`, closed by the total.
    first: Vec<usize>,
    entries: Vec<usize>,
}

impl Bins {
    fn new(generators: &[Generator], radius: f64) -> Self {
        let (min, max) = bounds(generators);
        // Bins may be larger than the radius, never smaller; this bounds their number.
        let size = radius.max((max - min).max_element() / 128.0);
        let count = ((max - min) / size).to_array().map(|c| c as i64 + 1);
        let mut bins = Self {
            origin: min,
            size,
            count,
            first: Vec::new(),
            entries: vec![0; generators.len()],
        };
        let slots: Vec<usize> = generators
            .iter()
            .map(|g| {
                let b = bins.bin(g.position);
                (b[0] + count[0] * (b[1] + count[1] * b[2])) as usize
            })
            .collect();
        bins.first = vec![0; (count[0] * count[1] * count[2]) as usize + 1];
        for &s in &slots {
            bins.first[s + 1] += 1;
        }
        for s in 1..bins.first.len() {
            bins.first[s] += bins.first[s - 1];
        }
        let mut next = bins.first.clone();
        for (i, &s) in slots.iter().enumerate() {
            bins.entries[next[s]] = i;
            next[s] += 1;
        }
        bins
    }

    fn bin(&self, q: DVec3) -> [i64; 3] {
        ((q - self.origin) / self.size)
            .floor()
            .to_array()
            .map(|c| c.clamp(-4.0, 1e6) as i64)
    }

    fn gather(&self, q: DVec3, mut visit: impl FnMut(usize)) {
        let b = self.bin(q);
        let along = |axis: usize| (b[axis] - 1).max(0)..(b[axis] + 2).min(self.count[axis]);
        for z in along(2) {
            for y in along(1) {
                for x in along(0) {
                    let s = (x + self.count[0] * (y + self.count[1] * z)) as usize;
                    for &i in &self.entries[self.first[s]..self.first[s + 1]] {
                        visit(i);
                    }
                }
            }
        }
    }
}

/// The sum of equation 3 before the threshold: D(q) = sum `w_i` `D_i(q)`.
#[derive(Debug, Clone)]
pub struct Field {
    generators: Vec<Generator>,
    /// Radius of influence, the same for all generators.
    pub radius: f64,
    /// Norm of equation 2.
    pub norm: Norm,
    bins: Option<Bins>,
}

impl Field {
    /// A field of `generators` with one radius (> 0).
    #[must_use]
    pub fn new(generators: &[Generator], radius: f64, norm: Norm) -> Self {
        Self {
            generators: generators.to_vec(),
            radius,
            norm,
            bins: (!generators.is_empty()).then(|| Bins::new(generators, radius)),
        }
    }

    /// Leaf-area density (area per volume, one-sided): the same kernel with unit integral,
    /// weighted with each generator's area. Euclidean norm.
    #[must_use]
    pub fn leaf_area(generators: &[Generator], radius: f64) -> Self {
        let weighted: Vec<Generator> = generators
            .iter()
            .map(|g| Generator {
                weight: g.area / (KERNEL_VOLUME * radius.powi(3)),
                ..*g
            })
            .collect();
        Self::new(&weighted, radius, Norm::Euclidean)
    }

    /// Density at `q`, before the threshold is subtracted.
    #[must_use]
    pub fn density(&self, q: DVec3) -> f64 {
        let mut sum = 0.0;
        if let Some(bins) = &self.bins {
            bins.gather(q, |i| {
                let g = &self.generators[i];
                sum += g.weight * kernel_density(q - g.position, self.radius, self.norm);
            });
        }
        sum
    }

    /// Density and its gradient at `q`.
    #[must_use]
    pub fn density_and_gradient(&self, q: DVec3) -> (f64, DVec3) {
        let (mut sum, mut gradient) = (0.0, DVec3::ZERO);
        if let Some(bins) = &self.bins {
            bins.gather(q, |i| {
                let g = &self.generators[i];
                let d = q - g.position;
                sum += g.weight * kernel_density(d, self.radius, self.norm);
                gradient += g.weight * kernel_gradient(d, self.radius, self.norm);
            });
        }
        (sum, gradient)
    }

    /// Density at every node of `grid`, x fastest.
    #[must_use]
    pub fn density_grid(&self, grid: &Grid) -> Vec<f64> {
        (0..grid.node_count())
            .into_par_iter()
            .map(|i| self.density(grid.position(grid.node(i))))
            .collect()
    }
}

/// A regular grid with one cell size on all axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Position of node (0,0,0).
    pub origin: [f32; 3],
    /// Cell size.
    pub cell: f32,
    /// Nodes per axis (cells + 1).
    pub nodes: [u32; 3],
}

impl Grid {
    /// The grid over the box `min..max` padded by `radius` and one cell, `cells` (>= 3) along its
    /// longest side.
    #[must_use]
    pub fn around(min: DVec3, max: DVec3, radius: f64, cells: u32) -> Self {
        let extent = max - min + 2.0 * radius;
        let cell = extent.max_element() / f64::from(cells - 2);
        // The small allowance keeps the longest side at exactly `cells` despite rounding.
        let counts = extent.to_array().map(|e| (e / cell - 1e-9).ceil() + 2.0);
        let origin = 0.5 * (min + max) - 0.5 * cell * DVec3::from(counts);
        Self {
            origin: origin.as_vec3().to_array(),
            cell: cell as f32,
            nodes: counts.map(|c| c as u32 + 1),
        }
    }

    /// Number of nodes.
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.nodes.iter().map(|&n| n as usize).product()
    }

    /// Node coordinates of a linear index (x fastest).
    #[must_use]
    pub fn node(&self, index: usize) -> [u32; 3] {
        let [nx, ny, _] = self.nodes.map(|n| n as usize);
        [index % nx, index / nx % ny, index / (nx * ny)].map(|c| c as u32)
    }

    /// Linear index of a node.
    #[must_use]
    pub fn index(&self, node: [u32; 3]) -> usize {
        let [nx, ny, _] = self.nodes.map(|n| n as usize);
        let [x, y, z] = node.map(|c| c as usize);
        x + nx * (y + ny * z)
    }

    /// Position of a node.
    #[must_use]
    pub fn position(&self, node: [u32; 3]) -> DVec3 {
        DVec3::from(self.origin.map(f64::from))
            + f64::from(self.cell) * DVec3::from(node.map(f64::from))
    }

    /// The eight nodes around `q` (clamped to the grid) and their trilinear weights.
    #[must_use]
    pub fn corners(&self, q: DVec3) -> [(usize, f64); 8] {
        let u = (q - DVec3::from(self.origin.map(f64::from))) / f64::from(self.cell);
        let (mut low, mut t) = ([0u32; 3], [0.0; 3]);
        for axis in 0..3 {
            let c = u[axis].clamp(0.0, f64::from(self.nodes[axis] - 1));
            low[axis] = (c as u32).min(self.nodes[axis] - 2);
            t[axis] = c - f64::from(low[axis]);
        }
        [0, 1, 2, 3, 4, 5, 6, 7].map(|corner: u32| {
            let bit = [0, 1, 2].map(|axis| corner >> axis & 1);
            let weight = (0..3)
                .map(|a| if bit[a] == 1 { t[a] } else { 1.0 - t[a] })
                .product();
            (self.index([0, 1, 2].map(|a| low[a] + bit[a])), weight)
        })
    }

    /// Trilinear interpolation of node values at `q`, clamped to the grid.
    #[must_use]
    pub fn sample(&self, values: &[f64], q: DVec3) -> f64 {
        self.corners(q)
            .iter()
            .map(|&(node, weight)| weight * values[node])
            .sum()
    }
}
