//! Skylight through the leaf-area field: twins against closed forms, kernels against twins.

use glam::DVec3;
use umbrage::app::conform;
use umbrage::math::sampling::fibonacci_directions;
use umbrage::reference::density::{Field, Grid};
use umbrage::reference::generators::Generator;
use umbrage::reference::realign::{open_normal, transmittance};
use umbrage::reference::skylight::{light_at, sky_depth, sky_light};

use super::fixture;
use super::foliage_field::{ball_cloud, generator};

#[test]
fn kernels_agree_with_their_twins() {
    let gpu = fixture::gpu();
    for case in conform::cases()
        .iter()
        .filter(|c| c.name.starts_with("foliage.sky_"))
    {
        let outcome = (case.run)(&gpu).unwrap();
        assert!(outcome.passed(), "{}: {outcome:?}", case.name);
    }
}

/// The line integral through the middle of one leaf's kernel: area times 7 / (2 pi r^2).
#[test]
fn depth_through_one_leaf_is_its_line_integral() {
    let radius = 0.2;
    let leaf = [Generator {
        area: 0.03,
        ..generator(DVec3::ZERO)
    }];
    let grid = Grid::around(DVec3::splat(-0.3), DVec3::splat(0.3), radius, 66);
    let values = Field::leaf_area(&leaf, radius).density_grid(&grid);
    let expected = 0.03 * 3.5 / (std::f64::consts::PI * radius * radius);
    for w in fibonacci_directions(20) {
        let depth = sky_depth(&grid, &values, w);
        // From the far side of the leaf, through its middle.
        let found = grid.sample(&depth, -0.3 * w);
        assert!(
            (found / expected - 1.0).abs() < 0.15,
            "{found} for {expected} along {w}"
        );
        assert_eq!(grid.sample(&depth, 0.35 * w), 0.0, "nothing behind it");
        // Interpolation spreads a ray, it does not absorb: what is lost in the middle is around it.
        let mean = |depth: &[f64]| depth.iter().sum::<f64>() / depth.len() as f64;
        let other = sky_depth(&grid, &values, -w);
        assert!(
            (mean(&depth) / mean(&other) - 1.0).abs() < 0.02,
            "symmetric"
        );
    }
}

/// The sweep is an approximation of marching every ray; both see the same light.
#[test]
fn the_sweep_agrees_with_marched_rays() {
    let leaves: Vec<Generator> = ball_cloud(600, 0.4, 2)
        .iter()
        .map(|g| Generator { area: 2e-3, ..*g })
        .collect();
    let radius = 0.08;
    let grid = Grid::around(DVec3::splat(-0.4), DVec3::splat(0.4), radius, 40);
    let values = Field::leaf_area(&leaves, radius).density_grid(&grid);
    let directions = fibonacci_directions(32);
    let light = sky_light(&grid, &values, &directions, 0.5);
    let (mut worst, mut sum, mut turned) = (0.0_f64, 0.0, 0.0_f64);
    for g in &leaves {
        let q = g.position;
        let marched: f64 = directions
            .iter()
            .map(|&w| transmittance(&grid, &values, q, w, 0.5) / 32.0)
            .sum();
        let (open, mean) = light_at(&grid, &light, q);
        worst = worst.max((mean - marched).abs());
        sum += mean - marched;
        if q.length() > 0.25 {
            let normal = open_normal(&grid, &values, q, &directions, 0.5).unwrap();
            turned = turned.max(normal.angle_between(open).to_degrees());
        }
    }
    let mean = sum / leaves.len() as f64;
    assert!(mean.abs() < 0.01, "mean difference {mean}");
    assert!(worst < 0.05, "largest difference {worst}");
    assert!(turned < 8.0, "largest angle {turned}");
}

#[test]
fn no_leaves_let_all_light_through() {
    let grid = Grid::around(DVec3::splat(-0.5), DVec3::splat(0.5), 0.1, 8);
    let directions = fibonacci_directions(16);
    let light = sky_light(&grid, &vec![0.0; grid.node_count()], &directions, 0.5);
    let (open, mean) = light_at(&grid, &light, DVec3::ZERO);
    assert!(
        (mean - 1.0).abs() < 1e-12 && open.length() < 0.05,
        "{open} {mean}"
    );
}
