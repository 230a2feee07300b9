//! The slab: an independent reference on a grid, limits in closed form, energy.

use std::fs;

use umbrage::math::slab::{Incidence, SlabLight, eigenvalue, solve};

fn beam(omega: f64, delta: f64) -> SlabLight {
    solve(omega, delta, Incidence::Beam(1.0)).unwrap()
}

/// 11 albedos x 12 thicknesses x 4 angles and diffuse light, by another method (integral equation).
#[test]
fn every_row_of_the_reference_is_met() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../shared/leaf/slab_reference.csv"
    );
    let Ok(text) = fs::read_to_string(path) else {
        println!("{path} is not there: the reference rows were not compared");
        return;
    };
    let (mut rows, mut worst, mut worst_thin) = (0, (0.0, String::new()), (0.0, String::new()));
    for line in text.lines().filter(|l| !l.starts_with('#')).skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |i: usize| cells[i].parse::<f64>().unwrap();
        let incidence = match cells[2] {
            "diffuse" => Incidence::Diffuse,
            mu0 => Incidence::Beam(mu0.parse().unwrap()),
        };
        let s = solve(number(0), number(1), incidence).unwrap();
        let mut error = (s.rho_d - number(3))
            .abs()
            .max((s.t_diff - number(4)).abs())
            .max((s.t_dir - number(5)).abs());
        if number(8).is_finite() {
            error = error.max((s.a - number(8)).abs().max((s.b - number(9)).abs()));
        }
        let worst = if number(1) < 0.02 {
            &mut worst_thin
        } else {
            &mut worst
        };
        if error.is_nan() || error > worst.0 {
            *worst = (
                error,
                format!("omega {} Delta {} {}: {s:?}", cells[0], cells[1], cells[2]),
            );
        }
        rows += 1;
    }
    assert_eq!(rows, 660, "rows of the reference");
    println!(
        "worst {} {}\nthin {} {}",
        worst.0, worst.1, worst_thin.0, worst_thin.1
    );
    assert!(worst.0 < 1e-5, "Delta >= 0.02: {} at {}", worst.0, worst.1);
    assert!(
        worst_thin.0 < 1e-4,
        "below: {} at {}",
        worst_thin.0,
        worst_thin.1
    );
}
