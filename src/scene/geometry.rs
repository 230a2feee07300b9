//! A model flattened to triangles in one frame: what foliage, leaf, ink and render work on.
//!
//! World coordinates are f64; vertices are stored as f32 relative to [`Geometry::origin`], the
//! centre of the bounding box, so that a tree at 5 000 000 m keeps its precision.

use std::collections::HashSet;
use std::hash::{BuildHasherDefault, Hasher};

use glam::{DMat3, DVec3, Vec3};

use super::model::Model;

/// Triangles of all instances, relative to one origin.
#[derive(Debug, Clone, Default)]
pub struct Geometry {
    /// World position of the frame's zero, metres.
    pub origin: DVec3,
    /// Position relative to `origin`, metres.
    pub positions: Vec<Vec3>,
    /// What rounding took from `positions`: added to them, the f64 positions come out. Work in
    /// other units than metres starts from the sum ([`Geometry::exact`]), so that a model and its
    /// copy at another scale or place are rounded alike. Empty: nothing was taken.
    pub rounded_off: Vec<Vec3>,
    /// Unit normals as the model has them; made from faces (area-weighted) where it has none or
    /// has a zero one.
    pub normals: Vec<Vec3>,
    /// `TEXCOORD_0`, zero where absent.
    pub texcoords: Vec<[f32; 2]>,
    /// `TEXCOORD_1`, zero where absent.
    pub texcoords1: Vec<[f32; 2]>,
    /// Linear RGBA vertex colours, white where absent.
    pub colors: Vec<[f32; 4]>,
    /// Ambient coefficient of an earlier bake (`_AMBIENT`), 1 where absent.
    pub ambient: Vec<f32>,
    /// Triangle list over all parts; indices are absolute.
    pub indices: Vec<u32>,
    /// Ranges of one primitive of one instance each, in order, covering everything.
    pub parts: Vec<Part>,
    /// Smallest corner relative to `origin`.
    pub min: Vec3,
    /// Largest corner relative to `origin`.
    pub max: Vec3,
    /// What was repaired, with counts (zero normals, zero-area triangles, missing normals).
    pub warnings: Vec<String>,
}

/// One primitive of one instance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    /// Index into [`Model::instances`].
    pub instance: usize,
    /// Index into [`Model::meshes`].
    pub mesh: usize,
    /// Index into the mesh's primitives.
    pub primitive: usize,
    /// Index into [`Model::materials`].
    pub material: usize,
    /// First vertex in [`Geometry::positions`].
    pub first_vertex: usize,
    /// Number of vertices.
    pub vertex_count: usize,
    /// First index in [`Geometry::indices`].
    pub first_index: usize,
    /// Number of indices.
    pub index_count: usize,
}

impl Part {
    /// Vertex range.
    #[must_use]
    pub fn vertices(&self) -> std::ops::Range<usize> {
        self.first_vertex..self.first_vertex + self.vertex_count
    }

    /// Index range.
    #[must_use]
    pub fn index_range(&self) -> std::ops::Range<usize> {
        self.first_index..self.first_index + self.index_count
    }
}

impl Geometry {
    /// Flattens every instance of `model`.
    #[must_use]
    pub fn flatten(model: &Model) -> Self {
        let mut world: Vec<DVec3> = Vec::new();
        let mut out = Self::default();
        for (instance_index, instance) in model.instances.iter().enumerate() {
            let to_world = instance.local_to_world;
            let normal_matrix = cofactors(&to_world.matrix3);
            let mirrored = to_world.matrix3.determinant() < 0.0;
            for (primitive_index, p) in model.meshes[instance.mesh].primitives.iter().enumerate() {
                let first_vertex = world.len();
                let first_index = out.indices.len();
                let n = p.positions.len();
                world.extend(
                    p.positions
                        .iter()
                        .map(|&q| to_world.transform_point3(Vec3::from(q).as_dvec3())),
                );
                if p.normals.is_empty() {
                    out.normals.resize(first_vertex + n, Vec3::ZERO);
                } else {
                    out.normals.extend(p.normals.iter().map(|&v| {
                        (normal_matrix * Vec3::from(v).as_dvec3())
                            .normalize_or_zero()
                            .as_vec3()
                    }));
                }
                extend_or(&mut out.texcoords, &p.texcoords, n, [0.0; 2]);
                extend_or(&mut out.texcoords1, &p.texcoords1, n, [0.0; 2]);
                extend_or(&mut out.colors, &p.colors, n, [1.0; 4]);
                extend_or(&mut out.ambient, &p.ambient, n, 1.0);
                let base = u32::try_from(first_vertex).expect("fewer than 2^32 vertices");
                for t in p.indices.chunks_exact(3) {
                    // A mirroring transform turns triangles inside out; turn them back.
                    let t = if mirrored {
                        [t[0], t[2], t[1]]
                    } else {
                        [t[0], t[1], t[2]]
                    };
                    out.indices.extend(t.map(|i| base + i));
                }
                out.parts.push(Part {
                    instance: instance_index,
                    mesh: instance.mesh,
                    primitive: primitive_index,
                    material: p.material,
                    first_vertex,
                    vertex_count: n,
                    first_index,
                    index_count: out.indices.len() - first_index,
                });
            }
        }
        out.place(&world);
        out.repair_normals();
        out.count_degenerate();
        out.count_untextured(model);
        out
    }

    /// Length of the bounding box's diagonal, metres.
    #[must_use]
    pub fn diagonal(&self) -> f32 {
        (self.max - self.min).length()
    }

    /// Position of a vertex relative to [`Geometry::origin`], as far as known.
    #[must_use]
    pub fn exact(&self, vertex: usize) -> DVec3 {
        let rounded_off = self.rounded_off.get(vertex).copied().unwrap_or_default();
        self.positions[vertex].as_dvec3() + rounded_off.as_dvec3()
    }

    fn place(&mut self, world: &[DVec3]) {
        let (min, max) = world
            .iter()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), &q| {
                (lo.min(q), hi.max(q))
            });
        if world.is_empty() {
            return;
        }
        self.origin = 0.5 * (min + max);
        let relative = world.iter().map(|&q| q - self.origin);
        self.positions = relative.clone().map(|q| q.as_vec3()).collect();
        self.rounded_off = relative
            .zip(&self.positions)
            .map(|(q, p)| (q - p.as_dvec3()).as_vec3())
            .collect();
        self.min = (min - self.origin).as_vec3();
        self.max = (max - self.origin).as_vec3();
    }

    /// Gives vertices without a usable normal the area-weighted mean of their faces' normals.
    fn repair_normals(&mut self) {
        let (repaired, hopeless) =
            repair_normals(&self.positions, &mut self.normals, &self.indices);
        if repaired + hopeless > 0 {
            self.warnings.push(format!(
                "{} without a usable normal: {repaired} made from their faces, {hopeless} set to +y",
                counted(repaired + hopeless, "vertex", "vertices")
            ));
        }
    }

    /// Counts parts whose material has a texture that they have no coordinates for.
    fn count_untextured(&mut self, model: &Model) {
        let lacks = |part: &&Part| {
            let primitive = &model.meshes[part.mesh].primitives[part.primitive];
            let material = model.materials.get(part.material);
            let texture = material.and_then(|m| m.base_color_texture);
            texture.is_some_and(|t| match t.texcoord {
                0 => primitive.texcoords.is_empty(),
                1 => primitive.texcoords1.is_empty(),
                _ => false,
            })
        };
        let lacking = self.parts.iter().filter(lacks).count();
        if lacking > 0 {
            self.warnings.push(format!(
                "{} without the texture coordinates that the material's texture needs: drawn with \
                 one texel",
                counted(lacking, "part", "parts")
            ));
        }
    }

    /// Counts triangles without area and vertices that repeat another one of their part.
    fn count_degenerate(&mut self) {
        let flat = self.indices.chunks_exact(3).filter(|t| {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| self.positions[i as usize].as_dvec3());
            (b - a).cross(c - a) == DVec3::ZERO
        });
        let flat = flat.count();
        if flat > 0 {
            self.warnings.push(format!(
                "{} without area",
                counted(flat, "triangle", "triangles")
            ));
        }
        let mut repeated = 0;
        let mut seen: HashSet<u64, BuildHasherDefault<Digest>> = HashSet::default();
        for part in &self.parts {
            seen.clear();
            let digests = part.vertices().map(|i| {
                let (p, n, [u, v]) = (self.positions[i], self.normals[i], self.texcoords[i]);
                let [r, g, b, a] = self.colors[i];
                digest(&[p.x, p.y, p.z, n.x, n.y, n.z, u, v, r, g, b, a])
            });
            repeated += digests.filter(|d| !seen.insert(*d)).count();
        }
        if repeated > 0 {
            self.warnings.push(match repeated {
                1 => "1 vertex repeats another one exactly".into(),
                n => format!("{n} vertices repeat another one exactly"),
            });
        }
    }
}

/// `1 part`, `2 parts`.
#[must_use]
pub fn counted(count: usize, one: &str, several: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { several })
}

/// 64 bits that tell vertices apart; for counting, so that a clash would not matter.
fn digest(values: &[f32; 12]) -> u64 {
    values.iter().fold(0x9E37_79B9_7F4A_7C15, |h: u64, v| {
        (h ^ u64::from(v.to_bits()))
            .wrapping_mul(0xBF58_476D_1CE4_E5B9)
            .rotate_left(29)
    })
}

/// Passes a digest through: it is mixed well enough to be its own hash.
#[derive(Default)]
struct Digest(u64);

impl Hasher for Digest {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&b| self.write_u64(u64::from(b)));
    }

    fn write_u64(&mut self, digest: u64) {
        self.0 = self.0.rotate_left(8) ^ digest;
    }
}

/// Replaces zero normals by the area-weighted mean of the normals of their faces, or by +y
/// where that is zero too. Returns how many of each.
pub(super) fn repair_normals(
    positions: &[Vec3],
    normals: &mut [Vec3],
    indices: &[u32],
) -> (usize, usize) {
    if normals.iter().all(|n| *n != Vec3::ZERO) {
        return (0, 0);
    }
    let mut sums = vec![DVec3::ZERO; positions.len()];
    for t in indices.chunks_exact(3) {
        let [a, b, c] = [t[0], t[1], t[2]].map(|i| positions[i as usize].as_dvec3());
        let n = (b - a).cross(c - a);
        for &i in t {
            sums[i as usize] += n;
        }
    }
    let (mut repaired, mut hopeless) = (0, 0);
    for (normal, sum) in normals.iter_mut().zip(sums) {
        if *normal != Vec3::ZERO {
            continue;
        }
        *normal = sum.normalize_or_zero().as_vec3();
        if *normal == Vec3::ZERO {
            *normal = Vec3::Y;
            hopeless += 1;
        } else {
            repaired += 1;
        }
    }
    (repaired, hopeless)
}

/// The inverse transpose up to a positive factor, defined for flat (singular) frames too.
pub(super) fn cofactors(m: &DMat3) -> DMat3 {
    let scale = m.x_axis.abs().max(m.y_axis.abs()).max(m.z_axis.abs());
    // Scaled first, so that products of lengths near 1e-3 or 1e6 metres keep their digits.
    let factor = scale.max_element();
    let m = if factor > 0.0 {
        *m * factor.recip()
    } else {
        *m
    };
    let sign = if m.determinant() < 0.0 { -1.0 } else { 1.0 };
    DMat3::from_cols(
        sign * m.y_axis.cross(m.z_axis),
        sign * m.z_axis.cross(m.x_axis),
        sign * m.x_axis.cross(m.y_axis),
    )
}

fn extend_or<T: Copy>(out: &mut Vec<T>, data: &[T], n: usize, default: T) {
    if data.is_empty() {
        out.resize(out.len() + n, default);
    } else {
        out.extend_from_slice(data);
    }
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;

    use super::*;
    use crate::scene::model::{Instance, Material, Mesh, Primitive};

    fn model(to_world: DAffine3, normals: Vec<[f32; 3]>) -> Model {
        let primitive = Primitive {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 3]],
            normals,
            indices: vec![0, 1, 2, 0, 3, 1],
            ..Primitive::default()
        };
        Model {
            meshes: vec![Mesh {
                name: "m".into(),
                primitives: vec![primitive],
            }],
            instances: vec![Instance {
                name: "i".into(),
                mesh: 0,
                local_to_world: to_world,
                source: None,
            }],
            materials: vec![Material::default()],
            ..Model::default()
        }
    }

    #[test]
    fn repairs_are_made_and_counted() {
        let mut normals = vec![[0.0, 0.0, 1.0]; 4];
        normals[1] = [0.0; 3];
        let g = Geometry::flatten(&model(DAffine3::IDENTITY, normals));
        assert!(g.normals.iter().all(|n| *n == Vec3::Z));
        let told = g.warnings.join("; ");
        for part in [
            "1 made from their faces",
            "1 triangle without area",
            "1 vertex repeats",
        ] {
            assert!(told.contains(part), "{told}");
        }
        let far = DAffine3::from_translation(DVec3::new(5e6, 0.0, 5e6));
        let g = Geometry::flatten(&model(far, vec![]));
        assert_eq!(
            (g.positions[1] - g.positions[0], g.normals[0]),
            (Vec3::X, Vec3::Z)
        );
    }

    #[test]
    fn normals_follow_stretched_flat_mirrored_and_extreme_frames() {
        let tilted = Vec3::new(1.0, 0.0, 1.0).normalize();
        for (scale, wanted) in [
            (DVec3::new(1.0, 1.0, 2.0), DVec3::new(1.0, 0.0, 0.5)),
            (DVec3::new(1.0, 1.0, 0.0), DVec3::Z),
            (DVec3::new(-1.0, 1.0, 1.0), DVec3::new(-1.0, 0.0, 1.0)),
            (DVec3::splat(1e-30), DVec3::new(1.0, 0.0, 1.0)),
            (DVec3::splat(1e12), DVec3::new(1.0, 0.0, 1.0)),
        ] {
            let g = Geometry::flatten(&model(DAffine3::from_scale(scale), vec![tilted.into(); 4]));
            let error = g.normals[0].as_dvec3().distance(wanted.normalize());
            assert!(error < 1e-6, "{scale}: {}", g.normals[0]);
        }
    }
}
