//! Where the picture is taken from. The only file that builds view and projection matrices.

use glam::dcamera::rh::{proj, view};
use glam::{DMat4, DVec3, Mat4, Vec3};

use super::camera_spec::CameraSpec;
use super::light::spherical;

/// A perspective camera in world coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// World metres.
    pub eye: DVec3,
    /// Unit direction of view.
    pub forward: DVec3,
    /// Vertical field of view, degrees, in (0, 180).
    pub fov: f64,
    /// Width over height.
    pub aspect: f64,
    /// Distance of the near plane, metres, above 0. There is no far plane.
    pub near: f64,
    /// Turn about the direction of view, degrees; the top of the picture leans to the right.
    pub roll: f64,
}

/// Basis of a direction of view: right, up, backward (unit, right-handed). Looking straight up or
/// down, the top of the picture is -z or +z.
fn basis(forward: DVec3) -> [DVec3; 3] {
    let up_hint = if forward.y.abs() > 0.999_999 {
        DVec3::Z * forward.y.signum()
    } else {
        DVec3::Y
    };
    let right = forward.cross(up_hint).normalize();
    [right, right.cross(forward), -forward]
}

impl Camera {
    /// The camera that `spec` describes for a subject given by `points` (relative to `origin`).
    /// `margin` is the free share of the picture on every side, in \[0, 0.45\].
    #[must_use]
    pub fn new(
        spec: &CameraSpec,
        lens: Lens,
        origin: DVec3,
        points: impl Iterator<Item = Vec3> + Clone,
    ) -> Self {
        match *spec {
            CameraSpec::LookAt { eye, target } => {
                let forward = (target - eye).normalize_or(DVec3::NEG_Z);
                let reach = points
                    .map(|p| (origin + p.as_dvec3() - eye).length())
                    .fold(eye.distance(target), f64::max);
                Self {
                    eye,
                    forward,
                    fov: lens.fov,
                    aspect: lens.aspect,
                    near: reach * NEAR_SHARE,
                    roll: 0.0,
                }
            }
            CameraSpec::Orbit {
                azimuth,
                elevation,
                distance,
            } => Self::frame(
                -spherical(azimuth, elevation),
                distance,
                lens,
                origin,
                points,
            ),
        }
    }

    /// Moves back along `-forward` until every point is inside the picture: the smallest pyramid
    /// with the given opening around the points, found in closed form (each side plane is pushed
    /// to its extreme point, opposite planes meet at the eye).
    fn frame(
        forward: DVec3,
        distance: f64,
        lens: Lens,
        origin: DVec3,
        points: impl Iterator<Item = Vec3> + Clone,
    ) -> Self {
        let [right, up, back] = basis(forward);
        let tan_y = (0.5 * lens.fov.to_radians()).tan() * (1.0 - 2.0 * lens.margin);
        let tan_x = tan_y * lens.aspect;
        // Support of the four side planes and of the view axis.
        let mut support = [f64::NEG_INFINITY; 4];
        let (mut nearest, mut farthest) = (f64::NEG_INFINITY, f64::INFINITY);
        for p in points.clone() {
            let p = p.as_dvec3();
            let (x, y, z) = (right.dot(p), up.dot(p), back.dot(p));
            let planes = [x + tan_x * z, -x + tan_x * z, y + tan_y * z, -y + tan_y * z];
            for (s, v) in support.iter_mut().zip(planes) {
                *s = s.max(v);
            }
            nearest = nearest.max(z);
            farthest = farthest.min(z);
        }
        if !nearest.is_finite() {
            // Nothing to frame: any camera will do.
            return Self {
                eye: origin + back,
                forward,
                fov: lens.fov,
                aspect: lens.aspect,
                near: NEAR_SHARE,
                roll: 0.0,
            };
        }
        let x = 0.5 * (support[0] - support[1]);
        let y = 0.5 * (support[2] - support[3]);
        let tight = f64::max(
            0.5 * (support[0] + support[1]) / tan_x,
            0.5 * (support[2] + support[3]) / tan_y,
        );
        let middle = 0.5 * (nearest + farthest);
        // A single point, or a flat subject seen edge-on, still needs some distance.
        let smallest = nearest + 1e-3 * f64::max(nearest - farthest, 1e-6);
        let z = (middle + (tight.max(smallest) - middle) * distance).max(smallest);
        let mut eye = DVec3::new(x, y, z);
        // The axis that does not decide the distance has room to spare: share it evenly.
        for _ in 0..CENTRING_ROUNDS {
            let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            for p in points.clone() {
                let p = p.as_dvec3();
                let depth = z - back.dot(p);
                let q = DVec3::new(right.dot(p) - eye.x, up.dot(p) - eye.y, 0.0) / depth;
                min = min.min(q);
                max = max.max(q);
            }
            eye += (0.5 * (min + max) * (z - middle)).with_z(0.0);
        }
        Self {
            eye: origin + right * eye.x + up * eye.y + back * z,
            forward,
            fov: lens.fov,
            aspect: lens.aspect,
            near: (z - farthest) * NEAR_SHARE,
            roll: 0.0,
        }
    }

    /// A camera at a place, with the near plane that suits `points` (relative to `origin`).
    #[must_use]
    pub fn posed(
        pose: &Pose,
        aspect: f64,
        origin: DVec3,
        points: impl Iterator<Item = Vec3>,
    ) -> Self {
        let reach = points
            .map(|p| (origin + p.as_dvec3() - pose.eye).length())
            .fold(f64::MIN_POSITIVE, f64::max);
        Self {
            eye: pose.eye,
            forward: pose.forward,
            fov: pose.fov,
            aspect,
            near: reach * NEAR_SHARE,
            roll: pose.roll,
        }
    }

    /// Right, up and backward unit vectors.
    #[must_use]
    pub fn basis(&self) -> [DVec3; 3] {
        let [right, up, back] = basis(self.forward);
        if self.roll == 0.0 {
            return [right, up, back];
        }
        let (sine, cosine) = self.roll.to_radians().sin_cos();
        [cosine * right - sine * up, cosine * up + sine * right, back]
    }

    /// Clip from positions relative to `origin`. The large parts (origin minus eye) cancel in f64
    /// before anything becomes f32. Depth is reversed: 1 at the near plane, 0 at infinity.
    #[must_use]
    pub fn relative_to_clip(&self, origin: DVec3) -> Mat4 {
        let [_, up, _] = self.basis();
        let rotation = view::look_to_mat4(DVec3::ZERO, self.forward, up);
        let to_view = rotation * DMat4::from_translation(origin - self.eye);
        let to_clip = proj::vulkan::perspective_infinite_reverse(
            self.fov.to_radians(),
            self.aspect,
            self.near,
        );
        (to_clip * to_view).as_mat4()
    }

    /// Tangents of the half-angles of the picture, horizontal and vertical.
    #[must_use]
    pub fn half_extent(&self) -> [f64; 2] {
        let tan_y = (0.5 * self.fov.to_radians()).tan();
        [tan_y * self.aspect, tan_y]
    }

    /// Position in the picture, \[0,1\]^2 from the top left, and linear eye depth in metres.
    #[must_use]
    pub fn project(&self, world: DVec3) -> (DVec3, f64) {
        let [right, up, _] = self.basis();
        let d = world - self.eye;
        let depth = self.forward.dot(d);
        let [tan_x, tan_y] = self.half_extent();
        let x = right.dot(d) / (depth * tan_x);
        let y = up.dot(d) / (depth * tan_y);
        (DVec3::new(0.5 + 0.5 * x, 0.5 - 0.5 * y, 0.0), depth)
    }
}

/// Rounds of centring the framed subject; each leaves less than a tenth of the error.
const CENTRING_ROUNDS: usize = 3;

/// Share of the subject's farthest distance at which the near plane stands.
const NEAR_SHARE: f64 = 1e-3;

/// Where a camera stands at one moment, and how it looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// World metres.
    pub eye: DVec3,
    /// Unit direction of view.
    pub forward: DVec3,
    /// Vertical field of view, degrees.
    pub fov: f64,
    /// As [`Camera::roll`].
    pub roll: f64,
}

/// Opening of the camera and shape of the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lens {
    /// Vertical field of view, degrees.
    pub fov: f64,
    /// Width over height.
    pub aspect: f64,
    /// Free share of the picture on every side when the subject is framed, in \[0, 0.45\].
    pub margin: f64,
}

/// Orthographic projection along a light: clip from positions relative to an origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightView {
    /// Relative position to clip; reversed depth: 1 nearest the light, 0 farthest.
    pub relative_to_clip: Mat4,
    /// Extent of the map across, metres: width, height.
    pub extent: [f32; 2],
    /// Extent along the light, metres.
    pub range: f32,
}

impl LightView {
    /// The tightest box along `to_light` around `points`, widened by `border` texels of a map of
    /// `size` texels so that a filter never reads outside.
    #[must_use]
    pub fn fit(
        to_light: DVec3,
        points: impl Iterator<Item = Vec3>,
        size: u32,
        border: u32,
    ) -> Self {
        let [right, up, back] = basis(-to_light);
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for p in points {
            let p = p.as_dvec3();
            let q = DVec3::new(right.dot(p), up.dot(p), back.dot(p));
            min = min.min(q);
            max = max.max(q);
        }
        if !min.is_finite() {
            (min, max) = (DVec3::splat(-0.5), DVec3::splat(0.5));
        }
        Self::of_box(to_light, [min, max], size, border)
    }

    /// A box of the same size whatever the light's direction: around a sphere, widened like
    /// [`LightView::fit`].
    #[must_use]
    pub fn around(to_light: DVec3, (centre, radius): (Vec3, f64), size: u32, border: u32) -> Self {
        let p = centre.as_dvec3();
        let middle = DVec3::from_array(basis(-to_light).map(|axis| axis.dot(p)));
        let reach = DVec3::splat(radius);
        Self::of_box(to_light, [middle - reach, middle + reach], size, border)
    }

    /// The view of a box given along right, up and backward.
    fn of_box(to_light: DVec3, [min, max]: [DVec3; 2], size: u32, border: u32) -> Self {
        let up = basis(-to_light)[1];
        let grow = f64::from(size) / f64::from(size.saturating_sub(2 * border).max(1));
        let centre = 0.5 * (min + max);
        // A subject without thickness along an axis still needs a box.
        let floor = 1e-6 * (max - min).max_element().max(1e-6);
        let mut half = (0.5 * (max - min)).max(DVec3::splat(floor));
        half.x *= grow;
        half.y *= grow;
        // The nearest and farthest casters keep away from the ends of the depth range.
        half.z *= 1.002;
        let rotation = view::look_to_mat4(DVec3::ZERO, -to_light, up);
        // Symmetric about the box's centre; near and far are exchanged, for reversed depth.
        let to_centre = DMat4::from_translation(-centre);
        let [x, y, z] = half.to_array();
        let projection = proj::vulkan::orthographic(-x, x, -y, y, z, -z) * to_centre;
        Self {
            relative_to_clip: (projection * rotation).as_mat4(),
            extent: [(2.0 * half.x) as f32, (2.0 * half.y) as f32],
            range: (2.0 * half.z) as f32,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn around_a_sphere_the_map_is_the_same_from_everywhere() {
        let points = cloud();
        let (low, high) = points
            .iter()
            .fold((Vec3::MAX, Vec3::MIN), |(a, b), p| (a.min(*p), b.max(*p)));
        let sphere = (0.5 * (low + high), 0.5 * f64::from(low.distance(high)));
        for direction in [DVec3::Y, DVec3::X, DVec3::new(0.3, 0.8, -0.5).normalize()] {
            let view = LightView::around(direction, sphere, 512, 4);
            let wide = 2.0 * sphere.1 * 512.0 / 504.0;
            for extent in view.extent {
                assert!(
                    (f64::from(extent) / wide - 1.0).abs() < 1e-6,
                    "{extent}, {wide}"
                );
            }
            for p in &points {
                let at = view.relative_to_clip.project_point3(*p);
                assert!(
                    at.truncate().abs().max_element() < 504.0 / 512.0 + 1e-5,
                    "{at}"
                );
                assert!((0.0..=1.0).contains(&at.z), "{at}");
            }
        }
    }

    const LENS: Lens = Lens {
        fov: 40.0,
        aspect: 1.5,
        margin: 0.05,
    };

    fn cloud() -> Vec<Vec3> {
        (0..500)
            .map(|i| {
                let f = |k: f32| (i as f32 * k).sin();
                Vec3::new(3.0 * f(1.1), 1.0 + 5.0 * f(1.7), 2.0 * f(2.3))
            })
            .collect()
    }

    #[test]
    fn framing_touches_the_margin_and_nothing_leaves_it() {
        let points = cloud();
        let origin = DVec3::new(5e6, 100.0, -2e6);
        for (azimuth, elevation) in [(0.0, 0.0), (25.0, 7.0), (130.0, -30.0), (10.0, 90.0)] {
            let spec = CameraSpec::Orbit {
                azimuth,
                elevation,
                distance: 1.0,
            };
            let camera = Camera::new(&spec, LENS, origin, points.iter().copied());
            let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            for p in &points {
                let (at, depth) = camera.project(origin + p.as_dvec3());
                assert!(depth > camera.near, "{depth}");
                lo = lo.min(at);
                hi = hi.max(at);
            }
            let free = (lo.x.min(1.0 - hi.x)).min(lo.y.min(1.0 - hi.y));
            assert!(
                (free - 0.05).abs() < 0.01,
                "{azimuth},{elevation}: {lo} {hi}"
            );
        }
    }

    #[test]
    fn matrix_and_projection_agree() {
        let origin = DVec3::new(4e5, 0.0, 6e6);
        let spec = "4e5,2,6.00001e6/4e5,1,6e6".parse().expect("a camera");
        let camera = Camera::new(&spec, LENS, origin, std::iter::empty());
        let p = Vec3::new(0.5, 0.25, -1.0);
        let clip = camera.relative_to_clip(origin) * p.extend(1.0);
        let (at, depth) = camera.project(origin + p.as_dvec3());
        assert!((f64::from(clip.w) - depth).abs() < 1e-5);
        assert!((f64::from(clip.x / clip.w) * 0.5 + 0.5 - at.x).abs() < 1e-6);
        assert!((f64::from(clip.y / clip.w) * 0.5 + 0.5 - at.y).abs() < 1e-6);
        assert!((f64::from(clip.z) - camera.near).abs() < 1e-6 * camera.near);
    }

    #[test]
    fn a_rolled_camera_turns_the_picture_and_nothing_else() {
        let spec = "10,2,5/0,1,0".parse().expect("a camera");
        let level = Camera::new(&spec, LENS, DVec3::ZERO, cloud().into_iter());
        let turned = Camera {
            roll: 90.0,
            aspect: 1.0,
            ..level
        };
        // What was above the middle now lies to its left.
        let [_, up, _] = level.basis();
        let above = level.eye + 5.0 * level.forward + up;
        let (at, depth) = turned.project(above);
        assert!((at.y - 0.5).abs() < 1e-12 && at.x < 0.4, "{at}");
        assert!(
            (depth - level.project(above).1).abs() < 1e-12,
            "depth stays"
        );
        let clip = turned.relative_to_clip(DVec3::ZERO) * above.as_vec3().extend(1.0);
        assert!((f64::from(clip.x / clip.w) * 0.5 + 0.5 - at.x).abs() < 1e-5);
    }

    #[test]
    fn suns_view_holds_every_caster_nearest_at_one() {
        let points = cloud();
        let to_sun = spherical(40.0, 35.0);
        let view = LightView::fit(to_sun, points.iter().copied(), 256, 4);
        let mut near = (f32::NEG_INFINITY, 0.0);
        for p in &points {
            let q = view.relative_to_clip.project_point3(*p);
            assert!(
                q.x.abs() < 1.0 && q.y.abs() < 1.0 && q.z > 0.0 && q.z < 1.0,
                "{q}"
            );
            let along = to_sun.as_vec3().dot(*p);
            if along > near.0 {
                near = (along, q.z);
            }
        }
        assert!(near.1 > 0.99, "{}", near.1);
    }

    #[test]
    fn degenerate_subjects_have_a_camera() {
        let spec = CameraSpec::default();
        for points in [vec![], vec![Vec3::ZERO], vec![Vec3::X; 3]] {
            let camera = Camera::new(&spec, LENS, DVec3::ZERO, points.iter().copied());
            let m = camera.relative_to_clip(DVec3::ZERO);
            assert!(m.is_finite() && camera.near > 0.0, "{camera:?}");
            let view = LightView::fit(DVec3::Y, points.iter().copied(), 64, 4);
            assert!(view.relative_to_clip.is_finite());
        }
    }

    #[test]
    fn refusals_give_the_reason() {
        for (text, reason) in [
            ("0,0,0/0,0,0", "same point"),
            ("25,95", "elevation 95"),
            ("25,7,0", "distance 0"),
            ("25,7,-1", "distance -1"),
            ("25", "expected"),
            ("1,2/3,4,5", "expected"),
        ] {
            let e = text.parse::<CameraSpec>().expect_err(text).to_string();
            assert!(e.contains(reason) && e.contains(text), "{e}");
        }
    }

    #[test]
    fn forms_of_the_option() {
        for (text, ok) in [
            ("25,7", true),
            ("25,7,1.5", true),
            ("1,2,3/4,5,6", true),
            ("1,2,3/1,2,3", false),
            ("25", false),
            ("25,91", false),
            ("25,7,0", false),
            ("nan,7", false),
        ] {
            assert_eq!(text.parse::<CameraSpec>().is_ok(), ok, "{text}");
        }
    }
}
