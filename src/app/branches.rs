//! Axes of branches through the cache: found once for the surface of a model's wood.

use glam::Vec3;

use super::bake_file::{Reader, slice};
use super::cache::{Cache, Kind};
use crate::ink::branches::Branches;

/// Branches in the cache. Raise the version when the form changes, or how axes are found.
const KIND: Kind = Kind {
    tag: *b"axes",
    version: 1,
};

/// Branches of the triangles of `indices`, found in `cache` or worked out and kept there.
#[must_use]
pub fn find(cache: &Cache, positions: &[Vec3], indices: &[u32]) -> Branches {
    find_by(cache, positions, indices, Branches::new)
}

fn find_by(
    cache: &Cache,
    positions: &[Vec3],
    indices: &[u32],
    new: impl FnOnce(&[Vec3], &[u32]) -> Branches,
) -> Branches {
    if cache.folder().is_none() {
        return new(positions, indices);
    }
    let key = key(positions, indices);
    let found = cache.load(KIND, &key);
    if let Some(found) = found.and_then(|bytes| from_bytes(&bytes, positions.len())) {
        log::info!("the axes of branches were found in the cache");
        return found;
    }
    let branches = new(positions, indices);
    cache.store(KIND, &key, &to_bytes(&branches));
    branches
}

/// Hash of all that branches depend on: places of the wood, and how many vertices are none.
fn key(positions: &[Vec3], indices: &[u32]) -> blake3::Hash {
    let mut hash = blake3::Hasher::new();
    hash.update(&(positions.len() as u64).to_le_bytes());
    hash.update(bytemuck::cast_slice(indices));
    let corners: Vec<Vec3> = indices.iter().map(|&v| positions[v as usize]).collect();
    hash.update(bytemuck::cast_slice(&corners));
    hash.finalize()
}

/// Axis, radius and coordinates of every vertex that has any, behind its number.
fn to_bytes(branches: &Branches) -> Vec<u8> {
    let axes = branches.axis.iter().zip(&branches.radius);
    let rows = (0_u32..).zip(axes.zip(&branches.hatch));
    let rows = rows.map(|(v, ((axis, radius), hatch))| {
        let [x, y, z] = axis.to_array().map(f32::to_bits);
        let [u, w, along, girth] = hatch.map(f32::to_bits);
        [v, x, y, z, radius.to_bits(), u, w, along, girth]
    });
    let rows: Vec<[u32; 9]> = rows.filter(|r| r[1..].iter().any(|&b| b != 0)).collect();
    let mut out = Vec::with_capacity(36 * rows.len() + 8);
    slice(&mut out, bytemuck::cast_slice(&rows), 36);
    out
}

/// The branches of so many vertices in `bytes`, or nothing when they are no such thing.
fn from_bytes(bytes: &[u8], vertices: usize) -> Option<Branches> {
    let mut reader = Reader(bytes);
    let rows: Vec<[u32; 9]> = reader.slice(36)?;
    let mut out = Branches {
        axis: vec![Vec3::ZERO; vertices],
        radius: vec![0.0; vertices],
        hatch: vec![[0.0; 4]; vertices],
    };
    for [v, rest @ ..] in rows {
        let v = v as usize;
        let [x, y, z, radius, hatch @ ..] = rest.map(f32::from_bits);
        *out.axis.get_mut(v)? = Vec3::new(x, y, z);
        out.radius[v] = radius;
        out.hatch[v] = hatch;
    }
    reader.0.is_empty().then_some(out)
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    /// Two tubes of six sides along y; a vertex that is no wood between them.
    fn wood() -> (Vec<Vec3>, Vec<u32>) {
        let (mut positions, mut indices) = (Vec::new(), Vec::new());
        for (tube, radius) in [0.2_f32, 0.05].into_iter().enumerate() {
            let first = positions.len() as u32;
            for ring in 0..8_u32 {
                for side in 0..6_u32 {
                    let (sin, cos) = (std::f32::consts::FRAC_PI_3 * side as f32).sin_cos();
                    let x = 2.0 * tube as f32 + radius * cos;
                    positions.push(Vec3::new(x, 0.2 * ring as f32, radius * sin));
                    if ring > 0 {
                        let (a, b) = ((ring - 1) * 6 + side, (ring - 1) * 6 + (side + 1) % 6);
                        indices.extend([a, b, b + 6, a, b + 6, a + 6].map(|i| first + i));
                    }
                }
            }
            positions.push(Vec3::splat(9.0));
        }
        (positions, indices)
    }

    #[test]
    fn axes_are_found_once_for_each_surface() {
        let folder = tempfile::tempdir().unwrap();
        let cache = Cache::new(Some(folder.path().to_owned()));
        let times = Cell::new(0);
        let found = |cache: &Cache, positions: &[Vec3], indices: &[u32]| {
            find_by(cache, positions, indices, |positions, indices| {
                times.set(times.get() + 1);
                Branches::new(positions, indices)
            })
        };
        let (mut positions, indices) = wood();
        let first = found(&cache, &positions, &indices);
        assert!(first.radius.iter().any(|&r| r > 0.0), "something to keep");
        assert_eq!(
            (found(&cache, &positions, &indices), times.get()),
            (first, 1)
        );
        positions[48] = Vec3::ZERO;
        found(&cache, &positions, &indices);
        assert_eq!(times.get(), 1, "leaves may be anywhere");
        positions[0].x += 0.01;
        found(&cache, &positions, &indices);
        found(&cache, &positions, &indices[3..]);
        found(&cache, &positions[..97], &indices);
        assert_eq!(times.get(), 4, "another place, surface, number of vertices");
        found(&Cache::new(None), &positions, &indices);
        assert_eq!(times.get(), 5, "without a cache");
    }

    #[test]
    fn other_bytes_are_no_branches() {
        let (positions, indices) = wood();
        let branches = Branches::new(&positions, &indices);
        let bytes = to_bytes(&branches);
        assert_eq!(from_bytes(&bytes, positions.len()), Some(branches));
        assert_eq!(from_bytes(&bytes, 12), None, "of fewer vertices");
        for length in 0..bytes.len() {
            assert_eq!(
                from_bytes(&bytes[..length], positions.len()),
                None,
                "{length} bytes"
            );
        }
    }
}
