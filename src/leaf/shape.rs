//! Shapes of flat lights as points of equal power, so that kernels need not know them: "there is no
//! restriction on the shapes of the area light sources" (Wang et al. 2005, section 4.2).
//!
//! Points lie in the square \[-1, 1\]^2, x to the right and y up as one looks at the light. The four
//! outermost along the diagonals come last, before them the four along the axes: where they see
//! the same, the rest need not be asked.

use std::path::Path;
use std::sync::Arc;

use crate::scene::float_image::{FloatImage, Transfer};
use crate::{Error, Result};

/// Golden angle, radians.
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
/// 1 over the golden ratio.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// The outline of a light, and how its light is spread over it.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// The disc in the square.
    Disc,
    /// The whole square.
    Square,
    /// As an image says.
    Mask(Arc<Mask>),
}

/// An image of how much light each place sends.
#[derive(Debug, Clone, PartialEq)]
pub struct Mask {
    width: usize,
    /// Running sums along each row, from the top, and of the rows; the last is 1 (or the row's sum).
    columns: Vec<f64>,
    rows: Vec<f64>,
    /// Share of the square that sends any light.
    pub area: f64,
}

impl Mask {
    /// Reads an image; its mean of red, green and blue times alpha, as linear numbers, counts.
    ///
    /// # Errors
    /// No image, or one that sends no light.
    pub fn read(path: &Path) -> Result<Self> {
        let bytes = std::fs::read(path).map_err(|e| Error::file(path, e))?;
        let image = FloatImage::decode(&path.display().to_string(), &bytes, Transfer::Linear)?;
        let power: Vec<f64> = image
            .pixels
            .iter()
            .map(|&[r, g, b, a]| f64::from(a) * (f64::from(r) + f64::from(g) + f64::from(b)) / 3.0)
            .collect();
        Self::new(image.width as usize, &power).map_err(|reason| Error::file(path, reason))
    }

    /// A mask of rows of `width` numbers, from the top.
    ///
    /// # Errors
    /// Negative or infinite numbers, or none above 0.
    pub fn new(width: usize, power: &[f64]) -> Result<Self, String> {
        if width == 0 || power.is_empty() || !power.len().is_multiple_of(width) {
            return Err(format!(
                "mask: {} texels are no rows of {width}",
                power.len()
            ));
        }
        let bad = power.iter().filter(|p| !(p.is_finite() && **p >= 0.0));
        match bad.count() {
            0 => {}
            n => return Err(format!("mask: {n} texels are negative or not finite")),
        }
        let (mut columns, mut rows, mut sum) = (Vec::with_capacity(power.len()), Vec::new(), 0.0);
        for row in power.chunks_exact(width) {
            let mut along = 0.0;
            for p in row {
                along += p;
                columns.push(along);
            }
            sum += along;
            rows.push(sum);
        }
        if sum <= 0.0 {
            return Err("mask: is black, a light needs some that is not".into());
        }
        rows.iter_mut().for_each(|r| *r /= sum);
        let bright = power.iter().filter(|p| **p > 0.0).count();
        Ok(Self {
            width,
            columns,
            rows,
            area: bright as f64 / power.len() as f64,
        })
    }

    /// The place of the share (`u`, `v`) of the light: rows by `v`, along the row by `u`.
    fn place(&self, u: f64, v: f64) -> [f64; 2] {
        let inside = |sums: &[f64], at: f64| {
            let i = sums.partition_point(|&s| s <= at).min(sums.len() - 1);
            let before = if i > 0 { sums[i - 1] } else { 0.0 };
            let step = sums[i] - before;
            let share = if step > 0.0 {
                (at - before) / step
            } else {
                0.5
            };
            (i, i as f64 + share.clamp(0.0, 1.0))
        };
        let (row, y) = inside(&self.rows, v);
        let sums = &self.columns[row * self.width..(row + 1) * self.width];
        let (_, x) = inside(sums, u * sums[self.width - 1]);
        [
            2.0 * x / self.width as f64 - 1.0,
            1.0 - 2.0 * y / self.rows.len() as f64,
        ]
    }
}

impl Shape {
    /// Share of the square that the light fills.
    #[must_use]
    pub fn area(&self) -> f64 {
        match self {
            Self::Disc => std::f64::consts::FRAC_PI_4,
            Self::Square => 1.0,
            Self::Mask(mask) => mask.area,
        }
    }

    /// `count` points of equal power.
    #[must_use]
    pub fn points(&self, count: u32) -> Vec<[f64; 2]> {
        let n = f64::from(count.max(1));
        // A lattice of the golden ratio: even along both sides whatever the number.
        let lattice = |i: u32| {
            let along = f64::from(i) + 0.5;
            (along / n, (along * GOLDEN).fract())
        };
        let mut out: Vec<[f64; 2]> = (0..count.max(1))
            .map(|i| match self {
                // Vogel 1979, A better way to construct the sunflower head.
                Self::Disc => {
                    let along = f64::from(i) + 0.5;
                    let (sin, cos) = (along * GOLDEN_ANGLE).sin_cos();
                    let radius = (along / n).sqrt();
                    [radius * cos, radius * sin]
                }
                Self::Square => {
                    let (u, v) = lattice(i);
                    [2.0 * u - 1.0, 2.0 * v - 1.0]
                }
                Self::Mask(mask) => {
                    let (v, u) = lattice(i);
                    mask.place(u, v)
                }
            })
            .collect();
        outermost_last(&mut out);
        out
    }
}

/// Moves the points that lie farthest along the four diagonals to the end, and before them those
/// along the axes.
fn outermost_last(points: &mut [[f64; 2]]) {
    const DIAGONALS: [[f64; 2]; 4] = [[1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0]];
    const AXES: [[f64; 2]; 4] = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
    let mut end = points.len();
    for [a, b] in DIAGONALS.into_iter().chain(AXES) {
        let far = |p: &[f64; 2]| a * p[0] + b * p[1];
        let best = (0..end).max_by(|&i, &j| far(&points[i]).total_cmp(&far(&points[j])));
        if let Some(best) = best {
            end -= 1;
            points.swap(best, end);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mean(points: &[[f64; 2]], f: impl Fn([f64; 2]) -> f64) -> f64 {
        points.iter().map(|&p| f(p)).sum::<f64>() / points.len() as f64
    }

    #[test]
    fn points_have_the_moments_of_their_shape() {
        for (shape, second) in [(Shape::Disc, 0.25), (Shape::Square, 1.0 / 3.0)] {
            let points = shape.points(256);
            for k in 0..2 {
                assert!(mean(&points, |p| p[k]).abs() < 0.01, "{shape:?}");
                let square = mean(&points, |p| p[k] * p[k]);
                assert!((square - second).abs() < 0.01, "{shape:?}: {square}");
            }
        }
    }

    #[test]
    fn the_four_last_lie_outside() {
        for shape in [Shape::Disc, Shape::Square] {
            let points = shape.points(16);
            let far = |p: &[f64; 2]| p[0].hypot(p[1]);
            let least = points[12..].iter().map(far).fold(9.0, f64::min);
            assert!(least > 0.8, "{shape:?}: {least}");
        }
    }

    /// A mask of one bright column and a dim one: points follow the power.
    #[test]
    fn masks_are_followed() {
        let row = [0.0, 3.0, 0.0, 1.0];
        let mask = Mask::new(4, &[row, row].concat()).unwrap();
        assert_eq!(mask.area, 0.5);
        let points = Shape::Mask(Arc::new(mask)).points(400);
        let bright = points.iter().filter(|p| (-0.5..0.0).contains(&p[0]));
        let dim = points.iter().filter(|p| (0.5..=1.0).contains(&p[0]));
        assert_eq!((bright.count(), dim.count()), (300, 100));
        assert!(mean(&points, |p| p[1]).abs() < 0.01);
        // Rows come from the top.
        let top = Mask::new(1, &[1.0, 0.0]).unwrap();
        let points = Shape::Mask(Arc::new(top)).points(9);
        assert!(points.iter().all(|p| p[1] >= 0.0), "{points:?}");
    }

    #[test]
    fn masks_that_send_nothing_are_refused() {
        assert!(Mask::new(2, &[0.0; 4]).unwrap_err().contains("black"));
        assert!(Mask::new(2, &[1.0, -1.0]).unwrap_err().contains("1 texels"));
        assert!(Mask::new(2, &[1.0; 3]).unwrap_err().contains("rows"));
    }
}
