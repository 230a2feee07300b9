//! Reading back what strokes on a bitmap are placed by: depths, light on stems, the sun's shadow.

use bytemuck::pod_collect_to_vec;

use super::renderer::Maps;
use crate::Result;
use crate::gpu::{Completed, Image, Readback, Work};
use crate::math::packing::f16_to_f32;

/// Pictures under way from the device.
pub(super) struct Tones {
    foliage: Readback<u8>,
    numbers: Option<Readback<u8>>,
    stems: Readback<u8>,
    normals: Readback<u8>,
    shadow: Option<Readback<u8>>,
}

impl Tones {
    /// Records the copies of the targets of foliage and stems (depth first, normals second) and of
    /// the shadow. `numbers`: of particles' numbers too.
    pub(super) fn read(
        work: &mut Work,
        foliage: &[Image],
        stems: &[Image],
        shadow: Option<&Image>,
        numbers: bool,
    ) -> Result<Self> {
        Ok(Self {
            numbers: if numbers {
                Some(work.read_image("foliage number", &foliage[1])?)
            } else {
                None
            },
            foliage: work.read_image("foliage depth", &foliage[0])?,
            stems: work.read_image("stem depth", &stems[0])?,
            normals: work.read_image("stem normal", &stems[1])?,
            shadow: match shadow {
                Some(shadow) => Some(work.read_image("shadow", shadow)?),
                None => None,
            },
        })
    }

    /// What came; maps that strokes do not need are empty.
    pub(super) fn maps(self, done: &mut Completed, size: [u32; 2], leaves: usize) -> Maps {
        let halves: Vec<[u16; 4]> = pod_collect_to_vec(&done.take(self.normals));
        let numbers: Vec<f32> = self
            .numbers
            .map_or_else(Vec::new, |n| pod_collect_to_vec(&done.take(n)));
        Maps {
            size: size.map(|s| s as usize),
            foliage_depth: pod_collect_to_vec(&done.take(self.foliage)),
            stem_depth: pod_collect_to_vec(&done.take(self.stems)),
            stem_normal: halves.iter().map(|h| h.map(f16_to_f32)).collect(),
            shadow: self
                .shadow
                .map_or_else(Vec::new, |s| pod_collect_to_vec(&done.take(s))),
            foliage_number: numbers.iter().map(|&n| n as u32).collect(),
            leaves,
            ..Maps::default()
        }
    }
}
