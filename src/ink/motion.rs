//! Hatching that stays on its clusters while the camera moves (Coconu, Deussen, Hege 2006,
//! equations 3, 4 and the turning of `V_O`).

use glam::{DVec2, DVec3};

use super::view::{Hatch, View};

/// Axes at a cluster: x to the right of the picture and y upwards, both across z, which points to
/// the eye.
#[derive(Debug, Clone, Copy)]
struct Axes {
    x: DVec3,
    y: DVec3,
    z: DVec3,
}

impl Axes {
    fn new(view: &View, centre: DVec3) -> Self {
        let [right, up, _] = view.camera.basis();
        let z = (view.eye() - centre).try_normalize();
        let z = z.unwrap_or(-view.camera.forward);
        let across = right - right.dot(z) * z;
        // A cluster straight to the side of the eye: the picture's up serves.
        let x = across
            .try_normalize()
            .unwrap_or_else(|| up.cross(z).normalize_or(DVec3::X));
        Self {
            x,
            y: z.cross(x),
            z,
        }
    }
}

/// `v` after the smallest turn that takes unit vector `from` to `to`.
fn transported(v: DVec3, from: DVec3, to: DVec3) -> DVec3 {
    let axis = from.cross(to);
    let cosine = from.dot(to);
    if cosine < -0.999_999 {
        // Half a turn has no smallest way; the axis is as good as any.
        return v;
    }
    v + axis.cross(v) + axis.cross(axis.cross(v)) / (1.0 + cosine)
}

impl Hatch {
    /// As it starts: `V_O` points left, the texture's middle is in the cluster's.
    #[must_use]
    pub fn start(tiles: DVec2) -> Self {
        Self {
            reference: DVec2::ZERO,
            up: DVec2::NEG_X,
            tiles,
        }
    }

    /// After the eye has moved from `before` to `after`: the texture's coordinates of the new
    /// centre (equation 4, with the increment turned into the texture's axes, without which
    /// strokes slip when the camera rolls), and `V_O` turned as the picture turns.
    #[must_use]
    pub fn moved(self, before: &View, after: &View, centre: DVec3) -> Self {
        let (old, new) = (Axes::new(before, centre), Axes::new(after, centre));
        let q = DVec3::new(new.z.dot(old.x), new.z.dot(old.y), new.z.dot(old.z));
        let angles = DVec2::new(q.x.atan2(q.z), q.y.clamp(-1.0, 1.0).asin());
        let turned = DVec2::new(
            self.up.y * angles.x - self.up.x * angles.y,
            self.up.x * angles.x + self.up.y * angles.y,
        );
        let reference = self.reference + self.tiles / std::f64::consts::PI * turned;
        let on_sphere = self.up.x * old.x + self.up.y * old.y;
        let carried = transported(on_sphere, old.z, new.z);
        let up = DVec2::new(carried.dot(new.x), carried.dot(new.y));
        Self {
            reference,
            up: up.try_normalize().unwrap_or(self.up),
            tiles: self.tiles,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Camera;
    use glam::Vec3;

    fn view(eye: DVec3, target: DVec3) -> View {
        let camera = Camera {
            eye,
            forward: (target - eye).normalize(),
            fov: 45.0,
            aspect: 4.0 / 3.0,
            near: 0.01,
        };
        View::new(camera, DVec3::ZERO, [800, 600], Vec3::Y, &[Vec3::ZERO])
    }

    /// Texture coordinates of a point of the sphere of radius 1 about the origin.
    fn coordinates(view: &View, hatch: &Hatch, point: DVec3) -> DVec2 {
        let (at, _) = view.pixel(point);
        let (centre, _) = view.pixel(DVec3::ZERO);
        let front = view.eye().length() - 1.0;
        let offset = (at - centre) * DVec2::new(1.0, -1.0) * front / view.focal();
        let up = hatch.up;
        let turned = DVec2::new(
            up.y * offset.x - up.x * offset.y,
            up.x * offset.x + up.y * offset.y,
        );
        hatch.reference + hatch.tiles / std::f64::consts::PI * turned
    }

    /// The eye on a way about the cluster that rises, sinks and comes nearer.
    fn eye(t: f64) -> DVec3 {
        let (azimuth, elevation) = (2.0 * t, 0.6 * (3.0 * t).sin());
        let distance = 10.0 + 2.0 * t.cos();
        distance
            * DVec3::new(
                azimuth.sin() * elevation.cos(),
                elevation.sin(),
                azimuth.cos() * elevation.cos(),
            )
    }

    #[test]
    fn strokes_do_not_slip_at_the_middle_of_a_cluster() {
        let mut hatch = Hatch::start(DVec2::new(3.0, 1.0));
        let frames = 400;
        let mut worst = 0.0_f64;
        for i in 0..frames {
            let t = f64::from(i) / f64::from(frames);
            let (a, b) = (eye(t), eye(t + 1.0 / f64::from(frames)));
            // Looks past the cluster, so that it is not in the picture's middle.
            let (before, after) = (
                view(a, DVec3::new(0.3, 0.1, 0.0)),
                view(b, DVec3::new(0.3, 0.1, 0.0)),
            );
            let next = hatch.moved(&before, &after, DVec3::ZERO);
            let front = a.normalize();
            let slip = coordinates(&after, &next, front) - coordinates(&before, &hatch, front);
            let turn = a.angle_between(b);
            worst = worst.max(slip.length() / turn.max(1e-9));
            hatch = next;
        }
        // Tiles per radian of the camera's turn; the texture itself goes 3 / pi of them.
        assert!(worst < 0.02, "{worst}");
        // Without the turning of V_O and of increments the slip is as large as the turn.
        assert!(
            hatch.up.distance(DVec2::NEG_X) > 0.05,
            "the picture did turn"
        );
    }

    #[test]
    fn a_level_walk_is_the_same_with_and_without_history() {
        let tiles = DVec2::splat(2.0);
        let at = |azimuth: f64| 8.0 * DVec3::new(azimuth.sin(), 0.0, azimuth.cos());
        let mut hatch = Hatch::stateless(&view(at(0.0), DVec3::ZERO), DVec3::ZERO, tiles);
        for i in 0..50 {
            let (a, b) = (f64::from(i) * 0.02, f64::from(i + 1) * 0.02);
            hatch = hatch.moved(
                &view(at(a), DVec3::ZERO),
                &view(at(b), DVec3::ZERO),
                DVec3::ZERO,
            );
        }
        let alone = Hatch::stateless(&view(at(1.0), DVec3::ZERO), DVec3::ZERO, tiles);
        assert!(hatch.reference.distance(alone.reference) < 1e-9);
        assert!(hatch.up.distance(alone.up) < 1e-9);
    }

    #[test]
    fn an_orbit_moves_the_texture_by_its_way_about_the_cluster() {
        // The spec's table: 2 m cos(elevation) tiles for a closed orbit.
        for (degrees, expected) in [(0.0_f64, 6.0), (30.0, 5.196)] {
            let e = degrees.to_radians();
            let at = |k: i32| {
                let azimuth = f64::from(k) * std::f64::consts::TAU / 720.0;
                10.0 * DVec3::new(e.cos() * azimuth.sin(), e.sin(), e.cos() * azimuth.cos())
            };
            let mut way = 0.0;
            let mut hatch = Hatch {
                up: DVec2::Y,
                ..Hatch::start(DVec2::splat(3.0))
            };
            for k in 0..720 {
                let (a, b) = (view(at(k), DVec3::ZERO), view(at(k + 1), DVec3::ZERO));
                // Level increments: along u, by a camera that does not roll.
                let next = Hatch {
                    up: DVec2::Y,
                    ..hatch
                }
                .moved(&a, &b, DVec3::ZERO);
                way += next.reference.x - hatch.reference.x;
                hatch = next;
            }
            assert!((way - expected).abs() < 0.01, "{degrees}: {way}");
        }
    }
}
