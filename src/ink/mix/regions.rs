//! Which style each leaf and each piece of wood of a scene has.

use super::rule::{Mix, Part};
use crate::abi::{InkPart, InkPlacement};
use crate::ink::plant::{Plant, rank};
use crate::ink::view::View;
use crate::scene::Model;
use crate::{Error, Result};

/// Names in messages at most.
const NAMES: usize = 8;

/// A mix laid over a scene and a picture. Parts are bits of words, the first the lowest.
#[derive(Debug, Clone)]
pub struct Regions {
    parts: Vec<Part>,
    /// Seeds of the styles: they fix the order in which leaves are dropped.
    seeds: Vec<u32>,
    /// Parts that may be an object's, by its name.
    objects: Vec<u32>,
    /// Parts that may be a material's.
    materials: Vec<u32>,
    /// Parts whose masks and windows hold a pixel, or that have none; empty where no part has a mask.
    masks: Vec<u32>,
    size: [u32; 2],
}

impl Regions {
    /// Lays `mix` over a plant and pictures of `size` pixels, of which `factor` along each axis
    /// become one.
    ///
    /// # Errors
    /// A part that names objects or materials that do not exist; a mask of another shape than
    /// the picture.
    pub fn new(
        mix: &Mix,
        model: &Model,
        plant: &Plant,
        size: [u32; 2],
        factor: u32,
    ) -> Result<Self> {
        let names = |name: &str, pattern: fn(&Part) -> Option<&regex::Regex>| {
            let bit = |(i, p): (usize, &Part)| {
                let holds = pattern(p).is_none_or(|r| r.is_match(name));
                u32::from(holds) << i
            };
            mix.parts.iter().enumerate().map(bit).sum()
        };
        let objects = plant.objects.iter();
        let materials = model.materials.iter();
        let out = Self {
            parts: mix.parts.clone(),
            seeds: mix.styles.iter().map(|s| s.seed).collect(),
            objects: objects.map(|o| names(o, |p| p.objects.as_ref())).collect(),
            materials: materials
                .map(|m| names(&m.name, |p| p.materials.as_ref()))
                .collect(),
            masks: masks(mix, size, factor)?,
            size,
        };
        out.check(model, plant)?;
        Ok(out)
    }

    /// Whether every part can be somewhere.
    fn check(&self, model: &Model, plant: &Plant) -> Result<()> {
        let leaves = plant
            .leaves
            .iter()
            .map(|l| (l.material as usize, l.instance as usize));
        let wood = plant
            .wood
            .iter()
            .map(|(material, instance, _)| (*material, *instance));
        let mut known: Vec<(usize, usize)> = leaves.chain(wood).collect();
        known.sort_unstable();
        known.dedup();
        let met = known.iter().fold(0, |all, &(m, i)| all | self.bits(m, i));
        for (i, part) in self.parts.iter().enumerate() {
            if met >> i & 1 == 1 {
                continue;
            }
            let mut text = format!("style: part {}: nothing has ", i + 1);
            let object = part.objects.as_ref().map(|r| {
                let names = known.iter().map(|k| plant.objects[k.1].as_str());
                format!("an object named `{r}` (there are {})", listed(names))
            });
            let material = part.materials.as_ref().map(|r| {
                let names = known.iter().map(|k| model.materials[k.0].name.as_str());
                format!("a material named `{r}` (there are {})", listed(names))
            });
            let both: Vec<String> = object.into_iter().chain(material).collect();
            text += &both.join(" and ");
            return Err(Error::usage(text));
        }
        Ok(())
    }

    /// Parts that a material of an object may be.
    #[must_use]
    pub fn bits(&self, material: usize, object: usize) -> u32 {
        self.materials[material] & self.objects[object]
    }

    /// Words of the masks, one per pixel; one word where there is none.
    #[must_use]
    pub fn mask_words(&self) -> &[u32] {
        if self.masks.is_empty() {
            &[0]
        } else {
            &self.masks
        }
    }

    /// Whether any part has a mask.
    #[must_use]
    pub fn is_masked(&self) -> bool {
        !self.masks.is_empty()
    }

    /// The parts in a view; one that nothing is where there is none.
    #[must_use]
    pub fn records(&self, view: &View) -> Vec<InkPart> {
        let record = |part: &Part| {
            let span = part.distance.map(|d| d.metres(view.depths));
            let [nearest, farthest] = span.unwrap_or([f32::MIN, f32::MAX]);
            InkPart {
                nearest,
                farthest,
                style: part.style as u32,
            }
        };
        let mut records: Vec<InkPart> = self.parts.iter().map(record).collect();
        records.resize(records.len().max(1), InkPart::default());
        records
    }

    /// Number of parts.
    #[must_use]
    pub fn len(&self) -> usize {
        self.parts.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.parts.is_empty()
    }

    /// Style, cluster and rank of every leaf in a view. Leaves of one cluster of the first style
    /// have one distance and one place in the masks: their centre's.
    #[must_use]
    pub fn placements(&self, plant: &Plant, view: &View) -> Vec<InkPlacement> {
        let parts = self.records(view);
        let deciding = plant.clusters_of(0);
        let whereabouts: Vec<u32> = deciding
            .clusters
            .iter()
            .map(|c| self.parts_at(c.centre, &parts, view))
            .collect();
        let first = plant.first_clusters();
        let placement = |(i, leaf): (usize, &crate::ink::leaves::Leaf)| {
            let own = self.bits(leaf.material as usize, leaf.instance as usize);
            let cluster = deciding.of_leaf[i] as usize;
            let part = (own & whereabouts[cluster]).trailing_zeros() as usize;
            let style = parts
                .get(part)
                .filter(|_| !self.is_empty())
                .map_or(0, |p| p.style as usize);
            InkPlacement {
                style: style as u32,
                cluster: first[style] + plant.clusters_of(style).of_leaf[i],
                rank: rank(i as u32, self.seeds[style]),
            }
        };
        plant.leaves.iter().enumerate().map(placement).collect()
    }

    /// Parts that are at a point, by distance and masks.
    fn parts_at(&self, point: glam::Vec3, parts: &[InkPart], view: &View) -> u32 {
        let (pixel, depth) = view.pixel(point.as_dvec3());
        let depth = depth as f32;
        let near =
            |(i, p): (usize, &InkPart)| u32::from(depth >= p.nearest && depth < p.farthest) << i;
        let near: u32 = parts.iter().enumerate().map(near).sum();
        if self.masks.is_empty() {
            return near;
        }
        let [x, y] = [pixel.x, pixel.y];
        // What is outside of the picture has the mask's nearest pixel.
        let at = |v: f64, size: u32| v.clamp(0.0, f64::from(size - 1)) as usize;
        let [width, height] = self.size;
        near & self.masks[at(y, height) * width as usize + at(x, width)]
    }
}

/// Names without repetition, as many as a message can hold.
fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let mut all: Vec<&str> = names.collect();
    all.sort_unstable();
    all.dedup();
    let more = all.len().saturating_sub(NAMES);
    all.truncate(NAMES);
    let text = all.join(", ");
    if more > 0 {
        format!("{text} and {more} more")
    } else {
        text
    }
}

/// Bits of parts for every pixel; nothing where no part has a mask.
fn masks(mix: &Mix, size: [u32; 2], factor: u32) -> Result<Vec<u32>> {
    let [width, height] = size;
    let final_size = size.map(|s| s / factor.max(1));
    for (number, part) in (1..).zip(&mix.parts) {
        let Some(mask) = part.mask.as_ref().filter(|m| !m.fits(final_size)) else {
            continue;
        };
        let [w, h] = final_size;
        return Err(Error::file(
            &mask.name,
            format!(
                "mask of part {number}: it is {} x {}; a picture of {w} x {h} takes masks of {w} x {h} or \
                 of any other size of the same shape",
                mask.image.width, mask.image.height
            ),
        ));
    }
    if !mix.parts.iter().any(Part::is_masked) {
        return Ok(Vec::new());
    }
    let word = |i: u32| {
        let at = [i % width, i / width];
        let bit = |(k, part): (usize, &Part)| u32::from(part.is_at(at, size)) << k;
        mix.parts.iter().enumerate().map(bit).sum()
    };
    Ok((0..width * height).map(word).collect())
}
