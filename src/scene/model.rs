//! A plant or any other model as plain data: meshes, materials, textures, instances.
//!
//! The model keeps what the file said in the file's own (local) coordinates; [`super::geometry`]
//! flattens it to triangles in one frame for the foliage, leaf, ink and render rooms.

use std::path::PathBuf;
use std::sync::Arc;

use glam::{DAffine3, DVec3};

/// A model read from a file or grown by the plant generator.
#[derive(Debug, Clone, Default)]
pub struct Model {
    /// File stem or species name, for messages and labels.
    pub name: String,
    /// The file it came from, if any.
    pub path: Option<PathBuf>,
    /// Meshes in their own coordinates.
    pub meshes: Vec<Mesh>,
    /// Every placement of a mesh (scene graph and GPU instancing already multiplied out).
    pub instances: Vec<Instance>,
    /// Materials; index `usize` from primitives. Never empty when there is a primitive: the
    /// importers append glTF's default material where a primitive names none.
    pub materials: Vec<Material>,
    /// Texture = image + sampler.
    pub textures: Vec<Texture>,
    /// Images, still encoded; decoded only when a plan asks for them.
    pub images: Vec<ImageSource>,
    /// Lights of the file (`KHR_lights_punctual`), in world coordinates.
    pub lights: Vec<PunctualLight>,
    /// What was repaired or ignored while reading, one sentence each, with counts.
    pub warnings: Vec<String>,
    /// The glTF document the model was read from, so that export keeps what it does not change.
    pub source: Option<Arc<super::gltf_document::GltfDocument>>,
}

impl Model {
    /// A model of one mesh, at its own place.
    #[must_use]
    pub fn of_mesh(name: &str, primitives: Vec<Primitive>, materials: Vec<Material>) -> Self {
        Self {
            name: name.to_owned(),
            meshes: vec![Mesh {
                name: name.to_owned(),
                primitives,
            }],
            instances: vec![Instance {
                name: name.to_owned(),
                mesh: 0,
                local_to_world: DAffine3::IDENTITY,
                source: None,
            }],
            materials,
            ..Self::default()
        }
    }
}

/// Primitives that share a node.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    /// Name in the file, or an invented one (`mesh 3`).
    pub name: String,
    /// One per material.
    pub primitives: Vec<Primitive>,
}

/// Indexed triangles with one material. All per-vertex arrays have the length of `positions`
/// or are empty (absent).
#[derive(Debug, Clone, Default)]
pub struct Primitive {
    /// Index into [`Model::materials`].
    pub material: usize,
    /// Local position, metres. Finite (the importers refuse NaN and infinity).
    pub positions: Vec<[f32; 3]>,
    /// Unit normals; empty when the file has none (the importers do not invent them here;
    /// [`super::geometry`] does).
    pub normals: Vec<[f32; 3]>,
    /// `TEXCOORD_0`.
    pub texcoords: Vec<[f32; 2]>,
    /// `TEXCOORD_1`, used by occlusion textures.
    pub texcoords1: Vec<[f32; 2]>,
    /// `COLOR_0`, linear RGBA.
    pub colors: Vec<[f32; 4]>,
    /// Ambient coefficient `k_a` in \[0,1\] from an `_AMBIENT` attribute; empty when not baked.
    pub ambient: Vec<f32>,
    /// Triangle list; every index is below `positions.len()` (the importers check).
    pub indices: Vec<u32>,
    /// What only the plant generator knows; `None` for files.
    pub botany: Option<Arc<Botany>>,
    /// Where this primitive stands in the source document: (mesh index, primitive index).
    pub source: Option<(usize, usize)>,
}

/// Exact botanical truth about a generated primitive.
#[derive(Debug, Clone, Default)]
pub struct Botany {
    /// Branching order per vertex (0 = trunk). Empty for leaf primitives.
    pub branch_order: Vec<u8>,
    /// Leaves, in the order of their triangles. Empty for wood primitives.
    pub leaves: Vec<Leaf>,
}

/// One leaf of a generated plant.
#[derive(Debug, Clone, Copy)]
pub struct Leaf {
    /// First index into [`Primitive::indices`].
    pub first_index: u32,
    /// Number of indices.
    pub index_count: u32,
    /// Where the petiole joins the twig, local metres.
    pub base: [f32; 3],
    /// Unit direction from base to tip.
    pub tangent: [f32; 3],
    /// Unit normal of the upper side.
    pub normal: [f32; 3],
    /// Length from base to tip, metres.
    pub length: f32,
    /// Branching order of the twig that bears it.
    pub order: u8,
}

/// One placement of a mesh.
#[derive(Debug, Clone)]
pub struct Instance {
    /// Name of the node, or an invented one.
    pub name: String,
    /// Index into [`Model::meshes`].
    pub mesh: usize,
    /// Local to world, f64 so that forests at 5 000 000 m keep their millimetres.
    pub local_to_world: DAffine3,
    /// Node index in the source document and, for `EXT_mesh_gpu_instancing`, which instance.
    pub source: Option<(usize, Option<usize>)>,
}

/// How alpha is used (glTF `alphaMode`).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum AlphaMode {
    /// Alpha is ignored.
    #[default]
    Opaque,
    /// Visible where alpha is at least the cutoff.
    Mask {
        /// Threshold in \[0,1\].
        cutoff: f32,
    },
    /// Blended over what is behind.
    Blend,
}

/// Surface appearance: the part of glTF's material that umbrage uses.
#[derive(Debug, Clone)]
pub struct Material {
    /// Name in the file, or an invented one (`material 0`).
    pub name: String,
    /// Linear RGBA factor.
    pub base_color: [f32; 4],
    /// sRGB base colour (alpha in A).
    pub base_color_texture: Option<TextureRef>,
    /// Perceptual roughness in \[0,1\].
    pub roughness: f32,
    /// Metalness in \[0,1\].
    pub metallic: f32,
    /// Alpha mode.
    pub alpha_mode: AlphaMode,
    /// Both sides are drawn.
    pub double_sided: bool,
    /// `KHR_materials_unlit`.
    pub unlit: bool,
    /// Emitted linear RGB.
    pub emissive: [f32; 3],
    /// `KHR_materials_diffuse_transmission`, if present.
    pub diffuse_transmission: Option<DiffuseTransmission>,
    /// An occlusion texture and its strength (used when a baked file is read back).
    pub occlusion_texture: Option<(TextureRef, f32)>,
    /// The normals of back faces are used as they are instead of being turned to the viewer.
    /// Set by umbrage's own exports (realigned normals describe the crown, not the leaf).
    pub unflipped_back_faces: bool,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: "default".into(),
            base_color: [1.0; 4],
            base_color_texture: None,
            roughness: 1.0,
            metallic: 0.0,
            alpha_mode: AlphaMode::Opaque,
            double_sided: false,
            unlit: false,
            emissive: [0.0; 3],
            diffuse_transmission: None,
            occlusion_texture: None,
            unflipped_back_faces: false,
        }
    }
}

/// `KHR_materials_diffuse_transmission`: the share of the diffuse lobe that goes through.
#[derive(Debug, Clone)]
pub struct DiffuseTransmission {
    /// Share in \[0,1\].
    pub factor: f32,
    /// Share in A of a linear texture.
    pub texture: Option<TextureRef>,
    /// Linear RGB tint of the transmitted light.
    pub color: [f32; 3],
    /// sRGB tint texture.
    pub color_texture: Option<TextureRef>,
}

/// A texture as a material uses it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextureRef {
    /// Index into [`Model::textures`].
    pub texture: usize,
    /// 0 or 1.
    pub texcoord: u32,
    /// `KHR_texture_transform` as a 2x3 matrix, row-major: `uv' = M (u, v, 1)`.
    pub transform: [[f32; 3]; 2],
}

impl TextureRef {
    /// Texture on `TEXCOORD_0`, untransformed.
    #[must_use]
    pub fn new(texture: usize) -> Self {
        Self {
            texture,
            texcoord: 0,
            transform: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        }
    }
}

/// Image + sampler.
#[derive(Debug, Clone, Copy, Default)]
pub struct Texture {
    /// Index into [`Model::images`].
    pub image: usize,
    /// Wrap mode along u.
    pub wrap_u: Wrap,
    /// Wrap mode along v.
    pub wrap_v: Wrap,
    /// Nearest instead of linear magnification.
    pub nearest: bool,
}

/// Texture addressing outside \[0,1\].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Wrap {
    /// Repeats (glTF's default).
    #[default]
    Repeat,
    /// Clamps to the edge texel.
    Clamp,
    /// Mirrors every other period.
    Mirror,
}

/// An image before decoding.
#[derive(Clone)]
pub enum ImageSource {
    /// PNG or JPEG bytes, with a name for messages.
    Encoded {
        /// File or image name for messages.
        name: String,
        /// The encoded bytes.
        bytes: Arc<[u8]>,
    },
    /// Decoded RGBA8 made by the program (plant generator).
    Rgba8 {
        /// Name for messages and export.
        name: String,
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
        /// `width * height * 4` bytes, sRGB colour and linear alpha.
        pixels: Arc<[u8]>,
    },
}

impl std::fmt::Debug for ImageSource {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Encoded { name, bytes } => write!(f, "Encoded({name}, {} bytes)", bytes.len()),
            Self::Rgba8 {
                name,
                width,
                height,
                ..
            } => write!(f, "Rgba8({name}, {width}x{height})"),
        }
    }
}

/// A light of `KHR_lights_punctual`, in world coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PunctualLight {
    /// What kind, with its own parameters.
    pub kind: LightKind,
    /// Linear RGB times intensity (lux for directional, candela for the others).
    pub color: [f32; 3],
    /// Position in world metres (unused by directional lights).
    pub position: DVec3,
    /// Unit direction of travel of the light.
    pub direction: DVec3,
    /// Range in metres beyond which the light is nil; infinite when absent.
    pub range: f32,
}

/// Kind of a punctual light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightKind {
    /// Parallel light.
    Directional,
    /// Equal in all directions.
    Point,
    /// A cone.
    Spot {
        /// Full intensity inside this half-angle, radians.
        inner: f32,
        /// Nil outside this half-angle, radians.
        outer: f32,
    },
}
