//! A picture: the order of its passes, and what is read back.

use glam::DVec2;

use super::looks::Light;
use super::order::{self, INDICES};
use super::pipelines::Stage1Pipelines;
use super::stage2::Stage2;
use super::styles::Styles;
use super::sun::SunMap;
use super::targets::Targets;
use super::uploads::Uploads;
use crate::Result;
use crate::abi::{InkCluster, InkFrame};
use crate::gpu::{Buffer, BufferInfo, Gpu, PassTime, QueueKind, Work};
use crate::ink::clusters::Cluster;
use crate::ink::mix::{Mix, MixPlan};
use crate::ink::motion::Course;
use crate::ink::plan::Attribute;
use crate::ink::plant::Plant;
use crate::ink::style::{Hatching, Style};
use crate::ink::view::{Hatch, View, tiles_about};
use crate::scene::{Geometry, Model};

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
    /// Sun, sky, shadow and tone (16-bit floats), as far as a style tells them apart and attributes
    /// were asked for.
    pub light: Vec<u8>,
}

/// Draws plants in one or several styles from any view.
pub struct InkRenderer {
    pub(super) gpu: Gpu,
    pub(super) size: [u32; 2],
    /// Pixels of this picture for one of the final one: widths in pixels grow by it.
    pub(super) factor: u32,
    /// Metres of a pixel where strokes have the style's size: strokes stay on their clusters, and
    /// grow and shrink with them, when the eye moves.
    pub(super) reference: f64,
    /// Courses of the clusters' hatching; without them it follows from each view alone.
    courses: Option<Vec<Course>>,
    pub(super) frame: Buffer,
    pub(super) clusters: Buffer,
    /// Indices of the leaves that a view draws.
    pub(super) order: Buffer,
    pub(super) uploads: Uploads,
    pub(super) targets: Targets,
    pub(super) stage1: Stage1Pipelines,
    pub(super) plan: MixPlan,
    pub(super) styles: Styles,
    pub(super) stage2: Vec<Stage2>,
    pub(super) light: Option<Light>,
}

impl std::fmt::Debug for InkRenderer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "InkRenderer({}x{})", self.size[0], self.size[1])
    }
}

impl InkRenderer {
    /// Uploads the plant, which was gathered for the styles of `mix`, and makes what they need for
    /// pictures of the size of `view`, of whose pixels `factor` along each axis become one. Strokes
    /// have the styles' size in that view.
    ///
    /// # Errors
    /// A texture that cannot be decoded, a mix that does not fit the scene or the picture, or
    /// memory runs out.
    pub fn new(
        gpu: &Gpu,
        scene: &InkScene<'_>,
        mix: &Mix,
        view: &View,
        factor: u32,
    ) -> Result<Self> {
        let plan = MixPlan::new(mix);
        let clusters = scene.plant.first_clusters()[mix.styles.len()].max(1) as usize;
        let stage2 = (0..).zip(&mix.styles);
        let device = |name, bytes: usize| gpu.buffer(BufferInfo::device(name, bytes as u64));
        Ok(Self {
            gpu: gpu.clone(),
            size: view.size,
            factor,
            reference: view.middle_distance() / view.focal(),
            courses: None,
            frame: device("ink frame", size_of::<InkFrame>())?,
            clusters: device("ink clusters", clusters * size_of::<InkCluster>())?,
            order: device(
                "ink order",
                scene.plant.leaves.len() * INDICES * size_of::<u32>(),
            )?,
            uploads: Uploads::new(gpu, scene, &mix.styles)?,
            targets: Targets::new(gpu, &plan, view.size)?,
            stage1: Stage1Pipelines::new(gpu, &plan)?,
            styles: Styles::new(gpu, scene, mix, view, factor)?,
            stage2: stage2
                .map(|one| Stage2::new(gpu, &plan, one, view.size))
                .collect::<Result<_>>()?,
            light: Light::new(gpu, (mix, &plan), scene, view)?,
            plan,
        })
    }

    /// How many leaves a view draws.
    #[must_use]
    pub fn drawn_leaves(&self, scene: &InkScene<'_>, view: &View) -> usize {
        order::drawn(scene, &self.styles, view, self.factor).len()
    }

    /// Takes the hatching of the next views from `courses`, one for each cluster; with none, from
    /// each view alone.
    pub fn follow(&mut self, courses: Option<&[Course]>) {
        self.courses = courses.map(<[Course]>::to_vec);
    }

    /// Draws in another style from now on, of the same plant with the same clusters. Where it takes
    /// the same images and passes, none is made anew: what a slider needs.
    ///
    /// # Errors
    /// As [`InkRenderer::new`].
    pub fn restyle(&mut self, scene: &InkScene<'_>, style: &Style, view: &View) -> Result<()> {
        let mix = Mix::single(style.clone());
        let map = SunMap::new(scene, &mix.styles, view);
        let texels = self.light.as_ref().map(|l| l.map.texels);
        let same = |old: &Style| {
            texels.is_none_or(|texels| texels == map.texels) && old.has_pictures_of(style)
        };
        match self.stage2.as_mut_slice() {
            [one] if self.plan == MixPlan::new(&mix) && same(&one.style) => {
                one.style = style.clone();
                self.styles = Styles::new(&self.gpu, scene, &mix, view, self.factor)?;
                if let Some(light) = &mut self.light {
                    light.map = map;
                }
            }
            _ => *self = Self::new(&self.gpu.clone(), scene, &mix, view, self.factor)?,
        }
        Ok(())
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
        let work = self.record(scene, view)?;
        self.read(work, wanted)
    }

    /// Makes the picture of `from` anew behind stage 1 and its light, of the attributes that were
    /// read back with it: what another device drew, or a file holds.
    ///
    /// # Errors
    /// Memory runs out or the device is lost.
    pub fn draw_again(
        &self,
        scene: &InkScene<'_>,
        view: &View,
        from: &Drawing,
        wanted: &[Attribute],
    ) -> Result<Drawing> {
        let mut work = self.gpu.work(QueueKind::Graphics, "ink again")?;
        self.upload_view(&mut work, scene, view)?;
        for (attribute, bytes) in &from.attributes {
            let image = self.targets.attributes.iter().find(|t| t.0 == *attribute);
            if let Some((_, image)) = image {
                work.upload_image(attribute.label(), image, &[bytes])?;
            }
        }
        if let Some(light) = self.light.as_ref().filter(|_| !from.light.is_empty()) {
            work.upload_image("ink light", &light.image, &[&from.light])?;
        }
        self.stage2(&mut work, view)?;
        self.read(work, wanted)
    }

    /// Runs `work` and reads the picture back, with what else is wanted.
    fn read(&self, mut work: Work, wanted: &[Attribute]) -> Result<Drawing> {
        let picture = work.read_image("ink picture", &self.targets.picture)?;
        let mut attributes = Vec::new();
        let mut lines = Vec::new();
        for (attribute, image) in self
            .targets
            .attributes
            .iter()
            .filter(|t| wanted.contains(&t.0))
        {
            attributes.push((*attribute, work.read_image(attribute.label(), image)?));
        }
        for image in self
            .targets
            .lines
            .iter()
            .flatten()
            .filter(|_| !wanted.is_empty())
        {
            lines.push(work.read_image("ink lines", image)?);
        }
        let light = self.light.as_ref().filter(|_| !wanted.is_empty());
        let light = light.map(|l| work.read_image("ink light", &l.image));
        let light = light.transpose()?;
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
            light: light.map(|r| done.take(r)).unwrap_or_default(),
        })
    }

    /// Records both stages.
    pub(super) fn record(&self, scene: &InkScene<'_>, view: &View) -> Result<Work> {
        let mut work = self.gpu.work(QueueKind::Graphics, "ink")?;
        let frame = self.upload_view(&mut work, scene, view)?;
        let drawn = order::drawn(scene, &self.styles, view, self.factor);
        let sun = self.sun_view(scene, view);
        self.sun_map(&mut work, (scene, &drawn), view, (&frame, &sun))?;
        self.stage1(&mut work, (scene, &drawn), view)?;
        self.light(&mut work, (scene, view), &sun)?;
        self.stage2(&mut work, view)?;
        Ok(work)
    }

    /// What all passes know of a view.
    fn upload_view(&self, work: &mut Work, scene: &InkScene<'_>, view: &View) -> Result<InkFrame> {
        let frame = self.styles.frame(scene, view, self.factor);
        work.upload("ink frame", &self.frame, &[frame])?;
        let clusters = self.cluster_records(scene, view);
        work.upload("ink clusters", &self.clusters, &clusters)?;
        let sizes = (self.reference, self.factor);
        self.styles.upload(work, scene, view, sizes)?;
        Ok(frame)
    }

    /// The clusters as kernels see them in a view: those of one style after the other.
    #[must_use]
    pub fn cluster_records(&self, scene: &InkScene<'_>, view: &View) -> Vec<InkCluster> {
        let least = scene.plant.leaf_radius;
        let record = |hatching: &Hatching, number: u32, cluster: &Cluster, course: Course| {
            let scale = f64::from(hatching.scale) * f64::from(self.factor);
            let radius = f64::from(cluster.radius.max(least));
            let tiles = tiles_about(radius, self.reference, scale);
            let mut hatch = Hatch::new(&course, DVec2::splat(tiles));
            if hatching.scatter {
                hatch = hatch.scattered(number);
            }
            view.cluster(cluster, least, &hatch)
        };
        let mut records = Vec::new();
        for (k, style) in self.styles.mix.styles.iter().enumerate() {
            for (number, cluster) in (0..).zip(&scene.plant.clusters_of(k).clusters) {
                let followed = self.courses.as_ref().and_then(|c| c.get(records.len()));
                let course = followed.copied();
                let course =
                    course.unwrap_or_else(|| Course::stateless(view, cluster.centre.as_dvec3()));
                records.push(record(&style.hatching, number, cluster, course));
            }
        }
        records
    }
}
