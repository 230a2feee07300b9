//! Generators and density field of the twins: closed forms and degenerate sets.

use glam::DVec3;
use umbrage::math::sampling::{fibonacci_directions, uniform};
use umbrage::reference::density::{Field, Grid, KERNEL_VOLUME, Norm};
use umbrage::reference::generators::{Generator, Source, generators, leaf_labels};
use umbrage::reference::subset::{Subset, subset};

pub(super) fn generator(position: DVec3) -> Generator {
    Generator {
        position,
        weight: 1.0,
        area: 1.0,
    }
}

/// `count` generators, uniform in the ball of `radius` about the origin.
pub(super) fn ball_cloud(count: u32, radius: f64, seed: u32) -> Vec<Generator> {
    let coordinate = |i: u32| radius * (2.0 * uniform(seed, i) - 1.0);
    (0..)
        .map(|i| {
            DVec3::new(
                coordinate(3 * i),
                coordinate(3 * i + 1),
                coordinate(3 * i + 2),
            )
        })
        .filter(|p| p.length() < radius)
        .take(count as usize)
        .map(generator)
        .collect()
}

/// Two quads that share no position, then a triangle that shares one with the first quad.
const POSITIONS: [[f32; 3]; 11] = [
    [0.0, 0.0, 0.0],
    [2.0, 0.0, 0.0],
    [2.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
    [5.0, 0.0, 0.0],
    [6.0, 0.0, 0.0],
    [6.0, 1.0, 0.0],
    [5.0, 1.0, 0.0],
    [-0.0, 0.0, -0.0],
    [0.0, -1.0, 0.0],
    [-1.0, 0.0, 0.0],
];
const INDICES: [u32; 15] = [0, 1, 2, 4, 5, 6, 0, 2, 3, 4, 6, 7, 8, 9, 10];

#[test]
fn leaves_are_components_by_shared_positions() {
    // Vertex 8 is another one than 0 at the same place, with negative zeros.
    assert_eq!(leaf_labels(&POSITIONS, &INDICES), [0, 1, 0, 1, 0]);
    let leaves = generators(&POSITIONS, &INDICES, Source::Leaf).unwrap();
    assert_eq!(leaves.len(), 2);
    assert_eq!(leaves[0].area, 2.5);
    assert_eq!(leaves[1].area, 1.0);
    let first = (2.0 * DVec3::new(1.0, 0.5, 0.0) + 0.5 * DVec3::new(-1.0, -1.0, 0.0) / 3.0) / 2.5;
    assert!(leaves[0].position.distance(first) < 1e-12);
    assert!(leaves[1].position.distance(DVec3::new(5.5, 0.5, 0.0)) < 1e-12);
    let triangles = generators(&POSITIONS, &INDICES, Source::Triangle).unwrap();
    assert_eq!(triangles.len(), 5);
    assert!(
        triangles[4]
            .position
            .distance(DVec3::new(-1.0, -1.0, 0.0) / 3.0)
            < 1e-12
    );
}

#[test]
fn degenerate_meshes_have_defined_generators() {
    let line = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
    let leaf = generators(&line, &[0, 1, 2], Source::Leaf).unwrap();
    assert_eq!((leaf[0].position, leaf[0].area), (DVec3::X, 0.0));
    let bad = [[0.0; 3], [f32::NAN, 0.0, 0.0], [f32::INFINITY, 0.0, 0.0]];
    assert_eq!(generators(&bad, &[0, 1, 2], Source::Leaf), Err(1));
    assert!(generators(&[], &[], Source::Leaf).unwrap().is_empty());
}

#[test]
fn subsets_keep_the_total_weight() {
    let all = ball_cloud(4000, 0.5, 5);
    for fraction in [0.5, 0.25, 0.1] {
        let total = |s: &[Generator]| s.iter().map(|g| g.weight).sum::<f64>();
        let stratified = subset(&all, fraction, Subset::Stratified, 1);
        let plain = subset(&all, fraction, Subset::Plain, 1);
        assert!((total(&stratified) - 4000.0).abs() < 1e-6);
        assert!((total(&plain) - 4000.0).abs() < 300.0, "{}", total(&plain));
        let target = 4000.0 * fraction;
        assert!(stratified.len() as f64 <= target, "never above the target");
        assert!(
            stratified.len() as f64 > 0.95 * target,
            "{}",
            stratified.len()
        );
        assert_eq!(plain, subset(&all, fraction, Subset::Plain, 1), "seeded");
        assert_ne!(plain, subset(&all, fraction, Subset::Plain, 2));
    }
    assert_eq!(subset(&all, 1.0, Subset::Plain, 1), all);
    assert_eq!(subset(&all, 1e-9, Subset::Plain, 1).len(), 1);
    assert_eq!(subset(&all, 1e-9, Subset::Stratified, 1).len(), 1);
    let coincident = vec![generator(DVec3::splat(0.2)); 10];
    let merged = subset(&coincident, 0.5, Subset::Stratified, 1);
    assert_eq!((merged.len(), merged[0].weight), (1, 10.0));
}

/// Measured claim of the specification: the stratified subset disturbs the normals less.
#[test]
fn stratified_subsets_disturb_the_gradient_less_than_plain_ones() {
    let all = ball_cloud(3000, 0.5, 9);
    let reference = Field::new(&all, 0.175, Norm::Euclidean);
    let error = |method| {
        let few = Field::new(&subset(&all, 0.25, method, 3), 0.175, Norm::Euclidean);
        let points = fibonacci_directions(200);
        let sum: f64 = points
            .iter()
            .map(|w| {
                let gradient = |f: &Field| f.density_and_gradient(0.4 * *w).1;
                gradient(&few).angle_between(gradient(&reference))
            })
            .sum();
        (sum / 200.0).to_degrees()
    };
    let (stratified, plain) = (error(Subset::Stratified), error(Subset::Plain));
    assert!(
        stratified < 0.5 * plain,
        "{stratified} against {plain} degrees"
    );
}

#[test]
fn one_generator_has_the_values_of_equation_2() {
    let r = 0.3;
    for norm in [Norm::Euclidean, Norm::Manhattan, Norm::Maximum] {
        let one = Field::new(&[generator(DVec3::ONE)], r, norm);
        let two = Field::new(&[generator(DVec3::ONE); 2], r, norm);
        assert_eq!(one.density(DVec3::ONE), 1.0);
        assert_eq!(two.density(DVec3::ONE), 2.0);
        assert_eq!(one.density_and_gradient(DVec3::ONE), (1.0, DVec3::ZERO));
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            for sign in [-1.0, 1.0] {
                let at = |s: f64| one.density(DVec3::ONE + sign * s * r * axis);
                assert!(at(1.0) < 1e-30, "the support is open: {}", at(1.0));
                assert_eq!(at(1.0 + 1e-12), 0.0);
                assert!((at(0.5) - 0.5625).abs() < 1e-12);
            }
        }
        assert_eq!(one.density(DVec3::splat(1e9)), 0.0);
    }
    // Off the axes the norms differ: (0.2, 0.1, 0.1) has lengths 0.2449, 0.4, 0.2.
    let d = DVec3::new(0.2, 0.1, 0.1);
    let at = |norm| Field::new(&[generator(DVec3::ZERO)], 0.5, norm).density(d);
    assert!((at(Norm::Euclidean) - (1.0_f64 - 0.06 / 0.25).powi(2)).abs() < 1e-12);
    assert!((at(Norm::Manhattan) - (1.0_f64 - 0.16 / 0.25).powi(2)).abs() < 1e-12);
    assert!((at(Norm::Maximum) - (1.0_f64 - 0.04 / 0.25).powi(2)).abs() < 1e-12);
}

#[test]
fn gradients_are_the_differences_of_the_density() {
    let cloud = ball_cloud(200, 1.0, 2);
    for norm in [Norm::Euclidean, Norm::Manhattan, Norm::Maximum] {
        let field = Field::new(&cloud, 0.4, norm);
        for w in fibonacci_directions(20) {
            let q = 0.7 * w;
            let h = 1e-6;
            let difference = DVec3::from([DVec3::X, DVec3::Y, DVec3::Z].map(|axis| {
                (field.density(q + h * axis) - field.density(q - h * axis)) / (2.0 * h)
            }));
            let gradient = field.density_and_gradient(q).1;
            assert!(
                gradient.distance(difference) < 1e-5,
                "{norm:?} {gradient} {difference}"
            );
        }
    }
}

#[test]
fn bins_find_every_generator() {
    let cloud = ball_cloud(500, 1.0, 4);
    for radius in [0.001, 0.05, 0.3, 5.0] {
        let field = Field::new(&cloud, radius, Norm::Euclidean);
        for i in 0..40 {
            let q = cloud[i].position + 0.5 * radius * DVec3::X;
            let all: f64 = cloud
                .iter()
                .map(|g| 1.0 - (q - g.position).length_squared() / (radius * radius))
                .filter(|&x| x > 0.0)
                .map(|x| x * x)
                .sum();
            assert!(
                (field.density(q) - all).abs() < 1e-9 * all,
                "radius {radius}"
            );
        }
    }
}

#[test]
fn the_grid_encloses_the_support_with_equal_cells() {
    let (min, max) = (DVec3::new(-0.5, -0.2, -0.1), DVec3::new(0.5, 0.3, 0.1));
    for cells in [3, 4, 16, 33, 96] {
        for radius in [0.01, 0.1, 0.4] {
            let grid = Grid::around(min, max, radius, cells);
            assert_eq!(grid.nodes.iter().max(), Some(&(cells + 1)));
            let cell = f64::from(grid.cell);
            let last = grid.position(grid.nodes.map(|n| n - 1));
            let margin = 0.999 * (radius + cell);
            assert!((grid.position([0; 3]) + margin).cmple(min).all());
            assert!((last - margin).cmpge(max).all());
            assert!((last - max).max_element() < radius + 2.0 * cell, "no waste");
            assert_eq!(grid.index(grid.node(17)), 17);
        }
    }
}

#[test]
fn leaf_area_is_conserved_on_the_grid() {
    let cloud = ball_cloud(300, 0.5, 6);
    let radius = 0.2;
    let field = Field::leaf_area(&cloud, radius);
    let grid = Grid::around(DVec3::splat(-0.5), DVec3::splat(0.5), radius, 48);
    let cell_volume = f64::from(grid.cell).powi(3);
    let total: f64 = field.density_grid(&grid).iter().sum::<f64>() * cell_volume;
    assert!((total / 300.0 - 1.0).abs() < 1e-3, "{total}");
    // And the constant itself: integral of (1 - r^2)^2 over the unit ball by 10^5 shells.
    let shells: f64 = (0..100_000)
        .map(|i| (f64::from(i) + 0.5) / 1e5)
        .map(|r| 4.0 * std::f64::consts::PI * r * r * (1.0 - r * r).powi(2) / 1e5)
        .sum();
    assert!((shells - KERNEL_VOLUME).abs() < 1e-8);
}
