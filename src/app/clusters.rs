//! Clusters of leaves through the cache: a model's leaves are gathered once for each radius.

use glam::Vec3;

use super::bake_file::{Reader, slice};
use super::cache::{Cache, Kind};
use crate::Result;
use crate::ink::clusters::{Choice, Cluster, Clusters};

/// Clusters in the cache. Raise the version when the form changes, or how leaves are gathered.
const KIND: Kind = Kind {
    tag: *b"clus",
    version: 1,
};

/// Clusters of leaves at `centres`, found in `cache` or gathered and kept there.
///
/// # Errors
/// As [`Clusters::new`].
pub fn gather(cache: &Cache, centres: &[Vec3], radius: f32, choice: Choice) -> Result<Clusters> {
    gather_by(cache, centres, (radius, choice), Clusters::new)
}

fn gather_by(
    cache: &Cache,
    centres: &[Vec3],
    (radius, choice): (f32, Choice),
    new: impl FnOnce(&[Vec3], f32, Choice) -> Result<Clusters>,
) -> Result<Clusters> {
    if cache.folder().is_none() {
        return new(centres, radius, choice);
    }
    let key = key(centres, radius, choice);
    let found = cache.load(KIND, &key);
    if let Some(found) = found.and_then(|bytes| from_bytes(&bytes, centres.len())) {
        log::info!("the clusters were found in the cache");
        return Ok(found);
    }
    let clusters = new(centres, radius, choice)?;
    cache.store(KIND, &key, &to_bytes(&clusters));
    Ok(clusters)
}

/// Hash of all that clusters depend on.
fn key(centres: &[Vec3], radius: f32, choice: Choice) -> blake3::Hash {
    let mut hash = blake3::Hasher::new();
    hash.update(format!("{choice:?}").as_bytes());
    hash.update(&radius.to_le_bytes());
    hash.update(bytemuck::cast_slice(centres));
    hash.finalize()
}

/// Centres, radii and members of the clusters, then the cluster of every leaf.
fn to_bytes(clusters: &Clusters) -> Vec<u8> {
    let rows = clusters.clusters.iter().map(|c| {
        let [x, y, z] = c.centre.to_array().map(f32::to_bits);
        [x, y, z, c.radius.to_bits(), c.leaves]
    });
    let rows: Vec<[u32; 5]> = rows.collect();
    let mut out = Vec::with_capacity(20 * rows.len() + 4 * clusters.of_leaf.len() + 16);
    slice(&mut out, bytemuck::cast_slice(&rows), 20);
    slice(&mut out, bytemuck::cast_slice(&clusters.of_leaf), 4);
    out
}

/// The clusters of so many leaves in `bytes`, or nothing when they are no such thing.
fn from_bytes(bytes: &[u8], leaves: usize) -> Option<Clusters> {
    let mut reader = Reader(bytes);
    let rows: Vec<[u32; 5]> = reader.slice(20)?;
    let of_leaf: Vec<u32> = reader.slice(4)?;
    let within = of_leaf.iter().all(|&c| (c as usize) < rows.len());
    let whole = reader.0.is_empty() && within && of_leaf.len() == leaves;
    let cluster = |row: &[u32; 5]| {
        let [x, y, z, radius, leaves] = *row;
        Cluster {
            centre: Vec3::from([x, y, z].map(f32::from_bits)),
            radius: f32::from_bits(radius),
            leaves,
        }
    };
    whole.then(|| Clusters {
        clusters: rows.iter().map(cluster).collect(),
        of_leaf,
    })
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    fn leaves() -> Vec<Vec3> {
        (0..200)
            .map(|i| Vec3::new((i % 7) as f32, (i % 11) as f32, 0.1 * i as f32))
            .collect()
    }

    #[test]
    fn leaves_are_gathered_once_for_each_radius() {
        let folder = tempfile::tempdir().unwrap();
        let cache = Cache::new(Some(folder.path().to_owned()));
        let times = Cell::new(0);
        let found = |cache: &Cache, centres: &[Vec3], how: (f32, Choice)| {
            gather_by(cache, centres, how, |centres, radius, choice| {
                times.set(times.get() + 1);
                Clusters::new(centres, radius, choice)
            })
            .unwrap()
        };
        let (all, how) = (leaves(), (2.0, Choice::Smallest));
        let first = found(&cache, &all, how);
        assert_eq!((found(&cache, &all, how), times.get()), (first, 1));
        found(&cache, &all, (2.5, Choice::Smallest));
        found(&cache, &all, (2.0, Choice::First));
        found(&cache, &all[1..], how);
        assert_eq!(times.get(), 4, "another radius, choice, plant");
        found(&Cache::new(None), &all, how);
        assert_eq!(times.get(), 5, "without a cache");
        assert!(gather(&cache, &all, f32::NAN, Choice::First).is_err());
    }

    #[test]
    fn other_bytes_are_no_clusters() {
        let clusters = Clusters::new(&leaves(), 2.0, Choice::Smallest).unwrap();
        let bytes = to_bytes(&clusters);
        assert_eq!(from_bytes(&bytes, 200), Some(clusters));
        assert_eq!(from_bytes(&bytes, 199), None, "of fewer leaves");
        for length in 0..bytes.len() {
            assert_eq!(from_bytes(&bytes[..length], 200), None, "{length} bytes");
        }
        let mut wild = bytes;
        let last = wild.len() - 4;
        wild[last..].copy_from_slice(&9999_u32.to_le_bytes());
        assert_eq!(from_bytes(&wild, 200), None, "a cluster that is not there");
    }
}
