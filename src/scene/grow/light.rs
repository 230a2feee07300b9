//! How much light reaches a place in the crown, so that shaded twigs carry fewer leaves.
//!
//! An addition to Weber and Penn, whose crowns are equally leafy inside; after the shadow
//! propagation of Palubicki et al. 2009, simplified to transmittance through a coarse grid.

use glam::DVec3;

use super::portable::exp;

/// Cells along the longest side of the crown.
const CELLS: f64 = 20.0;

/// Length of leafy wood per cell of a coarse grid.
pub(super) struct Light {
    low: DVec3,
    cell: f64,
    size: [usize; 3],
    density: Vec<f64>,
}

impl Light {
    /// Distributes weighted points over the grid; the mean non-empty cell gets density 1.
    pub(super) fn new(points: &[(DVec3, f64)]) -> Self {
        let (low, high) = points.iter().fold(
            (DVec3::INFINITY, DVec3::NEG_INFINITY),
            |(low, high), (q, _)| (low.min(*q), high.max(*q)),
        );
        let cell = ((high - low).max_element() / CELLS).max(1e-3);
        let size = [0, 1, 2].map(|a| ((high[a] - low[a]) / cell).max(0.0) as usize + 1);
        let mut light = Self {
            low,
            cell,
            size,
            density: vec![0.0; size[0] * size[1] * size[2]],
        };
        for &(q, weight) in points {
            if let Some(i) = light.index(q) {
                light.density[i] += weight;
            }
        }
        let filled = light.density.iter().filter(|&&d| d > 0.0).count().max(1) as f64;
        let mean = light.density.iter().sum::<f64>() / filled;
        if mean > 0.0 {
            light.density.iter_mut().for_each(|d| *d /= mean);
        }
        light
    }

    fn index(&self, q: DVec3) -> Option<usize> {
        let mut cell = [0; 3];
        for a in 0..3 {
            let c = (q[a] - self.low[a]) / self.cell;
            if c < 0.0 || c >= self.size[a] as f64 {
                return None;
            }
            cell[a] = c as usize;
        }
        Some((cell[2] * self.size[1] + cell[1]) * self.size[0] + cell[0])
    }

    /// Mean transmittance over the upper hemisphere and the horizon, (0, 1].
    pub(super) fn exposure(&self, q: DVec3) -> f64 {
        let mut sum = 0.0;
        let mut n = 0.0;
        for x in -1..=1 {
            for z in -1..=1 {
                for y in 0..=1 {
                    let d = DVec3::new(f64::from(x), f64::from(y), f64::from(z));
                    if d == DVec3::ZERO {
                        continue;
                    }
                    sum += self.transmittance(q, d.normalize() * self.cell);
                    n += 1.0;
                }
            }
        }
        sum / n
    }

    fn transmittance(&self, mut q: DVec3, step: DVec3) -> f64 {
        let mut depth = 0.0;
        loop {
            q += step;
            match self.index(q) {
                Some(i) => depth += self.density[i],
                None => return exp(-0.6 * depth),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_a_ball_is_darker_than_its_skin() {
        let mut points = Vec::new();
        for x in -10..=10 {
            for y in -10..=10 {
                for z in -10..=10 {
                    let q = DVec3::new(f64::from(x), f64::from(y), f64::from(z));
                    if q.length() <= 10.0 {
                        points.push((q, 1.0));
                    }
                }
            }
        }
        let light = Light::new(&points);
        assert!(light.exposure(DVec3::ZERO) < 0.2 * light.exposure(DVec3::Y * 9.9));
    }
}
