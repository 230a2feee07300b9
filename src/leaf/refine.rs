//! A finer mesh for shadows: visibility changes over less than a triangle, the light of the sky
//! does not (Wang et al. 2005 keep 4 to 5 thousand vertices for transfer and 34 to 60 thousand for
//! visibility).
//!
//! Every triangle becomes four flat ones, again and again; the surface stays what it was.

use std::collections::HashMap;

use glam::Vec3;

use crate::scene::Geometry;

/// A geometry with more vertices.
#[derive(Debug, Clone)]
pub struct Refined {
    /// The finer mesh; the vertices of the coarse one are somewhere among its own.
    pub geometry: Geometry,
    /// For every vertex: the two vertices, before it in the list or itself, that it is the middle
    /// of. A vertex of the coarse mesh names itself.
    parents: Vec<[u32; 2]>,
    /// Vertex of the coarse mesh, for those that are one.
    coarse: Vec<Option<u32>>,
}

impl Refined {
    /// `geometry` with every triangle split `times` times.
    #[must_use]
    pub fn new(geometry: &Geometry, times: u32) -> Self {
        let count = geometry.positions.len() as u32;
        let mut out = Self {
            geometry: geometry.clone(),
            parents: (0..count).map(|v| [v, v]).collect(),
            coarse: (0..count).map(Some).collect(),
        };
        for _ in 0..times {
            out.split();
        }
        out
    }

    /// Values of every vertex, `width` each, from those of the coarse mesh.
    #[must_use]
    pub fn spread(&self, coarse: &[[f32; 3]], width: usize) -> Vec<[f32; 3]> {
        let mut out: Vec<[f32; 3]> = Vec::with_capacity(width * self.parents.len());
        for (&[a, b], own) in self.parents.iter().zip(&self.coarse) {
            for k in 0..width {
                let value = match own {
                    Some(own) => coarse[*own as usize * width + k],
                    None => {
                        let [a, b] = [a, b].map(|v| Vec3::from(out[v as usize * width + k]));
                        (0.5 * (a + b)).to_array()
                    }
                };
                out.push(value);
            }
        }
        out
    }

    /// Values of the coarse mesh's vertices, from those of all.
    #[must_use]
    pub fn to_coarse<T: Copy + Default>(&self, values: &[T]) -> Vec<T> {
        let known = self.coarse.iter().flatten();
        let mut out = vec![T::default(); known.max().map_or(0, |&v| v as usize + 1)];
        for (own, &value) in self.coarse.iter().zip(values) {
            if let Some(own) = own {
                out[*own as usize] = value;
            }
        }
        out
    }

    fn split(&mut self) {
        let old = std::mem::take(&mut self.geometry);
        let (old_parents, old_coarse) = (
            std::mem::take(&mut self.parents),
            std::mem::take(&mut self.coarse),
        );
        let mut next = Geometry {
            origin: old.origin,
            min: old.min,
            max: old.max,
            warnings: old.warnings.clone(),
            ..Geometry::default()
        };
        for part in &old.parts {
            let (first_vertex, first_index) = (next.positions.len(), next.indices.len());
            // Vertices of the part come first and in order; parents stay inside their part.
            let shift = |v: u32| v - part.first_vertex as u32 + first_vertex as u32;
            for v in part.vertices() {
                copy(&old, &mut next, v);
                self.parents.push(old_parents[v].map(shift));
                self.coarse.push(old_coarse[v]);
            }
            let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
            for t in old.indices[part.index_range()].chunks_exact(3) {
                let t = [t[0], t[1], t[2]];
                let m = [0, 1, 2].map(|k| {
                    let (a, b) = (t[k], t[(k + 1) % 3]);
                    *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                        let number = next.positions.len() as u32;
                        middle(&old, &mut next, a.min(b) as usize, a.max(b) as usize);
                        self.parents.push([shift(a), shift(b)]);
                        self.coarse.push(None);
                        number
                    })
                });
                let [a, b, c] = t.map(shift);
                let [ab, bc, ca] = m;
                next.indices
                    .extend([a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca]);
            }
            next.parts.push(crate::scene::Part {
                first_vertex,
                vertex_count: next.positions.len() - first_vertex,
                first_index,
                index_count: next.indices.len() - first_index,
                ..*part
            });
        }
        self.geometry = next;
    }
}

fn copy(old: &Geometry, next: &mut Geometry, v: usize) {
    next.positions.push(old.positions[v]);
    next.normals.push(old.normals[v]);
    next.texcoords.push(old.texcoords[v]);
    next.texcoords1.push(old.texcoords1[v]);
    next.colors.push(old.colors[v]);
    next.ambient.push(old.ambient[v]);
}

fn middle(old: &Geometry, next: &mut Geometry, a: usize, b: usize) {
    let mean2 = |v: &[[f32; 2]]| [0, 1].map(|k| 0.5 * (v[a][k] + v[b][k]));
    let normal = (old.normals[a] + old.normals[b]).normalize_or(old.normals[a]);
    next.positions
        .push(0.5 * (old.positions[a] + old.positions[b]));
    next.normals.push(normal);
    next.texcoords.push(mean2(&old.texcoords));
    next.texcoords1.push(mean2(&old.texcoords1));
    next.colors
        .push([0, 1, 2, 3].map(|k| 0.5 * (old.colors[a][k] + old.colors[b][k])));
    next.ambient.push(0.5 * (old.ambient[a] + old.ambient[b]));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Part;

    fn two_parts() -> Geometry {
        let mut g = Geometry::default();
        for part in 0..2 {
            let first_vertex = g.positions.len();
            for (x, y) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
                g.positions.push(Vec3::new(x, y, part as f32));
                g.normals.push(Vec3::Z);
                g.texcoords.push([x, y]);
                g.texcoords1.push([0.0; 2]);
                g.colors.push([1.0; 4]);
                g.ambient.push(1.0);
            }
            let first_index = g.indices.len();
            let quad = [0, 1, 2, 0, 2, 3].map(|k| first_vertex as u32 + k);
            g.indices.extend(quad);
            g.parts.push(Part {
                instance: 0,
                mesh: 0,
                primitive: part,
                material: part,
                first_vertex,
                vertex_count: 4,
                first_index,
                index_count: 6,
            });
        }
        g
    }

    #[test]
    fn a_finer_mesh_is_the_same_surface() {
        let coarse = two_parts();
        let fine = Refined::new(&coarse, 2);
        let g = &fine.geometry;
        assert_eq!(g.positions.len(), 2 * 25);
        assert_eq!(g.indices.len(), 16 * coarse.indices.len());
        let area = |g: &Geometry| -> f32 {
            let triangles = g.indices.chunks_exact(3);
            triangles
                .map(|t| {
                    let [a, b, c] = [t[0], t[1], t[2]].map(|i| g.positions[i as usize]);
                    0.5 * (b - a).cross(c - a).z
                })
                .sum()
        };
        assert!((area(g) - area(&coarse)).abs() < 1e-6);
        // What is linear over the coarse triangles stays so.
        let values: Vec<[f32; 3]> = coarse.positions.iter().map(|p| p.to_array()).collect();
        for (p, v) in g.positions.iter().zip(fine.spread(&values, 1)) {
            assert!(p.distance(Vec3::from(v)) < 1e-6, "{p} {v:?}");
        }
        assert_eq!(fine.to_coarse(&g.positions), coarse.positions);
        for part in &g.parts {
            let range = part.vertices();
            let inside = |i: &u32| range.contains(&(*i as usize));
            assert!(g.indices[part.index_range()].iter().all(inside));
        }
        assert_eq!(
            Refined::new(&coarse, 0).geometry.positions,
            coarse.positions
        );
    }
}
