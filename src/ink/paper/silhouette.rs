//! Silhouettes of stems from their surface (Deussen and Strothotte 2000, section 3.1: stems as
//! generalised cylinders, whose silhouettes are computed): where the normals turn from the eye, in
//! each triangle a straight line (Hertzmann and Zorin 2000). On a mesh of a cone they are the cone's
//! outline up to the arrow of its sides. Lines traced in pixels are moved onto them.

use glam::{DVec2, DVec3};

use super::curve::Polyline;
use crate::ink::view::View;
use crate::scene::Geometry;

/// Pixels from which traced lines are moved: they lie up to a pixel within the stem.
const REACH: f64 = 1.6;
/// Pixels by which a line on the other side is farther away at least.
const THIN: f64 = 0.6;
/// Points on each side whose moves tell that of a point.
const ABOUT: usize = 6;
/// Share of them that lie on silhouettes where silhouettes are whole.
const WHOLE: f64 = 0.8;
/// Pixels along a cell of the search.
const CELL: usize = 4;

/// Silhouettes of the triangles of `stems` with smooth normals, pixels.
pub(super) fn silhouettes(geometry: &Geometry, stems: &[u32], view: &View) -> Vec<[DVec2; 2]> {
    let eye = view.eye();
    let place = |v: u32| geometry.positions[v as usize].as_dvec3();
    let facing = |v: u32| geometry.normals[v as usize].as_dvec3().dot(place(v) - eye);
    let mut out = Vec::new();
    for t in stems.chunks_exact(3) {
        let f = [facing(t[0]), facing(t[1]), facing(t[2])];
        if f.iter().all(|&f| f > 0.0) || f.iter().all(|&f| f <= 0.0) {
            continue;
        }
        let mut ends: Vec<DVec3> = Vec::with_capacity(2);
        for (a, b) in [(0, 1), (1, 2), (2, 0)] {
            if (f[a] > 0.0) != (f[b] > 0.0) {
                ends.push(place(t[a]).lerp(place(t[b]), f[a] / (f[a] - f[b])));
            }
        }
        let [one, other] = [ends[0], ends[1]].map(|p| view.pixel(p));
        let before = |depth: f64| depth > view.camera.near;
        if before(one.1) && before(other.1) && one.0.is_finite() && other.0.is_finite() {
            out.push([one.0, other.0]);
        }
    }
    out
}

/// Lines of the picture by their place.
pub(super) struct Edges<'a> {
    all: &'a [[DVec2; 2]],
    cells: [usize; 2],
    /// Numbers of the lines that pass each cell.
    of_cell: Vec<Vec<u32>>,
}

impl<'a> Edges<'a> {
    /// Of a picture of `size` pixels.
    pub(super) fn new(size: [usize; 2], all: &'a [[DVec2; 2]]) -> Self {
        let cells = size.map(|s| s / CELL + 1);
        let mut of_cell = vec![Vec::new(); cells[0] * cells[1]];
        let most = DVec2::new(cells[0] as f64 - 1.0, cells[1] as f64 - 1.0);
        for (number, [a, b]) in (0..).zip(all) {
            let low = ((a.min(*b) - REACH) / CELL as f64).floor();
            let high = ((a.max(*b) + REACH) / CELL as f64).floor();
            if high.cmplt(DVec2::ZERO).any() || low.cmpgt(most).any() {
                continue;
            }
            let (low, high) = (low.max(DVec2::ZERO), high.min(most));
            for y in low.y as usize..=high.y as usize {
                for x in low.x as usize..=high.x as usize {
                    of_cell[y * cells[0] + x].push(number);
                }
            }
        }
        Self {
            all,
            cells,
            of_cell,
        }
    }

    /// The way to the nearest line, if one is near and none on the other side is about as near: a
    /// branch as thin as a pixel has one line, which keeps its middle.
    pub(super) fn way(&self, p: DVec2) -> Option<DVec2> {
        let cell = (p / CELL as f64).floor();
        let [w, h] = self.cells.map(|c| c as f64);
        if !(cell.x >= 0.0 && cell.y >= 0.0 && cell.x < w && cell.y < h) {
            return None;
        }
        let near = &self.of_cell[cell.y as usize * self.cells[0] + cell.x as usize];
        let way = |&number: &u32| {
            let [a, b] = self.all[number as usize];
            let along = b - a;
            let t = (p - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
            a + t.clamp(0.0, 1.0) * along - p
        };
        let nearest = near
            .iter()
            .map(way)
            .min_by(|a, b| a.length().total_cmp(&b.length()));
        let nearest = nearest.filter(|w| w.length() <= REACH)?;
        let opposite = |other: DVec2| {
            other.length() < nearest.length() + THIN
                && nearest.dot(other) < -0.8 * nearest.length() * other.length()
        };
        (!near.iter().map(way).any(opposite)).then_some(nearest)
    }
}

/// A traced line (pixels) on the silhouettes beside it. Where they are patchy it is moved as its
/// neighbours are in the mean, so that nothing leaps; where there are none it stays.
pub(super) fn snapped(line: &Polyline, edges: &Edges<'_>) -> Polyline {
    let ways: Vec<Option<DVec2>> = line.points.iter().map(|&p| edges.way(p)).collect();
    let count = ways.len();
    let moved = |i: usize| {
        let about = i.saturating_sub(ABOUT)..(i + ABOUT + 1).min(count);
        let all = about.len() as f64;
        let near = about.filter_map(|k| ways[k]);
        let (sum, found) = near.fold((DVec2::ZERO, 0.0), |(s, n), w| (s + w, n + 1.0));
        let own = ways[i].filter(|_| found >= WHOLE * all);
        line.points[i] + own.unwrap_or(sum / all)
    };
    Polyline {
        points: (0..count).map(moved).collect(),
        closed: line.closed,
    }
}
