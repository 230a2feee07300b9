//! Twins of the kernels of drawings on paper: depth differences, shadows, the bitmap (Deussen and
//! Strothotte 2000).

use glam::{DMat4, DVec2, DVec3};

use crate::abi::{
    InkFrame, PAPER_DEPTHS, PAPER_INFINITE, PAPER_WIDEN, PaperBitmap, PaperDifference,
    PaperParticle, PaperSunlit,
};

/// Depth as it is compared: 0 to 65535 over the range; 0 or less shows nothing.
#[must_use]
pub fn depth(depth: f64, push: &PaperDifference) -> f64 {
    if depth <= 0.0 {
        let far = if push.sky_at_far == 1 {
            PAPER_DEPTHS
        } else {
            PAPER_INFINITE
        };
        return f64::from(far);
    }
    let (nearest, farthest) = (f64::from(push.nearest), f64::from(push.farthest));
    let share = (depth - nearest) / (farthest - nearest);
    let (z0, z1) = (f64::from(push.near), f64::from(push.far));
    let z = z0 + share * (z1 - z0);
    let value = if push.mapped == 1 {
        z1 * (z - z0) / (z * (z1 - z0))
    } else {
        share
    };
    f64::from(PAPER_DEPTHS) * value
}

/// Gap in depth (in the unit of z0 and z1) at which a threshold switches, for a surface at `z`;
/// none where no gap does.
#[must_use]
pub fn gap(threshold: f64, z: f64, z0: f64, z1: f64) -> Option<f64> {
    let delta = |z: f64| z1 * (z - z0) / (z * (z1 - z0));
    let behind = delta(z) + threshold / f64::from(PAPER_DEPTHS);
    (behind < 1.0).then(|| z0 * z1 / (z1 - behind * (z1 - z0)) - z)
}

/// How far a pixel is before the farthest of its neighbours.
#[must_use]
pub fn difference(depths: &[f32], push: &PaperDifference, x: i64, y: i64) -> f64 {
    let (w, h) = (i64::from(push.width), i64::from(push.height));
    let raw =
        |x: i64, y: i64| f64::from(depths[(y.clamp(0, h - 1) * w + x.clamp(0, w - 1)) as usize]);
    let at = |x, y| depth(raw(x, y), push);
    if raw(x, y) <= 0.0 {
        return 0.0;
    }
    let own = at(x, y);
    let (mut most, mut slope) = (0.0_f64, 0.0_f64);
    for (dx, dy) in [(1, 0), (1, 1), (0, 1), (-1, 1)] {
        let (ahead, behind) = (at(x + dx, y + dy) - own, at(x - dx, y - dy) - own);
        most = most.max(ahead).max(behind);
        slope = slope.max(ahead.abs().min(behind.abs()));
    }
    (most - f64::from(push.slope) * slope.min(f64::from(PAPER_DEPTHS))).max(0.0)
}

/// Maps of the camera and of the sun.
#[derive(Debug, Clone, Copy)]
pub struct Sunlit<'a> {
    /// Camera.
    pub frame: &'a InkFrame,
    /// Sun.
    pub sun: &'a InkFrame,
    /// Particles.
    pub particles: &'a [PaperParticle],
    /// Depth of foliage.
    pub foliage_depth: &'a [f32],
    /// Number of the particle plus 1.
    pub foliage_number: &'a [f32],
    /// Depth of stems.
    pub stem_depth: &'a [f32],
    /// Depth of foliage from the sun.
    pub sun_foliage: &'a [f32],
    /// Depth of stems from the sun.
    pub sun_stems: &'a [f32],
}

fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from(v.map(f64::from))
}

/// How deep a pixel lies in shadow.
#[must_use]
pub fn sunlit(maps: &Sunlit<'_>, push: &PaperSunlit, x: i64, y: i64) -> f64 {
    let here = (y * i64::from(push.width) + x) as usize;
    let foliage = f64::from(maps.foliage_depth[here]);
    let stem = f64::from(maps.stem_depth[here]);
    if foliage <= 0.0 && stem <= 0.0 {
        return 0.0;
    }
    let frame = maps.frame;
    let (mut bias, mut softness) = (push.bias, push.softness);
    let position = if foliage > 0.0 && (stem <= 0.0 || foliage <= stem) {
        let number = maps.foliage_number[here] as usize - 1;
        if number >= push.leaves as usize {
            (bias, softness) = (push.ground_bias, push.ground_softness);
        }
        vector(maps.particles[number].centre)
    } else {
        let half = 0.5 * DVec2::new(f64::from(push.width), f64::from(push.height));
        let at =
            (DVec2::new(x as f64 + 0.5, y as f64 + 0.5) - half) * stem / f64::from(frame.focal);
        vector(frame.eye) + stem * vector(frame.forward) + at.x * vector(frame.right)
            - at.y * vector(frame.up)
    };
    let sun = maps.sun;
    let matrix = DMat4::from_cols_array_2d(&sun.relative_to_clip.map(|c| c.map(f64::from)));
    let clip = matrix * position.extend(1.0);
    let size = i64::from(push.map_size);
    let middle = ((0.5 * DVec2::new(clip.x, clip.y) + 0.5) * size as f64).floor();
    let own = (position - vector(sun.eye)).dot(vector(sun.forward));
    let reach = i64::from(push.reach);
    let mut sum = 0.0;
    for (dy, dx) in (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dy, dx))) {
        let qx = (middle.x as i64 + dx).clamp(0, size - 1);
        let qy = (middle.y as i64 + dy).clamp(0, size - 1);
        let at = (qy * size + qx) as usize;
        let (f, s) = (
            f64::from(maps.sun_foliage[at]),
            f64::from(maps.sun_stems[at]),
        );
        let nearest = if f > 0.0 && (s <= 0.0 || f < s) { f } else { s };
        let behind = if nearest > 0.0 { own - nearest } else { 0.0 };
        sum += ((behind - f64::from(bias)) / f64::from(softness)).clamp(0.0, 1.0);
    }
    sum / ((2 * reach + 1) * (2 * reach + 1)) as f64
}

/// Maps that the bitmap is made of.
#[derive(Debug, Clone, Copy)]
pub struct Lines<'a> {
    /// Depth of foliage.
    pub foliage_depth: &'a [f32],
    /// Number of the particle plus 1.
    pub foliage_number: &'a [f32],
    /// Differences of foliage.
    pub foliage_difference: &'a [f32],
    /// Depth of stems.
    pub stem_depth: &'a [f32],
    /// Differences of stems.
    pub stem_difference: &'a [f32],
    /// Particles.
    pub particles: &'a [PaperParticle],
    /// Shadow, where there is one.
    pub shadow: Option<&'a [f32]>,
    /// Factors on threshold and width, where there are some.
    pub factors: Option<&'a [[f32; 4]]>,
}

/// Half width of the line in a pixel, 0: none; and whether it is a stem's.
fn line(maps: &Lines<'_>, push: &PaperBitmap, x: i64, y: i64) -> (f64, bool) {
    let (w, h) = (i64::from(push.width), i64::from(push.height));
    let row = y.clamp(0, h - 1);
    let at = (row * w + x.clamp(0, w - 1)) as usize;
    let (foliage, stem) = (maps.foliage_depth[at], maps.stem_depth[at]);
    let shade = maps.shadow.map_or(0.0, |s| f64::from(s[at]));
    let [more, wider] = maps
        .factors
        .map_or([1.0; 2], |f| [f[at][0], f[at][1]].map(f64::from));
    let on_foliage = foliage > 0.0 && (stem <= 0.0 || foliage <= stem);
    let width = if on_foliage {
        let number = maps.foliage_number[at] as u32;
        let threshold = f64::from(push.foliage) * (1.0 + f64::from(push.detail) * shade) * more;
        let particle = &maps.particles[number as usize - 1];
        let drawn = number <= push.leaves && f64::from(maps.foliage_difference[at]) > threshold;
        let low = push.lower == 0 || row as f64 + 0.5 >= f64::from(particle.row);
        if drawn && low {
            push.foliage_width
        } else {
            0.0
        }
    } else if stem > 0.0 && f64::from(maps.stem_difference[at]) > f64::from(push.stem) * more {
        push.stem_width
    } else {
        0.0
    };
    let width = f64::from(width) * (1.0 + f64::from(push.pressure) * shade) * wider;
    (width, !on_foliage)
}

/// Linear colour of a pixel of the bitmap.
#[must_use]
pub fn bitmap(maps: &Lines<'_>, push: &PaperBitmap, x: i64, y: i64) -> [f64; 3] {
    let at = (y * i64::from(push.width) + x) as usize;
    let ground = maps.foliage_depth[at] > 0.0 && maps.foliage_number[at] as u32 > push.leaves;
    let below = match (maps.shadow.is_some_and(|s| s[at] > push.black), ground) {
        (true, true) => push.ground_ink,
        (true, false) => push.shadow_ink,
        (false, _) => push.paper,
    };
    let widest = f64::from(push.foliage_width.max(push.stem_width))
        * (1.0 + f64::from(push.pressure))
        * f64::from(push.widest);
    let reach = (widest.ceil() as i64).min(i64::from(PAPER_WIDEN));
    let (mut most, mut ink) = (0.0_f64, push.ink);
    for (dy, dx) in (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dy, dx))) {
        let (width, on_stem) = line(maps, push, x + dx, y + dy);
        let cover = width + 0.5 - ((dx * dx + dy * dy) as f64).sqrt();
        if width > 0.0 && cover > most {
            most = cover;
            ink = if on_stem { push.stem_ink } else { push.ink };
        }
    }
    vector(below).lerp(vector(ink), most.min(1.0)).to_array()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn push() -> PaperDifference {
        PaperDifference {
            width: 1,
            height: 1,
            mapped: 1,
            sky_at_far: 0,
            nearest: 1.0,
            farthest: 11.0,
            near: 1.0,
            far: 11.0,
            slope: 0.0,
        }
    }

    #[test]
    fn equation_1_maps_its_ends_and_comes_back() {
        assert!(depth(1.0, &push()).abs() < 1e-9);
        assert!((depth(11.0, &push()) - 65535.0).abs() < 1e-6);
        for z in [1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 9.0, 11.0] {
            let d = depth(z, &push()) / 65535.0;
            assert!((11.0 / (11.0 - 10.0 * d) - z).abs() < 1e-9);
        }
    }

    #[test]
    fn thresholds_mean_the_gaps_of_the_table() {
        // The paper's units, z0 = 1, z1 = 11.
        for (z, threshold, expected) in [
            (1.0, 1000.0, 0.014),
            (2.0, 2000.0, 0.118),
            (4.0, 6000.0, 1.996),
            (6.0, 400.0, 0.207),
            (8.0, 2000.0, 2.282),
        ] {
            let found = gap(threshold, z, 1.0, 11.0).unwrap();
            assert!((found - expected).abs() < 6e-4, "{z} {threshold}: {found}");
        }
        assert_eq!(gap(6000.0, 6.0, 1.0, 11.0), None);
        // Outlines against a background at the far end vanish beyond these depths.
        for (threshold, last) in [
            (100.0, 10.83),
            (1000.0, 9.54),
            (2000.0, 8.43),
            (6000.0, 5.74),
        ] {
            assert!(
                gap(threshold, last - 0.01, 1.0, 11.0).is_some_and(|g| last - 0.01 + g <= 11.0)
            );
            assert!(gap(threshold, last + 0.02, 1.0, 11.0).is_none());
        }
    }
}
