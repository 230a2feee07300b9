//! Hatching tiles as vectors: strokes of a tonal art map (Praun, Hoppe, Webb, Finkelstein 2001) are
//! carried to each cluster of leaves by the affine map of Coconu, Deussen, Hege 2006, equations 5
//! to 7 without packing, solved for the picture: `x(T) = x_C + K Q^T diag(pi/m, pi/n) (T - R)`, and
//! kept where pixels are the cluster's and dark enough. The pictures in real time have the same
//! strokes as texels.

use glam::{DMat2, DVec2, DVec3, Vec3};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::curve::Polyline;
use super::particles::unit;
use super::renderer::Maps;
use super::style::PaperStyle;
use crate::abi::{INK_LEVELS, INK_TILE, InkCluster};
use crate::ink::clusters::{Choice, Clusters};
use crate::ink::motion::Course;
use crate::ink::strokes::{Stroke, Tile, TileSettings};
use crate::ink::view::{Hatch, View, tiles_about};

/// Shorter pieces of strokes are specks, pixels.
const SPECK: f64 = 2.0;
/// Distance of the points in which strokes are followed, pixels.
const STEP: f64 = 0.5;
/// Tiles that are looked at for one cluster, along each axis, at most.
const MOST_TILES: i64 = 64;

/// Hatching tiles on clusters of leaves.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Tiles {
    /// Darkness of the darkest places, 0 (no such strokes) to 1.
    pub strength: f64,
    /// Light above which nothing is hatched, 0 to 1.
    pub white: f64,
    /// Exponent on the darkness, 0.1 to 10.
    pub gamma: f64,
    /// Light from all around, 0 to 1.
    pub ambient: f64,
    /// Largest radius of clusters in the paper's unit, 0.01 to 10.
    pub radius: f64,
    /// Share of the crown's shape in what is lit, against the clusters', 0 to 1.
    pub crown: f64,
    /// Millimetres of paper for a texel of the tile: sets distance and width of strokes, 0.01 to 2.
    pub texel: f64,
    /// Darkness above which strokes cross, 0 to 1; 1: never.
    pub crossing: f64,
    /// Direction of strokes, degrees from the right upwards, -180 to 180.
    pub angle: f64,
    /// Colour of the strokes' ink, sRGB, 0 to 1; none: the sheet's.
    pub colour: Option<[f32; 3]>,
}

impl Default for Tiles {
    fn default() -> Self {
        Self {
            strength: 0.0,
            white: 0.7,
            gamma: 1.2,
            ambient: 0.15,
            radius: 1.0,
            crown: 0.5,
            texel: 0.14,
            crossing: 0.6,
            angle: 35.0,
            colour: None,
        }
    }
}

impl Tiles {
    /// Every number with its name and range.
    pub(super) fn numbers(&self) -> [(String, f64, f64, f64); 9] {
        [
            ("tiles.strength", self.strength, 0.0, 1.0),
            ("tiles.white", self.white, 0.0, 1.0),
            ("tiles.gamma", self.gamma, 0.1, 10.0),
            ("tiles.ambient", self.ambient, 0.0, 1.0),
            ("tiles.radius", self.radius, 0.01, 10.0),
            ("tiles.crown", self.crown, 0.0, 1.0),
            ("tiles.texel", self.texel, 0.01, 2.0),
            ("tiles.crossing", self.crossing, 0.0, 1.0),
            ("tiles.angle", self.angle, -180.0, 180.0),
        ]
        .map(|(name, value, low, high)| (name.to_owned(), value, low, high))
    }
}

/// What strokes are drawn on.
#[derive(Debug, Clone, Copy)]
pub struct Ground<'a> {
    /// Pixels across and down.
    pub size: [usize; 2],
    /// Number of the cluster in each pixel plus 1; 0: none.
    pub cluster: &'a [u32],
    /// Darkness of each pixel, 0 to 1.
    pub darkness: &'a [f32],
}

/// A piece of a tile's stroke in the picture, pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct TileLine {
    /// Number of its cluster.
    pub cluster: u32,
    /// Its way.
    pub line: Polyline,
    /// Width at each point.
    pub widths: Vec<f64>,
}

/// How the tile lies on a cluster.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Laid {
    /// The cluster's middle, pixels.
    pub middle: DVec2,
    /// Its place in the tile.
    pub reference: DVec2,
    /// Tiles for a pixel to the right and one upwards.
    pub linear: DMat2,
    /// How often the tile is repeated where it would be seen too large: 2 to the power of this.
    pub octave: u32,
    /// Level whose strokes are drawn.
    pub level: u32,
}

impl Laid {
    /// With strokes about as large as where a texel is `texel` pixels; none where the cluster is
    /// not seen from outside.
    #[must_use]
    pub fn new(cluster: &InkCluster, texel: f64) -> Option<Self> {
        let m = cluster.to_angles.map(f64::from);
        let v = DVec2::from(cluster.texture_up.map(f64::from));
        let tiles = DVec2::from(cluster.tiles.map(f64::from)) / std::f64::consts::PI;
        let row = |a: f64, b: f64| DVec2::new(a * m[0] + b * m[2], a * m[1] + b * m[3]);
        let (u, w) = (tiles.x * row(v.y, -v.x), tiles.y * row(v.x, v.y));
        let linear = DMat2::from_cols(DVec2::new(u.x, w.x), DVec2::new(u.y, w.y));
        let area = linear.determinant().abs();
        if cluster.pixel_radius <= 0.0 || area <= 0.0 || !area.is_finite() {
            return None;
        }
        // Texels of the tile where one is meant to be seen.
        let level = (area.sqrt() * f64::from(INK_TILE) * texel).log2().round();
        Some(Self {
            middle: DVec2::from(cluster.pixel.map(f64::from)),
            reference: DVec2::from(cluster.reference.map(f64::from)),
            linear,
            octave: (-level).clamp(0.0, 12.0) as u32,
            level: level.clamp(0.0, f64::from(INK_LEVELS - 1)) as u32,
        })
    }

    /// Place in the tile (not within 0 to 1) of a pixel.
    #[must_use]
    pub fn place(&self, pixel: DVec2) -> DVec2 {
        let away = (pixel - self.middle) * DVec2::new(1.0, -1.0);
        (self.reference + self.linear * away) * f64::from(1_u32 << self.octave)
    }

    /// The pixel at a place in the tile.
    #[must_use]
    pub fn pixel(&self, place: DVec2) -> DVec2 {
        let away =
            self.linear.inverse() * (place / f64::from(1_u32 << self.octave) - self.reference);
        self.middle + away * DVec2::new(1.0, -1.0)
    }

    /// Pixels of an edge of the tile.
    fn edge(&self) -> f64 {
        1.0 / (self.linear.determinant().abs().sqrt() * f64::from(1_u32 << self.octave))
    }
}

/// A point of a stroke at `t` (-1 to 1) along it, edges of the tile, and its width there, texels
/// of its level: as texels are drawn.
fn along(stroke: &Stroke, t: f64) -> (DVec2, f64) {
    let way = DVec2::from_angle(f64::from(stroke.angle));
    let length = f64::from(stroke.length);
    let sag = f64::from(stroke.bend) * length * (1.0 - t * t);
    let press = (1.0 - t * t).max(0.0).powf(0.6) * (1.1 - 0.35 * t);
    let at = stroke.at.as_dvec2() + 0.5 * length * t * way + sag * way.perp();
    (at, f64::from(stroke.width) * press)
}

/// The strokes of a tile on all clusters, those of one after the other.
#[must_use]
pub fn tile_lines(
    ground: &Ground<'_>,
    clusters: &[InkCluster],
    tile: &[Stroke],
    texel: f64,
) -> Vec<TileLine> {
    let one = |(number, cluster): (usize, &InkCluster)| {
        let number = number as u32;
        let laid = Laid::new(cluster, texel);
        let reach = f64::from(cluster.pixel_radius);
        laid.map_or_else(Vec::new, |laid| {
            on_cluster(ground, number, &laid, reach, tile)
        })
    };
    clusters.par_iter().enumerate().flat_map_iter(one).collect()
}

fn on_cluster(
    ground: &Ground<'_>,
    number: u32,
    laid: &Laid,
    reach: f64,
    tile: &[Stroke],
) -> Vec<TileLine> {
    // The cluster's leaves reach beyond it.
    let reach = 1.5 * reach + 8.0;
    let corners = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)]
        .map(|(x, y)| laid.place(laid.middle + reach * DVec2::new(x, y)));
    let low = corners.iter().copied().fold(DVec2::INFINITY, DVec2::min);
    let high = corners
        .iter()
        .copied()
        .fold(DVec2::NEG_INFINITY, DVec2::max);
    let tiles = |low: f64, high: f64| {
        let (a, b) = (low.floor() as i64 - 1, high.ceil() as i64);
        a..=b.min(a.saturating_add(MOST_TILES))
    };
    let mut out = Vec::new();
    let edge = laid.edge();
    for stroke in tile.iter().filter(|s| s.level >= laid.level) {
        let half = 0.5 * f64::from(stroke.length) * (1.0 + 2.0 * f64::from(stroke.bend).abs());
        for y in tiles(low.y, high.y) {
            for x in tiles(low.x, high.x) {
                let shift = DVec2::new(x as f64, y as f64);
                let middle = stroke.at.as_dvec2() + shift;
                let beside = (middle - middle.clamp(low, high)).abs().max_element();
                let far = laid.pixel(middle).distance(laid.middle) > reach + half * edge;
                if beside <= half && !far {
                    pieces(ground, number, laid, (stroke, shift), &mut out);
                }
            }
        }
    }
    out
}

/// The parts of a stroke, moved by whole tiles, that are on its cluster and dark enough.
fn pieces(
    ground: &Ground<'_>,
    number: u32,
    laid: &Laid,
    (stroke, shift): (&Stroke, DVec2),
    out: &mut Vec<TileLine>,
) {
    let [w, h] = ground.size;
    let texel = laid.edge() * f64::from(1_u32 << laid.level) / f64::from(INK_TILE);
    let length = f64::from(stroke.length) * laid.edge();
    let steps = (length / STEP).ceil().clamp(2.0, 4096.0) as u32;
    let mut piece = TileLine {
        cluster: number,
        line: Polyline::default(),
        widths: Vec::new(),
    };
    for k in 0..=steps {
        let t = 2.0 * f64::from(k) / f64::from(steps) - 1.0;
        let (place, width) = along(stroke, t);
        let p = laid.pixel(place + shift);
        let inside = p.x >= 0.0 && p.y >= 0.0 && p.x < w as f64 && p.y < h as f64;
        let draws = inside && {
            let pixel = p.y as usize * w + p.x as usize;
            ground.cluster[pixel] == number + 1 && ground.darkness[pixel] >= stroke.tone
        };
        if draws {
            piece.line.points.push(p);
            piece.widths.push(width * texel);
        }
        if (!draws || k == steps) && !piece.widths.is_empty() {
            let done = TileLine {
                cluster: number,
                line: std::mem::take(&mut piece.line),
                widths: std::mem::take(&mut piece.widths),
            };
            if done.line.length() >= SPECK {
                out.push(done);
            }
        }
    }
}

/// Clusters of the leaves of a drawing, and what of them each pixel shows.
#[derive(Debug, Clone)]
pub struct Hatched {
    /// Clusters in the view.
    pub clusters: Vec<InkCluster>,
    /// Number of the cluster in each pixel plus 1; 0: none.
    pub cluster: Vec<u32>,
    /// Darkness of each pixel.
    pub darkness: Vec<f32>,
}

/// Clusters and darkness of the foliage that is `visible`; `texel`: pixels of a texel.
#[must_use]
pub fn hatched(
    maps: &Maps,
    visible: &[bool],
    (style, texel): (&PaperStyle, f64),
    view: &View,
) -> Hatched {
    let t = &style.tiles;
    let centres: Vec<Vec3> = maps.particles[..maps.leaves]
        .iter()
        .map(|p| Vec3::from(p.centre))
        .collect();
    let radius = (t.radius * unit(view)) as f32;
    let found = Clusters::new(&centres, radius.max(f32::MIN_POSITIVE), Choice::Smallest);
    let found = found.unwrap_or_default();
    let metres = super::anchored::metres_of_pixel(&style.vector, view);
    let least = maps.particles.first().map_or(0.0, |p| p.radius);
    let record = |(number, cluster): (usize, &crate::ink::clusters::Cluster)| {
        let mut course = Course::stateless(view, cluster.centre.as_dvec3());
        // Strokes run across the direction in which v grows.
        course.up = DVec2::from_angle(t.angle.to_radians()).rotate(course.up);
        let tiles = tiles_about(f64::from(cluster.radius.max(least)), metres, texel);
        let hatch = Hatch::new(&course, DVec2::splat(tiles)).scattered(number as u32);
        view.cluster(cluster, least, &hatch)
    };
    let clusters: Vec<InkCluster> = found.clusters.iter().enumerate().map(record).collect();
    let of_pixel = |(i, &number): (usize, &u32)| {
        let leaf = (number as usize).checked_sub(1)?;
        let cluster = *found.of_leaf.get(leaf)?;
        visible[i].then_some(cluster + 1)
    };
    let cluster: Vec<u32> = maps
        .foliage_number
        .iter()
        .enumerate()
        .map(|p| of_pixel(p).unwrap_or(0))
        .collect();
    let darkness = darkness(maps, &cluster, &clusters, (style, view));
    Hatched {
        clusters,
        cluster,
        darkness,
    }
}

fn darkness(
    maps: &Maps,
    cluster: &[u32],
    clusters: &[InkCluster],
    (style, view): (&PaperStyle, &View),
) -> Vec<f32> {
    let t = &style.tiles;
    let sum: Vec3 = clusters.iter().map(|c| Vec3::from(c.centre)).sum();
    let crown = (sum / clusters.len().max(1) as f32).as_dvec3();
    let to_sun = view.to_sun.as_dvec3();
    let width = maps.size[0];
    let one = |(i, &number): (usize, &u32)| {
        let Some(c) = (number as usize).checked_sub(1).map(|c| &clusters[c]) else {
            return 0.0;
        };
        let pixel = DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
        let place = view.point(pixel, f64::from(maps.foliage_depth[i]));
        let away = |from: DVec3| (place - from).normalize_or_zero();
        let own = away(Vec3::from(c.centre).as_dvec3());
        let normal = own.lerp(away(crown), t.crown).normalize_or_zero();
        let shadow = f64::from(maps.shadow.get(i).copied().unwrap_or(0.0));
        // Half of the light goes round a crown.
        let sun = (0.5 + 0.5 * normal.dot(to_sun)) * (1.0 - shadow);
        let tone = t.ambient + (1.0 - t.ambient) * sun;
        let dark = (1.0 - tone / t.white.max(1e-3)).clamp(0.0, 1.0);
        (t.strength * dark.powf(t.gamma)) as f32
    };
    cluster.par_iter().enumerate().map(one).collect()
}

/// The strokes of a style's tile.
#[must_use]
pub fn tile(style: &PaperStyle) -> Vec<Stroke> {
    let settings = TileSettings {
        seed: style.seed.wrapping_add(1),
        crossing: style.tiles.crossing as f32,
        ..TileSettings::default()
    };
    Tile::new(&settings).strokes
}
