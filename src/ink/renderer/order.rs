//! Which leaves a view draws, and in which order: the nearest first, so that what they hide is not
//! shaded.

use std::ops::Range;

use glam::DVec3;

use super::frame::InkScene;
use super::styles::Styles;
use crate::abi::INK_FADE;
use crate::ink::leaves::Leaf;
use crate::ink::plant::Plant;
use crate::ink::style::Style;
use crate::ink::view::View;

/// Vertices of a leaf's two triangles, of the six that its square has.
const CORNERS: [u32; 6] = [0, 1, 2, 0, 2, 5];
/// Indices of a leaf.
pub(super) const INDICES: usize = CORNERS.len();

/// Leaves of a view as indices of vertices.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Order {
    pub(super) indices: Vec<u32>,
    /// Material and its part of the indices.
    pub(super) batches: Vec<(u32, Range<u32>)>,
}

/// Leaves that the styles keep in a view, in the plant's order.
pub(super) fn drawn(scene: &InkScene<'_>, styles: &Styles, view: &View, factor: u32) -> Vec<u32> {
    let placements = styles.regions.placements(scene.plant, view);
    let share = |style: &Style| Styles::detail(style, scene, view, factor).kept;
    // Leaves fade in at the end of those that are kept.
    let shares = styles
        .mix
        .styles
        .iter()
        .map(|s| share(s) * (1.0 + INK_FADE));
    let shares: Vec<f32> = shares.collect();
    let kept = (0..).zip(&placements);
    let kept = kept.filter(|(_, p)| p.rank < shares[p.style as usize]);
    kept.map(|(leaf, _)| leaf).collect()
}

impl Order {
    /// The `drawn` leaves, those of one material after the other, the nearest to who looks along
    /// `forward` first.
    pub(super) fn new(plant: &Plant, drawn: &[u32], forward: DVec3) -> Self {
        Self::sorted(&plant.leaves, &plant.batches, drawn, forward)
    }

    fn sorted(
        leaves: &[Leaf],
        batches: &[(u32, Range<u32>)],
        drawn: &[u32],
        forward: DVec3,
    ) -> Self {
        let forward = forward.as_vec3();
        let mut out = Self::default();
        for (material, range) in batches {
            let part = |end: u32| drawn.partition_point(|&leaf| leaf < end);
            let mut keys: Vec<u64> = drawn[part(range.start)..part(range.end)]
                .iter()
                .map(|&i| {
                    let depth = leaves[i as usize].centre.dot(forward);
                    u64::from(ascending(depth)) << 32 | u64::from(i)
                })
                .collect();
            keys.sort_unstable();
            let first = out.indices.len() as u32;
            for key in keys {
                let leaf = key as u32;
                out.indices.extend(CORNERS.map(|c| 6 * leaf + c));
            }
            let all = first..out.indices.len() as u32;
            if !all.is_empty() {
                out.batches.push((*material, all));
            }
        }
        out
    }
}

/// An integer that grows with `v`.
fn ascending(v: f32) -> u32 {
    let bits = v.to_bits();
    if bits >> 31 == 1 {
        !bits
    } else {
        bits | 1 << 31
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn numbers_keep_their_order() {
        let values = [-f32::INFINITY, -3.0, -1e-30, 0.0, 1e-30, 2.0, f32::INFINITY];
        let keys = values.map(ascending);
        assert!(keys.windows(2).all(|w| w[0] < w[1]), "{keys:?}");
    }

    #[test]
    fn the_nearest_come_first_and_dropped_leaves_not_at_all() {
        let at = |z: f32| Leaf {
            centre: Vec3::new(0.0, 0.0, z),
            ..Leaf::default()
        };
        let leaves = [at(3.0), at(1.0), at(2.0), at(5.0), at(4.0), at(6.0)];
        let batches = [(7, 0..3), (8, 3..5), (9, 5..6)];
        let order = Order::sorted(&leaves, &batches, &[0, 1, 3, 4], DVec3::Z);
        let drawn: Vec<u32> = order.indices.chunks(INDICES).map(|c| c[0] / 6).collect();
        assert_eq!(drawn, [1, 0, 4, 3]);
        assert_eq!(
            order.batches,
            [(7, 0..12), (8, 12..24)],
            "a batch of nothing is none"
        );
        assert!(order.indices.iter().all(|i| i / 6 < 5));
    }
}
