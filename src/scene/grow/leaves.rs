//! Leaves: how many on which twig, where, and their mesh (Weber and Penn 1995, sections 4.5, 4.9).

use std::sync::Arc;

use glam::DVec3;

use super::leaf_template::{Template, VARIANTS, templates};
use super::light::Light;
use super::parameters::{LeafParameters, LeafShape, Parameters};
use super::portable::{sin_cos_degrees, smoothstep};
use super::random::Random;
use super::stem::{Skeleton, Stem};
use crate::scene::{Botany, Leaf, Primitive};

/// Above this many leaves the coarse leaf mesh is used; sprays have twice a leaf's vertices.
const COARSE_ABOVE: u32 = 120_000;
const COARSE_SPRAY_ABOVE: u32 = 20_000;

/// Longest leaf over the plant's height, for plants of very few leaves.
const LONGEST: f64 = 0.1;

/// How the leaves are shared out.
pub(super) struct Shares {
    /// Which stems exist: plants with few leaves lose last-order twigs.
    pub(super) keep: Vec<bool>,
    /// Leaves per stem; the sum is the number asked for.
    counts: Vec<u32>,
    /// Light at the stem in \[0, 1\].
    light: Vec<f64>,
}

/// Decides on twigs and on the number of leaves of each stem. Exact: the counts are differences
/// of one rounded running sum.
pub(super) fn share_out(skeleton: &Skeleton, p: &Parameters, wanted: u32) -> Shares {
    let stems = &skeleton.stems;
    let (keep, twig_share) = thin_twigs(stems, p, wanted);
    let bearing = |stem: &Stem| p.leaf.bearing[usize::from(stem.order)].max(stem.start());
    let leafy: Vec<f64> = stems
        .iter()
        .zip(&keep)
        .map(|(stem, &kept)| {
            let length = stem.length * (1.0 - bearing(stem));
            // Where twigs are missing, branches lose as many leaves as the twigs do.
            let share = if stem.order + 1 == p.levels {
                1.0
            } else {
                twig_share
            };
            if kept { length * share } else { 0.0 }
        })
        .collect();
    let middle = |stem: &Stem| stem.at(0.5 * (1.0 + bearing(stem))).position;
    let points: Vec<(DVec3, f64)> = stems
        .iter()
        .zip(&leafy)
        .filter(|&(_, &weight)| weight > 0.0)
        .map(|(stem, &weight)| (middle(stem), weight))
        .collect();
    let field = Light::new(&points);
    let mut light = vec![0.0; stems.len()];
    let mut total = 0.0;
    let mut sums = Vec::with_capacity(stems.len());
    for (i, stem) in stems.iter().enumerate() {
        if leafy[i] > 0.0 {
            light[i] = smoothstep(0.02, 0.45, field.exposure(middle(stem)));
            total += leafy[i] * (1.0 - p.leaf.shade * (1.0 - light[i]));
        }
        sums.push(total);
    }
    let mut given = 0;
    let counts = sums
        .iter()
        .map(|sum| {
            // the last sum is the total itself, so the last quotient is exactly 1
            let upto = if total > 0.0 {
                (f64::from(wanted) * (sum / total)).floor() as u32
            } else {
                0
            };
            let own = upto - given;
            given = upto;
            own
        })
        .collect();
    Shares {
        keep,
        counts,
        light,
    }
}

/// Keeps as many last-order twigs as the leaves need, evenly. Returns the
/// stems that stay and the share of twigs that do.
fn thin_twigs(stems: &[Stem], p: &Parameters, wanted: u32) -> (Vec<bool>, f64) {
    let is_twig = |stem: &Stem| stem.order + 1 == p.levels;
    let twigs = stems.iter().filter(|s| is_twig(s)).count();
    // In winter the twigs of the natural density stay.
    let wanted = if wanted == 0 { p.leaf.count } else { wanted };
    let needed = f64::from(wanted) / (p.leaf.per_twig * twigs.max(1) as f64);
    let share = needed.clamp(0.06, 1.0);
    let mut seen = 0.0f64;
    let keep = stems
        .iter()
        .map(|stem| {
            if !is_twig(stem) || stem.is_fork {
                return true;
            }
            let before = (seen * share).floor();
            seen += 1.0;
            (seen * share).floor() > before
        })
        .collect();
    (keep, share)
}

/// A leaf about to be meshed.
struct Placement {
    base: DVec3,
    tangent: DVec3,
    normal: DVec3,
    length: f64,
    variant: usize,
    tint: [f32; 4],
    order: u8,
}

/// Meshes the leaves of all stems.
pub(super) fn mesh(
    skeleton: &Skeleton,
    shares: &Shares,
    p: &Parameters,
    seed: u64,
    material: usize,
) -> Primitive {
    let wanted: u32 = shares.counts.iter().sum();
    let fine_limit = match p.leaf.shape {
        LeafShape::NeedleSpray => COARSE_SPRAY_ABOVE,
        _ => COARSE_ABOVE,
    };
    let shapes = templates(&p.leaf, wanted > fine_limit);
    let mut out = Primitive {
        material,
        ..Primitive::default()
    };
    reserve(&mut out, &shapes[0], wanted as usize);
    let mut leaves = Vec::with_capacity(wanted as usize);
    let random = Random::new(seed).fork(4);
    let crown = Crown::of(skeleton);
    // total leaf area stays that of the natural density
    let natural = f64::from(p.leaf.count.max(1));
    let scale = p.leaf.scale * (natural / f64::from(wanted.max(1))).sqrt();
    // a handful of leaves cannot make up a crown; they stay recognisable as leaves
    let scale = scale.min(LONGEST * p.scale);
    for (i, stem) in skeleton.stems.iter().enumerate() {
        let mut own = random.fork(i as u64);
        let mut turn = own.unit() * 360.0;
        let count = shares.counts[i];
        for k in 0..count {
            let site = Site {
                stem,
                k,
                count,
                light: shares.light[i],
                scale,
                turn,
            };
            let leaf = place(&site, &p.leaf, &crown, &mut own);
            turn += p.leaf.rotate + p.leaf.rotate_v * own.signed();
            leaves.push(append(&mut out, &shapes[leaf.variant], &leaf));
        }
    }
    out.botany = Some(Arc::new(Botany {
        branch_order: Vec::new(),
        leaves,
    }));
    out
}

fn reserve(out: &mut Primitive, shape: &Template, leaves: usize) {
    let vertices = leaves * shape.positions.len();
    out.positions.reserve_exact(vertices);
    out.normals.reserve_exact(vertices);
    out.texcoords.reserve_exact(vertices);
    out.colors.reserve_exact(vertices);
    out.indices
        .reserve_exact(leaves * shape.triangles.len() * 3);
}

/// Where the light comes from, for leaves.
struct Crown {
    centre: DVec3,
}

impl Crown {
    fn of(skeleton: &Skeleton) -> Self {
        let top = skeleton
            .stems
            .iter()
            .flat_map(|s| &s.points)
            .fold(0.0f64, |top, q| top.max(q.y));
        Self {
            centre: DVec3::Y * (0.45 * top),
        }
    }

    /// Between up and out of the crown.
    fn light_at(&self, q: DVec3) -> DVec3 {
        let out = (q - self.centre).normalize_or_zero();
        (DVec3::Y + 0.8 * out).normalize_or(DVec3::Y)
    }
}

struct Site<'a> {
    stem: &'a Stem,
    k: u32,
    count: u32,
    light: f64,
    scale: f64,
    turn: f64,
}

fn place(site: &Site<'_>, leaf: &LeafParameters, crown: &Crown, random: &mut Random) -> Placement {
    let stem = site.stem;
    let first = leaf.bearing[usize::from(stem.order)].max(stem.start());
    let terminal = site.k + 1 == site.count;
    let along = (f64::from(site.k) + 0.5 + 0.6 * (random.unit() - 0.5)) / f64::from(site.count);
    let fraction = if terminal {
        1.0
    } else {
        first + (1.0 - first) * along
    };
    let point = stem.at(fraction);
    let heading = point.frame.z;
    // two-ranked leaves stand left and right of a level twig: angle 0 is level
    let level = heading.cross(DVec3::Y);
    let side = if level.length() > 0.15 {
        level.normalize()
    } else {
        point.frame.x
    };
    let rise = side.cross(heading);
    let turn = if leaf.rotate == 180.0 {
        180.0 * f64::from(site.k % 2) + leaf.rotate_v * random.signed()
    } else {
        site.turn
    };
    let (sine, cosine) = sin_cos_degrees(turn);
    let radial = side * cosine + rise * sine;
    let down = leaf.down_angle + leaf.down_angle_v * random.signed();
    let (sine, cosine) = sin_cos_degrees(if terminal { 0.25 * down } else { down });
    let jitter = DVec3::new(random.signed(), random.signed(), random.signed());
    let light = crown.light_at(point.position);
    let ahead = heading * cosine + radial * sine + 0.12 * jitter - DVec3::Y * (0.6 * leaf.droop);
    // leaf bend (section 4.9): the blade turns its upper side to the light
    let ahead = ahead - light * (0.6 * leaf.bend * ahead.dot(light));
    let size = 1.0 + 0.22 * random.signed();
    let length = site.scale * size;
    let mut ahead = ahead.normalize_or(heading);
    // no leaf pokes into the ground
    ahead.y = ahead.y.max(0.3 - 0.8 * point.position.y / length);
    let tangent = ahead.normalize_or(heading);
    let upper = heading * sine - radial * cosine;
    let upper = upper * (1.0 - leaf.bend) + light * leaf.bend;
    let sway = DVec3::new(random.signed(), random.signed(), random.signed());
    let upper = upper + 0.38 * sway;
    let normal = perpendicular(upper, tangent);
    let out = if terminal { heading } else { radial };
    Placement {
        base: point.position + out * (0.85 * point.radius),
        tangent,
        normal,
        length,
        variant: (random.bits() >> 33) as usize % VARIANTS,
        tint: tint(site.light, fraction, random),
        order: stem.order,
    }
}

/// The part of `v` perpendicular to the unit vector `axis`, unit length.
fn perpendicular(v: DVec3, axis: DVec3) -> DVec3 {
    let flat = v - axis * axis.dot(v);
    if flat.length_squared() > 1e-8 {
        return flat.normalize();
    }
    let other = if axis.y.abs() < 0.9 {
        DVec3::Y
    } else {
        DVec3::X
    };
    (other - axis * axis.dot(other)).normalize()
}

/// Colour variation: shade leaves darker and bluer, young and sunlit ones lighter and yellower.
fn tint(light: f64, fraction: f64, random: &mut Random) -> [f32; 4] {
    let young = smoothstep(0.6, 1.0, fraction);
    let value = 0.80 + 0.08 * light + 0.04 * young + 0.08 * random.signed();
    let yellow = 0.03 * light + 0.04 * young + 0.05 * random.signed();
    let red = (value * (0.95 + yellow * 1.6)).min(1.0);
    let green = value.min(1.0);
    let blue = (value * (0.92 - yellow)).min(1.0);
    [red as f32, green as f32, blue as f32, 1.0]
}

fn append(out: &mut Primitive, shape: &Template, leaf: &Placement) -> Leaf {
    let first_vertex = out.positions.len() as u32;
    let first_index = out.indices.len() as u32;
    let (x, z) = (leaf.tangent, leaf.normal);
    let y = z.cross(x);
    let turned = |q: DVec3| x * q.x + y * q.y + z * q.z;
    for q in &shape.positions {
        out.positions
            .push((leaf.base + turned(*q) * leaf.length).as_vec3().to_array());
    }
    for n in &shape.normals {
        out.normals
            .push(turned(*n).as_vec3().normalize().to_array());
    }
    out.texcoords.extend_from_slice(&shape.texcoords);
    out.colors.resize(out.positions.len(), leaf.tint);
    for t in &shape.triangles {
        out.indices.extend(t.map(|i| first_vertex + u32::from(i)));
    }
    Leaf {
        first_index,
        index_count: 3 * shape.triangles.len() as u32,
        base: leaf.base.as_vec3().to_array(),
        tangent: x.as_vec3().to_array(),
        normal: z.as_vec3().to_array(),
        length: leaf.length as f32,
        order: leaf.order,
    }
}
