//! The sun on a pixel by a shadow map.
//!
//! Twin of `shaders/leaf/lit_shadow.comp`.

use glam::DVec3;

use crate::abi::{LIT_SHADOW_STEEPEST, LIT_SHADOW_TAPS, ShadowView};

/// Golden angle, radians.
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

/// Share of the filter's points that nothing is nearer to the sun at, and how many of them would
/// decide otherwise if the place moved by `slack` texels or depths moved by as little: where it is
/// not 0, f32 and f64 may differ.
#[must_use]
pub fn shadow_visibility(
    (view, map): (&ShadowView, &[f32]),
    position: DVec3,
    cosine: f64,
    slack: f64,
) -> (f64, u32) {
    let columns = view.relative_to_sun.map(|c| c.map(f64::from));
    let place = [0, 1, 2].map(|row| {
        columns[0][row] * position.x
            + columns[1][row] * position.y
            + columns[2][row] * position.z
            + columns[3][row]
    });
    let size = f64::from(view.size);
    let slope = (1.0 - cosine * cosine).max(0.0).sqrt() / cosine.abs().max(1e-3);
    let radius = f64::from(view.radius);
    let rise = f64::from(view.texel) * (radius + 1.0) * slope.min(LIT_SHADOW_STEEPEST.into());
    let depth = place[2] + rise / f64::from(view.range) + 1e-5;
    let hides = |x: f64, y: f64, depth: f64| {
        let last = view.size as usize - 1;
        let at = [x, y].map(|v| (v.floor().max(0.0) as usize).min(last));
        f64::from(map[at[1] * view.size as usize + at[0]]) > depth
    };
    let (mut open, mut unsure) = (0, 0);
    for i in 0..LIT_SHADOW_TAPS {
        let along = f64::from(i) + 0.5;
        let far = radius * (along / f64::from(LIT_SHADOW_TAPS)).sqrt();
        let (sin, cos) = (along * GOLDEN_ANGLE).sin_cos();
        let x = (0.5 * place[0] + 0.5) * size + far * cos;
        let y = (0.5 * place[1] + 0.5) * size + far * sin;
        let hidden = hides(x, y, depth);
        open += u32::from(!hidden);
        let near = [-slack, slack].into_iter().any(|d| {
            [
                hides(x + d, y, depth),
                hides(x, y + d, depth),
                hides(x, y, depth + d),
            ]
            .into_iter()
            .any(|h| h != hidden)
        });
        unsure += u32::from(near);
    }
    (f64::from(open) / f64::from(LIT_SHADOW_TAPS), unsure)
}
