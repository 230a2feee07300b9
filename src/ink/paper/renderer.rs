//! The pictures that lines are found in: depth and numbers of primitives, depth and light of stems,
//! each with its differences (Deussen and Strothotte 2000, section 3.4: stem and foliage apart).

use bytemuck::pod_collect_to_vec;
use glam::DVec2;

use super::drawing::Placement;
use super::eye::Eye;
use super::factors::{Factors, Read};
use super::inks::Inks;
use super::laid::has_strokes;
use super::limbs::{LimbPoint, in_picture, thin};
use super::particles::{Particle, records};
use super::polygon;
use super::silhouette::silhouettes;
use super::style::{Form, PaperStyle, ShadowForm};
use super::sun::SunMap;
use super::tones::Tones;
use crate::abi::{
    InkFrame, PAPER_WIDER, PaperBitmap, PaperDifference, PaperEllipse, PaperParticle,
    PaperPrimitive, PaperStem,
};
use crate::gpu::shaders::ink as shaders;
use crate::gpu::{
    Binding, Buffer, BufferInfo, ComputePipeline, Format, Gpu, GraphicsPipeline,
    GraphicsPipelineInfo, Image, ImageInfo, PassTime, QueueKind, Sampler, SamplerInfo, Shader,
    Work,
};
use crate::ink::branches::limbs::{self, Limbs};
use crate::ink::view::View;
use crate::math::colour::srgb_to_linear;
use crate::scene::Geometry;
use crate::{Error, Result};

/// Light from all around on stems.
const AMBIENT: f32 = 0.2;
/// Numbers of particles are floats in their target.
const MOST_PARTICLES: usize = 1 << 24;

/// What is drawn on paper.
#[derive(Debug, Clone, Copy)]
pub struct PaperScene<'a> {
    /// Triangles of trunk and branches.
    pub geometry: &'a Geometry,
    /// Triangle list of them, indices into the geometry's vertices.
    pub stems: &'a [u32],
    /// Foliage, then ground.
    pub particles: &'a [Particle],
    /// How many of them are foliage.
    pub leaves: usize,
}

/// Pictures of one view, row by row.
#[derive(Debug, Clone, Default)]
pub struct Maps {
    /// Pixels across and down.
    pub size: [usize; 2],
    /// Eye depth of foliage; 0 where there is none.
    pub foliage_depth: Vec<f32>,
    /// Number of the particle plus 1.
    pub foliage_number: Vec<u32>,
    /// Depth differences of foliage.
    pub foliage_difference: Vec<f32>,
    /// Eye depth of stems; 0 where there are none.
    pub stem_depth: Vec<f32>,
    /// Depth differences of stems.
    pub stem_difference: Vec<f32>,
    /// Normal of stems in the camera's frame, and light.
    pub stem_normal: Vec<[f32; 4]>,
    /// Axes of branches, seen and hidden.
    pub limbs: Vec<Vec<LimbPoint>>,
    /// Silhouettes of stems, seen and hidden, pixels.
    pub silhouettes: Vec<[DVec2; 2]>,
    /// How deep pixels lie in shadow, 0 to 1; empty where the style has none.
    pub shadow: Vec<f32>,
    /// Factors on threshold and width of what is seen; empty where the style has none.
    pub factors: Vec<[f32; 2]>,
    /// How many of the particles are foliage; the others are ground.
    pub leaves: usize,
    /// The particles as they were drawn.
    pub particles: Vec<PaperParticle>,
    /// Device times.
    pub passes: Vec<PassTime>,
}

/// A picture of one view.
#[derive(Debug, Clone, Default)]
pub struct Bitmap {
    /// RGBA, 16-bit floats, linear, row by row.
    pub pixels: Vec<u8>,
    /// Depths, normals of stems and shadow, where the style has strokes.
    pub maps: Option<Maps>,
    /// Device times.
    pub passes: Vec<PassTime>,
}

/// Draws particles and stems of one scene in one style.
pub struct PaperRenderer {
    gpu: Gpu,
    style: PaperStyle,
    size: [u32; 2],
    frame: Buffer,
    particles: Buffer,
    outlines: Buffer,
    corners: Buffer,
    /// Points of an outline.
    points: u32,
    positions: Buffer,
    normals: Buffer,
    indices: Buffer,
    radii: Buffer,
    limbs: Limbs,
    foliage: [Image; 3],
    stems: [Image; 3],
    depth: Image,
    plain: Sampler,
    primitive: GraphicsPipeline,
    stem: GraphicsPipeline,
    difference: ComputePipeline,
    sun: Option<SunMap>,
    factors: Option<Factors>,
}

impl std::fmt::Debug for PaperRenderer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "PaperRenderer({}x{})", self.size[0], self.size[1])
    }
}

/// Outlines, and whether the fragment finds them (discs and ellipses) rather than triangles.
fn is_round(style: &PaperStyle) -> bool {
    matches!(style.primitive.form, Form::Disc | Form::Ellipse)
}

fn aspect(style: &PaperStyle) -> f64 {
    if style.primitive.form == Form::Disc {
        1.0
    } else {
        style.primitive.aspect
    }
}

impl PaperRenderer {
    /// Uploads the scene for pictures of `size` pixels.
    ///
    /// # Errors
    /// Memory runs out, more than 16 million particles.
    pub fn new(
        gpu: &Gpu,
        scene: &PaperScene<'_>,
        style: &PaperStyle,
        size: [u32; 2],
    ) -> Result<Self> {
        if scene.particles.len() >= MOST_PARTICLES {
            return Err(Error::usage(format!(
                "{} particles: a drawing takes at most {MOST_PARTICLES}; thin them (primitive.count)",
                scene.particles.len()
            )));
        }
        let views = polygon::views(&style.primitive).map_err(Error::usage)?;
        let outlines: Vec<[f32; 2]> = views
            .iter()
            .flatten()
            .map(|p| p.as_vec2().to_array())
            .collect();
        let g = scene.geometry;
        let count = scene.particles.len().max(1) as u64;
        let target = |name: &str, format| gpu.image(ImageInfo::target(name, format, size, 1));
        let difference = |name: &str| gpu.image(ImageInfo::storage(name, Format::R32Float, size));
        let pipeline = |name, vertex, fragment, formats: &[Format]| {
            gpu.graphics_pipeline(&GraphicsPipelineInfo {
                name,
                vertex,
                fragment: Some(fragment),
                color_formats: formats,
                depth_format: Some(Format::Depth32),
                ..GraphicsPipelineInfo::default()
            })
        };
        let (vertex, fragment): (Shader, Shader) = if is_round(style) {
            (shaders::ELLIPSE_VERT, shaders::ELLIPSE_FRAG)
        } else {
            (shaders::PRIMITIVE_VERT, shaders::PRIMITIVE_FRAG)
        };
        let factors = Factors::new(gpu, scene, style, size)?;
        let shadow = style.shadow.form != ShadowForm::None;
        let limbs = limbs::limbs(&g.positions, scene.stems);
        Ok(Self {
            gpu: gpu.clone(),
            style: style.clone(),
            size,
            frame: gpu.buffer(BufferInfo::device(
                "paper frame",
                size_of::<InkFrame>() as u64,
            ))?,
            particles: gpu.buffer(BufferInfo::device(
                "paper particles",
                count * size_of::<PaperParticle>() as u64,
            ))?,
            outlines: gpu.upload("paper outlines", &outlines)?,
            corners: gpu.upload("paper corners", &polygon::triangles(&views))?,
            points: views[0].len() as u32,
            positions: gpu.upload("positions", &g.positions)?,
            normals: gpu.upload("normals", &g.normals)?,
            indices: gpu.upload("stem indices", scene.stems)?,
            radii: gpu.upload("stem radii", &limbs.radius)?,
            limbs,
            foliage: [
                target("foliage depth", Format::R32Float)?,
                target("foliage number", Format::R32Float)?,
                difference("foliage difference")?,
            ],
            stems: [
                target("stem depth", Format::R32Float)?,
                target("stem normal", Format::Rgba16Float)?,
                difference("stem difference")?,
            ],
            depth: target("paper depth test", Format::Depth32)?,
            plain: gpu.sampler(&SamplerInfo::default())?,
            primitive: pipeline("paper primitives", vertex, fragment, &[Format::R32Float; 2])?,
            stem: pipeline(
                "paper stems",
                shaders::STEM_VERT,
                shaders::STEM_FRAG,
                &[Format::R32Float, Format::Rgba16Float],
            )?,
            difference: gpu.compute_pipeline(shaders::DIFFERENCE_COMP)?,
            sun: (shadow || factors.as_ref().is_some_and(|f| f.shadow))
                .then(|| SunMap::new(gpu, size))
                .transpose()?,
            factors,
        })
    }

    /// Everything that lines are found in, for vectors.
    ///
    /// # Errors
    /// Memory runs out or the device is lost.
    pub fn maps(&self, scene: &PaperScene<'_>, view: &View) -> Result<Maps> {
        let scale = Placement::new(&self.style, self.size.map(|s| s as usize)).scale;
        let (mut work, particles) = self.begin(scene, view, scale)?;
        let reads = [
            work.read_image("foliage depth", &self.foliage[0])?,
            work.read_image("foliage number", &self.foliage[1])?,
            work.read_image("foliage difference", &self.foliage[2])?,
            work.read_image("stem depth", &self.stems[0])?,
            work.read_image("stem difference", &self.stems[2])?,
            work.read_image("stem normal", &self.stems[1])?,
        ];
        let shadow = match &self.sun {
            Some(sun) => Some(work.read_image("shadow", &sun.shadow)?),
            None => None,
        };
        let factors = match &self.factors {
            Some(factors) => Some(work.read_image("factors", &factors.image)?),
            None => None,
        };
        let mut done = work.submit()?.wait()?;
        if let Some(sun) = &self.sun {
            sun.rests(view, &particles, !is_round(&self.style));
        }
        let passes = done.passes().to_vec();
        let [a, b, c, d, e, f] = reads.map(|r| done.take(r));
        let numbers: Vec<f32> = pod_collect_to_vec(&b);
        let halves: Vec<[u16; 4]> = pod_collect_to_vec(&f);
        let factors = factors.map_or_else(Vec::new, |f| pod_collect_to_vec(&done.take(f)));
        let two = |h: &[u16; 4]| [h[0], h[1]].map(crate::math::packing::f16_to_f32);
        Ok(Maps {
            size: self.size.map(|s| s as usize),
            foliage_depth: pod_collect_to_vec(&a),
            foliage_number: numbers.iter().map(|&n| n as u32).collect(),
            foliage_difference: pod_collect_to_vec(&c),
            stem_depth: pod_collect_to_vec(&d),
            stem_difference: pod_collect_to_vec(&e),
            stem_normal: halves
                .iter()
                .map(|h| h.map(crate::math::packing::f16_to_f32))
                .collect(),
            limbs: in_picture(&self.limbs, view),
            silhouettes: if self.style.stem.draw {
                silhouettes(scene.geometry, scene.stems, view)
            } else {
                Vec::new()
            },
            shadow: shadow.map_or_else(Vec::new, |s| pod_collect_to_vec(&done.take(s))),
            factors: factors.iter().map(two).collect(),
            leaves: scene.leaves,
            particles,
            passes,
        })
    }

    /// The drawing as pixels, `factor` of them for one of the picture. Strokes that the style has on
    /// stems and in shadow are not among them: [`Bitmap::maps`] has what `laid` finds them by.
    ///
    /// # Errors
    /// Memory runs out or the device is lost.
    pub fn bitmap(&self, scene: &PaperScene<'_>, view: &View, factor: u32) -> Result<Bitmap> {
        let scale = 1.0 / (self.style.sheet.resolution * f64::from(factor));
        let (mut work, particles) = self.begin(scene, view, scale)?;
        let switches = [
            (0, u32::from(self.sun.is_some())),
            (1, u32::from(self.factors.is_some())),
        ];
        let kernel = self
            .gpu
            .compute_pipeline_with(shaders::BITMAP_COMP, &switches)?;
        let picture = self.gpu.image(ImageInfo::storage(
            "paper picture",
            Format::Rgba16Float,
            self.size,
        ))?;
        let sampled = |image| Binding::Sampled(image, &self.plain);
        let bindings = [
            sampled(&self.foliage[0]),
            sampled(&self.foliage[1]),
            sampled(&self.foliage[2]),
            sampled(&self.stems[0]),
            sampled(&self.stems[2]),
            Binding::Read(&self.particles),
            // Never read where there is no shadow.
            sampled(self.sun.as_ref().map_or(&self.stems[2], |s| &s.shadow)),
            sampled(self.factors.as_ref().map_or(&self.stems[2], |f| &f.image)),
            Binding::StorageWrite(&picture),
        ];
        let push = self.bitmap_push(factor, scene.leaves);
        work.compute(
            "paper bitmap",
            &kernel,
            &bindings,
            &push,
            [self.size[0], self.size[1], 1],
        )?;
        let read = work.read_image("paper picture", &picture)?;
        let tones = if has_strokes(&self.style) {
            let shadow = self.sun.as_ref().map(|s| &s.shadow);
            let numbers = self.style.tiles.strength > 0.0 || self.style.ground.colour.is_some();
            let (foliage, stems) = (&self.foliage, &self.stems);
            Some(Tones::read(&mut work, foliage, stems, shadow, numbers)?)
        } else {
            None
        };
        let mut done = work.submit()?.wait()?;
        if let Some(sun) = &self.sun {
            sun.rests(view, &particles, !is_round(&self.style));
        }
        Ok(Bitmap {
            passes: done.passes().to_vec(),
            pixels: done.take(read),
            maps: tones.map(|t| Maps {
                particles,
                limbs: in_picture(&self.limbs, view),
                ..t.maps(&mut done, self.size, scene.leaves)
            }),
        })
    }

    fn bitmap_push(&self, factor: u32, leaves: usize) -> PaperBitmap {
        let s = &self.style;
        let detail = s.shadow.form == ShadowForm::Detail;
        let black = s.shadow.form == ShadowForm::Black;
        // A line that nobody wants is one that no difference reaches.
        let threshold = |draw: bool, t: f64| if draw { t as f32 } else { f32::INFINITY };
        let half = |width: f64| (0.5 * width * s.sheet.resolution * f64::from(factor)) as f32;
        let inks = Inks::of(s).linear();
        PaperBitmap {
            paper: s.sheet.colour.map(srgb_to_linear),
            width: self.size[0],
            ink: inks.foliage,
            height: self.size[1],
            stem_ink: inks.stem,
            shadow_ink: inks.shadow,
            ground_ink: inks.ground,
            foliage: threshold(s.foliage.draw, s.foliage.threshold),
            stem: threshold(s.stem.draw, s.stem.threshold),
            foliage_width: half(s.foliage.pen.width),
            stem_width: half(s.stem.pen.width),
            lower: u32::from(s.primitive.lower),
            leaves: leaves as u32,
            detail: if detail { s.shadow.detail as f32 } else { 0.0 },
            black: if black { s.shadow.black as f32 } else { 2.0 },
            pressure: if detail {
                s.shadow.pressure as f32
            } else {
                0.0
            },
            widest: self
                .factors
                .as_ref()
                .map_or(1.0, |f| f.widest.clamp(1.0, PAPER_WIDER)),
        }
    }

    /// Depths and differences; a pixel is `scale` millimetres.
    fn begin(
        &self,
        scene: &PaperScene<'_>,
        view: &View,
        scale: f64,
    ) -> Result<(Work, Vec<PaperParticle>)> {
        let particles = records(scene.particles, scene.leaves, &self.style, view);
        let mut work = self.gpu.work(QueueKind::Graphics, "paper")?;
        work.upload("paper frame", &self.frame, &[view.frame()])?;
        if !particles.is_empty() {
            work.upload("paper particles", &self.particles, &particles)?;
        }
        let eye = Eye {
            name: ["paper foliage", "paper stems"],
            frame: &self.frame,
            foliage: &self.foliage,
            stems: &self.stems,
            depth: &self.depth,
            extent: self.size,
        };
        self.draw_foliage(&mut work, &eye, particles.len() as u32)?;
        self.draw_stems(&mut work, &eye, scene, thin(&self.style, scale))?;
        let push = self.difference_push(view, 0.0);
        self.differences(&mut work, "foliage differences", &self.foliage, &push)?;
        let push = self.difference_push(view, self.style.stem.slope as f32);
        self.differences(&mut work, "stem differences", &self.stems, &push)?;
        if let Some(sun) = &self.sun {
            // A resting sun sees the same as in the drawing before.
            if !sun.shows(view, &particles, !is_round(&self.style)) {
                let (eye, frame) = sun.eye(scene.geometry, view);
                work.upload("sun frame", &sun.frame, &[frame])?;
                // Ground throws no shadow.
                self.draw_foliage(&mut work, &eye, scene.leaves as u32)?;
                self.draw_stems(&mut work, &eye, scene, 0.0)?;
            }
            self.sunlit(&mut work, sun, (view, scene.leaves))?;
        }
        if let Some(factors) = &self.factors {
            let read = Read {
                frame: &self.frame,
                foliage: [&self.foliage[0], &self.foliage[1]],
                stems: [&self.stems[0], &self.stems[1]],
                shadow: self.sun.as_ref().map(|s| &s.shadow),
            };
            let range = self.difference_push(view, 0.0);
            factors.run(&mut work, &read, &self.plain, &range, AMBIENT)?;
        }
        Ok((work, particles))
    }

    fn sunlit(&self, work: &mut Work, sun: &SunMap, (view, leaves): (&View, usize)) -> Result<()> {
        let sampled = |image| Binding::Sampled(image, &self.plain);
        let bindings = [
            Binding::Read(&self.frame),
            Binding::Read(&sun.frame),
            Binding::Read(&self.particles),
            sampled(&self.foliage[0]),
            sampled(&self.foliage[1]),
            sampled(&self.stems[0]),
            sampled(&sun.foliage[0]),
            sampled(&sun.stems[0]),
            Binding::StorageWrite(&sun.shadow),
        ];
        let push = sun.push(&self.style, (self.size, leaves), view);
        work.compute(
            "paper shadow",
            &sun.kernel,
            &bindings,
            &push,
            [self.size[0], self.size[1], 1],
        )
    }

    fn draw_foliage(&self, work: &mut Work, eye: &Eye<'_>, count: u32) -> Result<()> {
        let set = [
            Binding::Read(eye.frame),
            Binding::Read(&self.particles),
            Binding::Read(&self.outlines),
            Binding::Read(&self.corners),
        ];
        let round = is_round(&self.style);
        let set = if round { &set[..2] } else { &set[..] };
        let p = &self.style.primitive;
        eye.pass(work, 0, set, |draws| {
            draws.pipeline(&self.primitive);
            draws.bind(0, set)?;
            if round {
                draws.push(&PaperEllipse {
                    aspect: aspect(&self.style) as f32,
                    deformation: p.deformation as f32,
                })?;
                return draws.draw(0..3 * count, 1);
            }
            draws.push(&PaperPrimitive {
                points: self.points,
                views: (self.outlines.bytes() / (u64::from(self.points) * 8)) as u32,
                deformation: p.deformation as f32,
            })?;
            draws.draw(0..3 * self.points * count, 1)
        })
    }

    /// Branches of at least `thin` pixels.
    fn draw_stems(
        &self,
        work: &mut Work,
        eye: &Eye<'_>,
        scene: &PaperScene<'_>,
        thin: f64,
    ) -> Result<()> {
        let set = [
            Binding::Read(eye.frame),
            Binding::Read(&self.positions),
            Binding::Read(&self.normals),
            Binding::Read(&self.radii),
        ];
        let mut reads = set.to_vec();
        reads.push(Binding::Index(&self.indices));
        eye.pass(work, 1, &reads, |draws| {
            draws.pipeline(&self.stem);
            draws.bind(0, &set)?;
            draws.index_buffer(&self.indices);
            let thin = thin as f32;
            draws.push(&PaperStem {
                ambient: AMBIENT,
                thin,
            })?;
            draws.draw_indexed(0..scene.stems.len() as u32, 1)
        })
    }

    fn difference_push(&self, view: &View, slope: f32) -> PaperDifference {
        let d = &self.style.depth;
        let [nearest, farthest] = d.metres(view.depths);
        PaperDifference {
            width: self.size[0],
            height: self.size[1],
            mapped: u32::from(d.mapped),
            sky_at_far: u32::from(d.sky_at_far),
            nearest,
            farthest,
            near: d.near as f32,
            far: d.far as f32,
            slope,
        }
    }

    fn differences(
        &self,
        work: &mut Work,
        name: &str,
        images: &[Image; 3],
        push: &PaperDifference,
    ) -> Result<()> {
        let bindings = [
            Binding::Sampled(&images[0], &self.plain),
            Binding::StorageWrite(&images[2]),
        ];
        work.compute(
            name,
            &self.difference,
            &bindings,
            push,
            [self.size[0], self.size[1], 1],
        )
    }
}

/// Outlines in the picture of every particle of `maps`, pixels.
#[must_use]
pub fn outlines(maps: &Maps, style: &PaperStyle, view: &View) -> Vec<Vec<DVec2>> {
    use rayon::prelude::*;
    let Ok(views) = polygon::views(&style.primitive) else {
        return Vec::new();
    };
    // Of the ground only the shadow is drawn.
    maps.particles[..maps.leaves]
        .par_iter()
        .map(|p| super::particles::outline(p, &views, style.primitive.deformation, view))
        .collect()
}
