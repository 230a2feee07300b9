//! Real spherical harmonics.
//!
//! Conventions, here and in files: z is the pole, no Condon-Shortley sign, index l(l+1)+m, unit
//! norm over steradians. The scipy functions `sph_harm_y` carry a factor (-1)^m that these have
//! not. Closed forms after Sloan 2008, Stupid Spherical Harmonics Tricks, with all signs of odd m
//! positive.

use std::f64::consts::PI;

use glam::DVec3;

/// Bands 0 to 5.
pub const MAX_ORDER: usize = 6;
/// Coefficients of all bands.
pub const MAX_COEFFICIENTS: usize = MAX_ORDER * MAX_ORDER;

/// Associated Legendre functions over sin^m, times the norm, for z: the recurrence in l that is
/// stable upwards.
fn legendre(z: f64) -> [[f64; MAX_ORDER]; MAX_ORDER] {
    let mut p = [[0.0; MAX_ORDER]; MAX_ORDER];
    let mut diagonal = 1.0;
    for m in 0..MAX_ORDER {
        if m > 0 {
            diagonal *= (2 * m - 1) as f64;
        }
        p[m][m] = diagonal;
        if m + 1 < MAX_ORDER {
            p[m + 1][m] = z * (2 * m + 1) as f64 * diagonal;
        }
        for l in m + 2..MAX_ORDER {
            let (lf, mf) = (l as f64, m as f64);
            p[l][m] =
                ((2.0 * lf - 1.0) * z * p[l - 1][m] - (lf + mf - 1.0) * p[l - 2][m]) / (lf - mf);
        }
    }
    p
}

/// Norm of band `l` and `m`, with the factor sqrt(2) of m > 0.
fn norm(l: usize, m: usize) -> f64 {
    let ratio: f64 = (l - m + 1..=l + m).map(|k| k as f64).product();
    let k = ((2 * l + 1) as f64 / (4.0 * PI * ratio)).sqrt();
    if m == 0 {
        k
    } else {
        k * std::f64::consts::SQRT_2
    }
}

/// All functions at the unit direction `d`.
#[must_use]
pub fn evaluate(d: DVec3) -> [f64; MAX_COEFFICIENTS] {
    let p = legendre(d.z);
    let mut out = [0.0; MAX_COEFFICIENTS];
    // cos(m phi) and sin(m phi), times sin^m theta.
    let (mut c, mut s) = (1.0, 0.0);
    for m in 0..MAX_ORDER {
        for l in m..MAX_ORDER {
            let value = norm(l, m) * p[l][m];
            out[l * (l + 1) + m] = value * c;
            if m > 0 {
                out[l * (l + 1) - m] = value * s;
            }
        }
        (c, s) = (d.x * c - d.y * s, d.x * s + d.y * c);
    }
    out
}

/// Band of a coefficient.
#[must_use]
pub fn band(index: usize) -> usize {
    index.isqrt()
}

/// Zonal coefficients of the clamped cosine about +z; those of the lower side have the sign
/// (-1)^l (Ramamoorthi and Hanrahan 2001, An Efficient Representation for Irradiance Environment
/// Maps, equation 8, times the norm of Y).
pub const CLAMPED_COSINE: [f64; MAX_ORDER] = [
    0.886_226_925_452_758,
    1.023_326_707_946_488_5,
    0.495_415_912_200_751_4,
    0.0,
    -0.110_778_365_681_593_7,
    0.0,
];

/// Coefficients of a disc of radiance 1 and angular radius `radius` (radians) about the unit
/// direction `towards`.
#[must_use]
pub fn disc(towards: DVec3, radius: f64) -> [f64; MAX_COEFFICIENTS] {
    let mut out = evaluate(towards);
    let factors = disc_factors(radius);
    for (k, value) in out.iter_mut().enumerate() {
        *value *= factors[band(k)];
    }
    out
}

/// Integral of the Legendre polynomial of each band over a disc: 2 pi (P_{l-1}(c) - P_{l+1}(c)) /
/// (2l+1), in a form that does not cancel for small discs.
#[must_use]
pub fn disc_factors(radius: f64) -> [f64; MAX_ORDER] {
    // Gauss-Legendre over the cap's 1 - cos, exact for these polynomials.
    const NODES: [(f64, f64); 4] = [
        (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
        (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
        (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
        (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
    ];
    let height = 2.0 * (0.5 * radius).sin().powi(2);
    let mut out = [0.0; MAX_ORDER];
    for (node, weight) in NODES {
        let p = legendre(1.0 - height * node);
        for (l, value) in out.iter_mut().enumerate() {
            *value += 2.0 * PI * height * weight * p[l][0];
        }
    }
    out
}

/// Solid angle of a disc of angular radius `radius` (radians).
#[must_use]
pub fn disc_solid_angle(radius: f64) -> f64 {
    4.0 * PI * (0.5 * radius).sin().powi(2)
}

/// Window against ringing: the factor of each band for strength `lambda`.
#[must_use]
pub fn window(lambda: f64) -> [f64; MAX_ORDER] {
    std::array::from_fn(|l| {
        let l = l as f64;
        1.0 / (1.0 + lambda * l * l * (l + 1.0) * (l + 1.0))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sampling::fibonacci_directions;

    /// Gauss-Legendre in z (exact to degree 15) times a uniform rule in azimuth.
    fn quadrature() -> Vec<(DVec3, f64)> {
        const HALF: [(f64, f64); 4] = [
            (0.183_434_642_495_649_8, 0.362_683_783_378_362),
            (0.525_532_409_916_329, 0.313_706_645_877_887_3),
            (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
            (0.960_289_856_497_536_2, 0.101_228_536_290_376_3),
        ];
        let mut out = Vec::new();
        for (node, weight) in HALF {
            for z in [node, -node] {
                for k in 0..16 {
                    let phi = PI * f64::from(k) / 8.0;
                    let r = (1.0 - z * z).sqrt();
                    out.push((
                        DVec3::new(r * phi.cos(), r * phi.sin(), z),
                        weight * PI / 8.0,
                    ));
                }
            }
        }
        out
    }

    #[test]
    fn functions_are_orthonormal() {
        let mut gram = vec![[0.0; MAX_COEFFICIENTS]; MAX_COEFFICIENTS];
        for (d, w) in quadrature() {
            let y = evaluate(d);
            for i in 0..MAX_COEFFICIENTS {
                for j in 0..MAX_COEFFICIENTS {
                    gram[i][j] += w * y[i] * y[j];
                }
            }
        }
        for (i, row) in gram.iter().enumerate() {
            for (j, value) in row.iter().enumerate() {
                let wanted = if i == j { 1.0 } else { 0.0 };
                assert!((value - wanted).abs() < 1e-12, "{i} {j}: {value}");
            }
        }
    }

    #[test]
    fn signs_and_order_are_the_stated_ones() {
        for d in fibonacci_directions(40) {
            let (x, y, z) = (d.x, d.y, d.z);
            let found = evaluate(d);
            let wanted = [
                (0, 0.282_094_791_773_878_14),
                (1, 0.488_602_511_902_919_9 * y),
                (2, 0.488_602_511_902_919_9 * z),
                (3, 0.488_602_511_902_919_9 * x),
                (4, 1.092_548_430_592_079_2 * x * y),
                (8, 0.546_274_215_296_039_6 * (x * x - y * y)),
                (10, 2.890_611_442_640_554 * x * y * z),
                (13, 0.457_045_799_464_465_8 * x * (5.0 * z * z - 1.0)),
                (
                    20,
                    0.105_785_546_915_204_31 * (35.0 * z.powi(4) - 30.0 * z * z + 3.0),
                ),
                (
                    24,
                    0.625_835_735_449_176_1 * (x.powi(4) - 6.0 * x * x * y * y + y.powi(4)),
                ),
            ];
            for (k, value) in wanted {
                assert!((found[k] - value).abs() < 1e-14, "{k} at {d}");
            }
        }
    }

    #[test]
    fn the_suns_disc_is_nearly_a_point() {
        let radius = 0.2665_f64.to_radians();
        assert!((disc_solid_angle(radius) / 6.7967e-5 - 1.0).abs() < 1e-4);
        let factors = disc_factors(radius);
        for (l, f) in factors.iter().enumerate() {
            let share = f / disc_solid_angle(radius);
            assert!((0.9998..=1.0 + 1e-12).contains(&share), "{l}: {share}");
        }
        // The closed form, where it does not cancel.
        let c: f64 = 0.5_f64.cos();
        let p = legendre(c);
        for l in 1..MAX_ORDER - 1 {
            let wanted = 2.0 * PI * (p[l - 1][0] - p[l + 1][0]) / (2 * l + 1) as f64;
            assert!((disc_factors(0.5)[l] - wanted).abs() < 1e-13, "{l}");
        }
    }

    #[test]
    fn the_clamped_cosine_has_the_known_coefficients() {
        let steps = 20_000;
        for (l, wanted) in CLAMPED_COSINE.iter().enumerate() {
            let sum: f64 = (0..steps)
                .map(|i| (f64::from(i) + 0.5) / f64::from(steps))
                .map(|z| z * norm(l, 0) * legendre(z)[l][0])
                .sum();
            let found = 2.0 * PI * sum / f64::from(steps);
            assert!((found - wanted).abs() < 1e-7, "{l}: {found}");
        }
    }
}
