//! Camera, sun and sky of a lit picture, and what of them kernels need.

use glam::{DVec3, Vec3};

use super::environment::{Environment, Sun};
use super::glossy::Shadowing;
use super::lamp::Lamp;
use super::optics::Optics;
use super::rays::Occluders;
use super::receivers::Receivers;
use super::shape::Shape;
use crate::Result;
use crate::abi::LeafTurn;
use crate::gpu::{Buffer, Format, Gpu, Image, ImageInfo, QueueKind};
use crate::scene::{Camera, Geometry, Model};

/// Texels of the sky's image, across and down.
const SKY_TEXELS: [u32; 2] = [512, 256];

/// What is drawn.
#[derive(Debug, Clone, Copy)]
pub struct LitScene<'a> {
    /// Materials and textures.
    pub model: &'a Model,
    /// Triangles.
    pub geometry: &'a Geometry,
    /// The same for rays.
    pub occluders: &'a Occluders,
    /// Faces and materials.
    pub receivers: &'a Receivers,
    /// What each material makes of light.
    pub optics: &'a [Optics],
}

/// How it is drawn.
#[derive(Debug, Clone)]
pub struct Film {
    /// Where from.
    pub camera: Camera,
    /// Pixels across and down.
    pub size: [u32; 2],
    /// The sun.
    pub sun: Sun,
    /// What the sun's light is spread over, in the square about its disc.
    pub sun_shape: Shape,
    /// Everything else that is far.
    pub sky: Environment,
    /// Lamps near the scene.
    pub lamps: Vec<Lamp>,
}

/// Half the picture's width and height at distance 1, along the camera's axes.
pub(super) fn film_axes(camera: &Camera) -> [Vec3; 2] {
    let [right, up, _] = camera.basis();
    let [x, y] = camera.half_extent();
    [(right * x).as_vec3(), (up * y).as_vec3()]
}

/// Specular intensity and roughness of every material, below 0 where the lobe keeps the energy.
pub(super) fn gloss(gpu: &Gpu, optics: &[Optics]) -> Result<Buffer> {
    let rows: Vec<[f32; 4]> = optics
        .iter()
        .map(|o| {
            let [r, g, b] = o.rho_s.map(|v| v.max(0.0));
            let m = o.roughness.clamp(1e-3, 1.0);
            let signed = match o.shadowing {
                Shadowing::Paper => m,
                Shadowing::Safe => -m,
            };
            [r, g, b, signed]
        })
        .collect();
    gpu.upload("gloss", &rows)
}

/// Factors of oblique light, and the constant that says whether there are any.
pub(super) fn turns(gpu: &Gpu, receivers: &Receivers) -> Result<(Buffer, [(u32, u32); 1])> {
    let directional = !receivers.turns.is_empty();
    let buffer = if directional {
        gpu.upload("oblique light", &receivers.turns)?
    } else {
        gpu.upload("oblique light", &[LeafTurn::default()])?
    };
    Ok((buffer, [(7, u32::from(directional))]))
}

/// The sky as an image: rows from +y to -y, columns from +x to +z.
pub(super) fn sky_image(gpu: &Gpu, sky: &Environment) -> Result<Image> {
    use std::f64::consts::PI;
    let [width, height] = SKY_TEXELS;
    let mut texels = Vec::with_capacity((width * height) as usize);
    for row in 0..height {
        for column in 0..width {
            let theta = PI * (f64::from(row) + 0.5) / f64::from(height);
            let phi = 2.0 * PI * (f64::from(column) + 0.5) / f64::from(width);
            let d = DVec3::new(
                theta.sin() * phi.cos(),
                theta.cos(),
                theta.sin() * phi.sin(),
            );
            texels.push(sky.radiance(d).as_vec3().extend(1.0).to_array());
        }
    }
    let image = gpu.image(ImageInfo::texture(
        "sky",
        Format::Rgba32Float,
        SKY_TEXELS,
        1,
    ))?;
    let mut work = gpu.work(QueueKind::Transfer, "sky")?;
    work.upload_image("sky", &image, &[bytemuck::cast_slice(&texels)])?;
    work.submit()?.wait()?;
    Ok(image)
}
