//! Which parts of a model are foliage and which are only covered by it, and the foliage's leaves.

use std::collections::HashMap;

use glam::{DVec3, Vec3};
use regex::{Regex, RegexBuilder};

use super::settings::Primitive;
use crate::math::hashing::WordHash;
use crate::scene::{AlphaMode, Geometry, Model, Part};
use crate::{Error, Result};

/// Names that mean foliage.
const NAMES: &str = "leaf|leaves|foliage|needle|frond";

/// The foliage / covered split of a geometry: normals of foliage are realigned and its leaves
/// make generators; covered parts (trunk, branches, neighbours) get an ambient coefficient only.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Split {
    /// Per part of the geometry: whether it is foliage.
    pub foliage_parts: Vec<bool>,
    /// Vertices of foliage parts, ascending.
    pub foliage_vertices: Vec<u32>,
    /// All other vertices, ascending.
    pub covered_vertices: Vec<u32>,
    /// Triangles of foliage parts as absolute vertex indices.
    pub foliage_indices: Vec<u32>,
}

impl Split {
    /// Splits `geometry`. A part is foliage when its material's, node's or mesh's name contains
    /// leaf, leaves, foliage, needle or frond, or its material is alpha-tested or blended and
    /// double-sided; `pattern` (a regular expression, case-insensitive) replaces that rule and is
    /// matched against the names.
    ///
    /// # Errors
    /// A pattern that is no regular expression; a model without foliage (its materials are
    /// listed).
    pub fn new(model: &Model, geometry: &Geometry, pattern: Option<&str>) -> Result<Self> {
        let split = Self::with_or_without(model, geometry, pattern)?;
        if split.foliage_indices.len() < 3 {
            return Err(no_foliage(model, pattern));
        }
        Ok(split)
    }

    /// The same for what works without foliage, too.
    ///
    /// # Errors
    /// A pattern that is no regular expression.
    pub fn with_or_without(
        model: &Model,
        geometry: &Geometry,
        pattern: Option<&str>,
    ) -> Result<Self> {
        let names = RegexBuilder::new(pattern.unwrap_or(NAMES))
            .case_insensitive(true)
            .build()
            .map_err(|e| Error::usage(format!("--foliage: {e}")))?;
        let foliage_parts: Vec<bool> = geometry
            .parts
            .iter()
            .map(|part| is_foliage(model, part, &names, pattern.is_none()))
            .collect();
        let mut split = Self {
            foliage_parts,
            foliage_vertices: Vec::new(),
            covered_vertices: Vec::new(),
            foliage_indices: Vec::new(),
        };
        for (part, &foliage) in geometry.parts.iter().zip(&split.foliage_parts) {
            let vertices = part.vertices().map(|v| v as u32);
            if foliage {
                split.foliage_vertices.extend(vertices);
                split
                    .foliage_indices
                    .extend_from_slice(&geometry.indices[part.index_range()]);
            } else {
                split.covered_vertices.extend(vertices);
            }
        }
        Ok(split)
    }

    /// Smallest and largest corner of the foliage, relative to the geometry's origin.
    #[must_use]
    pub fn bounds(&self, geometry: &Geometry) -> (DVec3, DVec3) {
        self.foliage_vertices.iter().fold(
            (DVec3::INFINITY, DVec3::NEG_INFINITY),
            |(low, high), &v| {
                let p = geometry.exact(v as usize);
                (low.min(p), high.max(p))
            },
        )
    }
}

fn is_foliage(model: &Model, part: &Part, names: &Regex, by_material: bool) -> bool {
    let material = &model.materials[part.material];
    let named = [
        &material.name,
        &model.instances[part.instance].name,
        &model.meshes[part.mesh].name,
    ];
    if named.iter().any(|name| names.is_match(name)) {
        return true;
    }
    by_material && material.double_sided && material.alpha_mode != AlphaMode::Opaque
}

fn no_foliage(model: &Model, pattern: Option<&str>) -> Error {
    let materials: Vec<String> = model
        .materials
        .iter()
        .map(|m| format!("{:?}", m.name))
        .collect();
    let rule = pattern.map_or_else(
        || format!("no material or node is named like {NAMES} or is alpha-tested and double-sided"),
        |p| format!("nothing with triangles matches --foliage {p:?}"),
    );
    let reason = format!(
        "no foliage: {rule}; the materials are {}; choose with --foliage REGEX",
        materials.join(", ")
    );
    match &model.path {
        Some(path) => Error::file(path, reason),
        None => Error::usage(format!("{}: {reason}", model.name)),
    }
}

/// Triangles grouped by the generator that they make.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Leaves {
    /// First entry in `triangles` per leaf, closed by the total.
    pub first: Vec<u32>,
    /// Triangle numbers (in [`Split::foliage_indices`]), ascending within a leaf.
    pub triangles: Vec<u32>,
}

/// Below so many leaves `auto` takes their triangles: as many points make no field, and leaves that
/// are so few are clusters or fronds, large against the radius (docs/foliage-choices.md).
const FEW_LEAVES: usize = 256;

/// Triangles that these leaves must have in the mean: a few plain cards stay leaves.
const LARGE_LEAF: usize = 4;

impl Leaves {
    /// Groups triangles: each alone, or connected by equal positions. Leaves are numbered by their
    /// first triangle. `Auto` takes the triangles where leaves are fewer than 256 and have four
    /// triangles or more in the mean.
    #[must_use]
    pub fn new(positions: &[Vec3], indices: &[u32], primitive: Primitive) -> Self {
        let count = indices.len() / 3;
        match primitive {
            Primitive::Triangle => Self {
                first: (0..=count as u32).collect(),
                triangles: (0..count as u32).collect(),
            },
            Primitive::Leaf => Self::from_labels(&leaf_labels(positions, indices)),
            Primitive::Auto => {
                let leaves = Self::new(positions, indices, Primitive::Leaf);
                if leaves.len() < FEW_LEAVES && count >= LARGE_LEAF * leaves.len() {
                    Self::new(positions, indices, Primitive::Triangle)
                } else {
                    leaves
                }
            }
        }
    }

    /// Number of leaves.
    #[must_use]
    pub fn len(&self) -> usize {
        self.first.len().saturating_sub(1)
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn from_labels(labels: &[u32]) -> Self {
        let count = labels.iter().max().map_or(0, |&m| m as usize + 1);
        let mut first = vec![0u32; count + 1];
        for &l in labels {
            first[l as usize + 1] += 1;
        }
        for i in 0..count {
            first[i + 1] += first[i];
        }
        let mut next = first.clone();
        let mut triangles = vec![0; labels.len()];
        for (t, &l) in labels.iter().enumerate() {
            triangles[next[l as usize] as usize] = t as u32;
            next[l as usize] += 1;
        }
        Self { first, triangles }
    }
}

/// Component number per triangle (union-find over equal positions).
fn leaf_labels(positions: &[Vec3], indices: &[u32]) -> Vec<u32> {
    let mut parent: Vec<u32> = (0..(indices.len() / 3) as u32).collect();
    // Joining by index first leaves one position look-up per vertex instead of one per corner.
    let mut first_triangle = vec![u32::MAX; positions.len()];
    let mut owner: HashMap<[u32; 3], u32, WordHash> = HashMap::default();
    for (triangle, corners) in indices.chunks_exact(3).enumerate() {
        let triangle = triangle as u32;
        for &corner in corners {
            let corner = corner as usize;
            let other = if first_triangle[corner] == u32::MAX {
                first_triangle[corner] = triangle;
                // Adding zero turns -0 into +0, so that both have the same bits.
                let key = positions[corner].to_array().map(|c| (c + 0.0).to_bits());
                *owner.entry(key).or_insert(triangle)
            } else {
                first_triangle[corner]
            };
            let (a, b) = (root(&mut parent, triangle), root(&mut parent, other));
            parent[a.max(b) as usize] = a.min(b);
        }
    }
    let mut number = vec![u32::MAX; parent.len()];
    let mut next = 0;
    (0..parent.len() as u32)
        .map(|triangle| {
            let root = root(&mut parent, triangle) as usize;
            if number[root] == u32::MAX {
                number[root] = next;
                next += 1;
            }
            number[root]
        })
        .collect()
}

fn root(parent: &mut [u32], mut i: u32) -> u32 {
    while parent[i as usize] != i {
        parent[i as usize] = parent[parent[i as usize] as usize];
        i = parent[i as usize];
    }
    i
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Instance, Material, Mesh};

    fn quad(x: f32) -> crate::scene::Primitive {
        crate::scene::Primitive {
            positions: vec![
                [x, 0.0, 0.0],
                [x + 1.0, 0.0, 0.0],
                [x + 1.0, 1.0, 0.0],
                [x, 1.0, 0.0],
            ],
            indices: vec![0, 1, 2, 0, 2, 3],
            ..Default::default()
        }
    }

    fn model(names: &[&str]) -> Model {
        let mut model = Model {
            name: "test".into(),
            ..Default::default()
        };
        for (i, name) in names.iter().enumerate() {
            model.materials.push(Material {
                name: (*name).into(),
                ..Default::default()
            });
            let mut primitive = quad(3.0 * i as f32);
            primitive.material = i;
            model.meshes.push(Mesh {
                name: format!("mesh {i}"),
                primitives: vec![primitive],
            });
            model.instances.push(Instance {
                name: format!("node {i}"),
                mesh: i,
                local_to_world: glam::DAffine3::IDENTITY,
                source: None,
            });
        }
        model
    }

    #[test]
    fn names_decide_and_a_pattern_overrides() {
        let model = model(&["bark", "Oak_LEAVES", "cone"]);
        let geometry = Geometry::flatten(&model);
        let split = Split::new(&model, &geometry, None).unwrap();
        assert_eq!(split.foliage_parts, [false, true, false], "by name");
        assert_eq!(split.foliage_vertices, [4, 5, 6, 7], "vertices");
        assert_eq!(split.covered_vertices.len(), 8, "the rest is covered");
        let split = Split::new(&model, &geometry, Some("^CONE$")).unwrap();
        assert_eq!(split.foliage_parts, [false, false, true], "by pattern");
    }

    #[test]
    fn masked_double_sided_materials_are_foliage() {
        let mut model = model(&["a", "b"]);
        model.materials[1].alpha_mode = AlphaMode::Mask { cutoff: 0.5 };
        model.materials[1].double_sided = true;
        let geometry = Geometry::flatten(&model);
        let split = Split::new(&model, &geometry, None).unwrap();
        assert_eq!(split.foliage_parts, [false, true], "by material");
    }

    #[test]
    fn no_foliage_lists_the_materials() {
        let model = model(&["bark", "stone"]);
        let geometry = Geometry::flatten(&model);
        for pattern in [None, Some("fern")] {
            let message = Split::new(&model, &geometry, pattern)
                .unwrap_err()
                .to_string();
            assert!(
                message.contains("bark") && message.contains("stone"),
                "{message}"
            );
            assert!(message.contains("--foliage"), "{message}");
        }
        assert!(Split::new(&model, &geometry, Some("(")).is_err(), "regex");
    }

    #[test]
    fn leaves_are_joined_by_position_not_by_index() {
        let p = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        // Two triangles that share two positions through different indices, and one apart.
        let positions = [
            p(0.0, 0.0),
            p(1.0, 0.0),
            p(0.0, 1.0),
            p(5.0, 0.0),
            p(6.0, 0.0),
            p(5.0, 1.0),
            p(1.0, -0.0),
            p(1.0, 1.0),
            p(0.0, 1.0),
        ];
        let indices = [0, 1, 2, 3, 4, 5, 6, 7, 8];
        let leaves = Leaves::new(&positions, &indices, Primitive::Leaf);
        assert_eq!(leaves.first, [0, 2, 3], "two leaves");
        assert_eq!(leaves.triangles, [0, 2, 1], "numbered by first triangle");
        let triangles = Leaves::new(&positions, &indices, Primitive::Triangle);
        assert_eq!(triangles.len(), 3, "each alone");
    }

    #[test]
    fn few_large_leaves_are_taken_by_triangles() {
        // Fans of `triangles` each, which share their first corner and nothing between fans.
        let fans = |count: u32, triangles: u32| {
            let (mut positions, mut indices) = (Vec::new(), Vec::new());
            for leaf in 0..count {
                let first = positions.len() as u32;
                positions.extend(
                    (0..triangles + 2).map(|i| Vec3::new(leaf as f32, i as f32, (i * i) as f32)),
                );
                indices.extend((0..triangles).flat_map(|i| [first, first + i + 1, first + i + 2]));
            }
            Leaves::new(&positions, &indices, Primitive::Auto).len()
        };
        assert_eq!(fans(29, 8), 29 * 8, "few clusters");
        assert_eq!(fans(29, 2), 29, "few cards");
        assert_eq!(fans(300, 8), 300, "enough leaves");
        assert_eq!(fans(0, 1), 0, "no leaves");
    }
}
