//! Marching cubes of the twins: closed forms, topology, convergence.

use glam::DVec3;
use umbrage::math::marching_cubes_table::edge_owner;
use umbrage::math::sampling::uniform;
use umbrage::reference::density::{Field, Grid, Norm};
use umbrage::reference::marching_cubes::{Surface, marching_cubes};

use super::foliage_field::{ball_cloud, generator};

/// Surface of `field` over a box.
fn surface(field: &Field, half: f64, cells: u32, tau: f64) -> Surface {
    let grid = Grid::around(DVec3::splat(-half), DVec3::splat(half), field.radius, cells);
    marching_cubes(&grid, &field.density_grid(&grid), tau)
}

#[test]
fn one_generator_is_a_sphere_and_converges_at_second_order() {
    let r = 0.4;
    let centre = DVec3::new(0.013, -0.007, 0.021);
    let field = Field::new(&[generator(centre)], r, Norm::Euclidean);
    for tau in [0.1_f64, 0.3, 0.7] {
        let radius = r * (1.0 - tau.sqrt()).sqrt();
        let area = 4.0 * std::f64::consts::PI * radius * radius;
        let errors = [24, 48, 96].map(|cells| {
            let s = surface(&field, 0.03, cells, tau);
            assert_eq!(s.euler_characteristic(), 2);
            assert!(s.is_watertight());
            let furthest = s
                .vertices
                .iter()
                .map(|v| (v.distance(centre) - radius).abs())
                .fold(0.0, f64::max);
            for (n, v) in s.gradient_normals(&field).iter().zip(&s.vertices) {
                assert!(n.dot((*v - centre).normalize()) > 1.0 - 1e-12);
            }
            let volume = s.volume();
            assert!(volume > 0.0, "the triangles face outwards");
            [
                furthest / radius,
                (s.area() / area - 1.0).abs(),
                (volume / (area * radius / 3.0) - 1.0).abs(),
            ]
        });
        for k in 0..3 {
            let [a, b, c] = errors.map(|e| e[k]);
            assert!(
                a / c > 11.0,
                "measure {k} at tau {tau}: {a:.2e} {b:.2e} {c:.2e}"
            );
            assert!(c < 3e-3, "measure {k} at tau {tau}: {c:.2e}");
        }
    }
}

#[test]
fn two_generators_cross_the_axis_where_the_closed_form_says() {
    let (r, tau) = (0.4, 0.3);
    for distance in [0.1, 0.3, 0.5, 0.7] {
        let ends = [-0.5 * distance, 0.5 * distance];
        let field = Field::new(
            &ends.map(|x| generator(DVec3::new(x, 0.0, 0.0))),
            r,
            Norm::Euclidean,
        );
        let on_axis = |x: f64| -> f64 {
            ends.iter()
                .map(|e| (1.0 - ((x - e) / r).powi(2)).max(0.0).powi(2))
                .sum()
        };
        // Sign changes of the closed form on the axis, by bisection.
        let samples: Vec<f64> = (0..4000).map(|i| -1.0 + f64::from(i) / 2000.0).collect();
        let expected: Vec<f64> = samples
            .windows(2)
            .filter(|w| (on_axis(w[0]) > tau) != (on_axis(w[1]) > tau))
            .map(|w| {
                let (mut a, mut b) = (w[0], w[1]);
                for _ in 0..60 {
                    let m = 0.5 * (a + b);
                    if (on_axis(m) > tau) == (on_axis(a) > tau) {
                        a = m;
                    } else {
                        b = m;
                    }
                }
                a
            })
            .collect();
        assert_eq!(expected.len(), if distance > 0.6 { 4 } else { 2 });
        // A grid with a row of nodes on the axis.
        let grid = Grid {
            origin: [-1.0, -0.5, -0.5],
            cell: 1.0 / 64.0,
            nodes: [129, 65, 65],
        };
        let s = marching_cubes(&grid, &field.density_grid(&grid), tau);
        let mut found: Vec<f64> = s
            .vertices
            .iter()
            .filter(|v| v.y == 0.0 && v.z == 0.0)
            .map(|v| v.x)
            .collect();
        found.sort_by(f64::total_cmp);
        assert_eq!(found.len(), expected.len(), "distance {distance}");
        for (f, e) in found.iter().zip(&expected) {
            assert!((f - e).abs() < 2e-3, "distance {distance}: {f} for {e}");
            assert!((field.density(DVec3::new(*e, 0.0, 0.0)) - tau).abs() < 1e-9);
        }
        let balls = if expected.len() == 4 { 2 } else { 1 };
        assert_eq!(s.euler_characteristic(), 2 * balls);
    }
}

/// Noise has all 256 cases beside each other, the ambiguous ones included.
#[test]
fn random_fields_are_watertight() {
    for seed in 0..4 {
        let grid = Grid {
            origin: [0.0; 3],
            cell: 1.0,
            nodes: [24, 21, 22],
        };
        let values: Vec<f64> = (0..grid.node_count())
            .map(|i| {
                let node = grid.node(i);
                let inner = (0..3).all(|a| node[a] > 0 && node[a] + 1 < grid.nodes[a]);
                if inner { uniform(seed, i as u32) } else { 0.0 }
            })
            .collect();
        let s = marching_cubes(&grid, &values, 0.5);
        let crossed = s.vertices.len();
        assert!(crossed > 10_000);
        assert!(s.is_watertight(), "seed {seed}");
        assert!(s.volume() > 0.0);
        assert!(
            s.triangles
                .iter()
                .flatten()
                .all(|&i| (i as usize) < crossed)
        );
    }
}

#[test]
fn vertices_are_numbered_by_node_and_axis() {
    let field = Field::new(&ball_cloud(60, 0.4, 1), 0.2, Norm::Euclidean);
    let grid = Grid::around(DVec3::splat(-0.4), DVec3::splat(0.4), 0.2, 20);
    let s = marching_cubes(&grid, &field.density_grid(&grid), 0.5);
    let keys: Vec<(usize, usize)> = s
        .vertices
        .iter()
        .map(|v| {
            let u = (*v - grid.position([0; 3])) / f64::from(grid.cell);
            let node = u.to_array().map(|c| (c + 1e-9).floor() as u32);
            let axis = (0..3)
                .max_by(|&a, &b| {
                    u[a].fract()
                        .min(1.0 - u[a].fract())
                        .total_cmp(&u[b].fract().min(1.0 - u[b].fract()))
                })
                .unwrap();
            (grid.index(node), axis)
        })
        .collect();
    assert!(keys.is_sorted(), "ascending nodes, ascending axes");
    assert_eq!(edge_owner(0), (0, 0));
}

#[test]
fn degenerate_fields_have_defined_surfaces() {
    let one = Field::new(&[generator(DVec3::ZERO)], 0.5, Norm::Euclidean);
    // The threshold reaches the maximum: empty.
    assert_eq!(surface(&one, 0.01, 33, 1.0), Surface::default());
    assert_eq!(surface(&one, 0.01, 33, 1e9), Surface::default());
    assert_eq!(
        surface(&Field::new(&[], 0.5, Norm::Euclidean), 0.1, 8, 0.0),
        Surface::default()
    );
    // tau = 0 is the edge of the support, never more than a cell outside of it.
    let s = surface(&one, 0.01, 32, 0.0);
    assert!(s.is_watertight());
    assert_eq!(s.euler_characteristic(), 2);
    let cell = 1.02 / 30.0;
    assert!(s.vertices.iter().all(|v| (v.length() - 0.5).abs() < cell));
    assert!(
        s.gradient_normals(&one)
            .iter()
            .all(|n| (n.length() - 1.0).abs() < 1e-9)
    );
    // Many coincident generators are one of their weight.
    let many = Field::new(&[generator(DVec3::ZERO); 50], 0.5, Norm::Euclidean);
    let s = surface(&many, 0.01, 64, 25.0);
    let radius = 0.5 * (1.0 - 0.5_f64.sqrt()).sqrt();
    assert!(
        s.vertices
            .iter()
            .all(|v| (v.length() - radius).abs() < 2e-3)
    );
}

#[test]
fn other_norms_give_an_octahedron_and_a_cube() {
    let (r, tau) = (0.4, 0.25_f64);
    let reach = r * (1.0 - tau.sqrt()).sqrt();
    for (norm, volume) in [
        (Norm::Manhattan, 4.0 / 3.0 * reach.powi(3)),
        (Norm::Maximum, 8.0 * reach.powi(3)),
    ] {
        let s = surface(
            &Field::new(&[generator(DVec3::ZERO)], r, norm),
            0.01,
            64,
            tau,
        );
        assert_eq!(s.euler_characteristic(), 2);
        assert!(
            (s.volume() / volume - 1.0).abs() < 0.02,
            "{norm:?} {}",
            s.volume() / volume
        );
    }
}
