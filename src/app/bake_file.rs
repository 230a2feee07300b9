//! The file form of a bake, for the cache: little-endian numbers behind their counts.
//!
//! The cache's header carries version and checksum; reading checks every length all the same.

use glam::Vec3;

use super::cache::Kind;
use crate::foliage::bake::{Bake, Stats};

/// Bakes in the cache. Raise the version when the form or the meaning of a bake changes.
pub const KIND: Kind = Kind {
    tag: *b"bake",
    version: 2,
};

/// The bytes of `bake`.
#[must_use]
pub fn to_bytes(bake: &Bake) -> Vec<u8> {
    let mut out = Vec::with_capacity(16 * bake.normals.len() + 4 * bake.encoded.len() + 256);
    slice(&mut out, bytemuck::cast_slice(&bake.normals), 12);
    slice(&mut out, bytemuck::cast_slice(&bake.ambient), 4);
    let parts: Vec<u8> = bake.foliage_parts.iter().map(|&f| u8::from(f)).collect();
    slice(&mut out, &parts, 1);
    slice(&mut out, bytemuck::cast_slice(&bake.encoded), 4);
    let s = &bake.stats;
    for count in [
        s.foliage_vertices,
        s.covered_vertices,
        s.generators,
        s.surface_vertices,
        s.surface_triangles,
        s.wide_fallbacks,
        s.kept_normals,
        s.unsettled_normals,
    ] {
        out.extend_from_slice(&(count as u64).to_le_bytes());
    }
    out.extend_from_slice(&s.diagonal.to_le_bytes());
    for value in [s.tau, s.tau_ambient, s.d_min] {
        out.extend_from_slice(&value.to_le_bytes());
    }
    out
}

/// The bake in `bytes`, or nothing when they are no such thing.
#[must_use]
pub fn from_bytes(bytes: &[u8]) -> Option<Bake> {
    let mut reader = Reader(bytes);
    let normals: Vec<Vec3> = reader.slice(12)?;
    let ambient: Vec<f32> = reader.slice(4)?;
    let foliage_parts: Vec<u8> = reader.slice(1)?;
    let encoded: Vec<u32> = reader.slice(4)?;
    let stats = Stats {
        foliage_vertices: reader.count()?,
        covered_vertices: reader.count()?,
        generators: reader.count()?,
        surface_vertices: reader.count()?,
        surface_triangles: reader.count()?,
        wide_fallbacks: reader.count()?,
        kept_normals: reader.count()?,
        unsettled_normals: reader.count()?,
        diagonal: f64::from_le_bytes(reader.array()?),
        tau: f32::from_le_bytes(reader.array()?),
        tau_ambient: f32::from_le_bytes(reader.array()?),
        d_min: f32::from_le_bytes(reader.array()?),
    };
    let whole = reader.0.is_empty() && normals.len() == ambient.len();
    whole.then(|| Bake {
        normals,
        ambient,
        foliage_parts: foliage_parts.iter().map(|&f| f != 0).collect(),
        encoded,
        stats,
    })
}

/// Appends the number of elements of `element` bytes in `bytes`, and the bytes.
pub(super) fn slice(out: &mut Vec<u8>, bytes: &[u8], element: usize) {
    out.extend_from_slice(&((bytes.len() / element) as u64).to_le_bytes());
    out.extend_from_slice(bytes);
}

/// What is left to read.
pub(super) struct Reader<'a>(pub(super) &'a [u8]);

impl<'a> Reader<'a> {
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (head, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(head)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.take(N)?.try_into().ok()
    }

    fn count(&mut self) -> Option<usize> {
        usize::try_from(u64::from_le_bytes(self.array()?)).ok()
    }

    /// Elements of `element` bytes behind their number.
    pub(super) fn slice<T: bytemuck::Pod>(&mut self, element: usize) -> Option<Vec<T>> {
        let count = self.count()?;
        let bytes = self.take(count.checked_mul(element)?)?;
        Some(bytemuck::pod_collect_to_vec(bytes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Bake {
        Bake {
            normals: vec![Vec3::X, Vec3::new(0.0, 0.6, -0.8)],
            ambient: vec![0.25, 1.0],
            foliage_parts: vec![true, false, true],
            encoded: vec![7, 8, 9],
            stats: Stats {
                generators: 3,
                diagonal: 12.5,
                d_min: 0.5,
                ..Stats::default()
            },
        }
    }

    #[test]
    fn a_bake_survives_its_file() {
        assert_eq!(
            from_bytes(&to_bytes(&sample())),
            Some(sample()),
            "same bake"
        );
        let none = Bake::default();
        assert_eq!(from_bytes(&to_bytes(&none)), Some(none), "empty bake");
    }

    #[test]
    fn other_lengths_are_refused() {
        let bytes = to_bytes(&sample());
        for length in 0..bytes.len() {
            assert_eq!(from_bytes(&bytes[..length]), None, "{length} bytes");
        }
        assert_eq!(from_bytes(&[&bytes[..], &[0]].concat()), None, "one more");
        let mut huge = bytes;
        huge[..8].copy_from_slice(&u64::MAX.to_le_bytes());
        assert_eq!(from_bytes(&huge), None, "an impossible count");
    }
}
