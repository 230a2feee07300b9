//! Branches in the picture: where their axes run, how wide they are, and which of them a pixel is
//! part of.

use glam::{DVec2, DVec3};

use super::renderer::Maps;
use super::style::PaperStyle;
use crate::ink::branches::limbs::{Limb, Limbs};
use crate::ink::view::View;

/// Narrower branches are never two lines, pixels: there is no paper between them.
const LEAST: f64 = 3.0;
/// Factor on the width below which branches are one line, up to which what is drawn by two may have
/// ended.
const WIDER: f64 = 2.0;
/// Points of an axis are so many pixels apart at most.
const APART: f64 = 4.0;
/// Points of an axis between two sections of the branch at most.
const MOST: f64 = 4096.0;
/// A pixel is part of a branch up to so many radii beside its axis.
const BESIDE: f64 = 2.5;
/// The same before and behind the axis.
const BEFORE: f64 = 2.0;

/// A place on a branch's axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimbPoint {
    /// Place in the picture, pixels.
    pub at: DVec2,
    /// Eye depth, metres.
    pub depth: f64,
    /// Radius, metres.
    pub radius: f64,
    /// Width in the picture, pixels.
    pub width: f64,
    /// Unit direction of the axis in the picture; zero where it points to the eye.
    pub way: DVec2,
    /// How far the middle of a ring about the branch lies before its ends along the axis, pixels.
    pub bow: f64,
}

/// Width (pixels) below which branches of the style are one line; a pixel is `scale` millimetres.
/// 0: none is.
pub(super) fn thin(style: &PaperStyle, scale: f64) -> f64 {
    if style.stem.single > 0.0 {
        (style.stem.single * style.stem.pen.width / scale).max(LEAST)
    } else {
        0.0
    }
}

/// The style's numbers for branches, each with its range.
pub(super) fn numbers(style: &PaperStyle) -> [(String, f64, f64, f64); 6] {
    let (s, h) = (&style.stem, &style.shadow);
    [
        ("stem.single".into(), s.single, 0.0, 100.0),
        ("stem.shortest".into(), s.shortest, 0.0, 50.0),
        ("stem.stub".into(), s.stub, 0.0, 1.0),
        ("stem.stray".into(), s.stray, 0.0, 90.0),
        ("shadow.stub".into(), h.stub, 0.0, 1.0),
        ("foliage.shortest".into(), style.foliage.shortest, 0.0, 50.0),
    ]
}

/// Axes of branches in a view; one that comes from behind the camera is several.
pub(super) fn in_picture(limbs: &Limbs, view: &View) -> Vec<Vec<LimbPoint>> {
    limbs.limbs.iter().flat_map(|l| axis(l, view)).collect()
}

fn axis(limb: &Limb, view: &View) -> Vec<Vec<LimbPoint>> {
    let count = limb.middles.len();
    let mut out = Vec::new();
    let mut run: Vec<(DVec3, LimbPoint)> = Vec::new();
    for i in 1..count {
        let at = |k: usize| limb.middles[k.clamp(1, count) - 1];
        // Neighbours, so that the line is smooth (Catmull and Rom 1974).
        let p = [at(i - 1), at(i), at(i + 1), at(i + 2)];
        let [(a, _), (b, _)] = [p[1], p[2]].map(|p| view.pixel(p));
        let width = seen(p[1], limb.radii[i - 1], view).width;
        let step = (width / 12.0).clamp(1.0, APART);
        let length = a.distance(b) / step;
        let pieces = if length.is_finite() {
            length.ceil().clamp(1.0, MOST)
        } else {
            1.0
        };
        let last = i + 1 == count;
        for k in 0..pieces as u32 + u32::from(last) {
            let t = f64::from(k) / pieces;
            let place = between(p, t);
            let radius = limb.radii[i - 1] + t * (limb.radii[i] - limb.radii[i - 1]);
            let point = seen(place, radius, view);
            if point.depth > view.camera.near && point.at.is_finite() {
                run.push((place, point));
            } else if !run.is_empty() {
                out.push(directed(&std::mem::take(&mut run), view));
            }
        }
    }
    if !run.is_empty() {
        out.push(directed(&run, view));
    }
    out
}

fn between([a, b, c, d]: [DVec3; 4], t: f64) -> DVec3 {
    let (one, two) = (0.5 * (c - a), 0.5 * (d - b));
    let s = 1.0 - t;
    s * s * (1.0 + 2.0 * t) * b + t * t * (3.0 - 2.0 * t) * c + t * s * (s * one - t * two)
}

fn seen(place: DVec3, radius: f64, view: &View) -> LimbPoint {
    let (at, depth) = view.pixel(place);
    LimbPoint {
        at,
        depth,
        radius,
        width: 2.0 * radius * view.focal() / depth.max(1e-9),
        way: DVec2::ZERO,
        bow: 0.0,
    }
}

/// The points with their directions, taken over about the branch's width.
fn directed(run: &[(DVec3, LimbPoint)], view: &View) -> Vec<LimbPoint> {
    let one = |k: usize| {
        let (place, mut point) = run[k];
        let reach = (1.5 * point.width).max(2.0);
        let far = |j: usize| run[j].1.at.distance(point.at) < reach;
        let first = (0..k).rev().take_while(|&j| far(j)).last().unwrap_or(k);
        let last = (k + 1..run.len())
            .take_while(|&j| far(j))
            .last()
            .unwrap_or(k);
        let (first, last) = if first == last {
            (k.saturating_sub(1), (k + 1).min(run.len() - 1))
        } else {
            (first, last)
        };
        let along = run[last].0 - run[first].0;
        let shown = run[last].1.at - run[first].1.at;
        // Of a branch that points to the eye its round is no line across.
        let whole = along.length() * view.focal() / point.depth;
        if shown.length() > 0.15 * whole {
            point.way = shown.normalize_or_zero();
            let axis = along.normalize_or_zero();
            let front = (view.eye() - place).reject_from(axis).normalize_or_zero();
            let ahead = view.pixel(place + point.radius * front).0 - point.at;
            point.bow = ahead.dot(point.way);
        }
        point
    };
    (0..run.len()).map(one).collect()
}

/// The pixel of a place on an axis, if it is in the picture.
pub(super) fn pixel_of(maps: &Maps, point: &LimbPoint) -> Option<usize> {
    let [w, h] = maps.size;
    let p = point.at;
    let inside = p.x >= 0.0 && p.y >= 0.0 && p.x < w as f64 && p.y < h as f64;
    inside.then(|| p.y as usize * w + p.x as usize)
}

/// Whether a branch little wider than `limit` (pixels) is not drawn at a place on its axis, though no
/// other hides it: what the device draws of it ends by the surface's own triangles.
pub(super) fn is_bare(maps: &Maps, point: &LimbPoint, limit: f64) -> bool {
    let Some(pixel) = pixel_of(maps, point) else {
        return false;
    };
    let stem = f64::from(maps.stem_depth[pixel]);
    point.width < WIDER * limit && (stem <= 0.0 || stem > point.depth + 2.0 * point.radius)
}

/// For each pixel of stems the nearest place on the axis of the branch that it is part of.
pub(super) struct Nearest<'a> {
    size: [usize; 2],
    all: Vec<&'a LimbPoint>,
    /// Numbers of them, counted from 1.
    of_pixel: Vec<u32>,
}

impl<'a> Nearest<'a> {
    pub(super) fn new(maps: &'a Maps, stems: &[bool]) -> Self {
        let [w, h] = maps.size;
        let all: Vec<&LimbPoint> = maps.limbs.iter().flatten().collect();
        let mut best = vec![f32::INFINITY; w * h];
        let mut of_pixel = vec![0; w * h];
        let most = DVec2::new(w as f64, h as f64);
        for (number, point) in (1..).zip(&all) {
            let reach = (BESIDE * 0.5 * point.width).max(1.5);
            let low = (point.at - reach).floor().clamp(DVec2::ZERO, most);
            let high = (point.at + reach).ceil().clamp(DVec2::ZERO, most);
            for y in low.y as usize..high.y as usize {
                for x in low.x as usize..high.x as usize {
                    let i = y * w + x;
                    let before = f64::from(maps.stem_depth[i]) - point.depth;
                    if !stems[i] || before.abs() > BEFORE * point.radius {
                        continue;
                    }
                    let p = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                    let away = (p.distance(point.at) / reach) as f32;
                    if away <= 1.0 && away < best[i] {
                        (best[i], of_pixel[i]) = (away, number);
                    }
                }
            }
        }
        Self {
            size: maps.size,
            all,
            of_pixel,
        }
    }

    /// Of a pixel by its number; none where no branch is known.
    pub(super) fn of(&self, pixel: usize) -> Option<&'a LimbPoint> {
        let number = *self.of_pixel.get(pixel)?;
        (number > 0).then(|| self.all[number as usize - 1])
    }

    /// Of a place in the picture.
    pub(super) fn at(&self, p: DVec2) -> Option<&'a LimbPoint> {
        let [w, h] = self.size.map(|s| s as f64);
        let inside = p.x >= 0.0 && p.y >= 0.0 && p.x < w && p.y < h;
        inside
            .then(|| self.of(p.y as usize * self.size[0] + p.x as usize))
            .flatten()
    }
}

impl LimbPoint {
    /// A place on a straight stroke bent round the branch; `middle` stays.
    pub(super) fn bent(&self, p: DVec2, middle: DVec2) -> DVec2 {
        let half = (0.5 * self.width).max(1e-9);
        let rise = |p: DVec2| {
            let beside = (self.way.perp_dot(p - self.at) / half).clamp(-0.96, 0.96);
            (1.0 - beside * beside).sqrt()
        };
        p + self.bow * (rise(p) - rise(middle)) * self.way
    }
}
