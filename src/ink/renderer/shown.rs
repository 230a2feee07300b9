//! One attribute of a picture instead of the picture.

use super::frame::{InkRenderer, InkScene};
use crate::gpu::Image;
use crate::ink::plan::Attribute;
use crate::ink::shown::{self, InkView};
use crate::ink::view::View;
use crate::{Error, Result};

impl InkRenderer {
    /// Draws as [`InkRenderer::draw`] does and shows one attribute of it: RGBA, sRGB.
    ///
    /// # Errors
    /// The style has no such attribute ([`InkView::check`] says so before), memory runs out, or the
    /// device is lost.
    pub fn show(&self, scene: &InkScene<'_>, view: &View, which: InkView) -> Result<Vec<u8>> {
        let Some(image) = self.shown(which) else {
            return Err(Error::usage(format!(
                "the style has no {}; it takes {}",
                which.name(),
                which.needs()
            )));
        };
        let mut work = self.record(scene, view)?;
        let bytes = work.read_image("ink view", image)?;
        let depth = match self.attribute_image(Attribute::Depth) {
            Some(depth) => Some(work.read_image("ink depth", depth)?),
            None => None,
        };
        let mut done = work.submit()?.wait()?;
        let depth = depth.map(|d| done.take(d)).unwrap_or_default();
        let covered: Vec<bool> = depth
            .chunks_exact(4)
            .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]) > 0.0)
            .collect();
        let format = image.info().format;
        let bytes = done.take(bytes);
        Ok(shown::picture(
            which,
            (format, &bytes),
            &covered,
            view.depths,
        ))
    }

    fn attribute_image(&self, which: Attribute) -> Option<&Image> {
        let found = self.targets.attributes.iter().find(|a| a.0 == which);
        found.map(|a| &a.1)
    }

    /// The image that has what is shown.
    fn shown(&self, which: InkView) -> Option<&Image> {
        let light = self.light.as_ref();
        // Of several styles the first one's.
        let paints = self.stage2.first().map(|s| &s.paints);
        match which {
            InkView::Albedo => self.attribute_image(Attribute::Albedo),
            InkView::Normal => self.attribute_image(Attribute::Normal),
            InkView::Depth => self.attribute_image(Attribute::Depth),
            InkView::Object | InkView::Cluster => self.attribute_image(Attribute::Ids),
            InkView::Direction => self.attribute_image(Attribute::Direction),
            InkView::Hatch => self.attribute_image(Attribute::Hatch),
            InkView::Tone => light
                .map(|l| &l.image)
                .or_else(|| self.attribute_image(Attribute::Normal)),
            InkView::Shadow => light.filter(|l| l.shadow.is_some()).map(|l| &l.image),
            InkView::Contour => self.targets.lines[1].as_ref(),
            InkView::Silhouette => self.targets.lines[2].as_ref(),
            InkView::Edges => paints.and_then(|p| p.edges()),
            InkView::Wash => paints.and_then(|p| p.wash()),
        }
    }
}
