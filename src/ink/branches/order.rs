//! Branching order from nothing but the surface: connected tubes, each with its foot in another.
//!
//! Every branch of models that programs have grown is a tube of its own that begins within the
//! branch that bears it. Where the surface is no set of tubes (scans, welded meshes) nothing is
//! told.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::surface::{NONE, Surface};

/// A tube's sections are at most so many times wider than its area and length say.
const WIDEST: f64 = 3.0;
/// Share of the tubes' area, of which sections are narrow enough and whose foot is in another, that
/// is enough to tell orders.
const ENOUGH: f64 = 0.8;
/// A foot lies within so many radii of the axis of what bears it.
const WITHIN: f64 = 1.6;
/// A branch at least this share of what bears it, beyond where they part, is a fork: it has its order.
const FORK: f64 = 0.88;
/// A fork is as long as what is left of what bears it, within this factor.
const AS_LONG: f64 = 1.6;
/// Branches are wider at their foot, over so many radii of what bears them.
const FLARE: f64 = 2.5;
/// Length of sections in mean radii of their tube, which is about twice as thick at its foot.
const ROUND: f64 = 4.5;
/// Sections of a tube at most.
const SECTIONS: usize = 256;

/// One section: its middle, radius and way along the axis, metres.
#[derive(Debug, Clone, Copy, Default)]
struct Section {
    middle: DVec3,
    radius: f64,
    along: f64,
    /// Vertices in it.
    count: f64,
}

/// A connected piece of the surface.
#[derive(Debug, Clone, Default)]
pub(super) struct Tube {
    pub(super) nodes: Vec<u32>,
    area: f64,
    /// From the thick end to the thin one.
    sections: Vec<Section>,
    low: DVec3,
    high: DVec3,
    narrow: bool,
}

impl Tube {
    fn radius(&self) -> f64 {
        self.sections[0].radius
    }

    /// Whether it is one, rather than a surface of any other form.
    pub(super) fn is_narrow(&self) -> bool {
        self.narrow
    }

    /// Middles of its sections, their radii (metres) and how many vertices they have.
    pub(super) fn axis(&self) -> impl Iterator<Item = (DVec3, f64, f64)> {
        self.sections.iter().map(|s| (s.middle, s.radius, s.count))
    }

    fn length(&self) -> f64 {
        self.sections.last().map_or(0.0, |s| s.along)
    }

    /// Distance of a place from the axis in radii, the radius there and how far along that is.
    fn near(&self, p: DVec3) -> (f64, f64, f64) {
        let mut best = (f64::INFINITY, self.radius(), 0.0);
        for s in self.sections.windows(2) {
            let way = s[1].middle - s[0].middle;
            let square = way.length_squared();
            let t = if square > 0.0 {
                ((p - s[0].middle).dot(way) / square).clamp(0.0, 1.0)
            } else {
                0.0
            };
            let radius = (s[0].radius + t * (s[1].radius - s[0].radius)).max(1e-12);
            let away = p.distance(s[0].middle + t * way) / radius;
            if away < best.0 {
                best = (away, radius, s[0].along + t * (s[1].along - s[0].along));
            }
        }
        best
    }

    /// The radius at a way along.
    fn radius_at(&self, along: f64) -> f64 {
        let next = self.sections.partition_point(|s| s.along < along);
        self.sections[next.min(self.sections.len() - 1)].radius
    }
}

/// The branching order (0: trunk) of every vertex that `indices` name, `u8::MAX` for others; none
/// where the surface does not tell it.
#[must_use]
pub fn orders(positions: &[Vec3], indices: &[u32]) -> Option<Vec<u8>> {
    let surface = Surface::new(positions, indices);
    let tubes = tubes(&surface);
    let parents: Vec<Option<(usize, bool)>> = (0..tubes.len())
        .into_par_iter()
        .map(|i| parent(&tubes, i))
        .collect();
    let whole: f64 = tubes.iter().map(|t| t.area).sum();
    let told: f64 = (0..tubes.len())
        .filter(|&i| tubes[i].narrow && (parents[i].is_some() || is_trunk(&tubes, i)))
        .map(|i| tubes[i].area)
        .sum();
    // One tube alone may be a trunk; a tree that is one piece is not narrow.
    if tubes.is_empty() || told < ENOUGH * whole {
        return None;
    }
    let mut of_tube = vec![None; tubes.len()];
    for i in 0..tubes.len() {
        order_of(i, &tubes, &parents, &mut of_tube);
    }
    let mut of_node = vec![u8::MAX; surface.places.len()];
    for (tube, order) in tubes.iter().zip(&of_tube) {
        for &node in &tube.nodes {
            of_node[node as usize] = order.unwrap_or(u8::MAX);
        }
    }
    let of_vertex = |&node: &u32| {
        if node == NONE {
            u8::MAX
        } else {
            of_node[node as usize]
        }
    };
    Some(surface.of_vertex.iter().map(of_vertex).collect())
}

/// Whether a tube that nothing bears may be a trunk: it stands as low as the lowest, and is thick.
fn is_trunk(tubes: &[Tube], i: usize) -> bool {
    let low = tubes.iter().map(|t| t.low.y).fold(f64::INFINITY, f64::min);
    let high = tubes.iter().map(|t| t.high.y).fold(low, f64::max);
    let thickest = tubes.iter().map(Tube::radius).fold(0.0, f64::max);
    tubes[i].low.y < low + 0.1 * (high - low) && tubes[i].radius() > 0.1 * thickest
}

/// The order of a tube: one more than that of what bears it, or the same for forks. Follows the ways
/// down without recursion; rings (of which there are none, as what bears is thicker) end.
fn order_of(
    tube: usize,
    tubes: &[Tube],
    parents: &[Option<(usize, bool)>],
    known: &mut [Option<u8>],
) {
    let mut way = vec![tube];
    while let Some(&last) = way.last() {
        match parents[last] {
            Some((next, _)) if known[last].is_none() && way.len() <= parents.len() => {
                way.push(next);
            }
            _ => break,
        }
    }
    while let Some(i) = way.pop() {
        if known[i].is_none() {
            let order = match parents[i] {
                Some((p, fork)) => known[p].unwrap_or(0).saturating_add(u8::from(!fork)),
                None if is_trunk(tubes, i) => 0,
                // Thin, and borne by nothing that is known.
                None => u8::MAX,
            };
            known[i] = Some(order);
        }
    }
}

/// What bears a tube, and whether the tube is a fork of it.
fn parent(tubes: &[Tube], i: usize) -> Option<(usize, bool)> {
    let tube = &tubes[i];
    let radius = tube.radius();
    let foot = tube.sections[0].middle;
    let mut best: Option<(f64, usize, bool)> = None;
    for (j, other) in tubes.iter().enumerate() {
        let reach = WITHIN * other.radius() + radius;
        let outside =
            (other.low - reach).cmpgt(foot).any() || (other.high + reach).cmplt(foot).any();
        // What bears is thicker at its foot; among equals the longer, then the first.
        let rank = |t: &Tube, k: usize| (t.radius(), t.length(), Reverse(k));
        if i == j || outside || rank(other, j) <= rank(tube, i) {
            continue;
        }
        let (away, there, along) = other.near(foot);
        // A foot is not much thicker than what it stands on.
        if away > WITHIN || radius > 2.0 * there {
            continue;
        }
        // Inside several the thicker bears it.
        let score = away.max(1.0) - 0.01 * (there / radius).min(20.0);
        if best.is_none_or(|b| score < b.0) {
            best = Some((score, j, is_fork(tube, other, there, along)));
        }
    }
    best.map(|b| (b.1, b.2))
}

/// Whether a tube goes on as what bears it does beyond the place `along` it.
fn is_fork(tube: &Tube, other: &Tube, there: f64, along: f64) -> bool {
    let beyond = FLARE * there;
    let left = other.length() - along;
    let thick = tube.radius_at(beyond) > FORK * other.radius_at(along + beyond);
    thick && tube.length() < AS_LONG * left && left < AS_LONG * tube.length()
}

/// The connected pieces of a surface.
pub(super) fn tubes(surface: &Surface) -> Vec<Tube> {
    let count = surface.places.len();
    let mut seen = vec![false; count];
    let mut pieces = Vec::new();
    for start in 0..count {
        if seen[start] {
            continue;
        }
        seen[start] = true;
        let mut nodes = vec![start as u32];
        let mut next = 0;
        while next < nodes.len() {
            for &j in surface.graph.of(nodes[next] as usize) {
                if !std::mem::replace(&mut seen[j as usize], true) {
                    nodes.push(j);
                }
            }
            next += 1;
        }
        pieces.push(nodes);
    }
    pieces
        .into_par_iter()
        .map(|nodes| tube(surface, nodes))
        .collect()
}

/// Ways along the surface from a node to all of its piece, and the last that is reached.
fn ways(surface: &Surface, nodes: &[u32], index: &[(u32, u32)], from: u32) -> (Vec<f64>, u32) {
    let local = |node: u32| {
        let at = index.partition_point(|e| e.0 < node);
        index[at].1 as usize
    };
    let mut way = vec![f64::INFINITY; nodes.len()];
    let mut open = BinaryHeap::new();
    way[local(from)] = 0.0;
    open.push(Reverse((0_u64, from)));
    let mut last = from;
    while let Some(Reverse((bits, node))) = open.pop() {
        // Lengths are not negative: their bits have their order.
        let here = f64::from_bits(bits);
        if here > way[local(node)] {
            continue;
        }
        last = node;
        for &j in surface.graph.of(node as usize) {
            let step = surface.places[node as usize].distance(surface.places[j as usize]);
            let (next, k) = (here + step, local(j));
            if next < way[k] {
                way[k] = next;
                open.push(Reverse((next.to_bits(), j)));
            }
        }
    }
    (way, last)
}

fn tube(surface: &Surface, nodes: Vec<u32>) -> Tube {
    let place = |&n: &u32| surface.places[n as usize];
    let low = nodes.iter().map(place).fold(DVec3::INFINITY, DVec3::min);
    let high = nodes
        .iter()
        .map(place)
        .fold(DVec3::NEG_INFINITY, DVec3::max);
    let area: f64 = nodes
        .iter()
        .map(|&n| surface.moments[n as usize].area)
        .sum();
    let mut index: Vec<(u32, u32)> = (0..).zip(&nodes).map(|(k, &n)| (n, k)).collect();
    index.sort_unstable();
    let (_, one) = ways(surface, &nodes, &index, nodes[0]);
    let (mut way, other) = ways(surface, &nodes, &index, one);
    let length = way.iter().copied().fold(0.0, f64::max);
    // From the thick end: there is more surface on its half.
    let near = nodes.iter().zip(&way).filter(|e| *e.1 < 0.5 * length);
    let near: f64 = near.map(|e| surface.moments[*e.0 as usize].area).sum();
    if near < 0.5 * area {
        way = ways(surface, &nodes, &index, other).0;
    }
    let mean = area / (std::f64::consts::TAU * length.max(1e-12));
    // Sections so long that each has all its round, at the thick end too.
    let step = (ROUND * mean).max(length / SECTIONS as f64).max(1e-12);
    let bins = ((length / step) as usize + 1).min(SECTIONS + 1);
    let bin = |k: usize| ((way[k] / step) as usize).min(bins - 1);
    let mut sums = vec![(DVec3::ZERO, 0.0_f64, 0.0_f64); bins];
    for (k, n) in nodes.iter().enumerate() {
        let sum = &mut sums[bin(k)];
        *sum = (sum.0 + place(n), sum.1 + 1.0, sum.2);
    }
    let middle = |b: usize| sums[b].0 / sums[b].1.max(1.0);
    let middles: Vec<DVec3> = (0..bins).map(middle).collect();
    let (mut wide, mut total) = (0.0, 0.0);
    for (k, n) in nodes.iter().enumerate() {
        let b = bin(k);
        // Away from the axis, whose direction the neighbours' middles give.
        let neighbour = |mut at: usize, forth: bool| {
            while forth && at + 1 < bins || !forth && at > 0 {
                at = if forth { at + 1 } else { at - 1 };
                if sums[at].1 > 0.0 {
                    return Some(middles[at]);
                }
            }
            None
        };
        let ahead = neighbour(b, true).unwrap_or(middles[b]);
        let behind = neighbour(b, false).unwrap_or(middles[b]);
        let axis = (ahead - behind).normalize_or_zero();
        let off = place(n) - middles[b];
        sums[b].2 += off.reject_from_normalized(axis).length();
        let share = surface.moments[*n as usize].area;
        total += share;
        if off.length() > WIDEST * (mean + 0.5 * step) {
            wide += share;
        }
    }
    let filled = (0..bins).filter(|&b| sums[b].1 > 0.0);
    let mut sections: Vec<Section> = filled
        .map(|b| Section {
            middle: middles[b],
            radius: sums[b].2 / sums[b].1,
            along: 0.0,
            count: sums[b].1,
        })
        .collect();
    // The first section holds the end's cap: its neighbour tells the radius.
    if sections.len() > 2 {
        sections[0].radius = sections[0].radius.max(sections[1].radius);
    }
    for i in 1..sections.len() {
        let way = sections[i].middle.distance(sections[i - 1].middle);
        sections[i].along = sections[i - 1].along + way;
    }
    Tube {
        nodes,
        area,
        sections,
        low,
        high,
        narrow: wide < 0.1 * total.max(f64::MIN_POSITIVE),
    }
}
