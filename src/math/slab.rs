//! Light in a homogeneous slab that scatters isotropically: how much comes back, how much goes
//! through.
//!
//! The problem of Wang et al. 2005 (Real-Time Rendering of Plant Leaves, eqs. 2-5), with black
//! surroundings:
//!
//! ```text
//! mu dI/dtau + I = (omega/2) int_{-1}^{1} I dmu',   0 < tau < Delta
//! I(0, mu > 0) = delta(mu - mu0),   I(Delta, mu < 0) = 0
//! ```
//!
//! solved by the `F_N` method (Siewert 1978): the exit radiances are expanded in shifted Legendre
//! polynomials and made to satisfy the two exact singular integral equations at N points, one of
//! them the discrete eigenvalue. `docs/leaf.md` has the equations. Slabs thinner than [`THIN`],
//! whose exit radiance has a boundary layer that polynomials follow badly, are solved by orders of
//! scattering instead.

use super::special::{e2_e3, gauss_legendre, legendre_p, legendre_q};
use crate::{Error, Result};

/// Order N of the expansion: 1e-7 relative for `Delta` >= 1, 1e-5 at 0.05.
const N: usize = 16;
/// Below this optical thickness the orders of scattering are summed.
pub const THIN: f64 = 0.05;
/// Absorption `1 - omega` below which the slab counts as conservative.
const CONSERVATIVE: f64 = 1e-10;
/// Below this albedo `1 - k` is less than the spacing of f64: no discrete eigenvalue.
const NO_EIGENVALUE: f64 = 0.055;

type Row = [f64; N];
type Matrix = [Row; N];

/// What falls on the slab, with unit flux.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Incidence {
    /// A parallel beam; cosine of its angle to the normal, (0, 1].
    Beam(f64),
    /// The same radiance from the whole hemisphere.
    Diffuse,
}

/// How unit flux is shared out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlabLight {
    /// Reflected, all directions.
    pub rho_d: f64,
    /// Transmitted after at least one scattering.
    pub t_diff: f64,
    /// Transmitted unscattered.
    pub t_dir: f64,
    /// The paper's `A`: `rho_d = omega A / (2 mu0)`; the limit for omega = 0.
    pub a: f64,
    /// The paper's `B`: `t_diff = omega B / (2 mu0)`; the limit for omega = 0.
    pub b: f64,
}

/// Solves one slab: scattering albedo `omega` in \[0, 1\], optical thickness `delta` >= 0.
///
/// # Errors
/// A value outside its range, or NaN.
pub fn solve(omega: f64, delta: f64, incidence: Incidence) -> Result<SlabLight> {
    if !(delta >= 0.0 && delta.is_finite()) {
        return Err(Error::usage(format!(
            "optical thickness {delta} is not a number >= 0"
        )));
    }
    if let Incidence::Beam(mu0) = incidence
        && !(mu0 > 0.0 && mu0 <= 1.0)
    {
        return Err(Error::usage(format!(
            "cosine of incidence {mu0} is outside (0, 1]"
        )));
    }
    Ok(Albedo::new(omega)?.solve(delta, incidence))
}

/// The discrete eigenvalue k in \[0, 1\]: `omega artanh(k) = k`; 0 for omega = 1, 1 where the two
/// cannot be told apart. Light in a thick slab falls off as `exp(-k tau)`.
#[must_use]
pub fn eigenvalue(omega: f64) -> f64 {
    rapidity(omega).map_or(1.0, f64::tanh)
}

/// artanh of the eigenvalue; `None` where it is beyond the precision of f64.
fn rapidity(omega: f64) -> Option<f64> {
    if omega >= 1.0 {
        return Some(0.0);
    }
    if omega < NO_EIGENVALUE {
        return None;
    }
    // omega z = tanh z, by Newton from above on 1 - tanh(z)/z = 1 - omega, which is concave.
    let absorption = 1.0 - omega;
    let mut z = if omega > 0.5 {
        (3.0 * absorption).sqrt() * (1.0 + absorption)
    } else {
        1.0 / omega
    };
    for _ in 0..60 {
        let (value, slope) = if z < 0.05 {
            let s = z * z;
            (
                s * (1.0 / 3.0 - s * (2.0 / 15.0 - s * (17.0 / 315.0 - s * 62.0 / 2835.0))),
                z * (2.0 / 3.0 - s * (8.0 / 15.0 - s * 102.0 / 315.0)),
            )
        } else {
            let t = z.tanh();
            (1.0 - t / z, (t / z - (1.0 - t * t)) / z)
        };
        let step = (value - absorption) / slope;
        z -= step;
        if step.abs() <= 1e-15 * z {
            break;
        }
    }
    Some(z)
}

/// Everything of the system that depends on the albedo alone.
#[derive(Debug, Clone)]
pub struct Albedo {
    omega: f64,
    /// Points of collocation; the first is the eigenvalue's where there is one.
    points: Row,
    /// `B_n` at the points: what a side's own radiance does.
    own: Matrix,
    /// `A_n` at the points: what the other side's does, before `exp(-Delta / xi)`.
    other: Matrix,
    conservative: bool,
}

/// `int_0^1 mu psi_n` and `int_0^1 mu^2 psi_n`.
const FIRST_MOMENTS: [f64; 2] = [1.0 / 2.0, 1.0 / 6.0];
const SECOND_MOMENTS: [f64; 3] = [1.0 / 3.0, 1.0 / 6.0, 1.0 / 30.0];

impl Albedo {
    /// # Errors
    /// `omega` outside \[0, 1\].
    pub fn new(omega: f64) -> Result<Self> {
        if !(0.0..=1.0).contains(&omega) {
            return Err(Error::usage(format!(
                "scattering albedo {omega} is outside [0, 1]"
            )));
        }
        let conservative = 1.0 - omega < CONSERVATIVE;
        let eigen = rapidity(omega).filter(|_| !conservative);
        let special = usize::from(conservative || eigen.is_some());
        let count = (N - special) as f64;
        let points: Row = std::array::from_fn(|j| match (j, eigen) {
            (0, Some(z)) => 1.0 / z.tanh(),
            // Overwritten by the flux equations.
            (0, None) if conservative => 0.5,
            _ => {
                let i = (j - special) as f64;
                0.5 - 0.5 * ((2.0 * i + 1.0) * std::f64::consts::PI / (2.0 * count)).cos()
            }
        });
        let mut own = [[0.0; N]; N];
        let mut other = [[0.0; N]; N];
        for (j, &xi) in points.iter().enumerate() {
            // The distance of nu0 from 1 in full precision: 1/k - 1 = 2 / (e^{2z} - 1).
            let beyond = match (j, eigen) {
                (0, Some(z)) => 2.0 / (2.0 * z).exp_m1(),
                _ => xi - 1.0,
            };
            let outer = legendre_q::<N>(2.0 * xi);
            let inner = legendre_q::<N>(2.0 * beyond);
            let psi = legendre_p::<N>(2.0 * xi - 1.0);
            let diagonal = if beyond < 0.0 {
                1.0 - omega * xi * xi.atanh()
            } else {
                0.0
            };
            for n in 0..N {
                let one = f64::from(u8::from(n == 0));
                let sign = if n % 2 == 0 { 1.0 } else { -1.0 };
                own[j][n] = diagonal * psi[n] + 0.5 * omega * (2.0 * xi * inner[n] - one);
                other[j][n] = 0.5 * omega * (one - 2.0 * xi * sign * outer[n]);
            }
        }
        Ok(Self {
            omega,
            points,
            own,
            other,
            conservative,
        })
    }

    /// The slab of optical thickness `delta` >= 0; the range is not checked again.
    #[must_use]
    pub fn solve(&self, delta: f64, incidence: Incidence) -> SlabLight {
        let mu0 = match incidence {
            Incidence::Beam(mu0) => mu0,
            Incidence::Diffuse => 1.0,
        };
        let t_dir = match incidence {
            Incidence::Beam(mu0) => (-delta / mu0).exp(),
            Incidence::Diffuse => 2.0 * e2_e3(delta).1,
        };
        let (a, b) = if delta < THIN {
            self.thin(delta, incidence)
        } else {
            self.thick(delta, incidence)
        };
        SlabLight {
            rho_d: 0.5 * self.omega * a / mu0,
            t_diff: 0.5 * self.omega * b / mu0,
            t_dir,
            a,
            b,
        }
    }

    /// Single scattering exactly; of the higher orders their mean over the depth, which keeps the
    /// energy: for omega = 1 all light leaves.
    fn thin(&self, delta: f64, incidence: Incidence) -> (f64, f64) {
        if delta <= 0.0 {
            return (0.0, 0.0);
        }
        // Where the beam is, in units of depth; a grazing beam ends before the far side.
        let reach = match incidence {
            Incidence::Beam(mu0) => delta.min(40.0 * mu0),
            Incidence::Diffuse => delta,
        };
        let source = |tau: f64| match incidence {
            Incidence::Beam(mu0) => (-tau / mu0).exp(),
            Incidence::Diffuse => 2.0 * e2_e3(tau).0,
        };
        let (mut sum, mut up, mut down) = (0.0, 0.0, 0.0);
        for (x, w) in gauss_legendre(20) {
            // tau = reach t^2 (3 - 2 t): E2 has logarithmic slopes at both faces.
            let t = 0.5 * (x + 1.0);
            let tau = reach * t * t * (3.0 - 2.0 * t);
            let s = 0.5 * w * 6.0 * t * (1.0 - t) * reach * source(tau);
            sum += s;
            up += s * e2_e3(tau).0;
            down += s * e2_e3(delta - tau).0;
        }
        let lost = 0.5 - e2_e3(delta).1;
        let caught = self.omega * (1.0 - lost / delta);
        let again = 0.5 * self.omega * (2.0 * sum - up - down) / delta;
        let higher = again / (1.0 - caught) * lost;
        (up + higher, down + higher)
    }

    fn thick(&self, delta: f64, incidence: Incidence) -> (f64, f64) {
        let mut near = Half::default();
        let mut far = Half::default();
        let beams = beams(incidence);
        for (j, &xi) in self.points.iter().enumerate() {
            let fade = (-delta / xi).exp();
            near.own[j] = self.own[j];
            far.own[j] = self.own[j];
            near.other[j] = self.other[j].map(|v| v * fade);
            far.other[j] = near.other[j];
            for &(mu, weight) in &beams {
                near.rhs[j] += weight * mu * -(-delta / xi - delta / mu).exp_m1() / (xi + mu);
                far.rhs[j] += weight * mu * decay_quotient(xi, mu, delta);
            }
        }
        if self.conservative {
            conserve(&mut near, &mut far, delta, &beams);
        }
        // a + C1 b = g1, b + C2 a = g2. The far side's light may be 1e-13 of the near side's and
        // keeps its digits, because nothing large is subtracted to find it.
        let (g1, c1) = near.solved();
        let (g2, c2) = far.solved();
        let mut system = [[0.0; N]; N];
        let mut rhs = g2;
        for i in 0..N {
            for (j, entry) in system[i].iter_mut().enumerate() {
                let product: f64 = (0..N).map(|k| c2[i][k] * c1[k][j]).sum();
                *entry = f64::from(u8::from(i == j)) - product;
            }
            rhs[i] -= dot(&c2[i], &g1);
        }
        let mut column = rhs.map(|v| [v]);
        eliminate(&mut system, &mut column);
        let b = column.map(|v| v[0]);
        let a: Row = std::array::from_fn(|i| g1[i] - dot(&c1[i], &b));
        let flux = |v: &Row| FIRST_MOMENTS[0] * v[0] + FIRST_MOMENTS[1] * v[1];
        (flux(&a).max(0.0), flux(&b).max(0.0))
    }
}

/// The equations of one face.
struct Half {
    own: Matrix,
    other: Matrix,
    rhs: Row,
}

impl Default for Half {
    fn default() -> Self {
        Self {
            own: [[0.0; N]; N],
            other: [[0.0; N]; N],
            rhs: [0.0; N],
        }
    }
}

impl Half {
    /// `own^-1 rhs` and `own^-1 other`.
    fn solved(mut self) -> (Row, Matrix) {
        let mut columns: [[f64; N + 1]; N] = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                if j == N {
                    self.rhs[i]
                } else {
                    self.other[i][j]
                }
            })
        });
        eliminate(&mut self.own, &mut columns);
        (
            columns.map(|row| row[N]),
            columns.map(|row| std::array::from_fn(|j| row[j])),
        )
    }
}

/// omega = 1: the eigenvalue lies at infinity, and its two equations become the conservation of
/// flux and the diffusion of pressure.
fn conserve(near: &mut Half, far: &mut Half, delta: f64, beams: &[(f64, f64)]) {
    let first: Row = std::array::from_fn(|n| FIRST_MOMENTS.get(n).copied().unwrap_or(0.0));
    let second: Row = std::array::from_fn(|n| SECOND_MOMENTS.get(n).copied().unwrap_or(0.0));
    near.own[0] = first.map(|v| 0.5 * v);
    near.other[0] = near.own[0];
    far.own[0] = std::array::from_fn(|n| 0.5 * (second[n] + delta * first[n]));
    far.other[0] = second.map(|v| -0.5 * v);
    (near.rhs[0], far.rhs[0]) = (0.0, 0.0);
    for &(mu, weight) in beams {
        let fade = (-delta / mu).exp();
        let taken = -(-delta / mu).exp_m1();
        near.rhs[0] += weight * mu * taken;
        far.rhs[0] += weight * (mu * mu * taken - delta * mu * fade);
    }
}

/// Beams (cosine, weight) whose sum is the incident light. The diffuse panels shrink towards
/// grazing incidence, where `exp(-Delta / mu)` turns.
fn beams(incidence: Incidence) -> Vec<(f64, f64)> {
    let Incidence::Beam(mu0) = incidence else {
        let rule = gauss_legendre(12);
        let mut out = Vec::new();
        let mut high = 1.0;
        for panel in 0..9 {
            let low = if panel == 8 { 0.0 } else { 0.35 * high };
            let half: f64 = 0.5 * (high - low);
            out.extend(
                rule.iter()
                    .map(|(x, w)| (low + half * (x + 1.0), 2.0 * half * w)),
            );
            high = low;
        }
        return out;
    };
    vec![(mu0, 1.0)]
}

/// `(e^{-D/xi} - e^{-D/mu}) / (xi - mu)` without cancellation.
fn decay_quotient(xi: f64, mu: f64, delta: f64) -> f64 {
    let difference = xi - mu;
    if difference.abs() < 1e-12 {
        return delta / (mu * mu) * (-delta / mu).exp();
    }
    // The smaller exponential relative to the larger.
    let x = delta * difference.abs() / (xi * mu);
    (-delta / xi.max(mu)).exp() * -(-x).exp_m1() / difference.abs()
}

fn dot(a: &Row, b: &Row) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Gaussian elimination with row pivoting; the right-hand sides become the solutions.
fn eliminate<const M: usize>(matrix: &mut Matrix, rhs: &mut [[f64; M]; N]) {
    for column in 0..N {
        let pivot = (column..N)
            .max_by(|&i, &j| matrix[i][column].abs().total_cmp(&matrix[j][column].abs()))
            .expect("rows remain");
        matrix.swap(column, pivot);
        rhs.swap(column, pivot);
        let (head, head_rhs) = (matrix[column], rhs[column]);
        for row in column + 1..N {
            let factor = matrix[row][column] / head[column];
            for k in column..N {
                matrix[row][k] -= factor * head[k];
            }
            for k in 0..M {
                rhs[row][k] -= factor * head_rhs[k];
            }
        }
    }
    for row in (0..N).rev() {
        let (upper, solved) = rhs.split_at_mut(row + 1);
        for (factor, known) in matrix[row][row + 1..].iter().zip(solved.iter()) {
            (0..M).for_each(|k| upper[row][k] -= factor * known[k]);
        }
        upper[row] = upper[row].map(|v| v / matrix[row][row]);
    }
}
