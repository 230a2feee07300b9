//! Branches too narrow for two outlines: one line along the axis, where nothing hides it.

use glam::DVec2;

use super::anchored::{metres_of_pixel, noise_at};
use super::curve::Polyline;
use super::drawing::{Placement, Shade, least, width};
use super::limbs::{LimbPoint, is_bare, pixel_of, thin};
use super::pen::Stroke;
use super::renderer::Maps;
use super::style::PaperStyle;
use crate::ink::view::View;

/// Shorter gaps are closed, pixels: a leaf's corner, or a pixel more or less.
const GAP: f64 = 2.5;
/// What lies nearer than its axis by so many radii hides a branch.
const FRONT: f64 = 2.5;
/// Way that a line runs on into what is drawn by two, pixels.
const OVER: f64 = 4.0;

/// Lines of narrow branches, as the pen of stems draws them.
pub(super) fn single_lines(
    maps: &Maps,
    style: &PaperStyle,
    view: &View,
    placement: &Placement,
) -> Vec<Stroke> {
    let limit = thin(style, placement.scale);
    if !style.stem.draw || limit <= 0.0 {
        return Vec::new();
    }
    let shortest = least(style.stem.shortest, style, placement);
    let runs = maps.limbs.iter().flat_map(|l| {
        let thin = |p: &LimbPoint| p.width < limit || is_bare(maps, p, limit);
        let thin: Vec<bool> = l.iter().map(thin).collect();
        let draws = |k: usize| is_near(l, &thin, k) && is_seen(maps, style, view, &l[k]);
        let flags: Vec<bool> = (0..l.len()).map(draws).collect();
        pieces(l, &flags, shortest)
    });
    runs.map(|run| drawn(run, maps, (style, view), placement))
        .collect()
}

/// Whether a branch is one line at a point, or just before where it becomes so.
fn is_near(limb: &[LimbPoint], thin: &[bool], k: usize) -> bool {
    let near = |j: &usize| limb[*j].at.distance(limb[k].at) <= OVER;
    let before = (0..k).rev().take_while(near);
    let after = (k + 1..limb.len()).take_while(near);
    thin[k] || before.chain(after).any(|j| thin[j])
}

/// Whether nothing hides a point, and what lies behind it is farther by the threshold.
fn is_seen(maps: &Maps, style: &PaperStyle, view: &View, point: &LimbPoint) -> bool {
    let Some(pixel) = pixel_of(maps, point) else {
        return false;
    };
    let [foliage, stem] = [&maps.foliage_depth, &maps.stem_depth].map(|d| f64::from(d[pixel]));
    let front = point.depth - FRONT * point.radius;
    let hidden = |depth: f64| depth > 0.0 && depth < front;
    let [more, wider] = maps.factors.get(pixel).copied().unwrap_or([1.0; 2]);
    let step = unit(stem, style, view) - unit(point.depth, style, view);
    let over = step > style.stem.threshold * f64::from(more) || stem > 0.0 && stem < point.depth;
    !hidden(foliage) && !hidden(stem) && over && wider > 0.0
}

/// A depth in units of the threshold, as `difference.comp` has it; 0: nothing is there.
fn unit(depth: f64, style: &PaperStyle, view: &View) -> f64 {
    let d = &style.depth;
    if depth <= 0.0 {
        return if d.sky_at_far { 65535.0 } else { f64::INFINITY };
    }
    let [nearest, farthest] = if d.fitted {
        view.depths.map(f64::from)
    } else {
        [d.near, d.far]
    };
    let share = (depth - nearest) / (farthest - nearest);
    let z = d.near + share * (d.far - d.near);
    let mapped = d.far * (z - d.near) / (z * (d.far - d.near));
    65535.0 * if d.mapped { mapped } else { share }
}

/// The pieces of an axis that are drawn: without gaps of a pixel, and without specks.
fn pieces<'a>(limb: &'a [LimbPoint], flags: &[bool], shortest: f64) -> Vec<&'a [LimbPoint]> {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for k in (0..limb.len()).filter(|&k| flags[k]) {
        match runs.last_mut() {
            Some((_, last)) if *last + 1 == k || limb[*last].at.distance(limb[k].at) <= GAP => {
                *last = k;
            }
            _ => runs.push((k, k)),
        }
    }
    let length = |run: &[LimbPoint]| {
        let ways = run.windows(2).map(|p| p[0].at.distance(p[1].at));
        ways.sum::<f64>()
    };
    let runs = runs.iter().map(|&(first, last)| &limb[first..=last]);
    runs.filter(|r| r.len() > 1 && length(r) >= shortest.max(1e-3))
        .collect()
}

fn drawn(
    run: &[LimbPoint],
    maps: &Maps,
    (style, view): (&PaperStyle, &View),
    placement: &Placement,
) -> Stroke {
    let pen = &style.stem.pen;
    let metres = metres_of_pixel(&style.vector, view) / placement.scale;
    let hand = |p: DVec2| {
        let pixel = placement.pixel(p);
        let away = |q: &&LimbPoint| q.at.distance_squared(pixel);
        let nearest = run.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
        let depth = nearest.map_or(1.0, |q| q.depth);
        noise_at(
            view.point(pixel, depth),
            pen.wavelength * metres,
            style.seed,
        )
    };
    let shade = Shade::new(maps, style);
    let line = Polyline {
        points: run.iter().map(|p| p.at).collect(),
        closed: false,
    };
    pen.draw_over(&placement.line(&line), hand, |p| {
        let p = placement.pixel(p);
        shade.pressure(p) * width(maps, p, |_| true)
    })
}
