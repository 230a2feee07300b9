//! The wood's surface as a graph: vertices that lie on one another become one, triangles' edges
//! join them.

use std::collections::HashMap;

use glam::{DMat3, DVec3, IVec3, Vec3};

use crate::math::hashing::WordHash;

/// Vertices nearer than so much of the surface's extent are one.
const WELD: f32 = 2e-6;
/// Of a vertex that is no part of the surface.
pub(super) const NONE: u32 = u32::MAX;

/// What is known of a piece of the surface; pieces add up.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moments {
    /// Area, m^2.
    pub(super) area: f64,
    /// Area times place.
    pub(super) place: DVec3,
    /// Area times unit normal.
    pub(super) normal: DVec3,
    /// Area times normal times its transpose.
    pub(super) normals: DMat3,
    /// Area times place times the normal's transpose.
    pub(super) crossed: DMat3,
    /// Area times place times its transpose.
    pub(super) places: DMat3,
}

/// `a` times the transpose of `b`.
pub(super) fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

impl Moments {
    /// Of no surface.
    pub(super) const NONE: Self = Self {
        area: 0.0,
        place: DVec3::ZERO,
        normal: DVec3::ZERO,
        normals: DMat3::ZERO,
        crossed: DMat3::ZERO,
        places: DMat3::ZERO,
    };

    fn new(place: DVec3, normal: DVec3, area: f64) -> Self {
        Self {
            area,
            place: area * place,
            normal: area * normal,
            normals: area * outer(normal, normal),
            crossed: area * outer(place, normal),
            places: area * outer(place, place),
        }
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.area += other.area;
        self.place += other.place;
        self.normal += other.normal;
        self.normals += other.normals;
        self.crossed += other.crossed;
        self.places += other.places;
    }
}

/// A graph of places; neighbours of `i` are `neighbours[first[i]..first[i + 1]]`.
#[derive(Debug, Clone, Default)]
pub(super) struct Graph {
    pub(super) first: Vec<u32>,
    pub(super) neighbours: Vec<u32>,
}

impl Graph {
    /// From edges, in any order, once or several times; ends of one edge may be one.
    pub(super) fn new(count: usize, edges: impl Iterator<Item = (u32, u32)>) -> Self {
        let mut both: Vec<(u32, u32)> = edges
            .filter(|(a, b)| a != b)
            .flat_map(|(a, b)| [(a, b), (b, a)])
            .collect();
        both.sort_unstable();
        both.dedup();
        let mut first = vec![0; count + 1];
        for &(a, _) in &both {
            first[a as usize + 1] += 1;
        }
        for i in 0..count {
            first[i + 1] += first[i];
        }
        Self {
            first,
            neighbours: both.into_iter().map(|e| e.1).collect(),
        }
    }

    pub(super) fn len(&self) -> usize {
        self.first.len() - 1
    }

    pub(super) fn of(&self, node: usize) -> &[u32] {
        &self.neighbours[self.first[node] as usize..self.first[node + 1] as usize]
    }
}

/// A welded surface.
#[derive(Debug, Clone, Default)]
pub(super) struct Surface {
    pub(super) places: Vec<DVec3>,
    /// Unit normals, by area; zero where there is none.
    pub(super) normals: Vec<DVec3>,
    pub(super) moments: Vec<Moments>,
    pub(super) graph: Graph,
    /// Of each vertex that came in.
    pub(super) of_vertex: Vec<u32>,
}

impl Surface {
    /// Welds the vertices that `indices` (a triangle list) name.
    pub(super) fn new(positions: &[Vec3], indices: &[u32]) -> Self {
        let mut out = Self {
            of_vertex: vec![NONE; positions.len()],
            ..Self::default()
        };
        let used = indices.iter().map(|&v| positions[v as usize]);
        let extent = used.fold(0.0_f32, |most, p| most.max(p.abs().max_element()));
        let cell = (WELD * extent).max(f32::MIN_POSITIVE);
        let mut known: HashMap<IVec3, u32, WordHash> = HashMap::default();
        for &vertex in indices {
            let v = vertex as usize;
            if out.of_vertex[v] != NONE {
                continue;
            }
            let key = (positions[v] / cell).round().as_ivec3();
            out.of_vertex[v] = *known.entry(key).or_insert_with(|| {
                out.places.push(positions[v].as_dvec3());
                out.places.len() as u32 - 1
            });
        }
        let triangles: Vec<[u32; 3]> = indices
            .chunks_exact(3)
            .map(|t| [0, 1, 2].map(|k| out.of_vertex[t[k] as usize]))
            .collect();
        out.gather(&triangles);
        let edges = triangles
            .iter()
            .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
        out.graph = Graph::new(out.places.len(), edges);
        out
    }

    /// A third of each triangle goes to each of its corners.
    fn gather(&mut self, triangles: &[[u32; 3]]) {
        self.moments = vec![Moments::NONE; self.places.len()];
        for corners in triangles {
            let p = corners.map(|i| self.places[i as usize]);
            let twice = (p[1] - p[0]).cross(p[2] - p[0]);
            let Some(normal) = twice.try_normalize() else {
                continue;
            };
            for (&i, place) in corners.iter().zip(p) {
                let third = Moments::new(place, normal, twice.length() / 6.0);
                self.moments[i as usize].add(&third);
            }
        }
        let unit = |m: &Moments| m.normal.normalize_or_zero();
        self.normals = self.moments.iter().map(unit).collect();
    }
}
