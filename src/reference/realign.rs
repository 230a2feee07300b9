//! Realigned normals (Luft, Balzer, Deussen 2007, section 3.3) and their alternatives.

use glam::DVec3;

use super::density::{Field, Grid};
use super::marching_cubes::Surface;

/// Below this |grad D| times the radius the gradient has no trustworthy direction. One generator
/// reaches 1.5; f32 sums of thousands of generators err by about 1e-4.
pub const GRADIENT_FLOOR: f64 = 1e-3;

/// Below this length a mean of unit vectors has no direction: they cancel.
pub const OPPOSITE_FLOOR: f64 = 1e-3;

/// Index of the vertex nearest to `q`, the lowest one of equals; `None` without vertices.
#[must_use]
pub fn nearest_vertex(q: DVec3, vertices: &[DVec3]) -> Option<usize> {
    let mut best = None;
    for (i, v) in vertices.iter().enumerate() {
        let d2 = q.distance_squared(*v);
        if best.is_none_or(|(_, least)| d2 < least) {
            best = Some((i, d2));
        }
    }
    best.map(|(i, _)| i)
}

/// Mode `vertex`: the normal of the nearest surface vertex, as in the paper.
#[must_use]
pub fn vertex_normal(q: DVec3, surface: &Surface, normals: &[DVec3]) -> Option<DVec3> {
    nearest_vertex(q, &surface.vertices).map(|i| normals[i])
}

/// Barycentric coordinates of the point of triangle `abc` nearest to `q` (Ericson 2005,
/// Real-Time Collision Detection, 5.1.5: the Voronoi region decides).
#[must_use]
pub fn closest_on_triangle(q: DVec3, a: DVec3, b: DVec3, c: DVec3) -> DVec3 {
    let (ab, ac) = (b - a, c - a);
    let (d1, d2) = (ab.dot(q - a), ac.dot(q - a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return DVec3::X;
    }
    let (d3, d4) = (ab.dot(q - b), ac.dot(q - b));
    if d3 >= 0.0 && d4 <= d3 {
        return DVec3::Y;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let t = d1 / (d1 - d3);
        return DVec3::new(1.0 - t, t, 0.0);
    }
    let (d5, d6) = (ab.dot(q - c), ac.dot(q - c));
    if d6 >= 0.0 && d5 <= d6 {
        return DVec3::Z;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let t = d2 / (d2 - d6);
        return DVec3::new(1.0 - t, 0.0, t);
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return DVec3::new(0.0, 1.0 - t, t);
    }
    let (v, w) = (vb / (va + vb + vc), vc / (va + vb + vc));
    DVec3::new(1.0 - v - w, v, w)
}

/// Triangle nearest to `q` (the lowest of equals), the nearest point, its barycentrics.
#[must_use]
pub fn nearest_on_surface(q: DVec3, surface: &Surface) -> Option<(usize, DVec3, DVec3)> {
    let mut best: Option<(usize, DVec3, DVec3)> = None;
    for (i, [a, b, c]) in surface.corners().enumerate() {
        let w = closest_on_triangle(q, a, b, c);
        let p = w.x * a + w.y * b + w.z * c;
        if best.is_none_or(|(_, least, _)| q.distance_squared(p) < q.distance_squared(least)) {
            best = Some((i, p, w));
        }
    }
    best
}

/// Mode `face`: vertex normals interpolated at the nearest point of the surface's triangles.
#[must_use]
pub fn face_normal(q: DVec3, surface: &Surface, normals: &[DVec3]) -> Option<DVec3> {
    let (triangle, _, w) = nearest_on_surface(q, surface)?;
    let [a, b, c] = surface.triangles[triangle].map(|i| normals[i as usize]);
    (w.x * a + w.y * b + w.z * c).try_normalize().or(Some(a))
}

/// Point of D = tau nearest to `q`, sought from `start` (a point near the surface): Newton steps
/// along the gradient alternate with descent of the distance in the tangent plane.
#[must_use]
pub fn nearest_on_level_set(field: &Field, tau: f64, q: DVec3, start: DVec3) -> Option<DVec3> {
    let mut p = newton(field, tau, start)?;
    let mut step = 1.0;
    for _ in 0..200 {
        let n = field.density_and_gradient(p).1.try_normalize()?;
        let tangential = (q - p) - (q - p).dot(n) * n;
        if tangential.length() < 1e-7 * field.radius || step < 1e-6 {
            break;
        }
        match newton(field, tau, p + step * tangential) {
            Some(next) if next.distance_squared(q) < p.distance_squared(q) => {
                p = next;
                step = f64::min(1.0, 1.5 * step);
            }
            _ => step *= 0.5,
        }
    }
    Some(p)
}

/// Moves `p` along the gradient onto D = tau; a step is at most a quarter radius.
fn newton(field: &Field, tau: f64, mut p: DVec3) -> Option<DVec3> {
    for _ in 0..50 {
        let (density, gradient) = field.density_and_gradient(p);
        let slope = gradient.length();
        if slope * field.radius < 1e-9 {
            return None;
        }
        let distance = (tau - density) / slope;
        let limit = 0.25 * field.radius;
        p += distance.clamp(-limit, limit) * gradient / slope;
        if distance.abs() < 1e-10 * field.radius {
            return Some(p);
        }
    }
    let (density, gradient) = field.density_and_gradient(p);
    ((density - tau).abs() < 1e-6 * gradient.length() * field.radius).then_some(p)
}

/// Mode `exact`: the normal of D = tau at its point nearest to `q`, sought from the nearest point
/// of the marching cubes surface.
#[must_use]
pub fn exact_normal(q: DVec3, field: &Field, tau: f64, surface: &Surface) -> Option<DVec3> {
    let (_, start, _) = nearest_on_surface(q, surface)?;
    let p = nearest_on_level_set(field, tau, q, start)?;
    gradient_direction(field, p)
}

/// -grad D / |grad D|, or `None` where the gradient is too small to have a direction.
#[must_use]
pub fn gradient_direction(field: &Field, q: DVec3) -> Option<DVec3> {
    let gradient = field.density_and_gradient(q).1;
    let length = gradient.length();
    (length * field.radius > GRADIENT_FLOOR).then(|| -gradient / length)
}

/// Mode `gradient`: the field's own direction; where it has none, that of `wide` (a field of the
/// same generators with twice the radius).
#[must_use]
pub fn gradient_normal(q: DVec3, field: &Field, wide: &Field) -> Option<DVec3> {
    gradient_direction(field, q).or_else(|| gradient_direction(wide, q))
}

/// Mode `multiscale`: the mean of the directions at one and two radii.
#[must_use]
pub fn multiscale_normal(q: DVec3, field: &Field, wide: &Field) -> Option<DVec3> {
    let near = gradient_direction(field, q);
    let far = gradient_direction(wide, q);
    match (near, far) {
        (Some(a), Some(b)) => Some(mean_direction(a + b).unwrap_or(a)),
        (a, b) => a.or(b),
    }
}

/// Beer-Lambert transmittance exp(-extinction * integral of the leaf-area density) from `q`
/// along the unit direction `w` to the edge of the grid: midpoint rule with steps of one cell.
///
/// `leaf_area` holds area per volume at the nodes; `extinction` is 0.5 for leaves of random
/// angles (the mean projection of a unit area).
#[must_use]
pub fn transmittance(grid: &Grid, leaf_area: &[f64], q: DVec3, w: DVec3, extinction: f64) -> f64 {
    let step = f64::from(grid.cell);
    let end = exit_distance(grid, q, w);
    let steps = (end / step).ceil() as u32;
    let mut depth = 0.0;
    for i in 0..steps {
        depth += grid.sample(leaf_area, q + (f64::from(i) + 0.5) * step * w);
    }
    (-extinction * step * depth).exp()
}

/// Distance from `q` (inside) to where the ray along `w` leaves the grid's box; 0 outside.
fn exit_distance(grid: &Grid, q: DVec3, w: DVec3) -> f64 {
    let low = grid.position([0; 3]);
    let high = grid.position(grid.nodes.map(|n| n - 1));
    let mut end = f64::INFINITY;
    for axis in 0..3 {
        if w[axis] != 0.0 {
            let side = if w[axis] > 0.0 { high } else { low };
            end = end.min((side[axis] - q[axis]) / w[axis]);
        }
    }
    end.max(0.0)
}

/// Mode `open`: the mean of `directions`, each weighted with its transmittance.
#[must_use]
pub fn open_normal(
    grid: &Grid,
    leaf_area: &[f64],
    q: DVec3,
    directions: &[DVec3],
    extinction: f64,
) -> Option<DVec3> {
    let sum: DVec3 = directions
        .iter()
        .map(|&w| transmittance(grid, leaf_area, q, w, extinction) * w)
        .sum();
    mean_direction(sum / directions.len() as f64)
}

/// N' = normalize((1-b) N + b `N_s`); opposite vectors fall back to `N_s`.
#[must_use]
pub fn blend(original: DVec3, realigned: DVec3, b: f64) -> DVec3 {
    mean_direction((1.0 - b) * original + b * realigned).unwrap_or(realigned)
}

fn mean_direction(sum: DVec3) -> Option<DVec3> {
    (sum.length() > OPPOSITE_FLOOR).then(|| sum.normalize())
}
