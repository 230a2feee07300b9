//! Precomputed light of a model: transfer vectors and visibility maps, as plain data.

use glam::DVec3;
use rayon::prelude::*;

use super::directions::Directions;
use super::environment::Coefficients;
use super::matrix::StoredMatrices;
use super::prt::{Transfer, side_floats};
use super::runs;
use crate::abi::LeafSides;
use crate::math::packing::{f16_to_f32, f32_to_f16};
use crate::scene::Geometry;
use crate::{Error, Result};

/// Hash of what a light was computed for.
pub type ModelKey = [u8; 32];

/// How transfer vectors are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Storage {
    /// 48 bytes a vertex and coefficient: 1200 a vertex of order 5.
    F32,
    /// 24 bytes a vertex and coefficient: 600 a vertex of order 5.
    F16,
    /// 12 bytes a vertex and coefficient: signed bytes, a scale for each coefficient and channel.
    Byte,
}

impl Storage {
    /// All, with their names in files and on the command line.
    pub const NAMES: [(Self, &'static str); 3] =
        [(Self::F32, "f32"), (Self::F16, "f16"), (Self::Byte, "8bit")];

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        let known = Self::NAMES.iter().find(|n| n.0 == self);
        known.map_or("", |n| n.1)
    }

    /// Bytes of a number.
    #[must_use]
    pub fn bytes(self) -> u64 {
        match self {
            Self::F32 => 4,
            Self::F16 => 2,
            Self::Byte => 1,
        }
    }

    /// The storage of that name.
    ///
    /// # Errors
    /// There is none.
    pub fn parse(name: &str) -> Result<Self> {
        let known = Self::NAMES.iter().find(|n| n.1 == name);
        known
            .map(|n| n.0)
            .ok_or_else(|| Error::usage(format!("--storage {name}: expected f32, f16 or 8bit")))
    }
}

/// Transfer vectors as they are stored.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredTransfer {
    /// Form.
    pub storage: Storage,
    /// Bands.
    pub order: u32,
    /// Values in the order of [`Transfer`], little-endian.
    pub bytes: Vec<u8>,
    /// Scale of each float of a side; bytes only.
    pub scales: Vec<f32>,
    /// Paths of each side, for the record.
    pub paths: u32,
    /// Distance of the vertices that have vectors, metres (see [`super::lod`]); 0: all have.
    pub edge: f32,
}

impl StoredTransfer {
    /// Stores `transfer`, that of a level of detail of `edge` metres or of all vertices.
    #[must_use]
    pub fn new(transfer: &Transfer, storage: Storage, paths: u32, edge: f32) -> Self {
        let floats = side_floats(transfer.order);
        let (bytes, scales) = store(&transfer.values, floats, storage);
        Self {
            storage,
            order: transfer.order,
            bytes,
            scales,
            paths,
            edge,
        }
    }

    /// Vertices that have vectors.
    #[must_use]
    pub fn receivers(&self) -> usize {
        self.bytes.len() / (2 * side_floats(self.order) * self.storage.bytes() as usize)
    }

    /// The vectors again.
    #[must_use]
    pub fn transfer(&self) -> Transfer {
        self.part(0..self.receivers())
    }

    /// The vectors of some of the vertices that have them.
    #[must_use]
    pub fn part(&self, receivers: std::ops::Range<usize>) -> Transfer {
        let floats = side_floats(self.order);
        let width = 2 * floats * self.storage.bytes() as usize;
        let bytes = &self.bytes[width * receivers.start..width * receivers.end];
        Transfer {
            order: self.order,
            values: load(bytes, &self.scales, self.storage),
        }
    }
}

/// Values in the form of `storage`, and of bytes the scale of each of `period` values.
pub(super) fn store(values: &[f32], period: usize, storage: Storage) -> (Vec<u8>, Vec<f32>) {
    let mut scales = Vec::new();
    let bytes = match storage {
        Storage::F32 => bytemuck::cast_slice(values).to_vec(),
        Storage::F16 => values
            .iter()
            .flat_map(|&v| f32_to_f16(v).to_le_bytes())
            .collect(),
        Storage::Byte => {
            scales = vec![0.0_f32; period];
            for group in values.chunks_exact(period) {
                for (scale, v) in scales.iter_mut().zip(group) {
                    *scale = scale.max(v.abs() / 127.0);
                }
            }
            let packed = |(i, v): (usize, &f32)| {
                let scale = scales[i % period];
                let steps = if scale > 0.0 { v / scale } else { 0.0 };
                (steps.round() as i8).to_le_bytes()[0]
            };
            values.iter().enumerate().map(packed).collect()
        }
    };
    (bytes, scales)
}

/// The values again.
pub(super) fn load(bytes: &[u8], scales: &[f32], storage: Storage) -> Vec<f32> {
    match storage {
        Storage::F32 => bytemuck::pod_collect_to_vec(bytes),
        Storage::F16 => bytes
            .par_chunks_exact(2)
            .map(|b| f16_to_f32(u16::from_le_bytes([b[0], b[1]])))
            .collect(),
        Storage::Byte => bytes
            .iter()
            .enumerate()
            .map(|(i, &b)| scales[i % scales.len()] * f32::from(i8::from_le_bytes([b])))
            .collect(),
    }
}

/// Visibility of the sun's disc from every vertex, for a set of directions.
#[derive(Debug, Clone, PartialEq)]
pub struct VisibilityMaps {
    /// The directions.
    pub directions: Directions,
    /// Times that triangles are split for the maps (see [`super::refine`]).
    pub splits: u32,
    /// Bytes of a map: vertices of the finer mesh.
    pub vertices: u32,
    /// Angular radius of the disc, degrees.
    pub radius_degrees: f64,
    /// Samples of the disc, for the record.
    pub samples: u32,
    /// One map each, as runs.
    pub maps: Vec<Vec<u8>>,
}

impl VisibilityMaps {
    /// Visibility of a sun at `towards` from each vertex of the finer mesh, in \[0,1\]: one map,
    /// or the mean of those about it where `blend` is set.
    #[must_use]
    pub fn towards(&self, towards: DVec3, blend: bool) -> Vec<f32> {
        let vertices = self.vertices as usize;
        let mut out = vec![0.0; vertices];
        for tap in self.directions.taps(towards, blend) {
            let Some(map) = runs::decode(&self.maps[tap.map], vertices) else {
                continue;
            };
            for (sum, byte) in out.iter_mut().zip(map) {
                *sum += tap.weight as f32 * f32::from(byte) / 255.0;
            }
        }
        out
    }

    /// Bytes of all maps.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.maps.iter().map(|m| m.len() as u64).sum()
    }
}

/// Everything that `umbrage light` computes.
#[derive(Debug, Clone, PartialEq)]
pub struct Light {
    /// For which triangles.
    pub model: ModelKey,
    /// For which optics: transfer vectors hold for these alone, maps for any.
    pub optics: ModelKey,
    /// Vertices.
    pub vertices: u32,
    /// Sky and indirect light: levels of detail, finest first.
    pub transfer: Vec<StoredTransfer>,
    /// The same for any view.
    pub matrices: Option<StoredMatrices>,
    /// The sun.
    pub visibility: Option<VisibilityMaps>,
}

/// Hash of the triangles of `geometry`.
#[must_use]
pub fn model_key(geometry: &Geometry) -> ModelKey {
    let mut hash = blake3::Hasher::new();
    hash.update(bytemuck::cast_slice(&geometry.positions));
    hash.update(bytemuck::cast_slice(&geometry.indices));
    *hash.finalize().as_bytes()
}

/// Hash of what materials make of light.
#[must_use]
pub fn optics_key(materials: &[LeafSides]) -> ModelKey {
    *blake3::hash(bytemuck::cast_slice(materials)).as_bytes()
}

/// Which part of the transfer is lit: the sky takes both, the sun the indirect one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lighting<'a> {
    /// Coefficients of the sky: direct and indirect.
    pub sky: &'a Coefficients,
    /// Coefficients of the sun.
    pub sun: &'a Coefficients,
    /// Whether the sun's direct light comes from the transfer too (PRT alone).
    pub direct_sun: bool,
    /// Bands that are used at most, 1 to 6.
    pub order: usize,
}

/// Light that leaves each side of each vertex: front and back of the first, and so on. Sums below
/// 0 (ringing) are 0.
#[must_use]
pub fn exit_radiance(transfer: &Transfer, lighting: &Lighting<'_>) -> Vec<[f32; 3]> {
    let order = lighting.order.min(transfer.order as usize);
    let n = order * order;
    let weights = |part: usize, k: usize| {
        let sun = if part == 1 || lighting.direct_sun {
            lighting.sun[k]
        } else {
            DVec3::ZERO
        };
        (lighting.sky[k] + sun).as_vec3()
    };
    let l: Vec<[glam::Vec3; 2]> = (0..n).map(|k| [weights(0, k), weights(1, k)]).collect();
    let floats = side_floats(transfer.order) / 2;
    transfer
        .values
        .par_chunks_exact(2 * floats)
        .map(|side| {
            let mut sum = glam::Vec3::ZERO;
            for (k, l) in l.iter().enumerate() {
                let at = |part: usize| glam::Vec3::from_slice(&side[part * floats + 3 * k..]);
                sum += at(0) * l[0] + at(1) * l[1];
            }
            sum.max(glam::Vec3::ZERO).to_array()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn storage_keeps_what_it_promises() {
        let values: Vec<f32> = (0..6 * side_floats(4))
            .map(|i| ((i * 37 % 101) as f32 - 50.0) * 0.01)
            .collect();
        let transfer = Transfer { order: 4, values };
        for (storage, limit, bytes) in [
            (Storage::F32, 0.0, 4),
            (Storage::F16, 3e-4, 2),
            (Storage::Byte, 2.1e-3, 1),
        ] {
            let stored = StoredTransfer::new(&transfer, storage, 1, 0.0);
            assert_eq!(stored.bytes.len(), bytes * transfer.values.len());
            let back = stored.transfer();
            let errors = back.values.iter().zip(&transfer.values);
            let worst = errors.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(worst <= limit, "{storage:?}: {worst}");
            assert_eq!(Storage::parse(storage.name()).unwrap(), storage);
        }
        assert!(Storage::parse("f64").is_err());
    }

    #[test]
    fn maps_are_blended_by_their_taps() {
        let path = vec![DVec3::Y, DVec3::X];
        let maps = VisibilityMaps {
            directions: Directions::Path(path),
            splits: 0,
            vertices: 2,
            radius_degrees: 0.2665,
            samples: 16,
            maps: vec![runs::encode(&[255, 0]), runs::encode(&[255, 255])],
        };
        assert_eq!(maps.towards(DVec3::Y, true), [1.0, 0.0]);
        let between = maps.towards(DVec3::new(1.0, 1.0, 0.0).normalize(), true);
        assert!((between[1] - 0.5).abs() < 1e-6 && between[0] == 1.0);
        assert_eq!(maps.towards(DVec3::new(1.0, 0.9, 0.0), false), [1.0, 1.0]);
    }
}
