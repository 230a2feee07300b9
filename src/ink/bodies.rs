//! Smooth bodies: surfaces without leaves in clusters of their vertices (Coconu, Deussen, Hege
//! 2006, section 7, equations 9 and 10).
//!
//! Hatch coordinates belong to one cluster. So that a triangle's three corners have those of the
//! same one, it takes the cluster of most of its corners, and corners in others are doubled.

use std::collections::HashMap;
use std::ops::Range;

use glam::Vec3;

use super::clusters::{Choice, Cluster, Clusters};
use crate::Result;
use crate::math::hashing::WordHash;
use crate::scene::Geometry;

/// Bodies as they are drawn.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Bodies {
    /// Vertices of the geometry, some of them several times.
    pub vertices: Vec<u32>,
    /// Cluster of each, from [`Bodies::clusters`].
    pub of_vertex: Vec<u32>,
    /// Triangles over `vertices`.
    pub indices: Vec<u32>,
    /// Material, instance and range of `indices` of each part.
    pub parts: Vec<(usize, usize, Range<u32>)>,
    /// Clusters of places on the surface.
    pub clusters: Vec<Cluster>,
}

/// The cluster of a triangle: that of most corners; where all differ, the lowest.
#[must_use]
pub fn majority([a, b, c]: [u32; 3]) -> u32 {
    if a == b || a == c {
        a
    } else if b == c {
        b
    } else {
        a.min(b).min(c)
    }
}

/// Clusters smaller than this share of the largest radius give their places to their neighbours.
const SMALL: f32 = 0.25;
/// Farthest neighbour, largest radii from its centre.
const NEIGHBOUR: f32 = 1.5;

/// Gives up what greedy gathering leaves between clusters: few places, sometimes one, without an
/// extent that strokes could lie on. A small cluster without a neighbour stays, and is taken for
/// larger than it is.
fn absorbed(mut gathered: Clusters, places: &[Vec3], largest: f32) -> Clusters {
    let least = SMALL * largest;
    let found = std::mem::take(&mut gathered.clusters);
    let large: Vec<u32> = (0..)
        .zip(&found)
        .filter(|c| c.1.radius >= least)
        .map(|c| c.0)
        .collect();
    let mut radii: Vec<f32> = found.iter().map(|c| c.radius.max(least)).collect();
    for (own, &at) in gathered.of_leaf.iter_mut().zip(places) {
        if found[*own as usize].radius >= least {
            continue;
        }
        let away = |&c: &u32| found[c as usize].centre.distance(at);
        let nearest = large
            .iter()
            .copied()
            .min_by(|a, b| away(a).total_cmp(&away(b)));
        if let Some(c) = nearest.filter(|c| away(c) <= NEIGHBOUR * largest) {
            // The sphere holds its places still.
            radii[c as usize] = radii[c as usize].max(away(&c));
            *own = c;
        }
    }
    let mut number = vec![None; found.len()];
    for own in &mut gathered.of_leaf {
        let old = *own as usize;
        *own = *number[old].get_or_insert_with(|| {
            gathered.clusters.push(Cluster {
                radius: radii[old],
                ..found[old]
            });
            gathered.clusters.len() as u32 - 1
        });
    }
    gathered
}

impl Bodies {
    /// Gathers the surface of `parts` (material, instance, range of the geometry's indices) into
    /// clusters of at most `radius` metres.
    ///
    /// # Errors
    /// A radius that is no positive number, a vertex that is no place.
    pub fn new(
        geometry: &Geometry,
        parts: &[(usize, usize, Range<u32>)],
        radius: f32,
    ) -> Result<Self> {
        let corners = |range: &Range<u32>| {
            geometry.indices[range.start as usize..range.end as usize].chunks_exact(3)
        };
        // Vertices at one place are in one cluster, whatever seams of normals and textures say.
        let mut places: Vec<Vec3> = Vec::new();
        let mut known: HashMap<[u32; 3], u32, WordHash> = HashMap::default();
        let mut place_of: HashMap<u32, u32, WordHash> = HashMap::default();
        for &v in parts.iter().flat_map(|p| corners(&p.2)).flatten() {
            place_of.entry(v).or_insert_with(|| {
                let at = geometry.positions[v as usize];
                // 0 and -0 are one place.
                let key = (at + Vec3::ZERO).to_array().map(f32::to_bits);
                *known.entry(key).or_insert_with(|| {
                    places.push(at);
                    places.len() as u32 - 1
                })
            });
        }
        let gathered = absorbed(
            Clusters::new(&places, radius, Choice::Smallest)?,
            &places,
            radius,
        );
        let mut out = Self {
            clusters: gathered.clusters,
            ..Self::default()
        };
        let mut made: HashMap<(u32, u32), u32> = HashMap::new();
        for (material, instance, range) in parts {
            let first = out.indices.len() as u32;
            for triangle in corners(range) {
                let own = [0, 1, 2].map(|k| gathered.of_leaf[place_of[&triangle[k]] as usize]);
                let cluster = majority(own);
                for &v in triangle {
                    let number = *made.entry((v, cluster)).or_insert_with(|| {
                        out.vertices.push(v);
                        out.of_vertex.push(cluster);
                        out.vertices.len() as u32 - 1
                    });
                    out.indices.push(number);
                }
            }
            let end = out.indices.len() as u32;
            out.parts.push((*material, *instance, first..end));
        }
        Ok(out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::grow::rabbit;

    #[test]
    fn triangles_take_the_cluster_of_most_corners() {
        assert_eq!(majority([3, 1, 3]), 3);
        assert_eq!(majority([2, 5, 5]), 5);
        assert_eq!(majority([4, 4, 0]), 4);
        assert_eq!(majority([7, 2, 4]), 2, "all differ: the lowest");
    }

    #[test]
    fn every_triangle_has_one_cluster_and_the_surface_stays_what_it_was() {
        let geometry = Geometry::flatten(&rabbit());
        let all = 0..geometry.indices.len() as u32;
        let radius = 0.1 * geometry.diagonal();
        let bodies = Bodies::new(&geometry, &[(0, 0, all)], radius).unwrap();
        assert!(
            bodies.clusters.len() > 10,
            "{} clusters",
            bodies.clusters.len()
        );
        assert_eq!(bodies.indices.len(), geometry.indices.len());
        for (number, cluster) in (0..).zip(&bodies.clusters) {
            assert!(cluster.radius >= SMALL * radius, "{cluster:?}");
            let members = bodies.vertices.iter().zip(&bodies.of_vertex);
            assert!(
                members.filter(|m| *m.1 == number).count() > 2,
                "{number} is a patch"
            );
        }
        for (new, old) in bodies.indices.iter().zip(&geometry.indices) {
            assert_eq!(bodies.vertices[*new as usize], *old, "the same corner");
        }
        for t in bodies.indices.chunks_exact(3) {
            let c = [0, 1, 2].map(|k| bodies.of_vertex[t[k] as usize]);
            assert!(c[0] == c[1] && c[1] == c[2], "{c:?}");
        }
        let doubled = bodies.vertices.len() - geometry.positions.len();
        assert!(
            doubled > 0 && doubled < geometry.positions.len() / 2,
            "{doubled} doubled"
        );
        // Without doubling, corners of neighbours' clusters would be in a triangle.
        let one = Bodies::new(&geometry, &[(0, 0, 0..3)], 1.0).unwrap();
        assert_eq!((one.clusters.len(), one.vertices.len()), (1, 3));
    }
}
