//! Shapes between a leaf and a disc by one threshold (Coconu, Deussen, Hege 2006, section 6).
//!
//! The paper gives no formula. Here alpha is 1 inside the leaf, falls from its outline to the
//! disc around it as `to_disc / (to_disc + to_leaf)` of the two distances, and is 0 outside the
//! disc: whatever the outline looks like, the shape grows as the threshold falls, from the leaf at
//! 1 to the disc at 0. For an outline seen from its middle this is the spec's radial formula.

use glam::Vec2;

/// Texels along an edge of a shape.
pub const SHAPE_SIZE: usize = crate::abi::INK_SHAPE_SIZE as usize;
/// Value of a texel at the leaf's outline; above it lies the leaf, below it the way to the disc.
pub const OUTLINE: u8 = 128;
/// Least distance inside the leaf over which the values above [`OUTLINE`] rise, in radii.
const INSIDE_SPAN: f32 = 0.05;

/// Alpha of one shape over `[-1, 1]^2`, in radii of its disc; row by row from the tip.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Shape {
    /// `SHAPE_SIZE` squared values.
    pub texels: Vec<u8>,
}

/// Places of the texels' middles.
#[must_use]
pub fn place(x: usize, y: usize) -> Vec2 {
    let at = |i: usize| (i as f32 + 0.5) * 2.0 / SHAPE_SIZE as f32 - 1.0;
    Vec2::new(at(x), -at(y))
}

impl Shape {
    /// From what is leaf: `covers` is asked at four points of each texel.
    #[must_use]
    pub fn new(covers: impl Fn(Vec2) -> bool) -> Self {
        let fine = 2 * SHAPE_SIZE;
        let at = |i: usize| (i as f32 + 0.5) * 2.0 / fine as f32 - 1.0;
        let leaf: Vec<bool> = (0..fine * fine)
            .map(|i| covers(Vec2::new(at(i % fine), -at(i / fine))))
            .collect();
        let outside = distances(&leaf, fine);
        let gaps: Vec<bool> = leaf.iter().map(|l| !l).collect();
        let inside = distances(&gaps, fine);
        let texel = 2.0 / fine as f32;
        let value = |x: usize, y: usize| {
            // Mean over the four fine texels: distances are smooth where the outline is.
            let mut sum = 0.0;
            for k in 0..4 {
                let (fx, fy) = (2 * x + k % 2, 2 * y + k / 2);
                let i = fy * fine + fx;
                let p = Vec2::new(at(fx), -at(fy));
                // Half a texel: the outline lies between the middles of texels.
                let to_leaf = (outside[i] - 0.5) * texel;
                let depth = (inside[i] - 0.5) * texel;
                sum += 0.25 * extended(leaf[i], to_leaf, depth, 1.0 - p.length());
            }
            (f32::from(OUTLINE) * sum).round().clamp(0.0, 255.0) as u8
        };
        let texels = (0..SHAPE_SIZE * SHAPE_SIZE)
            .map(|i| value(i % SHAPE_SIZE, i / SHAPE_SIZE))
            .collect();
        Self { texels }
    }

    /// Alpha at a place in radii, bilinear; beyond 1 inside the leaf.
    #[must_use]
    pub fn alpha(&self, at: Vec2) -> f32 {
        let coordinate = |v: f32| {
            ((v + 1.0) * 0.5 * SHAPE_SIZE as f32 - 0.5).clamp(0.0, SHAPE_SIZE as f32 - 1.0)
        };
        let (x, y) = (coordinate(at.x), coordinate(-at.y));
        let (x0, y0) = (x as usize, y as usize);
        let (x1, y1) = ((x0 + 1).min(SHAPE_SIZE - 1), (y0 + 1).min(SHAPE_SIZE - 1));
        let (fx, fy) = (x - x0 as f32, y - y0 as f32);
        let t = |x: usize, y: usize| f32::from(self.texels[y * SHAPE_SIZE + x]);
        let top = t(x0, y0) * (1.0 - fx) + t(x1, y0) * fx;
        let bottom = t(x0, y1) * (1.0 - fx) + t(x1, y1) * fx;
        (top * (1.0 - fy) + bottom * fy) / f32::from(OUTLINE)
    }

    /// Whether the shape of threshold `tau` (1: the leaf, 0: the disc) covers a place.
    #[must_use]
    pub fn covers(&self, at: Vec2, tau: f32) -> bool {
        at.length_squared() <= 1.0 && self.alpha(at) >= tau
    }
}

/// Alpha that goes on rising inside the leaf, so that interpolation meets its outline.
fn extended(leaf: bool, to_leaf: f32, depth: f32, to_disc: f32) -> f32 {
    if leaf {
        // As steep as outside, so that interpolation meets the outline in the right place.
        1.0 + depth.max(0.0) / to_disc.max(INSIDE_SPAN)
    } else if to_disc <= 0.0 {
        0.0
    } else {
        to_disc / (to_disc + to_leaf.max(0.0))
    }
}

/// Euclidean distance in texels of each texel to the nearest that is set; infinite where none is.
/// Felzenszwalb and Huttenlocher 2012: lower envelopes of parabolas, along rows, then columns.
pub(super) fn distances(set: &[bool], size: usize) -> Vec<f32> {
    const FAR: f32 = 1e12;
    let mut squared: Vec<f32> = set.iter().map(|&s| if s { 0.0 } else { FAR }).collect();
    let mut line = vec![0.0; size];
    for column in 0..size {
        for (y, v) in line.iter_mut().enumerate() {
            *v = squared[y * size + column];
        }
        for (y, v) in envelope(&line).into_iter().enumerate() {
            squared[y * size + column] = v;
        }
    }
    for row in squared.chunks_exact_mut(size) {
        let new = envelope(row);
        row.copy_from_slice(&new);
    }
    squared.iter().map(|v| v.sqrt()).collect()
}

/// `min_j (i - j)^2 + values[j]` for every i.
fn envelope(values: &[f32]) -> Vec<f32> {
    let count = values.len();
    let mut apex = vec![0_usize; count];
    let mut from = vec![0.0_f32; count + 1];
    let mut last = 0;
    from[0] = f32::NEG_INFINITY;
    from[1] = f32::INFINITY;
    let crossing = |q: usize, p: usize| {
        let (fq, fp) = (q as f32, p as f32);
        ((values[q] + fq * fq) - (values[p] + fp * fp)) / (2.0 * (fq - fp))
    };
    for q in 1..count {
        let mut s = crossing(q, apex[last]);
        while s <= from[last] && last > 0 {
            last -= 1;
            s = crossing(q, apex[last]);
        }
        last += 1;
        apex[last] = q;
        from[last] = s;
        from[last + 1] = f32::INFINITY;
    }
    let mut k = 0;
    (0..count)
        .map(|i| {
            while from[k + 1] < i as f32 {
                k += 1;
            }
            let d = i as f32 - apex[k] as f32;
            d * d + values[apex[k]]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A lobed leaf: not seen whole from its middle.
    fn lobed(p: Vec2) -> bool {
        let r = p.length();
        let lobes = 0.55 + 0.4 * (3.0 * p.y.atan2(p.x)).cos();
        r <= lobes
    }

    fn share(covers: impl Fn(Vec2) -> bool) -> f64 {
        let n = 400;
        let at = |i: usize| (i as f32 + 0.5) * 2.0 / n as f32 - 1.0;
        let hits = (0..n * n).filter(|i| covers(Vec2::new(at(i % n), at(i / n))));
        hits.count() as f64 / (n * n) as f64
    }

    fn overlap(a: impl Fn(Vec2) -> bool, b: impl Fn(Vec2) -> bool) -> f64 {
        share(|p| a(p) && b(p)) / share(|p| a(p) || b(p))
    }

    #[test]
    fn the_threshold_goes_from_the_leaf_to_the_disc() {
        let shape = Shape::new(lobed);
        let leaf = overlap(|p| shape.covers(p, 1.0), lobed);
        assert!(leaf > 0.99, "leaf at 1: {leaf}");
        let disc = overlap(|p| shape.covers(p, 0.0), |p| p.length() <= 1.0);
        assert!(disc > 0.99, "disc at 0: {disc}");
    }

    #[test]
    fn area_grows_as_the_threshold_falls() {
        let shape = Shape::new(lobed);
        let areas: Vec<f64> = (0..=40)
            .map(|i| share(|p| shape.covers(p, 1.0 - i as f32 / 40.0)))
            .collect();
        assert!(areas.windows(2).all(|w| w[1] >= w[0]), "{areas:?}");
        assert!(areas[40] > areas[0] + 0.3, "{areas:?}");
        // No step of the slider may leap.
        let most = areas.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
        assert!(most < 0.1, "{most}");
        // The leaf's own mask, without distances, has nothing between.
        let mut mask = shape;
        for (i, texel) in mask.texels.iter_mut().enumerate() {
            let leaf = lobed(place(i % SHAPE_SIZE, i / SHAPE_SIZE));
            *texel = if leaf { OUTLINE } else { 0 };
        }
        let [low, high] = [0.1, 0.9].map(|t| share(|p| mask.covers(p, t)));
        assert!(low - high < 0.1, "a mask grows by {}", low - high);
    }

    #[test]
    fn distances_are_those_of_brute_force() {
        let size = 17;
        let set: Vec<bool> = (0..size * size).map(|i| i % 23 == 5 || i == 200).collect();
        let found = distances(&set, size);
        for (i, &found) in found.iter().enumerate() {
            let (x, y) = ((i % size) as f32, (i / size) as f32);
            let truth = (0..size * size)
                .filter(|&j| set[j])
                .map(|j| ((j % size) as f32 - x).hypot((j / size) as f32 - y))
                .fold(f32::INFINITY, f32::min);
            assert!((found - truth).abs() < 1e-4, "{i}: {found} {truth}");
        }
    }

    #[test]
    fn a_shape_that_is_nothing_or_all_is_finite() {
        for covers in [false, true] {
            let shape = Shape::new(|_| covers);
            assert!(shape.covers(Vec2::ZERO, if covers { 1.0 } else { 0.0 }));
        }
    }
}
