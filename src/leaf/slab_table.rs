//! The slab by table: `A(omega, Delta)` and `B(omega, Delta)` for light at normal incidence.
//!
//! 33 x 33 values over `s = sqrt(1 - omega)` and `ln Delta`, joined by the interpolating bicubic
//! spline. What is kept are the spline's coefficients, so that a read is 16 fetches and no search;
//! `shaders/include/leaf_slab.glsl` reads the same numbers.
//!
//! Thick slabs of little absorption change within less than a cell, as `sinh(k (Delta + 2 z0))`
//! does (k: the discrete eigenvalue, z0 the extrapolated end; van de Hulst 1980, ch. 5). That
//! known part is taken out before tabulation and put in again after the read:
//!
//! ```text
//! P = A + Q,  Q = B e^{-k x},  x = Delta + 2 z0       table: ln P,  ln (B sinh(k x) / k)
//! ```
//!
//! Both are smooth, and beyond the thickest node both stay what they are there.

use std::sync::LazyLock;

use rayon::prelude::*;

use crate::abi::{
    SLAB_COEFFICIENTS, SLAB_LN_THICK, SLAB_LN_THIN, SLAB_NODES, SLAB_SQRT_3, SLAB_TWO_ENDS,
};
use crate::math::slab::{Albedo, Incidence};

const NODES: usize = SLAB_NODES as usize;
const COEFFICIENTS: usize = SLAB_COEFFICIENTS as usize;
/// Ends of the axis of thickness, `ln Delta`.
const THIN: f64 = SLAB_LN_THIN as f64;
const THICK: f64 = SLAB_LN_THICK as f64;
/// Nodes per unit of `ln Delta`.
const PER_LN: f64 = (NODES - 1) as f64 / (THICK - THIN);
/// Twice the extrapolated end of a conservative slab.
const TWO_ENDS: f64 = SLAB_TWO_ENDS as f64;
const SQRT_3: f64 = SLAB_SQRT_3 as f64;

/// Reflectance and transmittance of a slab and how they change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    /// Reflected.
    pub r: f64,
    /// Transmitted, scattered or not.
    pub t: f64,
}

/// The spline's coefficients.
#[derive(Debug, Clone)]
pub struct SlabTable {
    coefficients: Vec<[f32; 2]>,
}

static SHARED: LazyLock<SlabTable> = LazyLock::new(SlabTable::build);

impl SlabTable {
    /// The table, built at its first use.
    #[must_use]
    pub fn shared() -> &'static Self {
        &SHARED
    }

    /// Solves the 33 x 33 slabs and finds the spline through them.
    #[must_use]
    pub fn build() -> Self {
        let rows: Vec<Vec<[f64; 2]>> = (0..NODES)
            .into_par_iter()
            .map(|i| {
                let s = i as f64 / (NODES - 1) as f64;
                let slab = Albedo::new(1.0 - s * s).expect("between 0 and 1");
                let row: Vec<[f64; 2]> = (0..NODES)
                    .map(|j| {
                        let light = slab.solve(node_delta(j), Incidence::Beam(1.0));
                        let known = Known::new(s, node_delta(j));
                        let q = light.b * (-known.kx).exp();
                        [(light.a + q).ln(), light.b.ln() + known.ln_sinh]
                    })
                    .collect();
                spline(&row)
            })
            .collect();
        let mut coefficients = vec![[0.0; 2]; COEFFICIENTS * COEFFICIENTS];
        for j in 0..COEFFICIENTS {
            let column: Vec<[f64; 2]> = rows.iter().map(|row| row[j]).collect();
            for (i, c) in spline(&column).into_iter().enumerate() {
                coefficients[i * COEFFICIENTS + j] = c.map(|v| v as f32);
            }
        }
        Self { coefficients }
    }

    /// The coefficients as the device reads them: rows of `sqrt(1 - omega)`, thickness fastest.
    #[must_use]
    pub fn coefficients(&self) -> &[[f32; 2]] {
        &self.coefficients
    }

    /// `(A, B)` of a slab; `omega` is clamped to \[0, 1\], `delta` to what is not negative.
    #[must_use]
    pub fn read(&self, omega: f64, delta: f64) -> (f64, f64) {
        self.at(omega).read(delta)
    }

    /// Reflectance and transmittance of a slab at normal incidence.
    #[must_use]
    pub fn share(&self, omega: f64, delta: f64) -> Share {
        self.at(omega).share(delta)
    }

    /// The table of one albedo, for many thicknesses.
    #[must_use]
    pub fn at(&self, omega: f64) -> Column {
        let omega = omega.clamp(0.0, 1.0);
        let s = (1.0 - omega).sqrt();
        let (first, weights, slopes) = cubic(s * (NODES - 1) as f64);
        let mut values = [[0.0; 2]; COEFFICIENTS];
        let mut by_s = [[0.0; 2]; COEFFICIENTS];
        for (k, (w, d)) in weights.iter().zip(slopes).enumerate() {
            let row = &self.coefficients[(first + k) * COEFFICIENTS..][..COEFFICIENTS];
            for (j, c) in row.iter().enumerate() {
                for q in 0..2 {
                    values[j][q] += w * f64::from(c[q]);
                    by_s[j][q] += d * (NODES - 1) as f64 * f64::from(c[q]);
                }
            }
        }
        Column {
            omega,
            s,
            values,
            by_s,
        }
    }
}

/// The optical thickness of a node.
fn node_delta(j: usize) -> f64 {
    (THIN + j as f64 / PER_LN).exp()
}

/// One albedo of the table.
#[derive(Debug, Clone)]
pub struct Column {
    omega: f64,
    s: f64,
    values: [[f64; 2]; COEFFICIENTS],
    by_s: [[f64; 2]; COEFFICIENTS],
}

impl Column {
    /// `(A, B)` at a thickness.
    #[must_use]
    pub fn read(&self, delta: f64) -> (f64, f64) {
        if delta < THIN.exp() || delta.is_nan() {
            self.thin(delta)
        } else {
            self.inside(delta)
        }
    }

    /// Reflectance and transmittance at a thickness.
    #[must_use]
    pub fn share(&self, delta: f64) -> Share {
        let (a, b) = self.read(delta);
        Share {
            r: 0.5 * self.omega * a,
            t: (-delta).exp() + 0.5 * self.omega * b,
        }
    }

    /// `d ln A` and `d ln B` by `omega` and by `ln Delta`, inside the table; `None` outside.
    #[must_use]
    pub(super) fn slopes(&self, ln_delta: f64) -> Option<[[f64; 2]; 2]> {
        if !(THIN..=THICK).contains(&ln_delta) || self.s < 1e-4 {
            return None;
        }
        let (first, weights, slopes) = cubic((ln_delta - THIN) * PER_LN);
        let [mut value, mut by_s, mut by_v] = [[0.0; 2]; 3];
        for q in 0..2 {
            for k in 0..4 {
                value[q] += weights[k] * self.values[first + k][q];
                by_s[q] += weights[k] * self.by_s[first + k][q];
                by_v[q] += slopes[k] * self.values[first + k][q] * PER_LN;
            }
        }
        let delta = ln_delta.exp();
        let known = Known::new(self.s, delta);
        let ln_b = value[1] - known.ln_sinh;
        let (p, q) = (value[0].exp(), (ln_b - known.kx).exp());
        // d s / d omega = -1 / (2 s).
        let to_omega = -0.5 / self.s;
        let x = delta + TWO_ENDS;
        let lb = [
            to_omega * (by_s[1] - known.by_k() * slope_of_eigenvalue(self.s)),
            by_v[1] - delta * known.k_coth,
        ];
        let lq = [
            lb[0] - to_omega * x * slope_of_eigenvalue(self.s),
            lb[1] - delta * known.k,
        ];
        let la = |slope: f64, lq: f64| (p * slope - q * lq) / (p - q);
        Some([[la(to_omega * by_s[0], lq[0]), la(by_v[0], lq[1])], lb])
    }

    /// Transmittance and its slope by `ln Delta`.
    #[must_use]
    pub(super) fn transmittance(&self, delta: f64) -> (f64, f64) {
        let v = delta.ln();
        let direct = (-delta).exp();
        if !(THIN..=THICK).contains(&v) {
            const H: f64 = 1e-4;
            let at = |h: f64| self.share(delta * h.exp()).t;
            return (self.share(delta).t, (at(H) - at(-H)) / (2.0 * H));
        }
        let (first, weights, slopes) = cubic((v - THIN) * PER_LN);
        let (mut ln_b, mut by_v) = (0.0, 0.0);
        for k in 0..4 {
            ln_b += weights[k] * self.values[first + k][1];
            by_v += slopes[k] * self.values[first + k][1] * PER_LN;
        }
        let known = Known::new(self.s, delta);
        let scattered = 0.5 * self.omega * (ln_b - known.ln_sinh).exp();
        (
            direct + scattered,
            scattered * (by_v - delta * known.k_coth) - delta * direct,
        )
    }

    /// `(A, B)` in the table and beyond its thick end.
    fn inside(&self, delta: f64) -> (f64, f64) {
        let (first, weights, _) = cubic((delta.ln().min(THICK) - THIN) * PER_LN);
        let [ln_p, ln_b] = [0, 1].map(|q| {
            (0..4)
                .map(|k| weights[k] * self.values[first + k][q])
                .sum::<f64>()
        });
        let known = Known::new(self.s, delta);
        let b = (ln_b - known.ln_sinh).exp();
        (ln_p.exp() - b * (-known.kx).exp(), b)
    }

    /// A = B = Delta in the limit; the first correction, Delta ln Delta, joins it to the table.
    fn thin(&self, delta: f64) -> (f64, f64) {
        if delta <= 0.0 || delta.is_nan() {
            return (0.0, 0.0);
        }
        let edge = THIN.exp();
        let t = delta / edge * (1.0 - delta.ln()) / (1.0 - THIN);
        let (a, b) = self.inside(edge);
        let toward = |at_edge: f64| delta * ((at_edge / edge).ln() * t).exp();
        (toward(a), toward(b))
    }
}

/// The part of a slab's light that is known in closed form.
struct Known {
    k: f64,
    x: f64,
    /// `k x`.
    kx: f64,
    /// `ln (sinh(k x) / k)`.
    ln_sinh: f64,
    /// `k coth(k x)`.
    k_coth: f64,
}

impl Known {
    fn new(s: f64, delta: f64) -> Self {
        let k = eigenvalue_of(s);
        let x = delta + TWO_ENDS;
        let kx = k * x;
        let e = (-2.0 * kx).exp();
        // (1 - e^{-2 k x}) / (2 k), whose limit for k = 0 is x.
        let rest = if kx < 5e-4 {
            x * (1.0 - kx)
        } else {
            (1.0 - e) / (2.0 * k)
        };
        Self {
            k,
            x,
            kx,
            ln_sinh: kx + rest.ln(),
            k_coth: 0.5 * (1.0 + e) / rest,
        }
    }

    /// Slope of `ln_sinh` by k.
    fn by_k(&self) -> f64 {
        if self.kx < 1e-3 {
            self.kx * self.x / 3.0
        } else {
            (self.x * self.k_coth - 1.0) / self.k
        }
    }
}

/// The discrete eigenvalue from `s = sqrt(1 - omega)`, by its series about omega = 1. Elsewhere it
/// only has to be smooth.
fn eigenvalue_of(s: f64) -> f64 {
    let q = s * s;
    SQRT_3 * s * (1.0 - q * (0.4 + q * (12.0 / 175.0)))
}

fn slope_of_eigenvalue(s: f64) -> f64 {
    let q = s * s;
    SQRT_3 * (1.0 - q * (1.2 + q * (12.0 / 35.0)))
}

/// First coefficient, weights and their slopes of the uniform cubic B-spline at `x` in units of
/// nodes.
fn cubic(x: f64) -> (usize, [f64; 4], [f64; 4]) {
    let cell = x.floor().clamp(0.0, (NODES - 2) as f64);
    let f = x - cell;
    let g = 1.0 - f;
    let weights = [
        g * g * g / 6.0,
        (3.0 * f * f * f - 6.0 * f * f + 4.0) / 6.0,
        (3.0 * g * g * g - 6.0 * g * g + 4.0) / 6.0,
        f * f * f / 6.0,
    ];
    let slopes = [
        -0.5 * g * g,
        0.5 * (3.0 * f * f - 4.0 * f),
        0.5 * (4.0 * g - 3.0 * g * g),
        0.5 * f * f,
    ];
    (cell as usize, weights, slopes)
}

/// Coefficients of the cubic spline through equidistant values; at both ends the outermost two
/// cells share one cubic ("not a knot").
fn spline(values: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let n = values.len() + 2;
    let mut rows = vec![vec![0.0; n]; n];
    let mut rhs = vec![[0.0; 2]; n];
    for (i, v) in values.iter().enumerate() {
        rows[i + 1][i..i + 3].copy_from_slice(&[1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0]);
        rhs[i + 1] = *v;
    }
    const KNOTLESS: [f64; 5] = [1.0, -4.0, 6.0, -4.0, 1.0];
    rows[0][..5].copy_from_slice(&KNOTLESS);
    rows[n - 1][n - 5..].copy_from_slice(&KNOTLESS);
    for column in 0..n {
        let pivot = (column..n)
            .max_by(|&i, &j| rows[i][column].abs().total_cmp(&rows[j][column].abs()))
            .expect("rows remain");
        rows.swap(column, pivot);
        rhs.swap(column, pivot);
        let (head, head_rhs) = (rows[column].clone(), rhs[column]);
        for row in column + 1..n {
            let factor = rows[row][column] / head[column];
            if factor != 0.0 {
                (column..n).for_each(|k| rows[row][k] -= factor * head[k]);
                (0..2).for_each(|q| rhs[row][q] -= factor * head_rhs[q]);
            }
        }
    }
    for row in (0..n).rev() {
        let (upper, solved) = rhs.split_at_mut(row + 1);
        for (factor, known) in rows[row][row + 1..].iter().zip(solved.iter()) {
            (0..2).for_each(|q| upper[row][q] -= factor * known[q]);
        }
        upper[row] = upper[row].map(|v| v / rows[row][row]);
    }
    rhs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::slab::solve;

    #[test]
    fn the_spline_meets_its_values_and_repeats_cubics() {
        let cubic_of = |x: f64| [x * x * x - 20.0 * x * x, 3.0 - x];
        let values: Vec<[f64; 2]> = (0..NODES).map(|i| cubic_of(i as f64)).collect();
        let c = spline(&values);
        for x in [0.0, 0.3, 1.7, 15.5, 31.2, 32.0] {
            let (first, w, d) = cubic(x);
            for (q, expected) in cubic_of(x).into_iter().enumerate() {
                let found: f64 = (0..4).map(|k| w[k] * c[first + k][q]).sum();
                assert!((found - expected).abs() < 1e-8, "{x}: {found} {expected}");
            }
            let slope: f64 = (0..4).map(|k| d[k] * c[first + k][0]).sum();
            assert!(
                (slope - (3.0 * x * x - 40.0 * x)).abs() < 1e-8,
                "{x}: {slope}"
            );
        }
    }

    /// Between the nodes, where the spline is at its worst; and outside of the table.
    #[test]
    fn the_table_agrees_with_the_solver() {
        let table = SlabTable::shared();
        let mut worst = 0.0_f64;
        for i in 0..64 {
            let s = (i as f64 + 0.5) / 64.0;
            let omega = 1.0 - s * s;
            for j in 0..64 {
                let delta = (THIN + (j as f64 + 0.5) / 64.0 * (THICK - THIN)).exp();
                let exact = solve(omega, delta, Incidence::Beam(1.0)).unwrap();
                let (a, b) = table.read(omega, delta);
                let error = (0.5 * omega * a - exact.rho_d)
                    .abs()
                    .max((0.5 * omega * b - exact.t_diff).abs());
                worst = worst.max(error);
            }
        }
        assert!(worst < 1e-5, "inside: {worst}");
        let (mut thin, mut thick) = (0.0_f64, 0.0_f64);
        for omega in [0.0, 0.3, 0.9, 0.97, 0.99, 0.999, 0.99999, 1.0] {
            for delta in [1e-6, 1e-4, 1e-3, 5e-3, 9.9e-3, 35.0, 60.0, 100.0, 400.0] {
                let exact = solve(omega, delta, Incidence::Beam(1.0)).unwrap();
                let share = table.share(omega, delta);
                let error = (share.r - exact.rho_d)
                    .abs()
                    .max((share.t - exact.t_diff - exact.t_dir).abs());
                let worst = if delta < 1.0 { &mut thin } else { &mut thick };
                *worst = worst.max(error);
            }
        }
        assert!(thin < 5e-5 && thick < 5e-5, "thin {thin} thick {thick}");
    }
}
