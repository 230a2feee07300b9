//! Twin of `ink_wood.glsl`: hatching of branches in object space.

use glam::DVec2;

/// Place in the tile, not wrapped, of `hatch` (across the axis in its frame, metres along it, log2
/// of its girth) with `tiles` tiles per metre; `along`: strokes run along branches, not round.
#[must_use]
pub fn wood_hatch(hatch: [f64; 4], tiles: f64, along: bool) -> DVec2 {
    let [x, y, way, girth] = hatch;
    let turn = y.atan2(x);
    let spread = if along {
        0.35 * (5.0 * turn).sin()
    } else {
        1.0
    };
    // Whole tiles round, so that strokes meet themselves.
    let around = (girth + tiles.log2() + spread + 0.5)
        .floor()
        .max(0.0)
        .exp2();
    let round = DVec2::new(around * turn / std::f64::consts::TAU, tiles * way);
    if along {
        DVec2::new(round.y, round.x)
    } else {
        round
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_whole_number_of_tiles_goes_round() {
        for girth in [-6.0, -1.3, 0.2, 2.7] {
            let at = |turn: f64| wood_hatch([turn.cos(), turn.sin(), 0.5, girth], 4.0, false);
            let (end, start) = (at(std::f64::consts::PI), at(-std::f64::consts::PI + 1e-12));
            let leap = end.x - start.x;
            assert!((leap - leap.round()).abs() < 1e-9 && leap > 0.9, "{leap}");
            assert!((end.y - 2.0).abs() < 1e-12, "{end}");
        }
    }
}
