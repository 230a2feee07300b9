//! Realigned normals and ambient coefficients of the twins.

use glam::DVec3;
use umbrage::math::sampling::{fibonacci_directions, uniform};
use umbrage::reference::ambient::{Transfer, mean_transmittance, transfer};
use umbrage::reference::density::{Field, Grid, Norm};
use umbrage::reference::generators::{Generator, Source, bounds, generators};
use umbrage::reference::marching_cubes::marching_cubes;
use umbrage::reference::realign::{
    blend, closest_on_triangle, exact_normal, face_normal, gradient_normal, multiscale_normal,
    nearest_on_level_set, nearest_vertex, open_normal, transmittance, vertex_normal,
};

use super::foliage_field::{ball_cloud, generator};

fn degrees(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}

#[test]
fn equation_4_is_continuous_and_monotonic() {
    for exponent in [1.0 / 3.0, 1.0, 3.0] {
        let t = Transfer {
            k_min: 0.2,
            d_min: 5.0,
            exponent,
        };
        assert_eq!(transfer(-1.0, &t), 1.0);
        assert_eq!(transfer(0.0, &t), 1.0);
        assert!((transfer(1e-12, &t) - 1.0).abs() < 1e-9);
        assert_eq!(transfer(5.0, &t), 0.2);
        assert_eq!(transfer(1e9, &t), 0.2);
        assert!((transfer(5.0 - 1e-12, &t) - 0.2).abs() < 1e-3);
        let middle = 0.2 + 0.8 * 0.5_f64.powf(exponent);
        assert!((transfer(2.5, &t) - middle).abs() < 1e-12);
        let all: Vec<f64> = (0..600)
            .map(|i| transfer(f64::from(i) * 0.01, &t))
            .collect();
        assert!(all.windows(2).all(|w| w[1] <= w[0]));
    }
    // A lower bound of zero is a step, never NaN.
    let step = Transfer {
        k_min: 0.2,
        d_min: 0.0,
        exponent: 1.0,
    };
    assert_eq!(
        [-1.0, 0.0, 1e-9].map(|d| transfer(d, &step)),
        [1.0, 1.0, 0.2]
    );
}

#[test]
fn nearest_points_of_a_triangle_beat_a_fine_sampling() {
    let [a, b, c] = [
        DVec3::new(0.0, 0.0, 0.0),
        DVec3::new(1.0, 0.1, 0.2),
        DVec3::new(0.3, 0.9, -0.4),
    ];
    for i in 0..60 {
        let q = DVec3::from([0, 1, 2].map(|k| 3.0 * uniform(8, 3 * i + k) - 1.0));
        let w = closest_on_triangle(q, a, b, c);
        assert!((w.element_sum() - 1.0).abs() < 1e-12 && w.min_element() >= 0.0);
        let found = q.distance(w.x * a + w.y * b + w.z * c);
        let mut best = f64::INFINITY;
        for u in 0..=60 {
            for v in 0..=60 - u {
                let p = a + f64::from(u) / 60.0 * (b - a) + f64::from(v) / 60.0 * (c - a);
                best = best.min(q.distance(p));
            }
        }
        assert!(
            found <= best + 1e-12 && best < found + 0.02,
            "{found} {best}"
        );
    }
}

#[test]
fn ties_go_to_the_lowest_index() {
    let v = [DVec3::X, DVec3::Y, -DVec3::X, DVec3::Y];
    assert_eq!(nearest_vertex(DVec3::ZERO, &v), Some(0));
    assert_eq!(nearest_vertex(DVec3::new(-0.1, 0.1, 0.0), &v), Some(1));
    assert_eq!(nearest_vertex(DVec3::ZERO, &[]), None);
}

#[test]
fn every_mode_is_radial_about_one_generator() {
    let (r, tau) = (0.4, 0.3);
    let single = [generator(DVec3::ZERO)];
    let field = Field::new(&single, r, Norm::Euclidean);
    let wide = Field::new(&single, 2.0 * r, Norm::Euclidean);
    let grid = Grid::around(DVec3::splat(-0.1), DVec3::splat(0.1), r, 32);
    let surface = marching_cubes(&grid, &field.density_grid(&grid), tau);
    let normals = surface.gradient_normals(&field);
    for (i, w) in fibonacci_directions(30).into_iter().enumerate() {
        let q = (0.1 + 0.01 * i as f64) * w;
        let cell = (f64::from(grid.cell) / (r * (1.0 - tau.sqrt()).sqrt())).to_degrees();
        for (mode, normal, limit) in [
            ("vertex", vertex_normal(q, &surface, &normals), cell),
            ("face", face_normal(q, &surface, &normals), 0.5 * cell),
            ("exact", exact_normal(q, &field, tau, &surface), 1e-4),
            ("gradient", gradient_normal(q, &field, &wide), 1e-9),
            ("multiscale", multiscale_normal(q, &field, &wide), 1e-9),
        ] {
            let angle = degrees(normal.expect(mode), w);
            assert!(angle < limit, "{mode} at {q}: {angle} degrees");
        }
    }
    // In the centre nothing has a direction; outside of the support only the wide field has.
    assert_eq!(gradient_normal(DVec3::ZERO, &field, &wide), None);
    assert_eq!(multiscale_normal(DVec3::ZERO, &field, &wide), None);
    let outside = gradient_normal(0.6 * DVec3::X, &field, &wide);
    assert_eq!(outside, Some(DVec3::X));
    assert_eq!(gradient_normal(2.0 * DVec3::X, &field, &wide), None);
}

#[test]
fn the_exact_point_is_the_nearest_of_the_surface() {
    let cloud = ball_cloud(40, 0.4, 12);
    let field = Field::new(&cloud, 0.2, Norm::Euclidean);
    let grid = Grid::around(DVec3::splat(-0.4), DVec3::splat(0.4), 0.2, 48);
    let tau = 0.5;
    let surface = marching_cubes(&grid, &field.density_grid(&grid), tau);
    for g in &cloud {
        let q = 1.1 * g.position;
        let nearest = &surface.vertices[nearest_vertex(q, &surface.vertices).unwrap()];
        let p = nearest_on_level_set(&field, tau, q, *nearest).unwrap();
        assert!((field.density(p) - tau).abs() < 1e-6, "on the level set");
        let cell = f64::from(grid.cell);
        assert!(p.distance(q) <= nearest.distance(q) + 0.05 * cell);
        // At the nearest point the offset is parallel to the gradient.
        let n = field.density_and_gradient(p).1.normalize();
        let offset = (q - p).normalize();
        assert!(
            offset.cross(n).length() < 1e-3,
            "{}",
            offset.cross(n).length()
        );
    }
}

#[test]
fn blending_keeps_unit_length_and_survives_opposites() {
    let n = blend(DVec3::X, DVec3::Y, 0.5);
    assert!(degrees(n, DVec3::new(1.0, 1.0, 0.0)) < 1e-9);
    assert_eq!(blend(DVec3::X, DVec3::Y, 1.0), DVec3::Y);
    assert_eq!(blend(DVec3::X, DVec3::Y, 0.0), DVec3::X);
    assert_eq!(blend(DVec3::X, -DVec3::X, 0.5), -DVec3::X);
}

/// HET01 of the RAMI exercises, regenerated: 49,999 discs of radius 0.1 m with centres uniform in a
/// ball of 10 m. By symmetry normals are radial, and the mean leaf-area density is 0.375 m2/m3.
#[test]
fn the_rami_ball_has_radial_normals_and_beer_lambert_transmittance() {
    let diagonal = 20.0 * 3.0_f64.sqrt();
    let area = std::f64::consts::PI * 0.01 / (diagonal * diagonal);
    let discs: Vec<Generator> = ball_cloud(49_999, 10.0 / diagonal, 1)
        .iter()
        .map(|g| Generator { area, ..*g })
        .collect();
    let field = Field::new(&discs, 0.1, Norm::Euclidean);
    let wide = Field::new(&discs, 0.2, Norm::Euclidean);
    let directions = fibonacci_directions(60);
    let rms = |mode: fn(DVec3, &Field, &Field) -> Option<DVec3>| {
        let square = |w: &DVec3| {
            let q = 9.0 / diagonal * *w;
            degrees(mode(q, &field, &wide).unwrap(), *w).powi(2)
        };
        (directions.iter().map(square).sum::<f64>() / 60.0).sqrt()
    };
    // Discs at random leave this much noise: 1 m inside the edge the gradient of 11.9 discs per m3
    // has a standard deviation of 8.4 per axis and a mean of 115, in discs per metre and radius,
    // which is 5.9 degrees.
    let (gradient, multiscale) = (rms(gradient_normal), rms(multiscale_normal));
    assert!(
        (4.0..7.0).contains(&gradient),
        "gradient {gradient} degrees"
    );
    assert!(multiscale < 4.0, "multiscale {multiscale} degrees");

    let radius = 0.03;
    let leaf_area = Field::leaf_area(&discs, radius);
    let (min, max) = bounds(&discs);
    let grid = Grid::around(min, max, radius, 48);
    let values = leaf_area.density_grid(&grid);
    // Metres of path from a point at distance `from` along `w`, at angle cosine `c`.
    let path = |from: f64, c: f64| -from * c + (100.0 - from * from * (1.0 - c * c)).sqrt();
    for from in [0.0, 5.0, 9.0] {
        let (mut depth, mut expected) = (0.0, 0.0);
        for w in fibonacci_directions(100) {
            let q = from / diagonal * DVec3::X;
            depth -= transmittance(&grid, &values, q, w, 0.5).ln() / 100.0;
            expected += 0.5 * 0.375 * path(from, w.x) / 100.0;
        }
        let error = depth / expected - 1.0;
        assert!(error.abs() < 0.03, "depth at {from} m is off by {error}");
    }
    let at = |from: f64| {
        mean_transmittance(&grid, &values, from / diagonal * DVec3::X, &directions, 0.5)
    };
    assert!(
        (at(0.0) - (-0.1875_f64 * 10.0).exp()).abs() < 0.01,
        "{}",
        at(0.0)
    );
    let open = open_normal(&grid, &values, 9.0 / diagonal * DVec3::Y, &directions, 0.5).unwrap();
    assert!(degrees(open, DVec3::Y) < 6.0, "{}", degrees(open, DVec3::Y));
}

/// Cards scattered in a ball, as a mesh in metres at `scale`, relative to the mean position.
fn cards(scale: f64, offset: DVec3) -> (Vec<DVec3>, Vec<u32>) {
    let mut positions = Vec::new();
    let mut indices = Vec::new();
    for (i, g) in ball_cloud(300, 1.0, 21).iter().enumerate() {
        let w = fibonacci_directions(300)[i];
        let side = w.any_orthonormal_vector();
        let up = w.cross(side);
        let first = positions.len() as u32;
        positions.extend(
            [side + up, side - up, -side - up, up - side]
                .map(|corner| offset + scale * (g.position + 0.05 * corner)),
        );
        indices.extend([0, 1, 2, 0, 2, 3].map(|k| first + k));
    }
    (positions, indices)
}

/// World f64 to normalised f32, the only thing that depends on scale and place.
fn normalise(world: &[DVec3]) -> Vec<[f32; 3]> {
    let (min, max) = world
        .iter()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), &q| {
            (lo.min(q), hi.max(q))
        });
    let (centre, diagonal) = (0.5 * (min + max), (max - min).length());
    world
        .iter()
        .map(|&q| ((q - centre) / diagonal).as_vec3().to_array())
        .collect()
}

#[test]
fn scale_and_place_change_nothing() {
    let bake = |scale: f64, offset: DVec3| -> (Vec<DVec3>, Vec<f64>) {
        let (world, indices) = cards(scale, offset);
        let positions = normalise(&world);
        let all = generators(&positions, &indices, Source::Triangle).unwrap();
        let field = Field::new(&all, 0.12, Norm::Euclidean);
        let wide = Field::new(&all, 0.24, Norm::Euclidean);
        let t = Transfer {
            k_min: 0.2,
            d_min: 10.0,
            exponent: 1.0,
        };
        positions
            .iter()
            .map(|&p| {
                let q = DVec3::from(p.map(f64::from));
                let normal = multiscale_normal(q, &field, &wide).unwrap();
                (normal, transfer(field.density(q), &t))
            })
            .unzip()
    };
    let (normals, ambient) = bake(1.0, DVec3::ZERO);
    let far = DVec3::new(5e6, 100.0, -5e6);
    for (scale, offset) in [
        (1e-3, DVec3::ZERO),
        (1e6, DVec3::ZERO),
        (1.0, far),
        (1e6, far),
    ] {
        let (n, a) = bake(scale, offset);
        for i in 0..n.len() {
            let angle = degrees(n[i], normals[i]);
            assert!(angle < 0.1, "{angle} degrees at scale {scale}, {offset}");
            assert!((a[i] - ambient[i]).abs() < 1e-3);
        }
    }
}
