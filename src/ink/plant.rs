//! What is drawn: leaves in clusters with their shapes, and the wood between them.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use glam::{DVec3, Vec2, Vec3};

use super::bodies::Bodies;
use super::branches::Branches;
use super::clusters::{Choice, Clusters};
use super::leaves::{Leaf, LeafTriangles, leaves};
use super::shape::Shape;
use super::style::Style;
use crate::abi::InkLeaf;
use crate::math::colour::srgb_to_linear;
use crate::scene::textures::{self, Rgba8};
use crate::scene::{AlphaMode, Geometry, Material, Model, Wrap};
use crate::{Error, Result};

/// Different shapes of one plant; further ones look like the first of their material.
const SHAPES: usize = 64;
/// Places along an edge at which a leaf's colour is read.
const SAMPLES: usize = 24;
/// Alpha from which on a blended material is leaf.
const BLEND_CUTOFF: f32 = 0.5;

/// A plant, ready to be drawn in styles of the cluster radii that it was gathered for.
#[derive(Debug, Clone)]
pub struct Plant {
    /// Leaves, those of one material after the other.
    pub leaves: Vec<Leaf>,
    /// Their clusters, once for each way of gathering them that a style has.
    pub clusters: Vec<Clusters>,
    /// Which of them are those of each style.
    pub set_of_style: Vec<usize>,
    /// Names of the objects that leaves and wood are of.
    pub objects: Vec<String>,
    /// Shapes that leaves name.
    pub shapes: Vec<Shape>,
    /// Mean linear colour of the texture within each shape; white without one.
    pub colours: Vec<Vec3>,
    /// Shape of each leaf.
    pub shape_of: Vec<u32>,
    /// Unit normal of the crown and ambient coefficient about each leaf.
    pub crown: Vec<(Vec3, f32)>,
    /// Radius of a median leaf, metres.
    pub leaf_radius: f32,
    /// Ranges of leaves by material.
    pub batches: Vec<(u32, std::ops::Range<u32>)>,
    /// Index ranges of the geometry that are no leaves, with material and instance.
    pub wood: Vec<(usize, usize, std::ops::Range<u32>)>,
    /// Axes of the wood, where they are known already; who needs them finds them otherwise.
    pub branches: Option<Branches>,
    /// Smooth bodies, where the style has them instead of wood; their clusters stand behind those
    /// of the leaves, too.
    pub bodies: Bodies,
    /// The first of them.
    pub first_body_cluster: u32,
}

/// Normals and ambient coefficients of a foliage bake, for each vertex.
#[derive(Debug, Clone, Copy)]
pub struct CrownLight<'a> {
    /// Realigned unit normals.
    pub normals: &'a [Vec3],
    /// Ambient coefficients.
    pub ambient: &'a [f32],
}

impl Plant {
    /// Gathers the leaves of `model`. `foliage` says which parts of the geometry are leaves.
    ///
    /// # Errors
    /// A plant without leaves, a texture that cannot be decoded.
    pub fn new(
        model: &Model,
        geometry: &Geometry,
        triangles: LeafTriangles<'_>,
        foliage: &[bool],
        light: Option<CrownLight<'_>>,
        styles: &[Style],
    ) -> Result<Self> {
        let crown = (foliage, light);
        Self::gathered(model, geometry, triangles, crown, styles, Clusters::new)
    }

    /// The same with clusters that `gather` makes or knows from leaves' centres, the largest radius
    /// and what a leaf prefers.
    ///
    /// # Errors
    /// As [`Plant::new`], and those of `gather`.
    pub fn gathered(
        model: &Model,
        geometry: &Geometry,
        triangles: LeafTriangles<'_>,
        (foliage, light): (&[bool], Option<CrownLight<'_>>),
        styles: &[Style],
        gather: impl Fn(&[Vec3], f32, Choice) -> Result<Clusters>,
    ) -> Result<Self> {
        let (mut found, kept) = leaves(model, geometry, triangles);
        let first = &styles[0];
        if found.is_empty() && !first.bodies.smooth {
            return Err(Error::usage(format!(
                "{}: has no leaves that a style could draw",
                model.name
            )));
        }
        let mut crown = crown_light(geometry, triangles, &kept, light);
        let mut order: Vec<usize> = (0..found.len()).collect();
        order.sort_by_key(|&i| found[i].material);
        found = order.iter().map(|&i| found[i]).collect();
        crown = order.iter().map(|&i| crown[i]).collect();
        let centres: Vec<Vec3> = found.iter().map(|l| l.centre).collect();
        let (mut clusters, set_of_style) = sets(&centres, styles, gather)?;
        let (shapes, colours, shape_of) =
            shapes(model, geometry, triangles, &kept, &found, &order)?;
        let mut radii: Vec<f32> = found.iter().map(|l| l.radius).collect();
        radii.sort_by(f32::total_cmp);
        let mut batches: Vec<(u32, std::ops::Range<u32>)> = Vec::new();
        for (i, leaf) in (0_u32..).zip(&found) {
            match batches.last_mut() {
                Some((material, range)) if *material == leaf.material => range.end = i + 1,
                _ => batches.push((leaf.material, i..i + 1)),
            }
        }
        let parts = geometry.parts.iter().enumerate();
        let wood: Vec<(usize, usize, std::ops::Range<u32>)> = parts
            .filter(|(i, p)| !foliage.get(*i).copied().unwrap_or(false) && p.index_count > 0)
            .map(|(_, p)| {
                let range = p.index_range();
                (p.material, p.instance, range.start as u32..range.end as u32)
            })
            .collect();
        let bodies = bodies(geometry, &wood, first)?;
        let first_body_cluster = clusters[0].len() as u32;
        clusters[0].clusters.extend(&bodies.clusters);
        Ok(Self {
            leaf_radius: radii.get(radii.len() / 2).copied().unwrap_or_default(),
            // Bodies are drawn instead of wood.
            wood: if first.bodies.smooth {
                Vec::new()
            } else {
                wood
            },
            branches: None,
            bodies,
            first_body_cluster,
            leaves: found,
            clusters,
            set_of_style,
            objects: model.instances.iter().map(|i| i.name.clone()).collect(),
            shapes,
            colours,
            shape_of,
            crown,
            batches,
        })
    }

    /// For each cluster of a style the middle of its object's clusters. A cluster's object is that
    /// of its first leaf.
    #[must_use]
    pub fn object_centres(&self, style: usize) -> Vec<DVec3> {
        let set = self.clusters_of(style);
        let mut object_of = vec![None; set.len()];
        for (leaf, &cluster) in self.leaves.iter().zip(&set.of_leaf) {
            object_of[cluster as usize].get_or_insert(leaf.instance);
        }
        let mut sums: HashMap<Option<u32>, (DVec3, f64)> = HashMap::new();
        for (object, cluster) in object_of.iter().zip(&set.clusters) {
            let sum = sums.entry(*object).or_default();
            *sum = (sum.0 + cluster.centre.as_dvec3(), sum.1 + 1.0);
        }
        let middle = |object: &Option<u32>| sums.get(object).map_or(DVec3::ZERO, |s| s.0 / s.1);
        object_of.iter().map(middle).collect()
    }

    /// Indices of the wood's triangles.
    #[must_use]
    pub fn wood_indices(&self, geometry: &Geometry) -> Vec<u32> {
        let ranges = self
            .wood
            .iter()
            .map(|w| w.2.start as usize..w.2.end as usize);
        ranges.flat_map(|r| &geometry.indices[r]).copied().collect()
    }

    /// Clusters of a style.
    #[must_use]
    pub fn clusters_of(&self, style: usize) -> &Clusters {
        &self.clusters[self.set_of_style[style]]
    }

    /// Number of the first cluster of each style where those of all styles stand one after the
    /// other, closed by their total. Styles share clusters here, but not there: hatching makes
    /// them different.
    #[must_use]
    pub fn first_clusters(&self) -> Vec<u32> {
        let mut first = vec![0];
        for &set in &self.set_of_style {
            first.push(first[first.len() - 1] + self.clusters[set].len() as u32);
        }
        first
    }

    /// The leaves as kernels see them.
    #[must_use]
    pub fn records(&self) -> Vec<InkLeaf> {
        let record = |(i, leaf): (usize, &Leaf)| {
            let (crown_normal, ambient) = self.crown[i];
            let across = leaf.texcoord_per_metre.x_axis * leaf.radius;
            let along = leaf.texcoord_per_metre.y_axis * leaf.radius;
            InkLeaf {
                centre: leaf.centre.to_array(),
                radius: leaf.radius,
                normal: leaf.normal.to_array(),
                object: leaf.instance,
                axis: leaf.axis.to_array(),
                shape: self.shape_of[i],
                crown_normal: crown_normal.to_array(),
                ambient,
                texcoord: leaf.texcoord.to_array(),
                texcoord_across: across.to_array(),
                texcoord_along: along.to_array(),
                colour: self.colours[self.shape_of[i] as usize].to_array(),
            }
        };
        self.leaves.iter().enumerate().map(record).collect()
    }
}

/// What is no leaf as smooth bodies, if the style wants them.
fn bodies(
    geometry: &Geometry,
    parts: &[(usize, usize, std::ops::Range<u32>)],
    style: &Style,
) -> Result<Bodies> {
    if !style.bodies.smooth || parts.is_empty() {
        return Ok(Bodies::default());
    }
    let radius = style.bodies.cluster_radius * geometry.diagonal();
    Bodies::new(geometry, parts, radius.max(f32::MIN_POSITIVE))
}

/// A number in [0, 1) of a leaf: its place in the order in which leaves are dropped.
pub(super) fn rank(leaf: u32, seed: u32) -> f32 {
    let mut x = leaf ^ seed.wrapping_mul(0x9e37_79b9);
    // lowbias32 (Wellons 2018).
    x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    ((x ^ (x >> 16)) >> 8) as f32 / 16_777_216.0
}

/// Clusters for every way of gathering that the styles have, and which is each style's.
fn sets(
    centres: &[Vec3],
    styles: &[Style],
    gather: impl Fn(&[Vec3], f32, Choice) -> Result<Clusters>,
) -> Result<(Vec<Clusters>, Vec<usize>)> {
    let way = |s: &Style| (s.leaves.cluster_radius, s.leaves.first_fit);
    let diagonal = diagonal(centres).max(f32::MIN_POSITIVE);
    let mut ways: Vec<(f32, bool)> = Vec::new();
    let mut clusters = Vec::new();
    let mut of_style = Vec::new();
    for style in styles {
        let (radius, first_fit) = way(style);
        let known = ways.iter().position(|w| *w == way(style));
        of_style.push(known.unwrap_or(ways.len()));
        if known.is_none() {
            let choice = if first_fit {
                Choice::First
            } else {
                Choice::Smallest
            };
            clusters.push(gather(centres, radius * diagonal, choice)?);
            ways.push((radius, first_fit));
        }
    }
    Ok((clusters, of_style))
}

fn diagonal(points: &[Vec3]) -> f32 {
    let far = Vec3::splat(f32::INFINITY);
    let low = points.iter().copied().fold(far, Vec3::min);
    let high = points.iter().copied().fold(-far, Vec3::max);
    (high - low).max(Vec3::ZERO).length()
}

/// Mean of a bake over each leaf's corners; without a bake away from the crown's middle, open.
fn crown_light(
    g: &Geometry,
    triangles: LeafTriangles<'_>,
    kept: &[Option<u32>],
    light: Option<CrownLight<'_>>,
) -> Vec<(Vec3, f32)> {
    let ranges = triangles
        .first
        .windows(2)
        .zip(kept)
        .filter(|(_, k)| k.is_some());
    let mean = |range: &[u32]| {
        let list = &triangles.triangles[range[0] as usize..range[1] as usize];
        let corners = list
            .iter()
            .flat_map(|&t| &triangles.indices[3 * t as usize..3 * t as usize + 3]);
        let (mut normal, mut ambient, mut count) = (Vec3::ZERO, 0.0, 0.0);
        for &v in corners {
            let v = v as usize;
            match light {
                Some(light) => {
                    normal += light.normals[v];
                    ambient += light.ambient[v];
                }
                None => {
                    normal += g.positions[v];
                    ambient += 1.0;
                }
            }
            count += 1.0;
        }
        (normal.try_normalize().unwrap_or(Vec3::Y), ambient / count)
    };
    ranges.map(|(range, _)| mean(range)).collect()
}

/// Shapes by material and place in the texture; where there is no texture, by material.
fn shapes(
    model: &Model,
    g: &Geometry,
    triangles: LeafTriangles<'_>,
    kept: &[Option<u32>],
    leaves: &[Leaf],
    order: &[usize],
) -> Result<(Vec<Shape>, Vec<Vec3>, Vec<u32>)> {
    // Leaves that were kept, by their first number: where their triangles are.
    let source: Vec<usize> = (0..kept.len()).filter(|&i| kept[i].is_some()).collect();
    let mut images: HashMap<usize, Rgba8> = HashMap::new();
    let mut known: HashMap<(u32, [i32; 6]), u32> = HashMap::new();
    let mut first_of: HashMap<u32, u32> = HashMap::new();
    let (mut shapes, mut colours) = (Vec::new(), Vec::new());
    let mut of_leaf = Vec::with_capacity(leaves.len());
    for (leaf, &from) in leaves.iter().zip(order) {
        let key = (leaf.material, key(leaf));
        if let Some(&shape) = known.get(&key) {
            of_leaf.push(shape);
            continue;
        }
        if shapes.len() >= SHAPES
            && let Some(&shape) = first_of.get(&leaf.material)
        {
            of_leaf.push(shape);
            continue;
        }
        let material = &model.materials[leaf.material as usize];
        let cut = cut(model, material, &mut images)?;
        let range = &triangles.first[source[from]..source[from] + 2];
        let corners: Vec<[Vec2; 3]> = triangles.triangles[range[0] as usize..range[1] as usize]
            .iter()
            .map(|&t| {
                [0, 1, 2].map(|k| {
                    let v = triangles.indices[3 * t as usize + k] as usize;
                    leaf.local(g.positions[v])
                })
            })
            .collect();
        let covers = |p: Vec2| {
            corners.iter().any(|c| inside(p, c))
                && cut.as_ref().is_none_or(|c| c.shows(leaf.texcoord_at(p)))
        };
        let shape = shapes.len() as u32;
        shapes.push(Shape::new(covers));
        let places = (0..SAMPLES * SAMPLES).map(|i| {
            let at = |k: usize| (2 * k + 1) as f32 / SAMPLES as f32 - 1.0;
            Vec2::new(at(i % SAMPLES), at(i / SAMPLES))
        });
        let within: Vec<Vec2> = places.filter(|&p| covers(p)).collect();
        colours.push(colour(model, material, &mut images, (leaf, &within))?);
        known.insert(key, shape);
        first_of.entry(leaf.material).or_insert(shape);
        of_leaf.push(shape);
    }
    Ok((shapes, colours, of_leaf))
}

/// Mean colour of the texture at places of a leaf.
fn colour(
    model: &Model,
    material: &Material,
    images: &mut HashMap<usize, Rgba8>,
    (leaf, places): (&Leaf, &[Vec2]),
) -> Result<Vec3> {
    let Some(reference) = material.base_color_texture.filter(|_| !places.is_empty()) else {
        return Ok(Vec3::ONE);
    };
    let texture = &model.textures[reference.texture];
    let texels = Cut {
        image: decoded(model, texture.image, images)?,
        least: 0.0,
        transform: reference.transform,
        wrap: [texture.wrap_u, texture.wrap_v],
    };
    let sum: Vec3 = places
        .iter()
        .map(|&p| texels.colour(leaf.texcoord_at(p)))
        .sum();
    Ok(sum / places.len() as f32)
}

fn decoded<'a>(
    model: &Model,
    image: usize,
    images: &'a mut HashMap<usize, Rgba8>,
) -> Result<&'a Rgba8> {
    Ok(match images.entry(image) {
        Entry::Occupied(known) => known.into_mut(),
        Entry::Vacant(new) => new.insert(textures::decode(&model.images[image])?),
    })
}

/// Place in the texture to a hundredth: leaves of one key look alike.
fn key(leaf: &Leaf) -> [i32; 6] {
    let across = leaf.texcoord_per_metre.x_axis * leaf.radius;
    let along = leaf.texcoord_per_metre.y_axis * leaf.radius;
    let t = leaf.texcoord;
    [t.x, t.y, across.x, across.y, along.x, along.y].map(|v| (v * 100.0).round() as i32)
}

fn inside(p: Vec2, [a, b, c]: &[Vec2; 3]) -> bool {
    let side = |a: Vec2, b: Vec2| (b - a).perp_dot(p - a);
    let (x, y, z) = (side(*a, *b), side(*b, *c), side(*c, *a));
    (x >= 0.0 && y >= 0.0 && z >= 0.0) || (x <= 0.0 && y <= 0.0 && z <= 0.0)
}

/// The texture of a material, read on the host.
struct Cut<'a> {
    image: &'a Rgba8,
    least: f32,
    transform: [[f32; 3]; 2],
    wrap: [Wrap; 2],
}

impl Cut<'_> {
    fn shows(&self, uv: Vec2) -> bool {
        f32::from(self.texel(uv)[3]) / 255.0 >= self.least
    }

    fn colour(&self, uv: Vec2) -> Vec3 {
        let [r, g, b, _] = self.texel(uv);
        Vec3::from([r, g, b].map(|v| srgb_to_linear(f32::from(v) / 255.0)))
    }

    fn texel(&self, uv: Vec2) -> [u8; 4] {
        let [u, v] = self.transform.map(|m| m[0] * uv.x + m[1] * uv.y + m[2]);
        let along = |at: f32, size: u32, wrap: Wrap| {
            let at = match wrap {
                Wrap::Repeat => at - at.floor(),
                Wrap::Clamp => at.clamp(0.0, 1.0),
                Wrap::Mirror => 1.0 - (2.0 * (0.5 * at - (0.5 * at).floor()) - 1.0).abs(),
            };
            ((at * size as f32) as usize).min(size as usize - 1)
        };
        let x = along(u, self.image.width, self.wrap[0]);
        let y = along(v, self.image.height, self.wrap[1]);
        let at = 4 * (y * self.image.width as usize + x);
        [0, 1, 2, 3].map(|k| self.image.pixels[at + k])
    }
}

fn cut<'a>(
    model: &Model,
    material: &Material,
    images: &'a mut HashMap<usize, Rgba8>,
) -> Result<Option<Cut<'a>>> {
    let cutoff = match material.alpha_mode {
        AlphaMode::Opaque => return Ok(None),
        AlphaMode::Mask { cutoff } => cutoff,
        AlphaMode::Blend => BLEND_CUTOFF,
    };
    let Some(reference) = material.base_color_texture else {
        return Ok(None);
    };
    let texture = &model.textures[reference.texture];
    Ok(Some(Cut {
        image: decoded(model, texture.image, images)?,
        least: cutoff / material.base_color[3].max(f32::MIN_POSITIVE),
        transform: reference.transform,
        wrap: [texture.wrap_u, texture.wrap_v],
    }))
}
