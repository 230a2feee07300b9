//! Images that the two stages write, as many as the plan has.

use crate::Result;
use crate::gpu::{
    AddressMode, Binding, ColorTarget, Format, Gpu, Image, ImageInfo, Sampler, SamplerInfo,
};
use crate::ink::images::filled_image;
use crate::ink::mix::MixPlan;
use crate::ink::plan::Attribute;

/// Images of a picture and the samplers to read them with.
pub(super) struct Targets {
    /// Attributes of stage 1, in the order of its targets.
    pub(super) attributes: Vec<(Attribute, Image)>,
    pub(super) depth: Image,
    /// Contour, cleaned contour, silhouette.
    pub(super) lines: [Option<Image>; 3],
    pub(super) picture: Image,
    /// A texel of zeros.
    pub(super) nothing: Image,
    /// Unfiltered.
    pub(super) plain: Sampler,
    /// Filtered; repeats along u.
    pub(super) smooth: Sampler,
    /// Filtered; repeats.
    pub(super) repeating: Sampler,
}

impl Targets {
    /// Images of `size` pixels.
    pub(super) fn new(gpu: &Gpu, plan: &MixPlan, size: [u32; 2]) -> Result<Self> {
        let target = |name, format| gpu.image(ImageInfo::target(name, format, size, 1));
        let storage = |name, format| gpu.image(ImageInfo::storage(name, format, size));
        let line = |wanted: bool, name| {
            let image = wanted.then(|| storage(name, Format::R32Float));
            image.transpose()
        };
        let sampler = |linear, address| {
            gpu.sampler(&SamplerInfo {
                linear,
                linear_mips: linear,
                address,
                ..SamplerInfo::default()
            })
        };
        let attributes = plan.attributes().into_iter();
        Ok(Self {
            attributes: attributes
                .map(|a| Ok((a, target(a.label(), a.format())?)))
                .collect::<Result<_>>()?,
            depth: target("ink depth test", Format::Depth32)?,
            lines: [
                line(plan.any(|s| s.contour), "ink contour")?,
                line(plan.any(|s| s.contour), "ink lines")?,
                line(plan.any(|s| s.silhouette), "ink silhouette")?,
            ],
            picture: storage("ink picture", Format::Rgba16Float)?,
            nothing: filled_image(gpu, "nothing", Format::Rgba8Unorm, [1, 1], &[&[0; 4]])?,
            plain: sampler(false, [AddressMode::Clamp; 2])?,
            smooth: sampler(true, [AddressMode::Repeat, AddressMode::Clamp])?,
            repeating: sampler(true, [AddressMode::Repeat; 2])?,
        })
    }

    /// The targets of stage 1, cleared to nothing.
    pub(super) fn color(&self) -> Vec<ColorTarget<'_>> {
        let images = self.attributes.iter().map(|(_, image)| image);
        let target = |image| ColorTarget {
            image,
            clear: Some([0.0; 4]),
            resolve: None,
            store: true,
        };
        images.map(target).collect()
    }

    /// The target of an attribute; a texel of nothing where the plan has none.
    pub(super) fn attribute(&self, attribute: Attribute) -> Binding<'_> {
        let found = self.attributes.iter().find(|t| t.0 == attribute);
        Binding::Sampled(found.map_or(&self.nothing, |t| &t.1), &self.plain)
    }

    /// Lines to be read, by their number in `lines`; nothing where the plan has none.
    pub(super) fn line(&self, number: usize) -> Binding<'_> {
        let image = self.lines[number].as_ref().unwrap_or(&self.nothing);
        Binding::Sampled(image, &self.plain)
    }
}
