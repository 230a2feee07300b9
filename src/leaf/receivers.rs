//! Where light is gathered, and what the surfaces there make of it.

use glam::{DVec3, Vec3};

use super::optics::Optics;
use super::rays::Occluders;
use crate::abi::{LeafSides, LeafTurn, Receiver};
use crate::scene::Geometry;

/// A receiver lies this share of the way from its vertex to the centre of one of its faces, so
/// that it is on no edge.
const INWARD: f32 = 0.03;

/// Receivers and faces of a model, in the forms of the kernels.
#[derive(Debug, Clone)]
pub struct Receivers {
    /// One for every vertex.
    pub points: Vec<Receiver>,
    /// Unit normal and material (bits) of every triangle.
    pub faces: Vec<[f32; 4]>,
    /// What every material makes of light.
    pub materials: Vec<LeafSides>,
    /// The same for transfer, where the glossy reflection counts as a diffuse one: bands 0 to 4
    /// would blur it anyway, and without it the light of the sky would lack its share.
    pub transfer: Vec<LeafSides>,
    /// Factors of oblique light (see [`super::directional`]); none: light from everywhere meets
    /// what straight light does.
    pub turns: Vec<LeafTurn>,
}

impl Receivers {
    /// The vertices of `geometry` with `optics`, one for each material of the model. `occluders`
    /// are of the same geometry or of a coarser mesh of it.
    #[must_use]
    pub fn new(geometry: &Geometry, occluders: &Occluders, optics: &[Optics]) -> Self {
        let scaled = geometry.positions.iter().map(|&p| occluders.scale * p);
        let positions: Vec<Vec3> = scaled.collect();
        let mut faces = Vec::with_capacity(geometry.indices.len() / 3);
        // The largest face of each vertex; none for vertices that no triangle uses.
        let mut face_of = vec![(0.0_f64, u32::MAX); positions.len()];
        let mut material_of = vec![0u32; positions.len()];
        for part in &geometry.parts {
            for vertex in part.vertices() {
                material_of[vertex] = part.material as u32;
            }
            for t in geometry.indices[part.index_range()].chunks_exact(3) {
                let [a, b, c] = [t[0], t[1], t[2]].map(|i| positions[i as usize].as_dvec3());
                let area = (b - a).cross(c - a);
                let number = faces.len() as u32;
                for &i in t {
                    let known = &mut face_of[i as usize];
                    // Of faces that are alike but for rounding, the first.
                    if area.length() > known.0 * (1.0 + 1e-5) {
                        *known = (area.length(), number);
                    }
                }
                let [x, y, z] = area.normalize_or(DVec3::Y).as_vec3().to_array();
                faces.push([x, y, z, f32::from_bits(part.material as u32)]);
            }
        }
        let point = |vertex: usize| {
            let (_, face) = face_of[vertex];
            let normal = geometry.normals[vertex];
            let p = positions[vertex];
            let (position, facing) = match faces.get(face as usize) {
                Some(n) => {
                    let at = 3 * face as usize;
                    let corners = &geometry.indices[at..at + 3];
                    let centre = corners.iter().map(|&i| positions[i as usize]).sum::<Vec3>() / 3.0;
                    let facing = Vec3::new(n[0], n[1], n[2]);
                    (p + INWARD * (centre - p), facing)
                }
                None => (p, normal),
            };
            // Normals that point behind their face (realigned, or of the other winding) follow it.
            let normal = if normal.dot(facing) < 0.0 {
                -normal
            } else {
                normal
            };
            Receiver {
                position: position.to_array(),
                material: material_of[vertex],
                normal: normal.to_array(),
                facing: facing.to_array(),
            }
        };
        Self {
            points: (0..positions.len()).map(point).collect(),
            faces,
            materials: optics.iter().map(Optics::sides).collect(),
            transfer: optics.iter().map(Optics::transfer_sides).collect(),
            turns: Vec::new(),
        }
    }

    /// Of every material, what transfer takes of its gloss for diffuse reflection.
    #[must_use]
    pub fn gloss_as_diffuse(&self) -> Vec<LeafSides> {
        let more = |a: [f32; 3], b: [f32; 3]| [0, 1, 2].map(|c| (a[c] - b[c]).max(0.0));
        let both = self.materials.iter().zip(&self.transfer);
        both.map(|(plain, with)| LeafSides {
            rho_d_front: more(with.rho_d_front, plain.rho_d_front),
            rho_d_back: more(with.rho_d_back, plain.rho_d_back),
            rho_t: [0.0; 3],
        })
        .collect()
    }
}
