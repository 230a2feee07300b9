//! Fewer vertices with transfer vectors: each coarse vertex keeps a Gaussian mean, over geodesic
//! distance, of the vectors about it on its own leaf (Wang et al. 2005, section 4.1).
//!
//! Means are weighted by area, so that densely meshed spots do not dominate, and normalised, so
//! that a constant stays what it is. Sides and leaves (connected pieces) are never mixed.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::Vec3;
use rayon::prelude::*;

use crate::scene::Geometry;

/// Reach of the filter, in edges of the level.
const REACH: f32 = 1.5;

/// One level: coarse vertices, and which vertices each stands for.
#[derive(Debug, Clone, PartialEq)]
pub struct Lod {
    /// Vertices that have a vector, ascending.
    pub coarse: Vec<u32>,
    /// For each coarse vertex: vertices within reach, ascending, and their weights.
    about: Vec<Vec<(u32, f32)>>,
    /// Sum of weight times area about each coarse vertex; 0: nothing there has an area.
    totals: Vec<f32>,
    /// Area that each vertex stands for.
    areas: Vec<f32>,
}

impl Lod {
    /// The level whose coarse vertices are about `edge` (metres) apart; 0 takes every vertex.
    #[must_use]
    pub fn new(geometry: &Geometry, edge: f32) -> Self {
        let graph = Graph::new(geometry);
        let count = geometry.positions.len();
        let mut near = vec![f32::INFINITY; count];
        let mut out = Self {
            coarse: Vec::new(),
            about: Vec::new(),
            totals: Vec::new(),
            areas: graph.areas.clone(),
        };
        let reach = REACH * edge;
        let sigma = 0.5 * reach;
        let mut search = Search::new(count);
        for vertex in 0..count as u32 {
            if near[vertex as usize] < edge {
                continue;
            }
            let mut found = search.within(&graph, vertex, reach);
            // Ascending: sums over them then do not depend on how receivers are batched.
            found.sort_unstable_by_key(|f| f.0);
            for &(v, d) in &found {
                near[v as usize] = near[v as usize].min(d);
            }
            let weight = |d: f32| {
                if sigma > 0.0 {
                    (-0.5 * (d / sigma).powi(2)).exp()
                } else {
                    1.0
                }
            };
            let about: Vec<_> = found.into_iter().map(|(v, d)| (v, weight(d))).collect();
            let areas = about.iter().map(|&(v, w)| w * out.areas[v as usize]);
            out.totals.push(areas.sum());
            out.coarse.push(vertex);
            out.about.push(about);
        }
        out
    }

    /// Adds to `sums` (of the coarse vertices, `width` floats each) the shares of the vertices
    /// from `first` on, whose values are `values`.
    pub fn gather(&self, sums: &mut [f32], width: usize, first: usize, values: &[f32]) {
        let last = first + values.len() / width;
        let coarse = self.coarse.par_iter().zip(&self.about).zip(&self.totals);
        sums.par_chunks_exact_mut(width)
            .zip(coarse)
            .for_each(|(sum, ((&own, about), &total))| {
                let from = about.partition_point(|a| (a.0 as usize) < first);
                let within = about[from..].iter();
                for &(v, w) in within.take_while(|a| (a.0 as usize) < last) {
                    let share = if total > 0.0 {
                        w * self.areas[v as usize] / total
                    } else {
                        f32::from(v == own)
                    };
                    let at = (v as usize - first) * width;
                    for (sum, value) in sum.iter_mut().zip(&values[at..at + width]) {
                        *sum += share * value;
                    }
                }
            });
    }

    /// Radiance of every vertex (front, back), from that of the coarse ones.
    #[must_use]
    pub fn spread(&self, coarse: &[[f32; 3]]) -> Vec<[f32; 3]> {
        let mut sums = vec![Vec3::ZERO; 2 * self.areas.len()];
        let mut weights = vec![0.0_f32; self.areas.len()];
        for (i, about) in self.about.iter().enumerate() {
            for &(v, w) in about {
                weights[v as usize] += w;
                for side in 0..2 {
                    sums[2 * v as usize + side] += w * Vec3::from(coarse[2 * i + side]);
                }
            }
        }
        sums.iter()
            .enumerate()
            .map(|(k, s)| (*s / weights[k / 2].max(f32::MIN_POSITIVE)).to_array())
            .collect()
    }
}

/// Edges of the mesh with their lengths.
struct Graph {
    first: Vec<u32>,
    edges: Vec<(u32, f32)>,
    areas: Vec<f32>,
}

impl Graph {
    fn new(geometry: &Geometry) -> Self {
        let count = geometry.positions.len();
        let mut areas = vec![0.0; count];
        let mut pairs = Vec::with_capacity(2 * geometry.indices.len());
        for t in geometry.indices.chunks_exact(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| geometry.positions[i as usize]);
            let area = (b - a).cross(c - a).length() / 6.0;
            for k in 0..3 {
                areas[t[k] as usize] += area;
                pairs.push((t[k], t[(k + 1) % 3]));
                pairs.push((t[(k + 1) % 3], t[k]));
            }
        }
        pairs.sort_unstable();
        pairs.dedup();
        let mut first = vec![0u32; count + 1];
        for &(from, _) in &pairs {
            first[from as usize + 1] += 1;
        }
        for i in 0..count {
            first[i + 1] += first[i];
        }
        let length = |&(a, b): &(u32, u32)| {
            let [a, b_at] = [a, b].map(|i| geometry.positions[i as usize]);
            (b, a.distance(b_at))
        };
        Self {
            first,
            edges: pairs.iter().map(length).collect(),
            areas,
        }
    }

    fn neighbours(&self, vertex: u32) -> &[(u32, f32)] {
        let v = vertex as usize;
        &self.edges[self.first[v] as usize..self.first[v + 1] as usize]
    }
}

/// Shortest ways along edges, within a bound (Dijkstra 1959).
struct Search {
    distance: Vec<f32>,
}

#[derive(PartialEq)]
struct Open(f32, u32);

impl Eq for Open {}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        other.0.total_cmp(&self.0).then(other.1.cmp(&self.1))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Search {
    fn new(count: usize) -> Self {
        Self {
            distance: vec![f32::INFINITY; count],
        }
    }

    /// Vertices within `reach` of `start` and their distances, nearest first.
    fn within(&mut self, graph: &Graph, start: u32, reach: f32) -> Vec<(u32, f32)> {
        let mut found = Vec::new();
        let mut touched = vec![start];
        let mut open = BinaryHeap::from([Open(0.0, start)]);
        self.distance[start as usize] = 0.0;
        while let Some(Open(d, v)) = open.pop() {
            if d > self.distance[v as usize] {
                continue;
            }
            found.push((v, d));
            for &(next, length) in graph.neighbours(v) {
                let way = d + length;
                if way < self.distance[next as usize] && way <= reach {
                    self.distance[next as usize] = way;
                    touched.push(next);
                    open.push(Open(way, next));
                }
            }
        }
        for v in touched {
            self.distance[v as usize] = f32::INFINITY;
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two separate strips of `n` quads of edge 1.
    fn strips(n: u32) -> Geometry {
        let mut g = Geometry::default();
        for strip in 0..2 {
            let first = g.positions.len() as u32;
            for i in 0..=n {
                for j in 0..2 {
                    g.positions
                        .push(Vec3::new(i as f32, j as f32, 0.01 * strip as f32));
                }
            }
            for i in 0..n {
                let a = first + 2 * i;
                g.indices.extend([a, a + 2, a + 3, a, a + 3, a + 1]);
            }
        }
        g
    }

    /// Coarse values, gathered in batches of `batch` vertices.
    fn gathered(lod: &Lod, all: &[[f32; 2]], batch: usize) -> Vec<f32> {
        let mut sums = vec![0.0; 2 * lod.coarse.len()];
        for (number, part) in all.chunks(batch).enumerate() {
            lod.gather(&mut sums, 2, number * batch, part.as_flattened());
        }
        sums
    }

    #[test]
    fn constants_survive_every_level_and_leaves_and_sides_stay_apart() {
        let g = strips(20);
        let half = g.positions.len() / 2;
        let mut last = usize::MAX;
        for edge in [0.0, 1.5, 3.0, 6.0, 100.0] {
            let lod = Lod::new(&g, edge);
            assert!(lod.coarse.len() <= last, "{edge}: {}", lod.coarse.len());
            last = lod.coarse.len();
            let leaf = |v: usize| if v < half { 1.0 } else { 3.0 };
            let all: Vec<[f32; 2]> = (0..2 * half).map(|v| [leaf(v), 10.0 * leaf(v)]).collect();
            let coarse = gathered(&lod, &all, 7);
            let radiance: Vec<[f32; 3]> = coarse.iter().map(|&v| [v; 3]).collect();
            for (k, value) in lod.spread(&radiance).iter().enumerate() {
                let wanted = all[k / 2][k % 2];
                assert!(
                    (value[0] - wanted).abs() < 1e-5 * wanted,
                    "{edge} {k}: {value:?}"
                );
            }
        }
        assert_eq!(last, 2, "one vertex for each leaf");
    }

    #[test]
    fn batches_change_no_bit() {
        let g = strips(20);
        let count = g.positions.len();
        let all: Vec<[f32; 2]> = (0..count).map(|v| [(v as f32).sin(), v as f32]).collect();
        let lod = Lod::new(&g, 3.0);
        assert_eq!(gathered(&lod, &all, count), gathered(&lod, &all, 5));
        let every = Lod::new(&g, 0.0);
        assert_eq!(gathered(&every, &all, 9), all.as_flattened());
    }
}
