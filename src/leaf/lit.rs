//! The picture in two passes (Wang et al. 2005, section 5): the first draws the light of the sky
//! and between leaves from the transfer vectors into one of three targets, the second adds the
//! sun by what each pixel's leaf scatters, times the visibility of the disc.

use std::cell::OnceCell;
use std::sync::Arc;

use super::appearance::LeafMaterial;
use super::film::{Film, LitScene, film_axes, gloss, turns};
use super::gloss_rays::{GlossLight, GlossPixels};
use super::lit_lamps::{LampLight, LampRenderer, LampsOnDevice};
use super::lit_materials::LitMaterial;
use super::radiance_map::RadianceMap;
use super::shadow_map::{self, ShadowRenderer, ShadowSettings};
use crate::Result;
use crate::abi::LitFrame;
use crate::gpu::shaders::leaf as shaders;
use crate::gpu::{
    Binding, Buffer, BufferInfo, ColorTarget, ComputePipeline, DepthTarget, Format, Gpu,
    GraphicsPipeline, GraphicsPipelineInfo, Image, ImageInfo, PassTime, QueueKind, RenderPass,
    Sampler, SamplerInfo, Work,
};
use crate::scene::Model;

/// Targets of the first pass: light, surface, what the leaf makes of light.
const TARGETS: [(&str, Format); 4] = [
    ("sky light", Format::Rgba16Float),
    ("lit surface", Format::Rgba16Float),
    ("lit leaf", Format::Rgba32Uint),
    ("lit shine", Format::Rgba16Float),
];

/// One part of the model as it is drawn.
struct Part {
    material: usize,
    first_index: u32,
    index_count: u32,
}

/// Draws one model again and again under changing light.
pub struct LitRenderer {
    gpu: Gpu,
    size: [u32; 2],
    frame: Buffer,
    positions: Buffer,
    normals: Buffer,
    texcoords: Buffer,
    indices: Buffer,
    radiance: Buffer,
    visibility: Buffer,
    sides: Buffer,
    gloss: Buffer,
    turns: Buffer,
    materials: Vec<LitMaterial>,
    parts: Vec<Part>,
    targets: Vec<Image>,
    depth: Image,
    picture: Image,
    plain: Sampler,
    /// For materials without and with maps of their own.
    first: [GraphicsPipeline; 2],
    second: ComputePipeline,
    constants: [(u32, u32); 1],
    /// Made when the first lamp is drawn.
    lamps: OnceCell<LampRenderer>,
    /// Made when the first shadow map is drawn; its size stays.
    shadow: OnceCell<ShadowRenderer>,
}

/// Light on the vertices of the mesh that is drawn.
#[derive(Debug, Clone, Copy)]
pub struct VertexLight<'a> {
    /// What leaves the front and back of each vertex (sky and indirect light).
    pub radiance: &'a [[f32; 3]],
    /// Share of the sun's disc that each vertex sees, \[0, 1\].
    pub visibility: &'a [f32],
    /// Lamps near the scene.
    pub lamps: Option<LampLight<'a>>,
    /// The sun's shadows by a shadow map too, for pictures whose vertices see nothing of it.
    pub shadow: Option<ShadowSettings>,
    /// Surroundings in gloss, where `radiance` holds them as diffuse.
    pub gloss: Option<GlossLight<'a>>,
}

impl std::fmt::Debug for LitRenderer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "LitRenderer({}x{})", self.size[0], self.size[1])
    }
}

impl LitRenderer {
    /// Uploads `scene` for pictures of `size` pixels.
    ///
    /// # Errors
    /// A texture that cannot be decoded, or memory runs out.
    pub fn new(gpu: &Gpu, scene: &LitScene<'_>, size: [u32; 2]) -> Result<Self> {
        let g = scene.geometry;
        let vertices = g.positions.len() as u64;
        let device = |name: &str, bytes: u64| gpu.buffer(BufferInfo::device(name, bytes));
        let target =
            |(name, format): (&str, Format)| gpu.image(ImageInfo::target(name, format, size, 1));
        let formats = TARGETS.map(|t| t.1);
        let first = |mapped: u32| {
            gpu.graphics_pipeline(&GraphicsPipelineInfo {
                name: "lit",
                vertex: shaders::LIT_VERT,
                fragment: Some(shaders::LIT_FRAG),
                color_formats: &formats,
                depth_format: Some(Format::Depth32),
                specialization: &[(0, mapped)],
                ..GraphicsPipelineInfo::default()
            })
        };
        let (turns, constants) = turns(gpu, scene.receivers)?;
        let parts = g.parts.iter().filter(|p| p.index_count > 0);
        let mut out = Self {
            gpu: gpu.clone(),
            size,
            frame: device("lit frame", size_of::<LitFrame>() as u64)?,
            positions: gpu.upload("positions", &g.positions)?,
            normals: gpu.upload("normals", &g.normals)?,
            texcoords: gpu.upload("texcoords", &g.texcoords)?,
            indices: gpu.upload("indices", &g.indices)?,
            radiance: device("radiance", 24 * vertices)?,
            visibility: device("visibility", 4 * vertices)?,
            sides: gpu.upload("leaf sides", &scene.receivers.materials)?,
            gloss: gloss(gpu, scene.optics)?,
            turns,
            materials: Vec::new(),
            parts: parts
                .map(|part| Part {
                    material: part.material,
                    first_index: part.first_index as u32,
                    index_count: part.index_count as u32,
                })
                .collect(),
            targets: TARGETS.into_iter().map(target).collect::<Result<_>>()?,
            depth: target(("lit depth", Format::Depth32))?,
            picture: gpu.image(ImageInfo::storage("lit picture", Format::Rgba32Float, size))?,
            plain: gpu.sampler(&SamplerInfo::default())?,
            first: [first(0)?, first(1)?],
            second: gpu.compute_pipeline_with(shaders::LIT_SUN_COMP, &constants)?,
            constants,
            lamps: OnceCell::new(),
            shadow: OnceCell::new(),
        };
        out.wear(scene.model, &[])?;
        Ok(out)
    }

    /// Gives materials the maps of `leaves`, one for each material of the model; those without
    /// keep their base colour.
    ///
    /// # Errors
    /// A texture that cannot be decoded, or memory runs out.
    pub fn wear(&mut self, model: &Model, leaves: &[Option<Arc<LeafMaterial>>]) -> Result<()> {
        let leaf = |i: usize| leaves.get(i).and_then(Option::as_deref);
        let all = 0..model.materials.len();
        self.materials = all
            .map(|i| LitMaterial::new(&self.gpu, model, i, leaf(i)))
            .collect::<Result<_>>()?;
        Ok(())
    }

    /// Bytes on the device for light that changes and for targets.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let targets: u64 = self.targets.iter().map(|t| t.info().bytes()).sum();
        let others = self.depth.info().bytes() + self.picture.info().bytes();
        targets + others + self.radiance.bytes() + self.visibility.bytes()
    }

    /// Draws under `light`. Also the device times.
    ///
    /// # Errors
    /// When memory runs out or the device is lost.
    pub fn draw(
        &self,
        scene: &LitScene<'_>,
        film: &Film,
        light: &VertexLight<'_>,
    ) -> Result<(RadianceMap, Vec<PassTime>)> {
        let frame = self.frame(scene, film);
        let lamps = match &light.lamps {
            Some(lamps) if !lamps.lamps.is_empty() => {
                let device = LampsOnDevice::new(&self.gpu, lamps, scene.geometry.origin)?;
                let renderer = made(&self.lamps, || {
                    LampRenderer::new(&self.gpu, self.size, &self.constants)
                })?;
                Some((renderer, device))
            }
            _ => None,
        };
        let mut work = self.gpu.work(QueueKind::Graphics, "lit picture")?;
        work.upload("lit frame", &self.frame, &[frame])?;
        work.upload("radiance", &self.radiance, light.radiance)?;
        work.upload("visibility", &self.visibility, light.visibility)?;
        self.surfaces(&mut work)?;
        self.sun(&mut work)?;
        if let Some(settings) = light.shadow {
            let renderer = made(&self.shadow, || {
                ShadowRenderer::new(&self.gpu, settings.size, &self.constants)
            })?;
            let points = &scene.geometry.positions;
            let view = shadow_map::view(film.sun.towards, points, settings);
            work.upload("shadow view", &renderer.view, &[view])?;
            self.add_shadowed_sun(&mut work, renderer)?;
        }
        if let Some((renderer, device)) = &lamps {
            self.add_lamps(&mut work, renderer, device)?;
        }
        let mut times = Vec::new();
        if let Some(gloss) = &light.gloss {
            times.extend_from_slice(work.submit()?.wait()?.passes());
            times.extend(gloss.rays.add(&self.gloss_pixels(), gloss)?);
            work = self.gpu.work(QueueKind::Graphics, "lit picture")?;
        }
        let picture = work.read_image("lit picture", &self.picture)?;
        let mut done = work.submit()?.wait()?;
        times.extend_from_slice(done.passes());
        let bytes = done.take(picture);
        let map = RadianceMap {
            width: self.size[0] as usize,
            height: self.size[1] as usize,
            pixels: bytemuck::pod_collect_to_vec(&bytes),
        };
        Ok((map, times))
    }

    fn gloss_pixels(&self) -> GlossPixels<'_> {
        GlossPixels {
            frame: &self.frame,
            surface: &self.targets[1],
            leaf: &self.targets[2],
            shine: &self.targets[3],
            depth: &self.depth,
            plain: &self.plain,
            picture: &self.picture,
        }
    }

    fn frame(&self, scene: &LitScene<'_>, film: &Film) -> LitFrame {
        let [right, up] = film_axes(&film.camera);
        LitFrame {
            relative_to_clip: film
                .camera
                .relative_to_clip(scene.geometry.origin)
                .to_cols_array_2d(),
            forward: film.camera.forward.as_vec3().to_array(),
            width: self.size[0],
            right: right.to_array(),
            height: self.size[1],
            up: up.to_array(),
            near: film.camera.near as f32,
            eye: (film.camera.eye - scene.geometry.origin)
                .as_vec3()
                .to_array(),
            sun: film.sun.towards.as_vec3().to_array(),
            irradiance: film.sun.irradiance.as_vec3().to_array(),
        }
    }

    /// Draws the model into colour targets and a depth target. Of two pipelines the second is for
    /// materials with maps.
    fn raster(
        &self,
        work: &mut Work,
        label: &'static str,
        (pipelines, targets, depth): (&[GraphicsPipeline], &[Image], &Image),
        vertex_reads: &[Binding<'_>],
    ) -> Result<()> {
        let maps = pipelines.len() > 1;
        let mut reads = vertex_reads.to_vec();
        reads.push(Binding::Index(&self.indices));
        for material in &self.materials {
            reads.push(Binding::Sampled(&material.base, &material.sampler));
            if maps {
                let maps = material.maps.iter();
                reads.extend(maps.map(|map| Binding::Sampled(map, &material.sampler)));
            }
        }
        let color: Vec<ColorTarget<'_>> = targets
            .iter()
            .map(|image| ColorTarget {
                image,
                clear: Some([0.0; 4]),
                resolve: None,
                store: true,
            })
            .collect();
        let pass = RenderPass {
            extent: depth.info().extent,
            color: &color,
            depth: Some(DepthTarget {
                image: depth,
                clear: Some(0.0),
                store: true,
            }),
            reads: &reads,
        };
        work.render(label, &pass, |draws| {
            draws.index_buffer(&self.indices);
            for part in &self.parts {
                let material = &self.materials[part.material];
                draws.pipeline(&pipelines[usize::from(maps && material.mapped)]);
                draws.bind(0, vertex_reads)?;
                let mut textures = vec![Binding::Sampled(&material.base, &material.sampler)];
                if maps {
                    let maps = material.maps.iter();
                    textures.extend(maps.map(|map| Binding::Sampled(map, &material.sampler)));
                }
                draws.bind(1, &textures)?;
                draws.push(&material.draw)?;
                let last = part.first_index + part.index_count;
                draws.draw_indexed(part.first_index..last, 1)?;
            }
            Ok(())
        })
    }

    /// First pass.
    fn surfaces(&self, work: &mut Work) -> Result<()> {
        let reads = [
            Binding::Read(&self.frame),
            Binding::Read(&self.positions),
            Binding::Read(&self.normals),
            Binding::Read(&self.texcoords),
            Binding::Read(&self.radiance),
            Binding::Read(&self.visibility),
            Binding::Read(&self.sides),
            Binding::Read(&self.gloss),
        ];
        let into = (self.first.as_slice(), self.targets.as_slice(), &self.depth);
        self.raster(work, "sky and leaf light", into, &reads)
    }

    /// Second pass.
    fn sun(&self, work: &mut Work) -> Result<()> {
        work.compute(
            "sun",
            &self.second,
            &[
                Binding::Read(&self.frame),
                Binding::Read(&self.turns),
                Binding::Sampled(&self.targets[0], &self.plain),
                Binding::Sampled(&self.targets[1], &self.plain),
                Binding::Sampled(&self.targets[2], &self.plain),
                Binding::Sampled(&self.targets[3], &self.plain),
                Binding::StorageWrite(&self.picture),
            ],
            &(),
            [self.size[0], self.size[1], 1],
        )
    }

    /// The sun by a shadow map.
    fn add_shadowed_sun(&self, work: &mut Work, renderer: &ShadowRenderer) -> Result<()> {
        let reads = [
            Binding::Read(&renderer.view),
            Binding::Read(&self.positions),
            Binding::Read(&self.texcoords),
        ];
        let one = std::slice::from_ref(&renderer.first);
        let into = (one, [].as_slice(), &renderer.map);
        self.raster(work, "shadow map", into, &reads)?;
        work.compute(
            "sun by shadow map",
            &renderer.second,
            &[
                Binding::Read(&self.frame),
                Binding::Read(&self.turns),
                Binding::Read(&renderer.view),
                Binding::Sampled(&self.targets[1], &self.plain),
                Binding::Sampled(&self.targets[2], &self.plain),
                Binding::Sampled(&self.targets[3], &self.plain),
                Binding::Sampled(&self.depth, &self.plain),
                Binding::Sampled(&renderer.map, &self.plain),
                Binding::StorageReadWrite(&self.picture),
            ],
            &(),
            [self.size[0], self.size[1], 1],
        )
    }

    /// Both passes again for every four lamps.
    fn add_lamps(
        &self,
        work: &mut Work,
        renderer: &LampRenderer,
        device: &LampsOnDevice,
    ) -> Result<()> {
        for (pass, visibility) in &device.passes {
            let reads = [
                Binding::Read(&self.frame),
                Binding::Read(&self.positions),
                Binding::Read(&self.texcoords),
                Binding::Read(visibility),
            ];
            let target = std::slice::from_ref(&renderer.target);
            let one = std::slice::from_ref(&renderer.first);
            let into = (one, target, &self.depth);
            self.raster(work, "surfaces for lamps", into, &reads)?;
            work.compute(
                "lamps",
                &renderer.second,
                &[
                    Binding::Read(&self.frame),
                    Binding::Read(&self.turns),
                    Binding::Read(&device.records),
                    Binding::Read(&device.points),
                    Binding::Sampled(&self.targets[1], &self.plain),
                    Binding::Sampled(&self.targets[2], &self.plain),
                    Binding::Sampled(&self.targets[3], &self.plain),
                    Binding::Sampled(&self.depth, &self.plain),
                    Binding::Sampled(&renderer.target, &self.plain),
                    Binding::StorageReadWrite(&self.picture),
                ],
                pass,
                [self.size[0], self.size[1], 1],
            )?;
        }
        Ok(())
    }
}

/// What `cell` holds, made when it holds nothing.
fn made<T>(cell: &OnceCell<T>, make: impl FnOnce() -> Result<T>) -> Result<&T> {
    if let Some(found) = cell.get() {
        return Ok(found);
    }
    let new = make()?;
    Ok(cell.get_or_init(|| new))
}
