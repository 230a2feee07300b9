//! Triangulation of planar polygons (OBJ faces, outlines of drawings) by ear clipping.

use glam::{DVec2, DVec3};

/// Longest polygon that is clipped ear by ear (quadratic time); longer ones become fans.
const EAR_CLIPPING_LIMIT: usize = 512;

/// Triangles of a polygon, as indices into `corners`, in the polygon's orientation. Always
/// `corners.len() - 2` of them; self-crossing or degenerate polygons get a defined answer.
pub(crate) fn triangulate(corners: &[DVec3]) -> Vec<[usize; 3]> {
    let n = corners.len();
    match n {
        0..=2 => vec![],
        3 => vec![[0, 1, 2]],
        _ if n > EAR_CLIPPING_LIMIT => (1..n - 1).map(|i| [0, i, i + 1]).collect(),
        _ => clip(&flat(corners)),
    }
}

/// Projection along the normal (Newell's method), counter-clockwise.
fn flat(corners: &[DVec3]) -> Vec<DVec2> {
    let n = corners.len();
    let first = corners[0];
    let newell = (0..n).fold(DVec3::ZERO, |sum, i| {
        sum + (corners[i] - first).cross(corners[(i + 1) % n] - first)
    });
    let normal = newell.try_normalize().unwrap_or(DVec3::Z);
    let (u, v) = normal.any_orthonormal_pair();
    let project = |p: &DVec3| DVec2::new((*p - first).dot(u), (*p - first).dot(v));
    corners.iter().map(project).collect()
}

fn clip(points: &[DVec2]) -> Vec<[usize; 3]> {
    let mut ring: Vec<usize> = (0..points.len()).collect();
    let mut out = Vec::with_capacity(points.len() - 2);
    while ring.len() > 3 {
        let k = best_ear(points, &ring);
        let n = ring.len();
        out.push([ring[(k + n - 1) % n], ring[k], ring[(k + 1) % n]]);
        ring.remove(k);
    }
    out.push([ring[0], ring[1], ring[2]]);
    out
}

/// The corner to cut: an ear with the shortest new edge; without any ear (degenerate input),
/// the corner with the largest turn.
fn best_ear(points: &[DVec2], ring: &[usize]) -> usize {
    let n = ring.len();
    let corner = |k: usize| [(k + n - 1) % n, k, (k + 1) % n].map(|i| points[ring[i]]);
    let turn = |k: usize| {
        let [a, b, c] = corner(k);
        (b - a).perp_dot(c - b)
    };
    let is_ear = |k: usize| {
        let [a, b, c] = corner(k);
        turn(k) > 0.0
            && (0..n)
                .filter(|&i| i != k && i != (k + 1) % n && i != (k + n - 1) % n)
                .all(|i| !inside(points[ring[i]], a, b, c))
    };
    let edge = |k: usize| {
        let [a, _, c] = corner(k);
        a.distance_squared(c)
    };
    (0..n)
        .filter(|&k| is_ear(k))
        .min_by(|&i, &j| edge(i).total_cmp(&edge(j)))
        .or_else(|| (0..n).max_by(|&i, &j| turn(i).total_cmp(&turn(j))))
        .unwrap_or(0)
}

fn inside(p: DVec2, a: DVec2, b: DVec2, c: DVec2) -> bool {
    let side = |a: DVec2, b: DVec2| (b - a).perp_dot(p - a) >= 0.0;
    // A corner at the same place as one of the triangle's own does not block it.
    p != a && p != b && p != c && side(a, b) && side(b, c) && side(c, a)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(points: &[DVec3], t: &[[usize; 3]]) -> f64 {
        let one = |t: &[usize; 3]| {
            let [a, b, c] = t.map(|i| points[i]);
            0.5 * (b - a).cross(c - a).z
        };
        assert!(t.iter().all(|t| one(t) >= 0.0), "a triangle is turned over");
        t.iter().map(one).sum()
    }

    #[test]
    fn concave_polygons_keep_area_and_orientation() {
        // An L of area 3, starting at different corners.
        let l = [[0., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]];
        for start in 0..6 {
            let p: Vec<DVec3> = (0..6)
                .map(|i| l[(i + start) % 6])
                .map(|[x, y]| DVec3::new(x, y, 5e6))
                .collect();
            let t = triangulate(&p);
            assert_eq!(t.len(), 4);
            assert!((area(&p, &t) - 3.0).abs() < 1e-9);
        }
        // A dart (concave quad): the diagonal must pass through the notch.
        let dart = [[0., 0.], [2., -1.], [0.5, 0.], [2., 1.]];
        let p: Vec<DVec3> = dart.iter().map(|&[x, y]| DVec3::new(x, y, 0.)).collect();
        assert!((area(&p, &triangulate(&p)) - 0.5).abs() < 1e-9);
    }

    #[test]
    fn degenerate_polygons_have_a_defined_answer() {
        assert_eq!(triangulate(&[DVec3::ZERO; 7]).len(), 5);
        assert_eq!(triangulate(&[DVec3::ZERO; 2]).len(), 0);
        assert_eq!(triangulate(&vec![DVec3::ONE; 2000]).len(), 1998);
    }
}
