//! Passes that draw particles and stems from an eye: the camera's, and the sun's.

use crate::Result;
use crate::gpu::{Binding, Buffer, ColorTarget, DepthTarget, Draws, Image, RenderPass, Work};

/// Where particles and stems are drawn from, and into what: depth, and number or normal.
pub(super) struct Eye<'a> {
    pub(super) name: [&'a str; 2],
    pub(super) frame: &'a Buffer,
    pub(super) foliage: &'a [Image],
    pub(super) stems: &'a [Image],
    pub(super) depth: &'a Image,
    pub(super) extent: [u32; 2],
}

impl Eye<'_> {
    /// Draws foliage (0) or stems (1) by what `record` records.
    pub(super) fn pass(
        &self,
        work: &mut Work,
        which: usize,
        reads: &[Binding<'_>],
        record: impl FnOnce(&mut Draws<'_>) -> Result<()>,
    ) -> Result<()> {
        let targets = [self.foliage, self.stems][which];
        let color = [&targets[0], &targets[1]].map(|image| ColorTarget {
            image,
            clear: Some([0.0; 4]),
            resolve: None,
            store: true,
        });
        let pass = RenderPass {
            extent: self.extent,
            color: &color,
            depth: Some(DepthTarget {
                image: self.depth,
                clear: Some(0.0),
                store: false,
            }),
            reads,
        };
        work.render(self.name[which], &pass, record)
    }
}
