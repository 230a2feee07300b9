//! The moving frame of a growing stem.

use glam::DVec3;

use super::portable::{sin_cos, sin_cos_degrees};

/// Right-handed orthonormal frame: z is where the stem grows, x the axis it curves about.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub(super) x: DVec3,
    pub(super) z: DVec3,
}

impl Frame {
    /// A frame that grows straight up.
    pub(super) fn upright() -> Self {
        Self {
            x: DVec3::X,
            z: DVec3::Y,
        }
    }

    /// The third axis.
    pub(super) fn y(&self) -> DVec3 {
        self.z.cross(self.x)
    }

    /// Turns about an axis through the origin, degrees.
    #[must_use]
    pub(super) fn turned(&self, axis: DVec3, degrees: f64) -> Self {
        Self {
            x: rotate(self.x, axis, degrees),
            z: rotate(self.z, axis, degrees),
        }
        .orthonormal()
    }

    /// Rotates about the growth axis, then tilts about the new x: how a child leaves its parent.
    #[must_use]
    pub(super) fn child(&self, rotate_degrees: f64, down_degrees: f64) -> Self {
        let spun = self.turned(self.z, rotate_degrees);
        spun.turned(spun.x, down_degrees)
    }

    /// Turns towards (or, when negative, away from) `target` by at most `degrees` times the sine
    /// of the angle between them, so that it eases in.
    #[must_use]
    pub(super) fn steered(&self, target: DVec3, degrees: f64) -> Self {
        let axis = self.z.cross(target);
        let sine = axis.length();
        if sine < 1e-6 {
            return *self;
        }
        self.turned(axis / sine, degrees * sine)
    }

    /// The frame moved along a curve to a new direction with no spin about it (parallel
    /// transport), so that the tube around it does not twist.
    #[must_use]
    pub(super) fn transported(&self, z: DVec3) -> Self {
        let axis = self.z.cross(z);
        let sine = axis.length();
        if sine < 1e-12 {
            return Self { x: self.x, z }.orthonormal();
        }
        let axis = axis / sine;
        let cosine = self.z.dot(z);
        let x = self.x * cosine
            + axis.cross(self.x) * sine
            + axis * (axis.dot(self.x) * (1.0 - cosine));
        Self { x, z }.orthonormal()
    }

    fn orthonormal(self) -> Self {
        let z = self.z.normalize();
        Self {
            x: (self.x - z * z.dot(self.x)).normalize(),
            z,
        }
    }

    /// Unit vector at an angle (radians) round the growth axis.
    pub(super) fn radial(&self, angle: f64) -> DVec3 {
        let (s, c) = sin_cos(angle);
        self.x * c + self.y() * s
    }
}

/// Rodrigues' rotation of `v` about the unit `axis`, degrees.
fn rotate(v: DVec3, axis: DVec3, degrees: f64) -> DVec3 {
    let (s, c) = sin_cos_degrees(degrees);
    v * c + axis.cross(v) * s + axis * (axis.dot(v) * (1.0 - c))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn children_leave_at_the_down_angle() {
        let f = Frame::upright();
        let child = f.child(77.0, 60.0);
        assert!((child.z.dot(f.z) - 0.5).abs() < 1e-12);
        assert!(child.x.dot(child.z).abs() < 1e-12);
        let up = child.steered(DVec3::Y, 20.0);
        assert!(up.z.y > child.z.y);
        let moved = f.transported(child.z);
        assert!(moved.x.dot(child.z).abs() < 1e-12 && (moved.x.length() - 1.0).abs() < 1e-12);
    }
}
