//! Ways along and round branches that are continuous: signs and frames go over from neighbour to
//! neighbour, then the way along is fitted to the axes (least squares over all edges).

use std::cmp::Ordering;
use std::collections::{BinaryHeap, VecDeque};

use glam::DVec3;

use super::axes::Axis;
use super::surface::{Graph, Surface};

/// Steps of the fit at most; the start is near already.
const STEPS: usize = 60;
/// The fit ends when this share of the first error is left.
const LEFT: f64 = 1e-3;
/// Rounds in which neighbouring frames agree.
const ROUNDS: usize = 8;

/// An edge over which a sign goes over: those whose axes agree most come first.
struct Step {
    agree: f64,
    from: u32,
    to: u32,
}

impl PartialEq for Step {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Step {}

impl PartialOrd for Step {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Step {
    fn cmp(&self, other: &Self) -> Ordering {
        self.agree
            .total_cmp(&other.agree)
            .then(other.to.cmp(&self.to))
            .then(other.from.cmp(&self.from))
    }
}

/// What is continuous over the surface.
#[derive(Debug, Clone)]
pub(super) struct Ways {
    /// Unit axes whose signs agree along branches.
    pub(super) direction: Vec<DVec3>,
    /// Unit vectors across, from which the way round is measured.
    pub(super) zero: Vec<DVec3>,
    /// Way along, metres.
    pub(super) along: Vec<f64>,
}

/// Ways along `axes`.
pub(super) fn ways(surface: &Surface, axes: &[Axis]) -> Ways {
    let count = surface.places.len();
    let mut out = Ways {
        direction: axes.iter().map(|a| a.direction).collect(),
        zero: vec![DVec3::ZERO; count],
        along: vec![0.0; count],
    };
    let mut seen = vec![false; count];
    let mut heap = BinaryHeap::new();
    // Pieces begin at their lowest place, upwards.
    let mut order: Vec<u32> = (0..count as u32).collect();
    order.sort_by(|&a, &b| {
        let height = |i: u32| surface.places[i as usize].y;
        height(a).total_cmp(&height(b)).then(a.cmp(&b))
    });
    for start in order {
        let s = start as usize;
        if seen[s] {
            continue;
        }
        seen[s] = true;
        if out.direction[s].y < 0.0 {
            out.direction[s] = -out.direction[s];
        }
        out.reach(&surface.graph, start, &seen, &mut heap);
        while let Some(Step { from, to, .. }) = heap.pop() {
            if !seen[to as usize] {
                seen[to as usize] = true;
                out.sign(from as usize, to as usize);
                out.reach(&surface.graph, to, &seen, &mut heap);
            }
        }
        out.spread(surface, start);
    }
    out.settle(&surface.graph);
    out.fit(surface);
    out
}

impl Ways {
    fn reach(&self, graph: &Graph, from: u32, seen: &[bool], heap: &mut BinaryHeap<Step>) {
        let own = self.direction[from as usize];
        for &to in graph
            .of(from as usize)
            .iter()
            .filter(|&&j| !seen[j as usize])
        {
            let agree = own.dot(self.direction[to as usize]).abs();
            heap.push(Step { agree, from, to });
        }
    }

    fn sign(&mut self, from: usize, to: usize) {
        if self.direction[to].dot(self.direction[from]) < 0.0 {
            self.direction[to] = -self.direction[to];
        }
    }

    /// Frames and first lengths of a piece, by the fewest edges: a frame that went round a bent
    /// branch many times would come back turned.
    fn spread(&mut self, surface: &Surface, start: u32) {
        let s = start as usize;
        self.zero[s] = self.direction[s].any_orthonormal_vector();
        // Tubes of one tree do not all start with the same stroke.
        self.along[s] = 0.618_034 * (f64::from(start) % 97.0);
        let mut queue = VecDeque::from([s]);
        while let Some(from) = queue.pop_front() {
            for &to in surface.graph.of(from) {
                let to = to as usize;
                if self.zero[to] != DVec3::ZERO {
                    continue;
                }
                self.zero[to] = across(self.zero[from], self.direction[to])
                    .unwrap_or_else(|| self.direction[to].any_orthonormal_vector());
                self.along[to] = self.along[from] + self.step(surface, from, to);
                queue.push_back(to);
            }
        }
    }

    /// Way along from one place to its neighbour.
    fn step(&self, surface: &Surface, from: usize, to: usize) -> f64 {
        let way = surface.places[to] - surface.places[from];
        0.5 * (self.direction[from] + self.direction[to]).dot(way)
    }

    /// Frames that came by different ways meet gently.
    fn settle(&mut self, graph: &Graph) {
        for _ in 0..ROUNDS {
            let one = |i: usize| {
                let sum: DVec3 = graph.of(i).iter().map(|&j| self.zero[j as usize]).sum();
                across(self.zero[i] + sum, self.direction[i]).unwrap_or(self.zero[i])
            };
            self.zero = (0..self.zero.len()).map(one).collect();
        }
    }

    /// Conjugate gradients (Hestenes, Stiefel 1952) on the graph's Laplacian: differences over
    /// edges become the axes' as far as they can all be.
    fn fit(&mut self, surface: &Surface) {
        let graph = &surface.graph;
        let count = self.along.len();
        let mut residual: Vec<f64> = (0..count)
            .map(|i| {
                let of = |&j: &u32| {
                    let j = j as usize;
                    self.along[j] - self.along[i] - self.step(surface, i, j)
                };
                graph.of(i).iter().map(of).sum()
            })
            .collect();
        let mut search = residual.clone();
        let mut norm = dot(&residual, &residual);
        let goal = norm * LEFT * LEFT;
        for _ in 0..STEPS {
            if norm <= goal || norm <= f64::MIN_POSITIVE {
                break;
            }
            let image: Vec<f64> = (0..count)
                .map(|i| {
                    graph
                        .of(i)
                        .iter()
                        .map(|&j| search[i] - search[j as usize])
                        .sum()
                })
                .collect();
            let curvature = dot(&search, &image);
            if curvature <= 0.0 || !curvature.is_finite() {
                break;
            }
            let step = norm / curvature;
            for i in 0..count {
                self.along[i] += step * search[i];
                residual[i] -= step * image[i];
            }
            let next = dot(&residual, &residual);
            let ratio = next / norm;
            for (s, r) in search.iter_mut().zip(&residual) {
                *s = r + ratio * *s;
            }
            norm = next;
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// The part of `v` across `axis`, of unit length.
fn across(v: DVec3, axis: DVec3) -> Option<DVec3> {
    (v - v.dot(axis) * axis).try_normalize()
}
