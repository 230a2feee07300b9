//! Axes of branches from the surface around each place: the direction that the normals there have
//! least of. Pieces of the surface grow until they have seen enough of the branch's round.

use glam::{DMat3, DVec3};

use super::surface::{Graph, Moments, Surface, outer};
use crate::math::eigen::symmetric;

/// Nodes that become one at the next coarser level at most.
const MERGED: usize = 4;
/// Levels at most; each has about a third of the nodes of the one before.
const LEVELS: usize = 16;
/// A smaller piece is taken when it tells the axis as well as this share of the larger one.
const AS_WELL: f64 = 0.8;
/// Less than this of the normals' spread is a flat piece.
const FLAT: f64 = 0.02;
/// Rounds in which neighbours agree.
const ROUNDS: usize = 4;

/// The branch at a place.
#[derive(Debug, Clone, Copy)]
pub(super) struct Axis {
    /// Unit direction, its sign free.
    pub(super) direction: DVec3,
    /// The middle of the piece of surface that told it.
    pub(super) middle: DVec3,
    /// Radius, metres.
    pub(super) radius: f64,
    /// How well the surface tells the axis: 0 (flat, or round like a ball) to 1/2 (a tube).
    sure: f64,
}

impl Axis {
    /// 1 where the surface is flat, 0 where it is a tube.
    pub(super) fn flatness(&self) -> f64 {
        (1.0 - self.sure / FLAT).clamp(0.0, 1.0)
    }
}

/// The branch at every place of the surface.
pub(super) fn axes(surface: &Surface) -> Vec<Axis> {
    let mut levels = vec![(surface.moments.clone(), surface.graph.clone())];
    let mut parents: Vec<Vec<u32>> = Vec::new();
    while levels.len() < LEVELS {
        let (moments, graph) = &levels[levels.len() - 1];
        let (parent, count) = merged(moments, graph);
        if count == moments.len() {
            break;
        }
        let mut coarse = vec![Moments::NONE; count];
        for (m, &p) in moments.iter().zip(&parent) {
            coarse[p as usize].add(m);
        }
        let edges = (0..graph.len()).flat_map(|i| graph.of(i).iter().map(move |&j| (i, j)));
        let edges = edges.map(|(i, j)| (parent[i], parent[j as usize]));
        levels.push((coarse, Graph::new(count, edges)));
        parents.push(parent);
    }
    let mut found: Vec<Axis> = Vec::new();
    for level in (0..levels.len()).rev() {
        let (moments, graph) = &levels[level];
        let choose = |i: usize| {
            let own = axis(&around(moments, graph, i));
            match parents.get(level).map(|p| found[p[i] as usize]) {
                Some(larger) if own.sure < AS_WELL * larger.sure => larger,
                _ => own,
            }
        };
        found = (0..moments.len()).map(choose).collect();
    }
    agreed(&surface.graph, found)
}

/// A node with its neighbours.
fn around(moments: &[Moments], graph: &Graph, node: usize) -> Moments {
    let mut sum = moments[node];
    for &j in graph.of(node) {
        sum.add(&moments[j as usize]);
    }
    sum
}

/// For each node the coarser one that it becomes part of, and their count: a node takes its
/// nearest free neighbours.
fn merged(moments: &[Moments], graph: &Graph) -> (Vec<u32>, usize) {
    let place = |i: usize| moments[i].place / moments[i].area.max(f64::MIN_POSITIVE);
    let mut parent = vec![u32::MAX; moments.len()];
    let mut count = 0;
    let mut free: Vec<(f64, u32)> = Vec::new();
    for i in 0..moments.len() {
        if parent[i] != u32::MAX {
            continue;
        }
        parent[i] = count;
        free.clear();
        let open = graph
            .of(i)
            .iter()
            .filter(|&&j| parent[j as usize] == u32::MAX);
        free.extend(open.map(|&j| (place(i).distance_squared(place(j as usize)), j)));
        free.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for &(_, j) in free.iter().take(MERGED - 1) {
            parent[j as usize] = count;
        }
        count += 1;
    }
    (parent, count as usize)
}

/// The axis that a piece tells.
fn axis(m: &Moments) -> Axis {
    let area = m.area.max(f64::MIN_POSITIVE);
    let normals = symmetric(m.normals);
    let total = normals.iter().map(|e| e.0).sum::<f64>();
    let sure = (normals[1].0 - normals[2].0) / total.max(f64::MIN_POSITIVE);
    let (place, normal) = (m.place / area, m.normal / area);
    let spread = (m.places - outer(place, m.place)) * (1.0 / area);
    if sure < FLAT {
        // Flat: the longest direction in its plane.
        let longest = symmetric(spread)[0];
        let direction = longest.1;
        // A rectangle's half width is sqrt(3) of its spread.
        let width = (3.0 * (trace(spread) - longest.0)).max(0.0).sqrt();
        return Axis {
            direction,
            middle: place,
            radius: width,
            sure: if m.area > 0.0 { 0.25 * FLAT } else { 0.0 },
        };
    }
    let direction = normals[2].1;
    // Across the axis a tube is place = middle + radius * normal: least squares.
    let across = DMat3::IDENTITY - outer(direction, direction);
    let both = (m.crossed - outer(place, m.normal)) * (1.0 / area);
    let own = (m.normals - outer(normal, m.normal)) * (1.0 / area);
    let radius = (trace(across * both) / trace(across * own).max(1e-12)).abs();
    Axis {
        direction,
        middle: place,
        radius,
        sure,
    }
}

fn trace(m: DMat3) -> f64 {
    m.x_axis.x + m.y_axis.y + m.z_axis.z
}

/// Neighbours' axes taken together, by how sure they are; the signs do not matter.
fn agreed(graph: &Graph, mut axes: Vec<Axis>) -> Vec<Axis> {
    for _ in 0..ROUNDS {
        let one = |i: usize| {
            let own = axes[i];
            let weight = |a: &Axis| a.sure.max(1e-6);
            let mut direction = weight(&own) * own.direction;
            let mut middle = weight(&own) * own.middle;
            let mut radius = weight(&own) * own.radius.max(1e-12).ln();
            let mut total = weight(&own);
            for &j in graph.of(i) {
                let a = axes[j as usize];
                // Middles of neighbours lie elsewhere along the axis.
                let w = weight(&a);
                let slid = a.middle - (a.middle - own.middle).dot(own.direction) * own.direction;
                direction += w * a.direction.dot(own.direction).signum() * a.direction;
                middle += w * slid;
                radius += w * a.radius.max(1e-12).ln();
                total += w;
            }
            Axis {
                direction: direction.try_normalize().unwrap_or(own.direction),
                middle: middle / total,
                radius: (radius / total).exp(),
                sure: own.sure,
            }
        };
        axes = (0..axes.len()).map(one).collect();
    }
    axes
}
