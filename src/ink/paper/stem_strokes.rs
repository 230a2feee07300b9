//! Outlines of stems from pixels, and strokes that carry their tone.

use glam::DVec2;

use super::across::{Across, expected, layers};
use super::anchored::{Surface, metres_of_pixel, noise_at, placed};
use super::curve::Polyline;
use super::diffusion::{DiffusionSettings, ShortStroke, Tone};
use super::drawing::{Placement, Shade, Visible, factors, least, width};
use super::limbs::{LimbPoint, Nearest, is_bare, thin};
use super::pen::{Pen, Stroke};
use super::progress::{Count, Stage, Tell};
use super::renderer::Maps;
use super::silhouette::{Edges, snapped};
use super::style::PaperStyle;
use super::trace::{Marks, smoothed, thinned, trace};
use super::whole::joined_through;
use crate::ink::view::View;
use crate::math::sampling::uniform;

/// Pixels on each side over which lines are smoothed.
const SMOOTH: usize = 3;

/// Whether each pixel of stems is seen and over its threshold.
pub(super) fn stem_marks(maps: &Maps, visible: &Visible, style: &PaperStyle) -> Vec<bool> {
    let threshold = style.stem.threshold as f32;
    maps.stem_difference
        .iter()
        .zip(&visible.stems)
        .enumerate()
        .map(|(i, (&d, &seen))| {
            let [more, wider] = factors(maps, i);
            seen && d > threshold * more && wider > 0.0
        })
        .collect()
}

/// Lines of stems, pixels.
pub(super) fn stem_lines(
    maps: &Maps,
    visible: &Visible,
    style: &PaperStyle,
    placement: &Placement,
) -> Vec<Polyline> {
    let shortest = least(style.stem.shortest, style, placement);
    let edges = Edges::new(maps.size, &maps.silhouettes);
    let mut marked = stem_marks(maps, visible, style);
    without_ends(&mut marked, maps, thin(style, placement.scale));
    let lines = thinned(&Marks {
        size: maps.size,
        marked: &marked,
    });
    let found = trace(&Marks {
        size: maps.size,
        marked: &lines,
    });
    joined_through(found)
        .iter()
        .filter(|l| l.length() >= shortest)
        .map(|l| snapped(&smoothed(l, SMOOTH), &edges))
        .collect()
}

/// Takes the marks from where branches end in the picture that go on as one line below `limit` (pixels):
/// what is drawn by two lines has no border across there.
fn without_ends(marked: &mut [bool], maps: &Maps, limit: f64) {
    for limb in &maps.limbs {
        let bare = |p: &LimbPoint| p.width < limit || is_bare(maps, p, limit);
        for pair in limb.windows(2).filter(|p| !bare(&p[0]) && bare(&p[1])) {
            let end = &pair[1];
            let [w, h] = maps.size;
            let most = DVec2::new(w as f64, h as f64);
            let reach = 0.5 * end.width + 1.0;
            let low = (end.at - reach).floor().clamp(DVec2::ZERO, most);
            let high = (end.at + reach).ceil().clamp(DVec2::ZERO, most);
            for y in low.y as usize..high.y as usize {
                for x in low.x as usize..high.x as usize {
                    let p = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                    let before = f64::from(maps.stem_depth[y * w + x]) - end.depth;
                    if p.distance(end.at) <= reach && before.abs() < 2.0 * end.radius {
                        marked[y * w + x] = false;
                    }
                }
            }
        }
    }
}

pub(super) fn stem_contour(
    (maps, visible): (&Maps, &Visible),
    lines: &[Polyline],
    style: &PaperStyle,
    view: &View,
    placement: &Placement,
) -> Vec<Stroke> {
    let pen = &style.stem.pen;
    // The hand is unsteady by where it is in space, since lines of pixels have no number that they
    // keep from frame to frame.
    let metres = metres_of_pixel(&style.vector, view) / placement.scale;
    let hand = |p: DVec2| {
        let pixel = placement.pixel(p);
        let [w, h] = maps.size;
        let at = pixel.clamp(DVec2::ZERO, DVec2::new(w as f64 - 1.0, h as f64 - 1.0));
        let depth = f64::from(maps.stem_depth[at.y as usize * w + at.x as usize]);
        noise_at(
            view.point(pixel, depth),
            pen.wavelength * metres,
            style.seed,
        )
    };
    let shade = Shade::new(maps, style);
    lines
        .iter()
        .map(|l| {
            pen.draw_over(&placement.line(l), hand, |p| {
                let p = placement.pixel(p);
                shade.pressure(p) * width(maps, p, |i| visible.stems[i])
            })
        })
        .collect()
}

/// Makes other numbers of a seed than those of lengths.
const SALT: u32 = 0x51ed_270b;

/// Strokes on stems: across the branch (`stem.along`: along it) and bent round it.
pub(super) fn stem_hatching(
    (maps, visible): (&Maps, &Visible),
    style: &PaperStyle,
    view: &View,
    placement: &Placement,
    tell: Tell<'_>,
) -> Vec<Stroke> {
    let s = &style.stem;
    let nearest = Nearest::new(maps, &visible.stems);
    let settings = DiffusionSettings {
        length: s.stroke / placement.scale,
        width: (s.hatching_pen.width / placement.scale).max(1.0),
        threshold: 0.5,
        seed: style.seed,
        stub: s.stub,
        inset: 0.5 * s.pen.width / placement.scale,
    };
    let darkness = darkness((maps, visible), style, &nearest, s.stub * settings.length);
    let across = Across::new(maps, visible);
    let surface = Surface {
        view,
        depth: &maps.stem_depth,
        vector: style.vector,
    };
    let along = if s.along {
        std::f64::consts::FRAC_PI_2
    } else {
        0.0
    };
    let way = |x: usize, y: usize| {
        let pixel = y * maps.size[0] + x;
        match nearest.of(pixel) {
            Some(limb) if limb.way != DVec2::ZERO => limb.way.perp(),
            _ => across.at(x, y),
        }
    };
    let stray = |x: usize, y: usize| {
        let chance = uniform(style.seed ^ SALT, (y * maps.size[0] + x) as u32);
        (2.0 * chance - 1.0) * s.stray.to_radians()
    };
    let mut out = Vec::new();
    let tones = layers(&darkness, s.crossing);
    let count = Count::new(tell, Stage::Strokes, expected(&tones, &settings));
    for (tone, turn) in tones {
        let tone = Tone {
            size: maps.size,
            darkness: &tone,
        };
        let found = placed(&tone, &settings, &surface, |x, y| {
            count.add();
            DVec2::from_angle(turn + along + stray(x, y)).rotate(way(x, y))
        });
        let one = |f: &ShortStroke| {
            let limb = nearest.at(0.5 * (f.from + f.to));
            hatch(f, limb, &s.hatching_pen, placement)
        };
        out.extend(found.iter().map(one));
    }
    out
}

/// Darkness of what is seen of stems. Branches narrower than `least` pixels have none, and those up
/// to twice as wide less than others.
fn darkness(
    (maps, visible): (&Maps, &Visible),
    style: &PaperStyle,
    nearest: &Nearest<'_>,
    least: f64,
) -> Vec<f32> {
    let s = &style.stem;
    let one = |i: usize| {
        if !visible.stems[i] {
            return -1.0;
        }
        let share = match nearest.of(i) {
            Some(limb) if least > 0.0 => (limb.width / least - 1.0).clamp(0.0, 1.0),
            _ => 1.0,
        };
        let dark = 1.0 - f64::from(maps.stem_normal[i][3]) / s.white.max(1e-3);
        (s.hatching * share * dark.clamp(0.0, 1.0)) as f32
    };
    (0..maps.stem_normal.len()).map(one).collect()
}

/// A stroke as its pen draws it, bent round the branch that it is on.
pub(super) fn hatch(
    stroke: &ShortStroke,
    limb: Option<&LimbPoint>,
    pen: &Pen,
    placement: &Placement,
) -> Stroke {
    let (from, to) = (stroke.from, stroke.to);
    let middle = 0.5 * (from + to);
    // A few points along it, so that its width can change.
    let points = (0..=6).map(|k| from.lerp(to, f64::from(k) / 6.0));
    let line = Polyline {
        points: points
            .map(|p| limb.map_or(p, |l| l.bent(p, middle)))
            .collect(),
        closed: false,
    };
    pen.draw(&placement.line(&line), from.x.to_bits() as u32, |_| 1.0)
}
