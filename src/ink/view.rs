//! What of clusters and textures depends on the camera: places in the picture, hatch coordinates
//! (Coconu, Deussen, Hege 2006, equations 3 to 7).

use glam::{DMat2, DVec2, DVec3, Vec3};

use super::clusters::Cluster;
use super::motion::Course;
use crate::abi::{InkCluster, InkFrame};
use crate::scene::Camera;

/// Camera, sun and plants of a view.
#[derive(Debug, Clone, Copy)]
pub struct View {
    /// The camera.
    pub camera: Camera,
    /// World position of the geometry's zero.
    pub origin: DVec3,
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Unit vector to the sun.
    pub to_sun: Vec3,
    /// Smallest and largest eye depth of what is drawn, metres.
    pub depths: [f32; 2],
}

impl View {
    /// The view of everything at `points` (relative to `origin`).
    #[must_use]
    pub fn new(
        camera: Camera,
        origin: DVec3,
        size: [u32; 2],
        to_sun: Vec3,
        points: &[Vec3],
    ) -> Self {
        let eye = (camera.eye - origin).as_vec3();
        let forward = camera.forward.as_vec3();
        let near = camera.near as f32;
        let (mut low, mut high) = (f32::INFINITY, near);
        for &p in points {
            let depth = (p - eye).dot(forward).max(near);
            (low, high) = (low.min(depth), high.max(depth));
        }
        let low = low.min(high);
        // A scene without depth would divide by zero.
        let high = high.max(low * (1.0 + 1e-5));
        Self {
            camera,
            origin,
            size,
            to_sun,
            depths: [low, high],
        }
    }

    /// Focal length, pixels.
    #[must_use]
    pub fn focal(&self) -> f64 {
        let [_, y] = self.camera.half_extent();
        0.5 * f64::from(self.size[1]) / y
    }

    /// Distance of the middle of what is drawn, metres.
    #[must_use]
    pub fn middle_distance(&self) -> f64 {
        0.5 * (f64::from(self.depths[0]) + f64::from(self.depths[1]))
    }

    /// The camera's place in the geometry's frame.
    #[must_use]
    pub fn eye(&self) -> DVec3 {
        self.camera.eye - self.origin
    }

    /// What kernels need of the view.
    #[must_use]
    pub fn frame(&self) -> InkFrame {
        let [right, up, _] = self.camera.basis();
        InkFrame {
            relative_to_clip: self.camera.relative_to_clip(self.origin).to_cols_array_2d(),
            eye: self.eye().as_vec3().to_array(),
            focal: self.focal() as f32,
            forward: self.camera.forward.as_vec3().to_array(),
            width: self.size[0],
            right: right.as_vec3().to_array(),
            height: self.size[1],
            up: up.as_vec3().to_array(),
            nearest: self.depths[0],
            to_sun: self.to_sun.to_array(),
            farthest: self.depths[1],
            parts: 0,
            masked: 0,
            wood: 0.0,
        }
    }

    /// Place in the picture (pixels, y down) and depth of a point of the geometry's frame.
    #[must_use]
    pub fn pixel(&self, point: DVec3) -> (DVec2, f64) {
        let away = point - self.eye();
        let [right, up, _] = self.camera.basis();
        let depth = away.dot(self.camera.forward);
        let scale = self.focal() / depth.max(1e-30);
        let [w, h] = self.size.map(f64::from);
        let at = DVec2::new(
            0.5 * w + away.dot(right) * scale,
            0.5 * h - away.dot(up) * scale,
        );
        (at, depth)
    }

    /// The point of the geometry's frame that is seen at a place of the picture (pixels, y down)
    /// at a depth: the inverse of [`View::pixel`].
    #[must_use]
    pub fn point(&self, pixel: DVec2, depth: f64) -> DVec3 {
        let [right, up, _] = self.camera.basis();
        let [w, h] = self.size.map(f64::from);
        let scale = depth / self.focal();
        let across = (pixel.x - 0.5 * w) * right + (0.5 * h - pixel.y) * up;
        self.eye() + depth * self.camera.forward + scale * across
    }

    /// Angles (radians) on a sphere about its front point along the axes of the eye's view of it,
    /// for a pixel to the right and one upwards: the inverse of how the picture shows the sphere
    /// there, exact also beside the picture's middle.
    fn angles_per_pixel(&self, centre: DVec3, radius: f64) -> [f32; 4] {
        let axes = Axes::new(self, centre);
        let [right, up, _] = self.camera.basis();
        let forward = self.camera.forward;
        let front = centre + radius * axes.z - self.eye();
        let depth = front.dot(forward);
        let scale = self.focal() * radius / (depth * depth);
        // Pixels for an angle along an axis of the sphere.
        let shown = |axis: DVec3| {
            let along = |of: DVec3| axis.dot(of) * depth - front.dot(of) * axis.dot(forward);
            DVec2::new(along(right), along(up)) * scale
        };
        let inverse = DMat2::from_cols(shown(axes.x), shown(axes.y)).inverse();
        let [a, c, b, d] = inverse.to_cols_array();
        [a, b, c, d].map(|v| if v.is_finite() { v as f32 } else { 0.0 })
    }

    /// A cluster in the picture. `least` is the smallest radius taken for it: that of a leaf.
    /// A cluster around the eye or behind it has no outline (`pixel_radius` 0).
    #[must_use]
    pub fn cluster(&self, cluster: &Cluster, least: f32, hatch: &Hatch) -> InkCluster {
        let centre = cluster.centre.as_dvec3();
        let radius = f64::from(cluster.radius.max(least).max(f32::MIN_POSITIVE));
        let distance = (centre - self.eye()).length();
        let (pixel, depth) = self.pixel(centre);
        let seen = distance - radius > self.camera.near && depth > self.camera.near;
        let front = depth * (1.0 - radius / distance.max(f64::MIN_POSITIVE));
        // The outline of a sphere: at the tangent cone, not at the radius.
        let outline = if seen {
            self.focal() * radius / (distance * distance - radius * radius).sqrt()
        } else {
            0.0
        };
        InkCluster {
            centre: cluster.centre.to_array(),
            radius: radius as f32,
            pixel: pixel.as_vec2().to_array(),
            pixel_radius: outline as f32,
            front: front.max(0.0) as f32,
            to_angles: if seen {
                self.angles_per_pixel(centre, radius)
            } else {
                [0.0; 4]
            },
            reference: hatch.reference.as_vec2().to_array(),
            texture_up: hatch.up.as_vec2().to_array(),
            tiles: hatch.tiles.as_vec2().to_array(),
        }
    }
}

/// Axes at a cluster: x to the right of the picture and y upwards, both across z, which points to
/// the eye.
#[derive(Debug, Clone, Copy)]
pub(super) struct Axes {
    pub(super) x: DVec3,
    pub(super) y: DVec3,
    pub(super) z: DVec3,
}

impl Axes {
    pub(super) fn new(view: &View, centre: DVec3) -> Self {
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

/// Where the hatching of a cluster stands: texture coordinates of its centre, and the direction in
/// the picture along which v grows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hatch {
    /// `R_uv`, tiles.
    pub reference: DVec2,
    /// `V_O`: unit, x right, y up.
    pub up: DVec2,
    /// Tiles over half a turn (m, n).
    pub tiles: DVec2,
}

/// Tiles over half a turn about a sphere of `radius` metres, for strokes as large as in the tile
/// (`scale` pixels a texel) where a pixel is `pixel` metres.
#[must_use]
pub fn tiles_about(radius: f64, pixel: f64, scale: f64) -> f64 {
    std::f64::consts::PI * radius / (pixel * f64::from(crate::abi::INK_TILE) * scale)
}

impl Hatch {
    /// What a course makes of tiles of one size.
    #[must_use]
    pub fn new(course: &Course, tiles: DVec2) -> Self {
        Self {
            reference: course.turned * tiles / std::f64::consts::PI,
            up: course.up,
            tiles,
        }
    }

    /// Starts elsewhere in the tile: what keeps clusters from looking alike.
    #[must_use]
    pub fn scattered(mut self, cluster: u32) -> Self {
        // The two-dimensional golden ratio sequence (Roberts 2018).
        let k = f64::from(cluster) + 1.0;
        self.reference += DVec2::new(0.754_877_666_246_692_8 * k, 0.569_840_290_998_053_3 * k);
        self.reference -= self.reference.floor();
        self
    }
}
