//! The frame in which the kernels work: the foliage box has its centre at zero and a diagonal of
//! one, so that neither scale nor distance from the origin costs digits.

use glam::{DVec3, Vec3};

/// Normalised coordinates: `q = (p - centre) / diagonal`, `p` relative to the geometry's origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Centre of the foliage box.
    pub centre: DVec3,
    /// Diagonal of the foliage box; 1 where it has none.
    pub diagonal: f64,
    /// Half the extent of the foliage box, normalised.
    pub half: DVec3,
}

impl Frame {
    /// The frame of a box.
    #[must_use]
    pub fn new(min: DVec3, max: DVec3) -> Self {
        let extent = (max - min).length();
        let diagonal = if extent > 0.0 { extent } else { 1.0 };
        Self {
            centre: 0.5 * (min + max),
            diagonal,
            half: 0.5 * (max - min) / diagonal,
        }
    }

    /// Normalised position; the only rounding on the way to the device.
    #[must_use]
    pub fn normalise(&self, p: DVec3) -> Vec3 {
        ((p - self.centre) / self.diagonal).as_vec3()
    }

    /// Position relative to the geometry's origin.
    #[must_use]
    pub fn restore(&self, q: Vec3) -> Vec3 {
        (q.as_dvec3() * self.diagonal + self.centre).as_vec3()
    }
}
