//! Rays against all triangles, one after the other.
//!
//! Twin of `shaders/leaf/any_hit.comp` and `nearest_hit.comp`: the triangle test of Woop, Benthin
//! and Wald 2013 without a hierarchy. Positions are those that the kernels see.

use glam::{DVec3, Vec3};

/// What a ray meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance in lengths of the direction.
    pub t: f64,
    /// Number of the triangle.
    pub triangle: u32,
    /// Weights of its corners.
    pub weights: [f64; 3],
}

/// Triangles that stop rays.
#[derive(Debug, Clone)]
pub struct Triangles {
    corners: Vec<[DVec3; 3]>,
}

impl Triangles {
    /// The triangles of `indices`.
    #[must_use]
    pub fn new(positions: &[Vec3], indices: &[u32]) -> Self {
        let corners = indices
            .chunks_exact(3)
            .map(|t| [t[0], t[1], t[2]].map(|i| positions[i as usize].as_dvec3()))
            .collect();
        Self { corners }
    }

    /// Corners of a triangle.
    #[must_use]
    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.corners[triangle as usize]
    }

    /// The nearest hit that `stops` accepts before `t_max`; of equals the lowest number.
    pub fn nearest(
        &self,
        origin: DVec3,
        direction: DVec3,
        t_max: f64,
        stops: impl Fn(&Hit) -> bool,
    ) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        for (number, corners) in (0u32..).zip(&self.corners) {
            let Some((t, weights)) = intersect(origin, direction, corners) else {
                continue;
            };
            let hit = Hit {
                t,
                triangle: number,
                weights,
            };
            if t > 0.0 && t < best.map_or(t_max, |b| b.t) && stops(&hit) {
                best = Some(hit);
            }
        }
        best
    }
}

/// Distance and barycentric weights; either side is hit, edges belong to both triangles.
#[must_use]
pub fn intersect(origin: DVec3, direction: DVec3, corners: &[DVec3; 3]) -> Option<(f64, [f64; 3])> {
    let axis = direction.abs().max_position();
    let turned = |v: DVec3| DVec3::new(v[(axis + 1) % 3], v[(axis + 2) % 3], v[axis]);
    let d = turned(direction);
    let [a, b, c] = corners.map(|p| {
        let p = turned(p - origin);
        DVec3::new(p.x - d.x / d.z * p.z, p.y - d.y / d.z * p.z, p.z / d.z)
    });
    let u = c.x * b.y - c.y * b.x;
    let v = a.x * c.y - a.y * c.x;
    let w = b.x * a.y - b.y * a.x;
    let inside = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
    let sum = u + v + w;
    if !inside || sum == 0.0 {
        return None;
    }
    let weights = [u / sum, v / sum, w / sum];
    Some((
        weights[0] * a.z + weights[1] * b.z + weights[2] * c.z,
        weights,
    ))
}
