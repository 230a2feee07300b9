//! Ambient coefficients (Luft, Balzer, Deussen 2007, section 3.2) of foliage and of what it covers.

use super::bake::Stats;
use super::openness::{self, Skylight};
use super::recorder::{Recorder, Store, Use};
use super::settings::{AmbientMode, Threshold};
use super::stages::{Scene, Sources, Vertices};
use crate::Result;
use crate::abi;
use crate::gpu::shaders::foliage as shaders;

/// What the coefficients follow from.
pub(super) struct AmbientFields<'a> {
    pub(super) scene: &'a Scene<'a>,
    pub(super) sources: &'a Sources,
    pub(super) skylight: Option<&'a Skylight>,
    pub(super) foliage: &'a Vertices<'a>,
    pub(super) covered: Option<&'a Vertices<'a>>,
}

/// Coefficients of the foliage's and of the covered vertices. `open` is the foliage's mean
/// transmittance where it is computed already.
pub(super) fn coefficients(
    r: &mut Recorder<'_>,
    f: &AmbientFields<'_>,
    open: Option<Store>,
    stats: &mut Stats,
) -> Result<(Store, Option<Store>)> {
    if f.scene.settings.ambient == AmbientMode::Eq4 {
        return transfer(r, f, stats);
    }
    let skylight = f.skylight.expect("made for transmittance");
    let on_foliage = match open {
        Some(open) => open,
        None => openness::at_queries(r, skylight, "foliage", &f.foliage.queries)?.ambient,
    };
    let on_covered = match f.covered {
        Some(c) => Some(openness::at_queries(r, skylight, "covered", &c.queries)?.ambient),
        None => None,
    };
    Ok((on_foliage, on_covered))
}

/// Equation 4 of the density with the ambient radius.
fn transfer(
    r: &mut Recorder<'_>,
    f: &AmbientFields<'_>,
    stats: &mut Stats,
) -> Result<(Store, Option<Store>)> {
    let s = f.scene.settings;
    let field = f.sources.field(s.rho_ambient, s.norm);
    let on_foliage = field.at_queries(
        r,
        "ambient density at foliage",
        &f.foliage.queries,
        abi::FIELD_DENSITY,
    )?;
    let on_covered = match f.covered {
        Some(c) => Some(field.at_queries(
            r,
            "ambient density at covered",
            &c.queries,
            abi::FIELD_DENSITY,
        )?),
        None => None,
    };
    let quantiles = [s.tau, s.d_min].map(|t| matches!(t, Threshold::Quantile(_)));
    let mut densities = Vec::new();
    if quantiles.contains(&true) {
        densities = r.fetch::<f32>("ambient densities", &on_foliage, || vec![1.0])?;
        densities.truncate(f.foliage.numbers.len());
    }
    stats.tau_ambient = threshold(s.tau, &mut densities);
    stats.d_min = match s.d_min {
        Threshold::Absolute(d) => d,
        // Quantiles of the density, so those of d = F(v) lie the threshold lower.
        quantile @ Threshold::Quantile(_) => {
            threshold(quantile, &mut densities) - stats.tau_ambient
        }
    };
    let push = abi::AmbientTransfer {
        count: 0,
        tau: stats.tau_ambient,
        k_min: s.k_min,
        d_min: stats.d_min,
        exponent: s.exponent,
    };
    let k_foliage = apply(r, "foliage", &on_foliage, f.foliage.numbers.len(), push)?;
    let k_covered = match (f.covered, on_covered) {
        (Some(c), Some(d)) => Some(apply(r, "covered", &d, c.numbers.len(), push)?),
        _ => None,
    };
    Ok((k_foliage, k_covered))
}

/// k_a of every density.
pub(super) fn apply(
    r: &mut Recorder<'_>,
    what: &str,
    density: &Store,
    count: usize,
    push: abi::AmbientTransfer,
) -> Result<Store> {
    let ambient = r.array::<f32>(&format!("{what} ambient"), count)?;
    r.compute(
        &format!("ambient of {what}"),
        shaders::AMBIENT_COMP,
        &[Use::Read(density), Use::Write(&ambient)],
        &abi::AmbientTransfer {
            count: count as u32,
            ..push
        },
        count,
    )?;
    Ok(ambient)
}

/// Value of a threshold: as given, or the quantile of `values`.
pub(super) fn threshold(t: Threshold, values: &mut [f32]) -> f32 {
    match t {
        Threshold::Absolute(v) => v,
        Threshold::Quantile(q) => quantile(values, f64::from(q)),
    }
}

/// Quantile with linear interpolation between order statistics; 0 when empty.
fn quantile(values: &mut [f32], p: f64) -> f32 {
    if values.is_empty() {
        return 0.0;
    }
    let at = p * (values.len() - 1) as f64;
    let low = at.floor() as usize;
    let (_, &mut below, above) = values.select_nth_unstable_by(low, f32::total_cmp);
    let next = above
        .iter()
        .copied()
        .min_by(f32::total_cmp)
        .unwrap_or(below);
    let t = at - low as f64;
    (f64::from(below) + t * (f64::from(next) - f64::from(below))) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_interpolate() {
        let mut v = [4.0, 1.0, 3.0, 2.0];
        for (p, expected) in [(0.0, 1.0), (1.0, 4.0), (0.5, 2.5), (0.25, 1.75)] {
            assert_eq!(quantile(&mut v, p), expected, "{p}");
        }
        assert_eq!(quantile(&mut [], 0.5), 0.0, "nothing");
    }
}
