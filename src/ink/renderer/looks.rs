//! Images and kernels of light, edges and washes, as many as the plan has.

use super::frame::{InkRenderer, InkScene};
use super::order::INDICES;
use super::stage2::Stage2;
use super::sun::SunMap;
use crate::Result;
use crate::abi::{InkEdges, InkFrame, InkSoften, InkWash};
use crate::gpu::shaders::ink as shaders;
use crate::gpu::{
    Binding, Buffer, BufferInfo, ComputePipeline, Format, Gpu, GraphicsPipeline,
    GraphicsPipelineInfo, Image, ImageInfo, Work,
};
use crate::ink::mix::{Mix, MixPlan};
use crate::ink::plan::{Attribute, InkPlan};
use crate::ink::style::Style;
use crate::ink::view::View;
use crate::math::colour::srgb_to_linear;

/// Depth bias of casters, constant (steps of the map) and by slope, away from the sun.
const SHADOW_BIAS: (f32, f32) = (-2.0, -1.0);

/// What the sun's view takes.
pub(super) struct Shadow {
    pub(super) map: Image,
    pub(super) frame: Buffer,
    /// Indices of the leaves, the nearest to the sun first.
    pub(super) order: Buffer,
    pub(super) leaves: GraphicsPipeline,
    pub(super) wood: GraphicsPipeline,
}

/// Sun and sky of every pixel, for all styles.
pub(super) struct Light {
    pub(super) shadow: Option<Shadow>,
    /// Size of the sun's map and its filter.
    pub(super) map: SunMap,
    pub(super) kernel: ComputePipeline,
    /// Sun, sky, shadow, tone.
    pub(super) image: Image,
}

/// A kernel and what it writes.
struct Made {
    kernel: ComputePipeline,
    image: Image,
}

/// Colour and tone on wet paper, in two passes, and the paint that comes of it.
struct Wet {
    kernels: [ComputePipeline; 2],
    colours: [Image; 2],
    tones: [Image; 2],
    paint: Made,
}

/// Edges and paint of a style.
pub(super) struct Paints {
    edges: Option<Made>,
    wet: Option<Wet>,
}

impl Light {
    /// For pictures of the size of `view`; none where no style of the plan tells sun and sky apart.
    pub(super) fn new(
        gpu: &Gpu,
        (mix, plan): (&Mix, &MixPlan),
        scene: &InkScene<'_>,
        view: &View,
    ) -> Result<Option<Self>> {
        if !plan.any(|s| s.light) {
            return Ok(None);
        }
        let map = SunMap::new(scene, &mix.styles, view);
        let mixed = u32::from(plan.is_mixed());
        let shadow = plan
            .any(|s| s.shadow)
            .then(|| Shadow::new(gpu, map.texels, (mixed, scene.plant.leaves.len())));
        let switches = [(0, u32::from(shadow.is_some())), (1, mixed)];
        let size = view.size;
        let image = ImageInfo::storage("ink light", Format::Rgba16Float, size);
        Ok(Some(Self {
            shadow: shadow.transpose()?,
            map,
            kernel: gpu.compute_pipeline_with(shaders::LIGHT_COMP, &switches)?,
            image: gpu.image(image)?,
        }))
    }
}

impl Shadow {
    fn new(gpu: &Gpu, texels: u32, (mixed, leaves): (u32, usize)) -> Result<Self> {
        let pipeline = |name, vertex, fragment| {
            gpu.graphics_pipeline(&GraphicsPipelineInfo {
                name,
                vertex,
                fragment: Some(fragment),
                depth_format: Some(Format::Depth32),
                depth_bias: Some(SHADOW_BIAS),
                specialization: &[(6, mixed)],
                ..GraphicsPipelineInfo::default()
            })
        };
        let bytes = size_of::<InkFrame>() as u64;
        let indices = (leaves.max(1) * INDICES * size_of::<u32>()) as u64;
        let map = ImageInfo::target("ink sun map", Format::Depth32, [texels; 2], 1);
        Ok(Self {
            map: gpu.image(map)?,
            frame: gpu.buffer(BufferInfo::device("ink sun frame", bytes))?,
            order: gpu.buffer(BufferInfo::device("ink sun order", indices))?,
            leaves: pipeline(
                "ink sun leaves",
                shaders::SUN_LEAF_VERT,
                shaders::SUN_LEAF_FRAG,
            )?,
            wood: pipeline("ink sun wood", shaders::WOOD_VERT, shaders::SUN_WOOD_FRAG)?,
        })
    }
}

impl Paints {
    /// What the plan of a style has, for pictures of `size` pixels.
    pub(super) fn new(gpu: &Gpu, plan: &InkPlan, size: [u32; 2]) -> Result<Self> {
        let made = |name, format, shader| {
            Ok(Made {
                kernel: gpu.compute_pipeline(shader)?,
                image: gpu.image(ImageInfo::storage(name, format, size))?,
            })
        };
        let colours = Format::Rgba16Float;
        let image = |name| gpu.image(ImageInfo::storage(name, colours, size));
        let soften = |first: u32| gpu.compute_pipeline_with(shaders::SOFTEN_COMP, &[(0, first)]);
        let wet = || -> Result<Wet> {
            Ok(Wet {
                kernels: [soften(1)?, soften(0)?],
                colours: [image("ink colour across")?, image("ink colour")?],
                tones: [image("ink tone across")?, image("ink tone")?],
                paint: made("ink wash", colours, shaders::WASH_COMP)?,
            })
        };
        let edges = || made("ink edges", Format::R32Float, shaders::EDGES_COMP);
        Ok(Self {
            edges: plan.edges.then(edges).transpose()?,
            wet: plan.wash.then(wet).transpose()?,
        })
    }

    /// Lines where normals turn.
    pub(super) fn edges(&self) -> Option<&Image> {
        self.edges.as_ref().map(|e| &e.image)
    }

    /// Paint.
    pub(super) fn wash(&self) -> Option<&Image> {
        self.wet.as_ref().map(|w| &w.paint.image)
    }
}

impl InkRenderer {
    /// An image to be read texel by texel; nothing where there is none.
    pub(super) fn look<'a>(&'a self, image: Option<&'a Image>) -> Binding<'a> {
        Binding::Sampled(image.unwrap_or(&self.targets.nothing), &self.targets.plain)
    }

    /// What has the tone of a style in w.
    pub(super) fn tone(&self, of: &Stage2) -> Binding<'_> {
        let light = self
            .light
            .as_ref()
            .filter(|_| self.plan.styles[of.number].light);
        match light {
            Some(light) => self.look(Some(&light.image)),
            None => self.targets.attribute(Attribute::Normal),
        }
    }

    /// Lines where normals turn.
    pub(super) fn edges(&self, work: &mut Work, of: &Stage2) -> Result<()> {
        let Some(made) = &of.paints.edges else {
            return Ok(());
        };
        let e = &of.style.edges;
        let bindings = [
            self.targets.attribute(Attribute::Normal),
            Binding::StorageWrite(&made.image),
        ];
        let push = InkEdges {
            width: self.size[0],
            height: self.size[1],
            // The two sides of the filter are as far apart as the line is wide.
            reach: (0.5 * e.width * self.factor as f32).max(0.5),
            threshold: e.threshold,
            softness: e.softness,
        };
        self.pass(work, ("ink edges", of), &made.kernel, &bindings, &push)
    }

    /// Paint.
    pub(super) fn wash(&self, work: &mut Work, of: &Stage2) -> Result<()> {
        let Some(wet) = &of.paints.wet else {
            return Ok(());
        };
        let [width, height] = self.size;
        let push = InkSoften {
            width,
            height,
            deviation: of.style.wash.softness * self.factor as f32,
        };
        for (pass, label) in ["ink soften across", "ink soften down"]
            .into_iter()
            .enumerate()
        {
            let (colour, tone) = if pass == 0 {
                (self.targets.attribute(Attribute::Albedo), self.tone(of))
            } else {
                let first = [&wet.colours[0], &wet.tones[0]];
                (self.look(Some(first[0])), self.look(Some(first[1])))
            };
            let bindings = [
                self.targets.attribute(Attribute::Depth),
                colour,
                tone,
                Binding::StorageWrite(&wet.colours[pass]),
                Binding::StorageWrite(&wet.tones[pass]),
            ];
            self.pass(work, (label, of), &wet.kernels[pass], &bindings, &push)?;
        }
        let bindings = [
            self.look(Some(&wet.colours[1])),
            self.look(Some(&wet.tones[1])),
            Binding::StorageWrite(&wet.paint.image),
        ];
        let push = self.wash_push(&of.style);
        self.pass(work, ("ink wash", of), &wet.paint.kernel, &bindings, &push)
    }

    fn wash_push(&self, style: &Style) -> InkWash {
        let w = &style.wash;
        let factor = self.factor as f32;
        InkWash {
            paper: style.paper.colour.map(srgb_to_linear),
            width: self.size[0],
            height: self.size[1],
            factor,
            wobble: w.wobble * factor,
            feather: w.feather * factor,
            darkening: w.darkening,
            edge_width: w.edge_width * factor,
            density: w.density,
            pigment: w.pigment,
            grain: w.grain,
            middle: w.middle,
            dark: w.dark,
            seed: style.seed,
        }
    }
}
