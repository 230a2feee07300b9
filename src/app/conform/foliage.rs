//! Kernels of the foliage bake against their twins.

use glam::{DVec3, Vec3};

use super::{Case, Outcome};
use crate::Result;
use crate::abi;
use crate::foliage::probe_field::{self as probe, FieldInput};
use crate::foliage::{Encoding, NodeGrid, Norm, Primitive};
use crate::gpu::Gpu;
use crate::math::sampling::uniform;
use crate::math::stats::angle_degrees;
use crate::reference::ambient::{Transfer, transfer};
use crate::reference::density::{self, Field, Grid};
use crate::reference::generators::{self, Generator, Source};
use crate::reference::{encode, realign};

/// Largest relative error of a density. Errors are relative to the density or to this floor, one
/// twentieth of the largest weight: near the edge of the support 1 - |d|^2 cancels.
const DENSITY_LIMIT: f64 = 1e-5;
const DENSITY_FLOOR: f64 = 0.05;
/// Degrees between a kernel's direction and the twin's.
const NORMAL_LIMIT: f64 = 0.05;

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let mut add = |name, run| cases.push(Case { name, run });
    add("foliage.generators.leaf", |gpu| {
        leaf_centres(gpu, Primitive::Leaf)
    });
    add("foliage.generators.triangle", |gpu| {
        leaf_centres(gpu, Primitive::Triangle)
    });
    add("foliage.generators.auto", |gpu| {
        leaf_centres(gpu, Primitive::Auto)
    });
    add("foliage.density.one_ball", |gpu| {
        on_grid(gpu, &[[0.01, -0.02, 0.03, 1.0]], 0.2, Norm::Euclidean)
    });
    add("foliage.density.two_balls", |gpu| {
        on_grid(
            gpu,
            &[[-0.1, 0.0, 0.0, 1.0], [0.12, 0.0, 0.0, 1.0]],
            0.17,
            Norm::Euclidean,
        )
    });
    add("foliage.density.cloud", |gpu| {
        on_grid(gpu, &cloud(3000), 0.1, Norm::Euclidean)
    });
    add("foliage.density.manhattan", |gpu| {
        on_grid(gpu, &cloud(500), 0.12, Norm::Manhattan)
    });
    add("foliage.density.maximum", |gpu| {
        on_grid(gpu, &cloud(500), 0.08, Norm::Maximum)
    });
    add("foliage.density.small_radius", |gpu| {
        on_grid(gpu, &cloud(2000), 0.01, Norm::Euclidean)
    });
    add("foliage.density.coincident", |gpu| {
        on_grid(
            gpu,
            &vec![[0.1, 0.1, 0.1, 1.0]; 2000],
            0.15,
            Norm::Euclidean,
        )
    });
    add("foliage.field.cloud", |gpu| {
        at_points(gpu, &cloud(3000), 0.1, Norm::Euclidean)
    });
    add("foliage.field.manhattan", |gpu| {
        at_points(gpu, &cloud(600), 0.12, Norm::Manhattan)
    });
    add("foliage.field.maximum", |gpu| {
        at_points(gpu, &cloud(600), 0.1, Norm::Maximum)
    });
    add("foliage.field.weights", |gpu| {
        let mut cloud = cloud(900);
        for (i, g) in (0u32..).zip(&mut cloud) {
            g[3] = 0.25 + 4.0 * uniform(11, i) as f32;
        }
        at_points(gpu, &cloud, 0.15, Norm::Euclidean)
    });
    add("foliage.field.one_point", |gpu| {
        at_points(gpu, &[[0.0, 0.0, 0.0, 1.0]], 0.3, Norm::Euclidean)
    });
    add("foliage.field.direction", field_direction);
    add("foliage.directions.single", |gpu| {
        direction_modes(gpu, abi::DIRECTIONS_SINGLE)
    });
    add("foliage.directions.mean", |gpu| {
        direction_modes(gpu, abi::DIRECTIONS_MEAN)
    });
    add("foliage.directions.fill", directions_fill);
    add("foliage.realign.blend", blend);
    add("foliage.ambient.eq4", |gpu| equation_4(gpu, 0.3, 0.8));
    add("foliage.ambient.step", |gpu| equation_4(gpu, 0.3, 0.0));
    add("foliage.ambient.tau_zero", |gpu| equation_4(gpu, 0.0, 0.8));
    add("foliage.encode.length", |gpu| {
        encoded(gpu, Encoding::Length)
    });
    add("foliage.encode.packed16", |gpu| {
        encoded(gpu, Encoding::Packed16)
    });
    add("foliage.encode.packed8", |gpu| {
        encoded(gpu, Encoding::Packed8)
    });
    cases
}

const HALF: DVec3 = DVec3::new(0.3, 0.28, 0.29);

/// Seeded generators in the box, denser towards one corner.
fn cloud(count: u32) -> Vec<[f32; 4]> {
    let along = |i: u32, k: u32| {
        let u = uniform(7, 3 * i + k);
        (HALF[k as usize] * (2.0 * u * u.sqrt() - 1.0)) as f32
    };
    (0..count)
        .map(|i| [along(i, 0), along(i, 1), along(i, 2), 1.0])
        .collect()
}

fn points(count: u32) -> Vec<[f32; 4]> {
    let along = |i: u32, k: u32| (HALF[k as usize] * (2.0 * uniform(3, 3 * i + k) - 1.0)) as f32;
    (0..count)
        .map(|i| [along(i, 0), along(i, 1), along(i, 2), 0.0])
        .collect()
}

fn input(generators: &[[f32; 4]], radius: f32, norm: Norm) -> FieldInput<'_> {
    FieldInput {
        generators,
        radius,
        norm,
        half: HALF,
    }
}

fn twin(generators: &[[f32; 4]], radius: f32, norm: Norm) -> Field {
    let widened: Vec<Generator> = generators
        .iter()
        .map(|g| Generator {
            position: position(*g),
            weight: f64::from(g[3]),
            area: 0.0,
        })
        .collect();
    let norm = match norm {
        Norm::Euclidean => density::Norm::Euclidean,
        Norm::Manhattan => density::Norm::Manhattan,
        Norm::Maximum => density::Norm::Maximum,
    };
    Field::new(&widened, f64::from(radius), norm)
}

fn position(p: [f32; 4]) -> DVec3 {
    DVec3::new(f64::from(p[0]), f64::from(p[1]), f64::from(p[2]))
}

fn relative(got: f32, expected: f64, weight: f64) -> f64 {
    (f64::from(got) - expected).abs() / expected.max(DENSITY_FLOOR * weight)
}

/// The largest of `errors`; NaN when one of them is.
fn worst(errors: impl IntoIterator<Item = f64>) -> f64 {
    errors
        .into_iter()
        .fold(0.0, |a: f64, b| if b.is_nan() { b } else { a.max(b) })
}

fn on_grid(gpu: &Gpu, generators: &[[f32; 4]], radius: f32, norm: Norm) -> Result<Outcome> {
    let grid = NodeGrid::around(HALF, f64::from(radius), 30, 64)?;
    // Coincident generators are one of the weight of all.
    let coincident = generators.iter().all(|g| g == &generators[0]);
    let weight = if coincident {
        generators.len() as f64
    } else {
        1.0
    };
    let got = input(generators, radius, norm).on_grid(gpu, &grid)?;
    let twin_grid = Grid {
        origin: grid.origin,
        cell: grid.cell,
        nodes: grid.nodes,
    };
    let expected = twin(generators, radius, norm).density_grid(&twin_grid);
    Ok(Outcome::worst(
        (&got, &expected),
        |&g, &e| relative(g, e, weight),
        (DENSITY_LIMIT, "relative density"),
    ))
}

fn at_points(gpu: &Gpu, generators: &[[f32; 4]], radius: f32, norm: Norm) -> Result<Outcome> {
    let points = points(1001);
    let field = input(generators, radius, norm);
    let got = field.at(gpu, &points)?;
    let alone = field.density_at(gpu, &points)?;
    let twin = twin(generators, radius, norm);
    let errors = points
        .iter()
        .zip(got.iter().zip(alone))
        .map(|(&p, (g, alone))| {
            let (d, gradient) = twin.density_and_gradient(position(p));
            let got = DVec3::new(f64::from(g[1]), f64::from(g[2]), f64::from(g[3]));
            // |grad D| is at most about 1.5 w / r per generator.
            let slope = (got - gradient).length() * f64::from(radius)
                / d.max(gradient.length() * f64::from(radius)).max(1.0);
            relative(g[0], d, 1.0)
                .max(relative(alone, d, 1.0))
                .max(slope)
        });
    Ok(Outcome::new(
        worst(errors),
        DENSITY_LIMIT,
        "relative density and slope",
    ))
}

fn field_direction(gpu: &Gpu) -> Result<Outcome> {
    let (points, cloud) = (points(2000), cloud(3000));
    let got = input(&cloud, 0.1, Norm::Euclidean).at(gpu, &points)?;
    let twin = twin(&cloud, 0.1, Norm::Euclidean);
    let errors = points.iter().zip(got).filter_map(|(&p, g)| {
        // Where the sum nearly cancels, the direction is that of rounding errors.
        let (d, gradient) = twin.density_and_gradient(position(p));
        if gradient.length() * 0.1 < 1e-2 * d {
            return None;
        }
        let expected = realign::gradient_direction(&twin, position(p))?;
        let got = -Vec3::new(g[1], g[2], g[3]).normalize();
        Some(angle_degrees(got, expected.as_vec3()))
    });
    Ok(Outcome::new(worst(errors), NORMAL_LIMIT, "degrees"))
}

/// Two triangles per leaf, some leaves of no area.
fn leaf_mesh() -> (Vec<Vec3>, Vec<u32>) {
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    for i in 0..300u32 {
        let random = |k: u32| (uniform(5, 8 * i + k) - 0.5) as f32;
        let base = Vec3::new(random(0), random(1), random(2));
        let (a, b) = match i % 10 {
            0 => (Vec3::new(0.01, 0.0, 0.0), Vec3::new(0.02, 0.0, 0.0)),
            1 => (Vec3::ZERO, Vec3::ZERO),
            _ => (
                0.02 * Vec3::new(random(3), random(4), random(5)),
                0.02 * Vec3::new(random(6), random(7), 0.3),
            ),
        };
        let first = positions.len() as u32;
        positions.extend([base, base + a, base + a + b, base + b]);
        indices.extend([0, 1, 2, 0, 2, 3].map(|k| first + k));
    }
    (positions, indices)
}

fn leaf_centres(gpu: &Gpu, primitive: Primitive) -> Result<Outcome> {
    let (positions, indices) = leaf_mesh();
    let centres = probe::generators(gpu, &positions, &indices, primitive)?;
    let areas = probe::areas(gpu, &positions, &indices, primitive)?;
    let plain: Vec<[f32; 3]> = positions.iter().map(|p| p.to_array()).collect();
    let source = match primitive {
        // 300 leaves are enough for `auto` to keep them.
        Primitive::Leaf | Primitive::Auto => Source::Leaf,
        Primitive::Triangle => Source::Triangle,
    };
    let expected = generators::generators(&plain, &indices, source).expect("finite positions");
    let got: Vec<([f32; 4], f32)> = centres.into_iter().zip(areas).collect();
    Ok(Outcome::worst(
        (&got, &expected),
        |(c, a), e| {
            let far = (position(*c) - e.position).length();
            far.max((f64::from(*a) - e.area).abs())
        },
        (2e-7, "diagonals"),
    ))
}

/// Gradients of all sizes, also none (density first).
fn gradient(seed: u32, i: u32) -> [f32; 4] {
    let k = |k: u32| (2.0 * uniform(seed, 3 * i + k) - 1.0) as f32;
    let size = [0.0, 1e-4, 1.0, 50.0][(i as usize + seed as usize) % 4];
    [1.0, size * k(0), size * k(1), size * k(2)]
}

/// The direction of a gradient that is large enough to have one.
fn direction(g: &[f32; 4], radius: f64) -> Option<DVec3> {
    let v = DVec3::new(f64::from(g[1]), f64::from(g[2]), f64::from(g[3]));
    (v.length() * radius > realign::GRADIENT_FLOOR).then(|| -v.normalize())
}

/// Degrees of a direction from the twin's; NaN where only one of them has one.
fn direction_error(got: &[f32; 4], expected: Option<DVec3>) -> f64 {
    match expected {
        None => f64::from(got[3]),
        Some(e) if got[3] == 1.0 => angle_degrees(Vec3::new(got[0], got[1], got[2]), e.as_vec3()),
        Some(_) => f64::NAN,
    }
}

/// A first field leaves gaps; one of twice the radius fills them and changes nothing else.
fn directions_fill(gpu: &Gpu) -> Result<Outcome> {
    let radius = 0.1f32;
    let near: Vec<[f32; 4]> = (0..999).map(|i| gradient(1, i)).collect();
    let wide: Vec<[f32; 4]> = (0..999).map(|i| gradient(2, i / 4)).collect();
    let (first, gaps) = probe::directions(gpu, abi::DIRECTIONS_SINGLE, (&near, &near), radius)?;
    let (filled, left) = probe::filled_directions(gpu, (&near, &wide), radius)?;
    let expected = near.iter().zip(&wide).map(|(n, w)| {
        let (near, wide) = (f64::from(radius), 2.0 * f64::from(radius));
        direction(n, near).or_else(|| direction(w, wide))
    });
    let mut error = worst(
        filled
            .iter()
            .zip(expected)
            .map(|(g, e)| direction_error(g, e)),
    );
    let kept = first
        .iter()
        .zip(&filled)
        .all(|(a, b)| a[3] == 0.0 || a == b);
    let count = |of: &[[f32; 4]]| of.iter().filter(|d| d[3] == 0.0).count();
    if !kept || count(&first) != gaps || count(&filled) != left || left == 0 || left >= gaps {
        error = f64::NAN;
    }
    Ok(Outcome::new(error, NORMAL_LIMIT, "degrees"))
}

/// The twin's rule on the kernel's own inputs.
fn direction_modes(gpu: &Gpu, mode: u32) -> Result<Outcome> {
    let radius = 0.1f32;
    let near: Vec<[f32; 4]> = (0..999).map(|i| gradient(1, i)).collect();
    let wide: Vec<[f32; 4]> = (0..999).map(|i| gradient(2, i / 4)).collect();
    let (got, _) = probe::directions(gpu, mode, (&near, &wide), radius)?;
    let errors = got.iter().zip(near.iter().zip(&wide)).map(|(g, (n, w))| {
        let (n, w) = (
            direction(n, f64::from(radius)),
            direction(w, 2.0 * f64::from(radius)),
        );
        let expected = match (mode, n, w) {
            (abi::DIRECTIONS_SINGLE, n, _) => n,
            (_, Some(a), Some(b)) if (a + b).length() > realign::OPPOSITE_FLOOR => {
                Some((a + b).normalize())
            }
            (_, a, b) => a.or(b),
        };
        direction_error(g, expected)
    });
    Ok(Outcome::new(worst(errors), NORMAL_LIMIT, "degrees"))
}

fn blend(gpu: &Gpu) -> Result<Outcome> {
    let unit = |seed: u32, i: u32| {
        let u = glam::DVec2::new(uniform(seed, 2 * i), uniform(seed, 2 * i + 1));
        crate::math::sampling::uniform_sphere(u)
    };
    let own: Vec<[f32; 3]> = (0..500).map(|i| unit(1, i).as_vec3().to_array()).collect();
    let mut found: Vec<[f32; 4]> = (0..500)
        .map(|i| unit(2, i).as_vec3().extend(1.0).to_array())
        .collect();
    // Opposite, and missing.
    found[0] = [-own[0][0], -own[0][1], -own[0][2], 1.0];
    found[1] = [0.0; 4];
    let got = probe::blend(gpu, &own, &found, 0.5)?;
    let widen = |v: &[f32]| DVec3::new(f64::from(v[0]), f64::from(v[1]), f64::from(v[2]));
    let errors = got.iter().zip(own.iter().zip(&found)).map(|(g, (o, f))| {
        let expected = match f[3] {
            0.0 => widen(o),
            _ => realign::blend(widen(o), widen(f), 0.5),
        };
        angle_degrees(Vec3::from(*g), expected.as_vec3())
    });
    Ok(Outcome::new(worst(errors), NORMAL_LIMIT, "degrees"))
}

fn equation_4(gpu: &Gpu, tau: f32, d_min: f32) -> Result<Outcome> {
    let density: Vec<f32> = (0..400).map(|i| 0.005 * i as f32).collect();
    let mut error = 0.0f64;
    for exponent in [1.0 / 3.0, 1.0, 3.0] {
        let push = abi::AmbientTransfer {
            count: 0,
            tau,
            k_min: 0.2,
            d_min,
            exponent,
        };
        let got = probe::transfer(gpu, &density, push)?;
        let t = Transfer {
            k_min: f64::from(0.2f32),
            d_min: f64::from(d_min),
            exponent: f64::from(exponent),
        };
        error = worst(
            got.iter()
                .zip(&density)
                .map(|(&g, &d)| (f64::from(g) - transfer(f64::from(d - tau), &t)).abs())
                .chain([error]),
        );
    }
    Ok(Outcome::new(error, 1e-4, "coefficient"))
}

fn encoded(gpu: &Gpu, encoding: Encoding) -> Result<Outcome> {
    let count = 2000;
    let normals: Vec<Vec3> = crate::math::sampling::fibonacci_directions(count)
        .iter()
        .map(|n| n.as_vec3())
        .collect();
    let ambient: Vec<f32> = (0..count).map(|i| i as f32 / (count - 1) as f32).collect();
    let got = probe::encode(gpu, encoding, &normals, &ambient)?;
    let expected: Vec<u32> = normals
        .iter()
        .zip(&ambient)
        .flat_map(|(n, &k)| {
            let (n, k) = (n.as_dvec3(), f64::from(k));
            match encoding {
                Encoding::Length => encode::encode_length(n, k).map(f32::to_bits).to_vec(),
                Encoding::Packed16 => encode::encode_packed16(n, k).to_vec(),
                Encoding::Packed8 => vec![encode::encode_packed8(n, k)],
                Encoding::None => Vec::new(),
            }
        })
        .collect();
    // A value that lies on the edge of two steps may take either.
    let step = |a: u32, b: u32| match encoding {
        Encoding::Length => f64::from((f32::from_bits(a) - f32::from_bits(b)).abs()) * 1e6,
        Encoding::Packed8 => (0..3)
            .map(|i| lane_difference(a >> (8 * i), b >> (8 * i), 8))
            .fold(0.0, f64::max),
        _ => lane_difference(a, b, 16).max(lane_difference(a >> 16, b >> 16, 16)),
    };
    Ok(Outcome::worst(
        (&got, &expected),
        |&g, &e| step(g, e),
        (1.0, "steps"),
    ))
}

/// Difference of two fields of `bits` bits, round the circle: -1 and 1 are the same direction.
fn lane_difference(a: u32, b: u32, bits: u32) -> f64 {
    let mask = (1u32 << bits) - 1;
    let d = a.wrapping_sub(b) & mask;
    f64::from(d.min((mask + 1).wrapping_sub(d) & mask))
}
