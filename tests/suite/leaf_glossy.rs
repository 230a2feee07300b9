//! The glossy term: measured albedos, energy, reciprocity, grazing light.

use glam::DVec3;
use umbrage::leaf::glossy::{Shadowing, directional_albedo, distribution, glossy};
use umbrage::math::sampling::uniform;
use umbrage::reference::leaf_glossy;

#[test]
fn directional_albedos_are_the_measured_ones() {
    let angles = [0.0_f64, 60.0, 75.0, 85.0, 88.0, 89.0];
    for (shadowing, m, row) in [
        (
            Shadowing::Paper,
            0.1,
            [1.000, 1.000, 0.987, 0.997, 1.38, 2.15],
        ),
        (
            Shadowing::Paper,
            0.3,
            [1.000, 0.957, 0.988, 1.53, 2.95, 5.36],
        ),
        (
            Shadowing::Paper,
            0.5,
            [0.982, 0.940, 1.126, 2.15, 4.55, 8.59],
        ),
        (
            Shadowing::Safe,
            0.3,
            [1.000, 0.923, 0.903, 0.947, 0.976, 0.987],
        ),
        (
            Shadowing::Safe,
            0.5,
            [0.943, 0.869, 0.905, 0.960, 0.983, 0.991],
        ),
    ] {
        for (angle, expected) in angles.into_iter().zip(row) {
            let found = directional_albedo(angle.to_radians().cos(), m, shadowing);
            assert!(
                (found - expected).abs() < 0.006 * expected,
                "{shadowing:?} m {m} {angle}: {found} {expected}"
            );
        }
    }
}

#[test]
fn the_safe_form_never_gives_back_more() {
    for m in [1e-3, 0.05, 0.1, 0.3, 0.7, 1.0] {
        for angle in [0.0_f64, 45.0, 80.0, 89.0, 89.99] {
            let found = directional_albedo(angle.to_radians().cos(), m, Shadowing::Safe);
            assert!(found <= 1.005, "{m} {angle}: {found}");
        }
    }
}

/// The distribution is normalised, and Stogryn's form is Beckmann's.
#[test]
fn two_forms_of_one_lobe() {
    for m in [0.05, 0.3, 1.0] {
        let n = 20_000;
        let sum: f64 = (0..n)
            .map(|i| {
                // tan^2 = t / (1 - t) spreads the whole hemisphere of half vectors.
                let c2 = 1.0 - (f64::from(i) + 0.5) / f64::from(n);
                std::f64::consts::PI * distribution(c2.sqrt(), m) / f64::from(n)
            })
            .sum();
        assert!((sum - 1.0).abs() < 1e-3, "{m}: {sum}");
    }
    for i in 0..500u32 {
        let u = |k: u32| uniform(5, 8 * i + k);
        let direction = |a: f64, b: f64| {
            let (s, c) = (std::f64::consts::TAU * b).sin_cos();
            let r = (1.0 - a * a).sqrt();
            DVec3::new(r * c, r * s, a.max(1e-3)).normalize()
        };
        let (i, r) = (direction(u(0), u(1)), direction(u(2), u(3)));
        let m = 0.05 + 0.95 * u(4);
        let half = (i + r).normalize();
        for (shadowing, safe) in [(Shadowing::Paper, false), (Shadowing::Safe, true)] {
            let found = glossy(i.z, r.z, half.z, m, shadowing);
            let twin = leaf_glossy::glossy(i, r, m, safe);
            assert!(
                (found - twin).abs() <= 1e-9 * twin + 1e-12,
                "{found} {twin}"
            );
            // f is reciprocal: f cos_i / cos_i is the same with the directions exchanged.
            if r.z > 1e-2 && i.z > 1e-2 {
                let back = glossy(r.z, i.z, half.z, m, shadowing);
                assert!((found / i.z - back / r.z).abs() <= 1e-9 * (found / i.z) + 1e-12);
            }
        }
    }
}

#[test]
fn grazing_and_hidden_directions_are_defined() {
    for shadowing in [Shadowing::Paper, Shadowing::Safe] {
        for c in [0.0, -0.5, f64::NAN] {
            assert_eq!(glossy(c, 0.5, 0.5, 0.3, shadowing), 0.0);
            assert_eq!(glossy(0.5, c, 0.5, 0.3, shadowing), 0.0);
        }
        for m in [0.0, 1e-3, 1.0] {
            for c in [1e-12, 1e-4, (89.99_f64).to_radians().cos(), 1.0] {
                let value = glossy(c, c, 1.0, m, shadowing);
                assert!(value.is_finite() && value >= 0.0, "{m} {c}: {value}");
            }
        }
    }
}
