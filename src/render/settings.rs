//! Everything about a picture that can be chosen; `setting_table.rs` describes it.

use crate::scene::{CameraSpec, Pose, Sky, Sun};

/// What stands behind the subject.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Background {
    /// A soft neutral gradient, as in a studio.
    Neutral,
    /// A clear sky that brightens towards the horizon.
    Sky,
    /// One linear colour.
    Color([f32; 3]),
}

/// What the shadow map spans.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ShadowFit {
    /// The casters as the sun sees them: the finest shadows.
    #[default]
    Tight,
    /// The sphere around the casters' bounding box: texels keep their size when the sun moves, so
    /// that shadows do not shimmer.
    Sphere,
}

/// How normal and ambient coefficient travel to the vertex shader.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Encoding {
    /// 8 bytes: octahedral 2 x 16 bit and a 16-bit coefficient. Error below 0.004 degrees and
    /// 1/131070.
    #[default]
    Packed,
    /// 12 bytes: the coefficient is the vector's length (Luft, Balzer, Deussen 2007, section
    /// 3.2). Coefficients below [`crate::abi::LENGTH_MIN_AMBIENT`] are raised to it, since a
    /// vector of length 0 has no direction.
    Length,
    /// 16 bytes: unit vector and coefficient, exact.
    Float,
}

/// Settings of one picture. Angles in degrees, lengths in metres, colours linear unless said.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RenderSettings {
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Coverage samples per pixel: 1 or 4. Ignored by views of attributes.
    pub samples: u32,
    /// The sun casts shadows.
    pub shadows: bool,
    /// Texels along an edge of the shadow map.
    pub shadow_size: u32,
    /// What the shadow map spans.
    pub shadow_fit: ShadowFit,
    /// Radius of the shadow filter, texels of the map.
    pub shadow_radius: f32,
    /// Textures are decoded and used; without them alpha cuts nothing out either.
    pub textures: bool,
    /// Longest edge of a texture level that is used, texels; larger ones are averaged down.
    pub texture_size: u32,
    /// Largest ratio of anisotropic filtering; 1 = off.
    pub anisotropy: f32,
    /// Longest edge of the coarsest texture level whose leaf shapes stay whole when leaf cards are
    /// cut to the outline of what they show, texels; 0 = cards stay as they are.
    pub leaf_outline: u32,
    /// Where from.
    pub camera: CameraSpec,
    /// Stands for `camera`, `fov` and `margin`: a place on a way.
    pub pose: Option<Pose>,
    /// Vertical field of view.
    pub fov: f64,
    /// Free share of the picture on every side.
    pub margin: f64,
    /// The sun.
    pub sun: Sun,
    /// Ambient intensity `I_a`.
    pub sky: Sky,
    /// Factor on everything before it is encoded.
    pub exposure: f32,
    /// Specular reflection coefficient `k_s` of a smooth surface (scaled by 1 - roughness^2).
    pub specular: f32,
    /// Exponent `n` of the specular term.
    pub shininess: f32,
    /// Share of the sun's diffuse light that goes through a leaf to the side away from it
    /// (added to eq. 1; 0 = the paper's model). Materials with
    /// `KHR_materials_diffuse_transmission` bring their own.
    pub translucency: f32,
    /// Realigned normals turn round on back faces, as glTF has it for double-sided materials.
    pub flip_back_faces: bool,
    /// A ground plane under the subject.
    pub ground: bool,
    /// What stands behind.
    pub background: Background,
    /// Vertex form of normals and ambient coefficients.
    pub encoding: Encoding,
}

impl Default for RenderSettings {
    fn default() -> Self {
        Self {
            size: [800, 600],
            samples: 4,
            shadows: true,
            shadow_size: 2048,
            shadow_fit: ShadowFit::Tight,
            shadow_radius: 2.5,
            textures: true,
            texture_size: 2048,
            anisotropy: 1.0,
            leaf_outline: 16,
            camera: CameraSpec::default(),
            pose: None,
            fov: 30.0,
            margin: 0.04,
            sun: Sun::default(),
            sky: Sky::default(),
            exposure: 1.0,
            specular: 0.08,
            shininess: 12.0,
            translucency: 0.0,
            flip_back_faces: false,
            ground: true,
            background: Background::Neutral,
            encoding: Encoding::Packed,
        }
    }
}
