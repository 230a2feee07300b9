//! Reflectance and transmittance of light that does not come straight down.
//!
//! Wang et al. 2005 take the values of normal incidence for every direction. The slab itself
//! reflects more of oblique light and transmits less; the table here holds by how much, from the
//! slab that has a material's colours at normal incidence.

use rayon::prelude::*;

use super::fit;
use super::optics::Optics;
use crate::abi::{LEAF_TURN_NODES, LeafTurn};
use crate::math::slab::{Incidence, solve};
use crate::{Error, Result};

/// Least cosine that the slab is solved for: below, its polynomials lose light.
const LEAST_COSINE: f64 = 0.05;

/// Factors over the cosine, from 0 to 1, for each of `optics`. Opaque materials are no slabs and
/// stay as they are.
///
/// # Errors
/// Colours that no slab has.
pub fn table(optics: &[Optics]) -> Result<Vec<LeafTurn>> {
    let rows: Vec<Result<Vec<LeafTurn>>> = optics.par_iter().map(material).collect();
    let mut out = Vec::with_capacity(optics.len() * LEAF_TURN_NODES as usize);
    for row in rows {
        out.extend(row?);
    }
    Ok(out)
}

fn material(optics: &Optics) -> Result<Vec<LeafTurn>> {
    let nodes = LEAF_TURN_NODES as usize;
    let same = LeafTurn {
        front: [1.0; 3],
        back: [1.0; 3],
        down: [1.0; 3],
        up: [1.0; 3],
    };
    let mut out = vec![same; nodes];
    if optics.rho_t.iter().all(|t| *t <= 0.0) {
        return Ok(out);
    }
    for c in 0..3 {
        let through = f64::from(optics.rho_t[c]);
        let [front, back] = [optics.rho_d_front[c], optics.rho_d_back[c]]
            .map(|rho| factors(f64::from(rho), through));
        let (front, back) = (front?, back?);
        for (i, row) in out.iter_mut().enumerate() {
            (row.front[c], row.down[c]) = front[i];
            (row.back[c], row.up[c]) = back[i];
        }
    }
    Ok(out)
}

/// Of reflectance and transmittance at every node.
fn factors(rho_d: f64, rho_t: f64) -> Result<Vec<(f32, f32)>> {
    let slab = fit::invert(fit::clamp(rho_d, rho_t).0);
    let share = |mu: f64| -> Result<(f64, f64), Error> {
        let light = solve(slab.omega, slab.delta, Incidence::Beam(mu))?;
        Ok((light.rho_d, light.t_diff + light.t_dir))
    };
    let (r, t) = share(1.0)?;
    (0..LEAF_TURN_NODES)
        .map(|i| {
            let mu = f64::from(i) / f64::from(LEAF_TURN_NODES - 1);
            let (own_r, own_t) = share(mu.max(LEAST_COSINE))?;
            Ok(((own_r / r) as f32, (own_t / t) as f32))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Birch at green: the values of the specification.
    #[test]
    fn oblique_light_is_reflected_more_and_transmitted_less() {
        let optics = Optics {
            rho_t: [0.0835; 3],
            ..Optics::opaque([0.0741; 3])
        };
        let rows = table(&[optics, Optics::opaque([0.3; 3])]).unwrap();
        let n = LEAF_TURN_NODES as usize;
        let at = |mu: f32| {
            let x = mu * (n - 1) as f32;
            let (i, f) = (x as usize, x.fract());
            let mix = |a: f32, b: f32| a + f * (b - a);
            let (a, b) = (rows[i], rows[(i + 1).min(n - 1)]);
            (
                0.0741 * mix(a.front[1], b.front[1]),
                0.0835 * mix(a.down[1], b.down[1]),
            )
        };
        for (mu, r, t) in [
            (1.0, 0.0741, 0.0835),
            (0.8, 0.0840, 0.0492),
            (0.5, 0.1052, 0.0157),
            (0.2, 0.1431, 0.0067),
        ] {
            let (found_r, found_t) = at(mu);
            assert!((found_r - r).abs() < 3e-4, "{mu}: R {found_r} for {r}");
            assert!((found_t - t).abs() < 3e-4, "{mu}: T {found_t} for {t}");
        }
        assert!(
            rows[n..]
                .iter()
                .all(|r| r.front == [1.0; 3] && r.up == [1.0; 3])
        );
        assert!(rows.iter().all(|r| r.back.iter().all(|v| v.is_finite())));
    }
}
