//! Growth of the stems (Weber and Penn 1995, sections 4.1 to 4.6).

use glam::DVec3;

use super::frame::Frame;
use super::parameters::{Level, Parameters};
use super::plant::GrowOptions;
use super::portable::{pow, sin_cos_degrees};
use super::random::Random;
use super::stem::{Skeleton, Stem};
use crate::Result;

/// Thinnest twig, metres.
const MIN_RADIUS: f64 = 0.0007;
/// Radius left to each side of a fork: a little more than da Vinci's rule, which suits short forks.
const FORK_RADIUS: f64 = 0.84;
/// Fractions of the trunk at which the root flare needs its own sections.
const FLARE_SECTIONS: [f64; 7] = [0.004, 0.01, 0.018, 0.03, 0.045, 0.065, 0.09];

/// Grows the stems of a plant, all branching orders, before thinly leaved plants lose twigs.
///
/// # Errors
/// Parameters or options outside their ranges.
pub fn skeleton(parameters: &Parameters, options: &GrowOptions) -> Result<Skeleton> {
    parameters.check()?;
    options.check()?;
    let mut random = Random::new(options.seed);
    let height = parameters.scale + parameters.scale_v * random.signed();
    let mut grower = Grower {
        p: parameters,
        detail: f64::from(options.detail),
        height,
        stems: Vec::new(),
    };
    grower.trunks(&random);
    let max_order = grower.stems.iter().map(|s| s.order).max().unwrap_or(0);
    Ok(Skeleton {
        stems: grower.stems,
        max_order,
    })
}

struct Grower<'a> {
    p: &'a Parameters,
    detail: f64,
    height: f64,
    stems: Vec<Stem>,
}

/// A stem about to grow.
#[derive(Clone)]
struct Sprout {
    order: u8,
    parent: Option<(usize, f64)>,
    is_fork: bool,
    frame: Frame,
    position: DVec3,
    length: f64,
    radius: f64,
    first_segment: u32,
    random: Random,
}

/// A stem as the paper draws it: nodes with straight segments between them.
struct Trace {
    nodes: Vec<DVec3>,
    radius_scales: Vec<f64>,
    forks: Vec<Fork>,
}

struct Fork {
    frame: Frame,
    position: DVec3,
    segment: u32,
    radius_scale: f64,
}

impl Grower<'_> {
    fn trunks(&mut self, random: &Random) {
        let level = &self.p.level[0];
        let n = self.p.trunks;
        let turn = random.fork(1).unit() * 360.0;
        for i in 0..n {
            let mut own = random.fork(1000 + u64::from(i));
            let alone = n == 1;
            let azimuth = turn + level.rotate * f64::from(i) + level.rotate_v * own.signed();
            let (sine, cosine) = sin_cos_degrees(azimuth);
            // A sunflower's arrangement fills the ring's disc evenly; the outer stems lean most.
            let out = if alone {
                0.0
            } else {
                ((f64::from(i) + 0.5) / f64::from(n)).sqrt()
            };
            let down = level.down_angle * if alone { 1.0 } else { 0.25 + 0.75 * out }
                + level.down_angle_v * own.signed();
            let axis = DVec3::new(sine, 0.0, -cosine);
            let lean = Frame::upright().turned(DVec3::Y, -azimuth);
            let length = self.height
                * (level.length + level.length_v * own.signed())
                * if alone { 1.0 } else { 1.0 - 0.25 * out };
            let sprout = Sprout {
                order: 0,
                parent: None,
                is_fork: false,
                frame: lean.turned(axis, down),
                position: DVec3::new(cosine, 0.0, sine) * (self.p.trunk_spread * out),
                length,
                radius: length * self.p.ratio,
                first_segment: 0,
                random: own,
            };
            self.grow(sprout);
        }
    }

    /// Grows a stem with its forks and then their children, depth first.
    fn grow(&mut self, sprout: Sprout) {
        let mut trace = self.trace(&sprout);
        let mut sprout = sprout;
        // the envelope belongs to the leader of a tree: it bounds everything else
        if sprout.order > 0 || sprout.is_fork || self.p.trunks > 1 {
            let wanted = sprout.length;
            for _ in 0..16 {
                if self.inside(&trace) {
                    break;
                }
                sprout.length *= 0.88;
                trace = self.trace(&sprout);
            }
            // A shorter branch is a younger one: it is thinner as well.
            sprout.radius *= pow(sprout.length / wanted, 0.5 * self.p.ratio_power);
            if sprout.length < 0.15 * wanted {
                return;
            }
        }
        let id = self.finish(&sprout, &trace);
        for (i, fork) in trace.forks.into_iter().enumerate() {
            let level = &self.p.level[usize::from(sprout.order)];
            let fraction = f64::from(fork.segment) / f64::from(level.curve_res);
            self.grow(Sprout {
                order: sprout.order,
                parent: Some((id, fraction)),
                is_fork: true,
                frame: fork.frame,
                position: fork.position,
                length: sprout.length,
                radius: sprout.radius * fork.radius_scale,
                first_segment: fork.segment,
                random: sprout.random.fork(500 + i as u64),
            });
        }
        if sprout.order + 1 < self.p.levels {
            self.children(id, &sprout);
        }
    }

    /// Lays the segments of a stem: curvature (section 4.1), forks (4.2), attraction (4.8).
    fn trace(&self, sprout: &Sprout) -> Trace {
        let level = &self.p.level[usize::from(sprout.order)];
        let mut random = sprout.random.fork(2);
        let segments = level.curve_res;
        let step = sprout.length / f64::from(segments);
        let (mut frame, mut position) = (sprout.frame, sprout.position);
        let mut trace = Trace {
            nodes: vec![position],
            radius_scales: vec![1.0],
            forks: Vec::new(),
        };
        let mut scale = 1.0;
        let mut split_error = random.unit() - 0.5;
        for segment in sprout.first_segment..segments {
            if segment > sprout.first_segment {
                frame = bend(frame, level, segment, &mut random);
                let fraction = f64::from(segment) / f64::from(segments);
                let wanted = if fraction >= level.split_from {
                    level.seg_splits
                } else {
                    0.0
                };
                let splits = (wanted + split_error + 0.5).floor().max(0.0);
                split_error += wanted - splits;
                if splits > 0.5 {
                    let angle = level.split_angle + level.split_angle_v * random.signed();
                    let axis = frame.radial(random.unit() * std::f64::consts::TAU);
                    trace.forks.push(Fork {
                        frame: frame.turned(axis, 0.6 * angle),
                        position,
                        segment,
                        radius_scale: scale,
                    });
                    frame = frame.turned(axis, -0.4 * angle);
                    scale *= FORK_RADIUS;
                }
            }
            position += frame.z * step;
            trace.nodes.push(position);
            trace.radius_scales.push(scale);
        }
        trace
    }

    /// Whether a branch stays above ground and inside the pruning envelope (section 4.6).
    fn inside(&self, trace: &Trace) -> bool {
        let prune = &self.p.prune;
        trace.nodes.iter().skip(1).all(|q| {
            if q.y < 0.015 * self.height {
                return false;
            }
            if prune.ratio <= 0.0 {
                return true;
            }
            let crown = self.height * (1.0 - self.p.base_size);
            let r = ((self.height - q.y) / crown).min(0.98);
            if r <= 0.0 {
                return false;
            }
            let share = if r < prune.width_peak {
                pow(r / prune.width_peak, prune.power_high)
            } else {
                pow((1.0 - r) / (1.0 - prune.width_peak), prune.power_low)
            };
            let limit = prune.width * self.height * share;
            // `PruneRatio` below 1 lets branches through in part: it widens the envelope.
            let limit = limit / prune.ratio;
            q.x * q.x + q.z * q.z < limit * limit
        })
    }

    /// Rounds the nodes off to a smooth curve, adds radii and twist-free frames.
    fn finish(&mut self, sprout: &Sprout, trace: &Trace) -> usize {
        let level = &self.p.level[usize::from(sprout.order)];
        let fractions = self.sections(sprout, level);
        let mut stem = Stem {
            order: sprout.order,
            parent: sprout.parent,
            is_fork: sprout.is_fork,
            length: sprout.length,
            fractions,
            points: Vec::new(),
            radii: Vec::new(),
            frames: Vec::new(),
            bark_offset: 0.0,
            bark_repeats: 1.0,
        };
        let mut frame = sprout.frame;
        let mut thinnest = f64::INFINITY;
        for i in 0..stem.fractions.len() {
            let fraction = stem.fractions[i];
            let curve = fraction * f64::from(level.curve_res) - f64::from(sprout.first_segment);
            let (point, tangent, scale) = curve_at(trace, sprout.frame.z, curve);
            frame = frame.transported(tangent.normalize());
            let radius = self.radius(sprout, level, fraction) * scale;
            thinnest = radius.max(MIN_RADIUS).min(thinnest);
            stem.points.push(point);
            stem.frames.push(frame);
            stem.radii.push(thinnest);
        }
        if let (true, Some((parent, fraction))) = (sprout.is_fork, sprout.parent) {
            let parent = &self.stems[parent];
            stem.bark_repeats = parent.bark_repeats;
            stem.bark_offset = parent.bark_offset + fraction;
        } else {
            let around = std::f64::consts::TAU * sprout.radius;
            stem.bark_repeats = (around / 0.45).floor().clamp(1.0, 8.0);
            stem.bark_offset = sprout.random.fork(9).unit();
        }
        self.stems.push(stem);
        self.stems.len() - 1
    }

    /// Fractions of the stem at which it gets a section.
    fn sections(&self, sprout: &Sprout, level: &Level) -> Vec<f64> {
        let per_segment = if sprout.order <= 1 { 2.0 } else { 1.0 };
        let per_segment = (per_segment * self.detail + 0.5).floor().max(1.0);
        let first = f64::from(sprout.first_segment) / f64::from(level.curve_res);
        let n = (f64::from(level.curve_res - sprout.first_segment) * per_segment) as u32;
        let mut fractions: Vec<f64> = (0..=n)
            .map(|i| first + (1.0 - first) * f64::from(i) / f64::from(n))
            .collect();
        if sprout.order == 0 && !sprout.is_fork {
            fractions.extend(FLARE_SECTIONS);
        } else if let (1 | 2, Some((parent, at)), false) =
            (sprout.order, sprout.parent, sprout.is_fork)
        {
            let collar = self.stems[parent].at(at).radius / sprout.length;
            fractions.extend(
                [0.8, 1.3, 2.0]
                    .map(|r| r * collar)
                    .iter()
                    .filter(|&&f| f < 0.3),
            );
        }
        fractions.sort_by(f64::total_cmp);
        fractions.dedup_by(|a, b| *a - *b < 1e-3);
        let last = fractions.len() - 1;
        fractions[last] = 1.0;
        fractions
    }

    /// Radius before forks thin it (sections 4.4): taper, root flare, branch collar.
    fn radius(&self, sprout: &Sprout, level: &Level, fraction: f64) -> f64 {
        let tapered = sprout.radius * (1.0 - level.taper * fraction);
        if sprout.order == 0 && !sprout.is_fork {
            // Section 4.4: flare(y) = Flare (100^y - 1) / 100 + 1 with y = 1 - 8 z
            let y = (1.0 - 8.0 * fraction).max(0.0);
            return tapered * (1.0 + self.p.flare * (pow(100.0, y) - 1.0) / 100.0);
        }
        match (sprout.parent, sprout.is_fork) {
            (Some((parent, at)), false) if sprout.order <= 2 => {
                let reach = 2.0 * self.stems[parent].at(at).radius / sprout.length;
                let near = (1.0 - fraction / reach).max(0.0);
                tapered * (1.0 + 0.45 * near * near)
            }
            _ => tapered,
        }
    }

    /// Sets the children of a stem (section 4.3).
    fn children(&mut self, id: usize, sprout: &Sprout) {
        let order = sprout.order + 1;
        let level = self.p.level[usize::from(order)];
        let mut random = sprout.random.fork(3);
        let stem = &self.stems[id];
        let start = stem.start();
        let bare = if order == 1 {
            self.p.base_size
        } else {
            level.bare
        };
        let low = bare.max(start);
        let count = self.child_count(id, order) * (1.0 - low) / (1.0 - bare);
        let whorls = (count / f64::from(level.whorl) + random.unit()).floor();
        let mut turn = random.unit() * 360.0;
        for i in 0..whorls as u32 {
            let jitter = 0.7 * (random.unit() - 0.5);
            let fraction = low + (1.0 - low) * (f64::from(i) + 0.55 + jitter) / whorls;
            for k in 0..level.whorl {
                let own = random.fork(u64::from(i) * 64 + u64::from(k));
                let side = if (i + k) % 2 == 0 { 1.0 } else { -1.0 };
                let azimuth = if level.rotate < 0.0 {
                    0.5 * level.rotate * side
                } else {
                    turn + 360.0 * f64::from(k) / f64::from(level.whorl)
                };
                let azimuth = azimuth + level.rotate_v * random.signed();
                // the boughs of a whorl do not stand on one ring exactly
                let aside = if level.whorl > 1 {
                    0.5 * random.signed()
                } else {
                    0.0
                };
                let at = fraction + (1.0 - low) * aside / whorls;
                self.child(id, at.clamp(low, 0.995), azimuth, own);
            }
            turn += level.rotate;
        }
    }

    fn child_count(&self, id: usize, order: u8) -> f64 {
        let stem = &self.stems[id];
        let level = &self.p.level[usize::from(order)];
        match order {
            1 => level.branches,
            _ => {
                let whole = self.longest(order - 1);
                level.branches * (0.2 + 0.8 * (stem.length / whole).min(1.2))
            }
        }
    }

    /// Length of an unhindered stem of an order on a trunk of this plant's height.
    fn longest(&self, order: u8) -> f64 {
        (0..=usize::from(order))
            .map(|n| self.p.level[n].length)
            .product::<f64>()
            * self.height
    }

    fn child(&mut self, id: usize, fraction: f64, azimuth: f64, mut random: Random) {
        let parent = &self.stems[id];
        let order = parent.order + 1;
        let level = &self.p.level[usize::from(order)];
        let bare = if order == 1 {
            self.p.base_size
        } else {
            level.bare
        };
        let crown = (1.0 - fraction) / (1.0 - bare);
        let share = level.length + level.length_v * random.signed();
        let length = if order == 1 {
            parent.length * share * self.p.shape.ratio(crown)
        } else {
            parent.length * share * (1.0 - 0.6 * fraction)
        };
        let down = if level.down_angle_v >= 0.0 {
            level.down_angle + level.down_angle_v * random.signed()
        } else {
            let conical = 0.2 + 0.8 * crown.clamp(0.0, 1.0);
            level.down_angle + level.down_angle_v * (1.0 - 2.0 * conical + 0.2 * random.signed())
        };
        let place = parent.at(fraction);
        let thick = parent.radii[0].min(self.nominal_radius(id));
        let radius = thick * pow((length / parent.length).min(1.0), self.p.ratio_power);
        let sprout = Sprout {
            order,
            parent: Some((id, fraction)),
            is_fork: false,
            frame: place.frame.child(azimuth, down),
            position: place.position,
            length,
            radius: radius.min(0.8 * place.radius).max(MIN_RADIUS),
            first_segment: 0,
            random,
        };
        self.grow(sprout);
    }

    /// Radius at the base of the first stem of a row of forks, without flare or collar.
    fn nominal_radius(&self, id: usize) -> f64 {
        let stem = &self.stems[id];
        match (stem.order, stem.is_fork) {
            (0, false) => stem.length * self.p.ratio,
            (0, true) => stem.radii[0] / (1.0 - 0.9 * stem.start()).max(0.1),
            _ => stem.radii[0],
        }
    }
}

/// Curvature of one segment (section 4.1) and attraction to or from the light.
fn bend(frame: Frame, level: &Level, segment: u32, random: &mut Random) -> Frame {
    let n = f64::from(level.curve_res);
    let along = if level.curve_back == 0.0 {
        level.curve / n
    } else if f64::from(segment) < 0.5 * n {
        level.curve / (0.5 * n)
    } else {
        level.curve_back / (0.5 * n)
    };
    let wobble = level.curve_v / n;
    let frame = frame.turned(frame.x, along + wobble * random.signed());
    let frame = frame.turned(frame.y(), wobble * random.signed());
    frame.steered(DVec3::Y, level.attraction_up / n)
}

/// Position, tangent and radius scale on the Catmull-Rom curve through the nodes.
fn curve_at(trace: &Trace, first_tangent: DVec3, at: f64) -> (DVec3, DVec3, f64) {
    let last = trace.nodes.len() - 1;
    let i = (at.max(0.0) as usize).min(last - 1);
    let t = (at - i as f64).clamp(0.0, 1.0);
    let step = (trace.nodes[1] - trace.nodes[0]).length();
    let tangent = |k: usize| match k {
        0 => first_tangent * step,
        k if k == last => trace.nodes[last] - trace.nodes[last - 1],
        k => 0.5 * (trace.nodes[k + 1] - trace.nodes[k - 1]),
    };
    let (p, q) = (trace.nodes[i], trace.nodes[i + 1]);
    let (m, n) = (tangent(i), tangent(i + 1));
    let (t2, t3) = (t * t, t * t * t);
    let point = p * (2.0 * t3 - 3.0 * t2 + 1.0)
        + m * (t3 - 2.0 * t2 + t)
        + q * (3.0 * t2 - 2.0 * t3)
        + n * (t3 - t2);
    let slope = p * (6.0 * t2 - 6.0 * t)
        + m * (3.0 * t2 - 4.0 * t + 1.0)
        + q * (6.0 * t - 6.0 * t2)
        + n * (3.0 * t2 - 2.0 * t);
    let scale = trace.radius_scales[i] * (1.0 - t) + trace.radius_scales[i + 1] * t;
    (point, slope, scale)
}
