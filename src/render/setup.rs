//! Camera, sun's view and uniform data of a picture: everything that follows from subject and
//! settings without a device.

use glam::{DVec3, Vec3};

use super::settings::{Background, RenderSettings, ShadowFit};
use super::subject::Subject;
use super::view::View;
use crate::abi::{self, RenderFrame};
use crate::math::colour::srgb_to_linear;
use crate::scene::{Camera, CameraSpec, Lens, LightView};

/// Texels around the shadow map's subject that stay empty, so that the filter reads light there.
const SHADOW_BORDER: u32 = 4;
/// Longest part of a shadow that the automatic camera keeps in the picture, in subject heights.
const FRAMED_SHADOW: f64 = 0.75;
/// Radius of the ground plane in diagonals of the subject.
const GROUND_DIAGONALS: f32 = 4.0;
/// Share of the sky that a crown hides from the ground right below it.
const CROWN_OPACITY: f32 = 0.55;
/// Bit of `RenderFrame::terms`: ambient light.
const TERM_AMBIENT: u32 = 1;
/// Bit of `RenderFrame::terms`: sun and punctual lights.
const TERM_DIRECT: u32 = 2;

/// What a picture is taken with.
#[derive(Debug, Clone, Copy)]
pub struct Setup {
    /// The camera.
    pub camera: Camera,
    /// The sun's view of the subject.
    pub sun: LightView,
    /// Uniform data, for [`View::Textured`].
    pub frame: RenderFrame,
}

/// The camera for a subject: as set, framing the subject and the nearer part of its shadow.
#[must_use]
pub fn camera(subject: &Subject<'_>, settings: &RenderSettings) -> Camera {
    let g = subject.geometry;
    if let Some(pose) = &settings.pose {
        let aspect = f64::from(settings.size[0]) / f64::from(settings.size[1]);
        return Camera::posed(pose, aspect, g.origin, g.positions.iter().copied());
    }
    let lens = Lens {
        fov: settings.fov,
        aspect: f64::from(settings.size[0]) / f64::from(settings.size[1]),
        margin: settings.margin,
    };
    let foot = f64::from(g.min.y);
    let height = f64::from(g.max.y) - foot;
    let to_sun = settings.sun.direction();
    let casts = settings.ground && settings.shadows && to_sun.y > 0.0;
    // Horizontal way of the shadow per metre of height, shortened to what is framed.
    let slope = DVec3::new(-to_sun.x, 0.0, -to_sun.z) / to_sun.y.max(1e-6);
    let slope = slope.clamp_length_max(FRAMED_SHADOW);
    let shadow = g
        .positions
        .iter()
        .filter(move |_| casts && height > 0.0)
        .map(move |p| {
            let way = slope * (f64::from(p.y) - foot);
            Vec3::new(p.x + way.x as f32, foot as f32, p.z + way.z as f32)
        });
    let points = g.positions.iter().copied();
    let camera = Camera::new(
        &settings.camera,
        lens,
        g.origin,
        points.clone().chain(shadow),
    );
    let frames = matches!(settings.camera, CameraSpec::Orbit { .. });
    if frames && casts && !sees_ground(subject, settings, &camera) {
        // No ground, no shadow on it: the subject alone fills the picture.
        return Camera::new(&settings.camera, lens, g.origin, points);
    }
    camera
}

/// Whether there is a ground and the camera stands above it. From below it would hide everything.
fn sees_ground(subject: &Subject<'_>, settings: &RenderSettings, camera: &Camera) -> bool {
    let g = subject.geometry;
    settings.ground && camera.eye.y > g.origin.y + f64::from(g.min.y)
}

/// Mean and radius of the sphere with the second moment of the foliage (or of everything).
fn crown(subject: &Subject<'_>) -> (Vec3, f32) {
    let g = subject.geometry;
    let parts = g.parts.iter().enumerate();
    let foliage: Vec<_> = parts
        .filter(|(i, _)| {
            subject
                .baked
                .is_none_or(|b| b.foliage_parts.get(*i).copied().unwrap_or(false))
        })
        .flat_map(|(_, p)| g.positions[p.vertices()].iter().map(|p| p.as_dvec3()))
        .collect();
    if foliage.is_empty() {
        return (Vec3::ZERO, 0.0);
    }
    let n = foliage.len() as f64;
    let mean = foliage.iter().copied().sum::<DVec3>() / n;
    let spread = foliage
        .iter()
        .map(|p| p.distance_squared(mean))
        .sum::<f64>()
        / n;
    (mean.as_vec3(), (spread * 5.0 / 3.0).sqrt() as f32)
}

/// Horizon and zenith of the background, linear.
fn background(settings: &RenderSettings) -> (u32, [f32; 3], [f32; 3]) {
    let linear = |c: [f32; 3]| c.map(srgb_to_linear);
    match settings.background {
        Background::Neutral => (
            abi::BACKGROUND_NEUTRAL,
            linear([0.925, 0.922, 0.910]),
            linear([0.760, 0.795, 0.830]),
        ),
        Background::Sky => (
            abi::BACKGROUND_SKY,
            linear([0.88, 0.92, 0.95]),
            linear([0.36, 0.55, 0.80]),
        ),
        Background::Color(c) => (abi::BACKGROUND_NEUTRAL, c, c),
    }
}

/// Base colour of the ground: that which makes the sunlit ground look like the horizon in the light
/// of `terms`, so that only shade shows; under a sky, dry grass.
fn ground_albedo(settings: &RenderSettings, horizon: [f32; 3], terms: u32) -> [f32; 3] {
    if settings.background == Background::Sky {
        return [0.30, 0.29, 0.17];
    }
    let incidence = settings.sun.direction().y.max(0.0) as f32;
    let share = |term| if terms & term != 0 { 1.0 } else { 0.0 };
    std::array::from_fn(|c| {
        let light = settings.sky.zenith[c] * share(TERM_AMBIENT)
            + settings.sun.color[c] * incidence * share(TERM_DIRECT);
        horizon[c] / (light * settings.exposure).max(1e-6)
    })
}

/// The sun's view of the casters.
fn sun_view(subject: &Subject<'_>, settings: &RenderSettings) -> LightView {
    let g = subject.geometry;
    let to_sun = settings.sun.direction();
    let (size, border) = (settings.shadow_size, SHADOW_BORDER);
    if settings.shadow_fit == ShadowFit::Sphere && !g.positions.is_empty() {
        let sphere = (0.5 * (g.min + g.max), 0.5 * f64::from(g.diagonal()));
        return LightView::around(to_sun, sphere, size, border);
    }
    LightView::fit(to_sun, g.positions.iter().copied(), size, border)
}

impl Setup {
    /// Camera, sun's view and uniform data.
    #[must_use]
    pub fn new(subject: &Subject<'_>, settings: &RenderSettings) -> Self {
        let g = subject.geometry;
        let camera = camera(subject, settings);
        let sees_ground = sees_ground(subject, settings, &camera);
        if settings.ground && !sees_ground && !g.positions.is_empty() {
            log::warn!("the camera stands below the ground, which is left out");
        }
        let to_sun = settings.sun.direction();
        let sun = sun_view(subject, settings);
        let texels = settings.shadow_size as f32;
        let [right, up, _] = camera.basis();
        let [half_width, half_height] = camera.half_extent();
        let (background, horizon_color, zenith_color) = background(settings);
        let (crown_centre, crown_radius) = crown(subject);
        let extent = f64::from((g.max - g.min).max_element()).max(1e-9);
        let depth_scale = (g.origin - camera.eye).length() + extent;
        let frame = RenderFrame {
            relative_to_clip: camera.relative_to_clip(g.origin).to_cols_array_2d(),
            relative_to_sun: sun.relative_to_clip.to_cols_array_2d(),
            eye: (camera.eye - g.origin).as_vec3().into(),
            exposure: settings.exposure,
            forward: camera.forward.as_vec3().into(),
            terms: TERM_AMBIENT | TERM_DIRECT,
            right: (right * half_width).as_vec3().into(),
            shadow_texel: sun.extent[0].max(sun.extent[1]) / texels,
            up: (up * half_height).as_vec3().into(),
            shadow_radius: settings.shadow_radius / texels,
            sun_direction: to_sun.as_vec3().into(),
            shadow_range: sun.range,
            sun_color: settings.sun.color,
            light_count: u32::try_from(subject.model.lights.len()).unwrap_or(u32::MAX),
            sky_zenith: settings.sky.zenith,
            background,
            sky_ground: settings.sky.ground,
            ground_height: g.min.y,
            ground_albedo: ground_albedo(settings, horizon_color, TERM_AMBIENT | TERM_DIRECT),
            ground_radius: if sees_ground {
                GROUND_DIAGONALS * g.diagonal()
            } else {
                0.0
            },
            horizon_color,
            crown_radius,
            zenith_color,
            crown_opacity: CROWN_OPACITY,
            crown_centre: crown_centre.into(),
            depth_scale: depth_scale as f32,
            clay: [0.36, 0.37, 0.35],
            near: camera.near as f32,
            pixel: settings.size.map(|s| 2.0 / s as f32),
            shadow_reach: settings.shadow_radius + 1.0,
        };
        Self { camera, sun, frame }
    }

    /// Uniform data for one view: the same but for the terms of eq. 1 and the ground under them.
    #[must_use]
    pub fn frame_for(&self, view: View, settings: &RenderSettings) -> RenderFrame {
        let terms = match view {
            View::Ambient => TERM_AMBIENT,
            View::Direct => TERM_DIRECT,
            _ => TERM_AMBIENT | TERM_DIRECT,
        };
        RenderFrame {
            terms,
            ground_albedo: ground_albedo(settings, self.frame.horizon_color, terms),
            ..self.frame
        }
    }
}
