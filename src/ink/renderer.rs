//! The two stages on the device (Coconu, Deussen, Hege 2006, section 4): attributes into several
//! targets at once, then lines, strokes and washes in image space.

use glam::DVec2;

use super::images::{
    band_image, filled_image, material_textures, shapes_image, tile_image, wood_hatching,
};
use super::plan::{Attribute, InkPlan};
use super::plant::Plant;
use super::style::Style;
use super::view::{Hatch, View, tiles_about};
use crate::Result;
use crate::abi::{
    INK_DEPTH_LINEAR, INK_DEPTH_MAPPED, INK_TILE, InkClean, InkCluster, InkCompose, InkContour,
    InkFrame, InkLeafDraw, InkSilhouette, InkWoodDraw,
};
use crate::gpu::shaders::ink as shaders;
use crate::gpu::{
    AddressMode, Binding, Buffer, BufferInfo, ColorTarget, ComputePipeline, DepthTarget, Format,
    Gpu, GraphicsPipeline, GraphicsPipelineInfo, Image, ImageInfo, PassTime, QueueKind, RenderPass,
    Sampler, SamplerInfo, Shader, Work,
};
use crate::math::colour::srgb_to_linear;
use crate::scene::{AlphaMode, Geometry, Model};

/// Fragment shaders for one to six targets.
const LEAF_FRAGMENTS: [Shader; 6] = [
    shaders::LEAF_1_FRAG,
    shaders::LEAF_2_FRAG,
    shaders::LEAF_3_FRAG,
    shaders::LEAF_4_FRAG,
    shaders::LEAF_5_FRAG,
    shaders::LEAF_6_FRAG,
];
/// The same for wood.
const WOOD_FRAGMENTS: [Shader; 6] = [
    shaders::WOOD_1_FRAG,
    shaders::WOOD_2_FRAG,
    shaders::WOOD_3_FRAG,
    shaders::WOOD_4_FRAG,
    shaders::WOOD_5_FRAG,
    shaders::WOOD_6_FRAG,
];

/// What is drawn.
#[derive(Debug, Clone, Copy)]
pub struct InkScene<'a> {
    /// Materials and textures.
    pub model: &'a Model,
    /// Triangles of the wood.
    pub geometry: &'a Geometry,
    /// Leaves.
    pub plant: &'a Plant,
}

/// A picture in linear light, straight from the device, with the times of its passes.
#[derive(Debug, Clone)]
pub struct Drawing {
    /// Pixels across and down.
    pub size: [u32; 2],
    /// RGBA, 16-bit floats.
    pub pixels: Vec<u8>,
    /// Device times.
    pub passes: Vec<PassTime>,
    /// Attributes of stage 1 that were asked for, with the bytes of their images.
    pub attributes: Vec<(Attribute, Vec<u8>)>,
    /// Contour, cleaned contour and silhouette, as far as the style has them and attributes were
    /// asked for: 32-bit floats.
    pub lines: Vec<Vec<u8>>,
}

/// Pipelines of stage 1 and 2.
struct Pipelines {
    leaves: GraphicsPipeline,
    wood: GraphicsPipeline,
    contour: Option<ComputePipeline>,
    clean: Option<ComputePipeline>,
    silhouette: Option<ComputePipeline>,
    compose: ComputePipeline,
}

/// Draws one plant in one style from any view.
pub struct InkRenderer {
    gpu: Gpu,
    style: Style,
    size: [u32; 2],
    /// Pixels of this picture for one of the final one: widths in pixels grow by it.
    factor: u32,
    /// Distance of the eye at which strokes have the style's size, metres: strokes stay on their
    /// clusters, and grow and shrink with them, when the eye moves.
    reference: f64,
    frame: Buffer,
    leaves: Buffer,
    clusters: Buffer,
    positions: Buffer,
    normals: Buffer,
    texcoords: Buffer,
    hatches: Buffer,
    indices: Buffer,
    shapes: Image,
    textures: Vec<(Image, Sampler)>,
    targets: Vec<(Attribute, Image)>,
    depth: Image,
    lines: Vec<Image>,
    strokes: Option<Image>,
    tiles: Option<Image>,
    nothing: Image,
    picture: Image,
    plain: Sampler,
    smooth: Sampler,
    repeating: Sampler,
    pipelines: Pipelines,
}

impl std::fmt::Debug for InkRenderer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "InkRenderer({}x{})", self.size[0], self.size[1])
    }
}

impl InkRenderer {
    /// Uploads the plant and makes what the style needs for pictures of the size of `view`, of
    /// whose pixels `factor` along each axis become one. Strokes have the style's size in that
    /// view.
    ///
    /// # Errors
    /// A texture that cannot be decoded, or memory runs out.
    pub fn new(
        gpu: &Gpu,
        scene: &InkScene<'_>,
        style: &Style,
        view: &View,
        factor: u32,
    ) -> Result<Self> {
        let size = view.size;
        let plan = InkPlan::new(style);
        let g = scene.geometry;
        let clusters = scene.plant.clusters.len().max(1) as u64;
        let sampler = |linear, address| {
            gpu.sampler(&SamplerInfo {
                linear,
                linear_mips: linear,
                address,
                ..SamplerInfo::default()
            })
        };
        let targets: Vec<(Attribute, Image)> = plan
            .attributes()
            .into_iter()
            .map(|a| {
                let info = ImageInfo::target(a.label(), a.format(), size, 1);
                Ok((a, gpu.image(info)?))
            })
            .collect::<Result<_>>()?;
        let line_names = ["ink contour", "ink lines", "ink silhouette"];
        let wanted = [plan.contour, plan.contour, plan.silhouette];
        let lines = line_names
            .iter()
            .zip(wanted)
            .filter(|(_, wanted)| *wanted)
            .map(|(name, _)| gpu.image(ImageInfo::storage(*name, Format::R32Float, size)))
            .collect::<Result<_>>()?;
        Ok(Self {
            gpu: gpu.clone(),
            style: style.clone(),
            size,
            factor,
            reference: view.middle_distance(),
            frame: gpu.buffer(BufferInfo::device(
                "ink frame",
                size_of::<InkFrame>() as u64,
            ))?,
            leaves: gpu.upload("ink leaves", &scene.plant.records(style.seed))?,
            clusters: gpu.buffer(BufferInfo::device(
                "ink clusters",
                clusters * size_of::<InkCluster>() as u64,
            ))?,
            positions: gpu.upload("positions", &g.positions)?,
            normals: gpu.upload("normals", &g.normals)?,
            texcoords: gpu.upload("texcoords", &g.texcoords)?,
            hatches: gpu.upload("wood hatching", &wood_hatching(g))?,
            indices: gpu.upload("indices", &g.indices)?,
            shapes: shapes_image(gpu, scene.plant)?,
            textures: material_textures(gpu, scene.model)?,
            depth: gpu.image(ImageInfo::target(
                "ink depth test",
                Format::Depth32,
                size,
                1,
            ))?,
            lines,
            strokes: plan
                .silhouette
                .then(|| band_image(gpu, style.seed))
                .transpose()?,
            tiles: plan
                .hatching
                .then(|| tile_image(gpu, style.seed))
                .transpose()?,
            nothing: filled_image(gpu, "nothing", Format::Rgba8Unorm, [1, 1], &[&[0; 4]])?,
            picture: gpu.image(ImageInfo::storage("ink picture", Format::Rgba16Float, size))?,
            plain: sampler(false, [AddressMode::Clamp; 2])?,
            smooth: sampler(true, [AddressMode::Repeat, AddressMode::Clamp])?,
            repeating: sampler(true, [AddressMode::Repeat; 2])?,
            pipelines: pipelines(gpu, &plan, &targets)?,
            targets,
        })
    }

    /// Draws the plant.
    ///
    /// # Errors
    /// Memory runs out or the device is lost.
    pub fn draw(&self, scene: &InkScene<'_>, view: &View) -> Result<Drawing> {
        self.draw_with(scene, view, &[])
    }

    /// As [`InkRenderer::draw`], with attributes of stage 1 read back; those that the style does
    /// not need do not exist.
    ///
    /// # Errors
    /// Memory runs out or the device is lost.
    pub fn draw_with(
        &self,
        scene: &InkScene<'_>,
        view: &View,
        wanted: &[Attribute],
    ) -> Result<Drawing> {
        let shading = &self.style.shading;
        let frame = view.frame(shading.ambient, shading.depth);
        let mut work = self.gpu.work(QueueKind::Graphics, "ink")?;
        work.upload("ink frame", &self.frame, &[frame])?;
        work.upload(
            "ink clusters",
            &self.clusters,
            &self.cluster_records(scene, view),
        )?;
        self.stage1(&mut work, scene, view)?;
        self.stage2(&mut work, view)?;
        let picture = work.read_image("ink picture", &self.picture)?;
        let mut attributes = Vec::new();
        let mut lines = Vec::new();
        for (attribute, image) in self.targets.iter().filter(|t| wanted.contains(&t.0)) {
            attributes.push((*attribute, work.read_image(attribute.label(), image)?));
        }
        for image in self.lines.iter().filter(|_| !wanted.is_empty()) {
            lines.push(work.read_image("ink lines", image)?);
        }
        let mut done = work.submit()?.wait()?;
        let passes = done.passes().to_vec();
        Ok(Drawing {
            size: self.size,
            pixels: done.take(picture),
            passes,
            attributes: attributes
                .into_iter()
                .map(|(a, r)| (a, done.take(r)))
                .collect(),
            lines: lines.into_iter().map(|r| done.take(r)).collect(),
        })
    }

    /// The clusters as kernels see them in a view.
    #[must_use]
    pub fn cluster_records(&self, scene: &InkScene<'_>, view: &View) -> Vec<InkCluster> {
        let scale = f64::from(self.style.hatching.scale) * f64::from(self.factor);
        let least = scene.plant.leaf_radius;
        let clusters = scene.plant.clusters.clusters.iter();
        let record = |(number, cluster): (u32, &super::clusters::Cluster)| {
            let radius = f64::from(cluster.radius.max(least));
            let tiles = tiles_about(radius, self.reference, view.focal(), scale);
            let mut hatch = Hatch::stateless(view, cluster.centre.as_dvec3(), DVec2::splat(tiles));
            if self.style.hatching.scatter {
                hatch = hatch.scattered(number);
            }
            view.cluster(cluster, least, &hatch)
        };
        (0..).zip(clusters).map(record).collect()
    }

    fn stage1(&self, work: &mut Work, scene: &InkScene<'_>, view: &View) -> Result<()> {
        let leaf_set = [
            Binding::Read(&self.frame),
            Binding::Read(&self.leaves),
            Binding::Read(&self.clusters),
            Binding::Sampled(&self.shapes, &self.smooth),
        ];
        let wood_set = [
            Binding::Read(&self.frame),
            Binding::Read(&self.positions),
            Binding::Read(&self.normals),
            Binding::Read(&self.texcoords),
            Binding::Read(&self.hatches),
        ];
        let mut reads = leaf_set.to_vec();
        reads.extend(&wood_set[1..]);
        reads.push(Binding::Index(&self.indices));
        reads.extend(self.textures.iter().map(|(i, s)| Binding::Sampled(i, s)));
        let color: Vec<ColorTarget<'_>> = self
            .targets
            .iter()
            .map(|(_, image)| ColorTarget {
                image,
                clear: Some([0.0; 4]),
                resolve: None,
                store: true,
            })
            .collect();
        let pass = RenderPass {
            extent: self.size,
            color: &color,
            depth: Some(DepthTarget {
                image: &self.depth,
                clear: Some(0.0),
                store: false,
            }),
            reads: &reads,
        };
        work.render("ink stage 1", &pass, |draws| {
            draws.pipeline(&self.pipelines.wood);
            draws.bind(0, &wood_set)?;
            draws.index_buffer(&self.indices);
            for (material, instance, range) in &scene.plant.wood {
                let (image, sampler) = &self.textures[*material];
                draws.bind(1, &[Binding::Sampled(image, sampler)])?;
                draws.push(&self.wood_draw(scene.model, view, *material, *instance))?;
                draws.draw_indexed(range.clone(), 1)?;
            }
            draws.pipeline(&self.pipelines.leaves);
            draws.bind(0, &leaf_set)?;
            for (material, range) in &scene.plant.batches {
                let (image, sampler) = &self.textures[*material as usize];
                draws.bind(1, &[Binding::Sampled(image, sampler)])?;
                draws.push(&self.leaf_draw(scene.model, *material as usize))?;
                draws.draw(6 * range.start..6 * range.end, 1)?;
            }
            Ok(())
        })
    }

    fn leaf_draw(&self, model: &Model, material: usize) -> InkLeafDraw {
        let m = &model.materials[material];
        let [u, v] = m
            .base_color_texture
            .map_or([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], |t| t.transform);
        let (l, h) = (&self.style.leaves, &self.style.hatching);
        InkLeafDraw {
            base_color: m.base_color,
            texcoord_u: u,
            displacement: l.displacement,
            texcoord_v: v,
            orientation: l.orientation,
            facing: l.facing,
            size: l.size * self.style.enlargement(),
            shape: l.shape,
            kept: l.kept,
            crown: self.style.shading.crown,
            packing: h.packing,
        }
    }

    fn wood_draw(
        &self,
        model: &Model,
        view: &View,
        material: usize,
        instance: usize,
    ) -> InkWoodDraw {
        let m = &model.materials[material];
        let [u, v] = m
            .base_color_texture
            .map_or([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], |t| t.transform);
        let scale = f64::from(self.style.hatching.scale) * f64::from(self.factor);
        InkWoodDraw {
            base_color: m.base_color,
            texcoord_u: u,
            cutoff: match m.alpha_mode {
                AlphaMode::Opaque => -1.0,
                AlphaMode::Mask { cutoff } => cutoff,
                AlphaMode::Blend => 0.5,
            },
            texcoord_v: v,
            // Wood is no part of the clusters: a line goes between the two.
            object: (1 << 20) + instance as u32,
            tiles: (view.focal() / (self.reference * f64::from(INK_TILE) * scale)) as f32,
        }
    }

    /// The target of an attribute; a texel of nothing where the plan has none.
    fn target(&self, attribute: Attribute) -> Binding<'_> {
        let found = self.targets.iter().find(|t| t.0 == attribute);
        Binding::Sampled(found.map_or(&self.nothing, |t| &t.1), &self.plain)
    }

    fn line(&self, number: usize) -> Binding<'_> {
        Binding::Sampled(self.lines.get(number).unwrap_or(&self.nothing), &self.plain)
    }

    fn stage2(&self, work: &mut Work, view: &View) -> Result<()> {
        let [width, height] = self.size;
        let invocations = [width, height, 1];
        let p = &self.pipelines;
        if let (Some(contour), Some(clean)) = (&p.contour, &p.clean) {
            let bindings = [
                self.target(Attribute::Depth),
                self.target(Attribute::Ids),
                self.target(Attribute::Direction),
                Binding::StorageWrite(&self.lines[0]),
            ];
            let push = self.contour_push(view);
            work.compute("ink contour", contour, &bindings, &push, invocations)?;
            let push = InkClean {
                width,
                height,
                neighbours: self.style.contour.neighbours,
            };
            let bindings = [self.line(0), Binding::StorageWrite(&self.lines[1])];
            work.compute("ink clean", clean, &bindings, &push, invocations)?;
        }
        if let (Some(silhouette), Some(strokes)) = (&p.silhouette, &self.strokes) {
            let bindings = [
                self.target(Attribute::Ids),
                self.target(Attribute::Direction),
                self.target(Attribute::Normal),
                self.line(1),
                Binding::Sampled(strokes, &self.smooth),
                Binding::Read(&self.clusters),
                Binding::StorageWrite(&self.lines[2]),
            ];
            let s = &self.style.silhouette;
            let factor = self.factor as f32;
            let push = InkSilhouette {
                width,
                height,
                reach: (s.width * factor).round().max(1.0) as u32,
                band_length: s.length * factor,
                aspect: s.aspect,
                blend: u32::from(s.blend),
            };
            work.compute("ink silhouette", silhouette, &bindings, &push, invocations)?;
        }
        let tiles = self.tiles.as_ref().unwrap_or(&self.nothing);
        let bindings = [
            self.target(Attribute::Depth),
            self.target(Attribute::Albedo),
            self.target(Attribute::Normal),
            self.target(Attribute::Hatch),
            self.line(1),
            self.line(2),
            Binding::Sampled(tiles, &self.repeating),
            Binding::StorageWrite(&self.picture),
        ];
        work.compute(
            "ink compose",
            &p.compose,
            &bindings,
            &self.compose_push(),
            invocations,
        )
    }

    fn contour_push(&self, view: &View) -> InkContour {
        let c = &self.style.contour;
        let [nearest, mut farthest] = view.depths;
        let mapped = c.mapping > 0.0;
        if mapped {
            // The mapping's own range: its ratio is the strength of abstraction.
            farthest = nearest * c.mapping;
        }
        InkContour {
            width: self.size[0],
            height: self.size[1],
            threshold: c.threshold,
            threshold_wood: c.threshold_wood,
            mapping: if mapped {
                INK_DEPTH_MAPPED
            } else {
                INK_DEPTH_LINEAR
            },
            nearest,
            farthest,
            detail: c.detail,
            detail_power: c.detail_power,
        }
    }

    fn compose_push(&self) -> InkCompose {
        let s = &self.style;
        InkCompose {
            paper: s.paper.colour.map(srgb_to_linear),
            width: self.size[0],
            ink: s.paper.ink.map(srgb_to_linear),
            height: self.size[1],
            contour: s.contour.strength,
            silhouette: s.silhouette.strength,
            hatching: s.hatching.strength,
            colour: s.shading.colour,
            shading: s.shading.strength,
            half_width: 0.5 * s.contour.width * self.factor as f32,
            steps: s.shading.steps as f32,
            white: s.hatching.white,
            gamma: s.hatching.gamma,
        }
    }
}

fn pipelines(gpu: &Gpu, plan: &InkPlan, targets: &[(Attribute, Image)]) -> Result<Pipelines> {
    let formats: Vec<Format> = targets.iter().map(|t| t.0.format()).collect();
    let channels: Vec<(u32, u32)> = (0..).zip(targets).map(|(i, t)| (i, t.0.number())).collect();
    let stage1 = |name, vertex, fragments: [Shader; 6]| {
        gpu.graphics_pipeline(&GraphicsPipelineInfo {
            name,
            vertex,
            fragment: Some(fragments[targets.len() - 1]),
            color_formats: &formats,
            depth_format: Some(Format::Depth32),
            specialization: &channels,
            ..GraphicsPipelineInfo::default()
        })
    };
    let kernel = |wanted: bool, shader, constants: &[(u32, u32)]| {
        wanted
            .then(|| gpu.compute_pipeline_with(shader, constants))
            .transpose()
    };
    let switches = [
        plan.contour,
        plan.silhouette,
        plan.hatching,
        plan.shading,
        plan.colour,
    ];
    let switches: Vec<(u32, u32)> = (0..).zip(switches.map(u32::from)).collect();
    Ok(Pipelines {
        leaves: stage1("ink leaves", shaders::LEAF_VERT, LEAF_FRAGMENTS)?,
        wood: stage1("ink wood", shaders::WOOD_VERT, WOOD_FRAGMENTS)?,
        contour: kernel(
            plan.contour,
            shaders::CONTOUR_COMP,
            &[(0, u32::from(plan.detail))],
        )?,
        clean: kernel(plan.contour, shaders::CLEAN_COMP, &[])?,
        silhouette: kernel(plan.silhouette, shaders::SILHOUETTE_COMP, &[])?,
        compose: gpu.compute_pipeline_with(shaders::COMPOSE_COMP, &switches)?,
    })
}
