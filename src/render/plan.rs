//! What a picture needs, computed before anything touches a device.
//!
//! The renderer allocates exactly the buffers and images of the plan and runs exactly its passes;
//! what is not in the plan does not exist.

use std::fmt;

pub use super::planned::{
    Attribute, Channel, PixelFormat, PlannedBuffer, PlannedImage, PlannedPass,
};
use super::settings::{Encoding, RenderSettings};
use super::subject::Subject;
use super::texture::{self, TextureKey};
use super::view::View;
use crate::Result;
use crate::scene::{AlphaMode, textures};

/// The whole plan. See the module's description.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Plan {
    /// Views, in the order asked for.
    pub views: Vec<View>,
    /// Channels of the G-buffer.
    pub channels: Vec<Channel>,
    /// Vertex attributes.
    pub attributes: Vec<Attribute>,
    /// Images.
    pub images: Vec<PlannedImage>,
    /// Buffers.
    pub buffers: Vec<PlannedBuffer>,
    /// Passes in the order they run.
    pub passes: Vec<PlannedPass>,
}

/// Labels of images and passes, said once.
pub mod label {
    /// Base colour and ambient coefficient of every sample.
    pub const RECORD_A: &str = "surface record a";
    /// Normal and material of every sample.
    pub const RECORD_B: &str = "surface record b";
    /// Depth of every sample.
    pub const DEPTH: &str = "depth";
    /// The finished picture.
    pub const PICTURE: &str = "picture";
    /// Depth of the implicit surface over the picture.
    pub const OVERLAY_DEPTH: &str = "overlay depth";
    /// Depth of the G-buffer pass.
    pub const GBUFFER_DEPTH: &str = "g-buffer depth";
    /// Depth as the sun sees it.
    pub const SHADOW_MAP: &str = "shadow map";
    /// One white texel for draws without a texture.
    pub const NO_TEXTURE: &str = "no texture";
    /// A slice of the field, coloured.
    pub const SLICE: &str = "field slice";
    /// Stage 1: the pass that finds the nearest surface of every sample.
    pub const SURFACE_PASS: &str = "surface";
    /// Stage 2: the pass that shades it.
    pub const SHADE_PASS: &str = "shade";
    /// The pass that draws implicit surface or slice over the picture.
    pub const OVERLAY_PASS: &str = "overlay";
    /// Table of materials.
    pub const MATERIALS: &str = "materials";
    /// The pass that fills the G-buffer.
    pub const GBUFFER_PASS: &str = "g-buffer";
    /// Uniform buffer of a view.
    pub const FRAME: &str = "frame";
    /// Buffer of positions.
    pub const POSITIONS: &str = "positions";
    /// Buffer of encoded realigned normals and ambient.
    pub const SHADING: &str = "shading normals";
    /// Buffer of the model's own normals.
    pub const MODEL_NORMALS: &str = "model normals";
    /// Buffer of texture coordinates.
    pub const TEXCOORDS: &str = "texture coordinates";
    /// Buffer of vertex colours.
    pub const COLORS: &str = "vertex colours";
    /// Indices sorted from the camera.
    pub const INDICES: &str = "indices, camera order";
    /// Indices sorted from the sun.
    pub const SHADOW_INDICES: &str = "indices, sun order";
    /// Punctual lights.
    pub const LIGHTS: &str = "lights";
    /// Vertices of the implicit surface.
    pub const SURFACE_POSITIONS: &str = "surface positions";
    /// Normals of the implicit surface.
    pub const SURFACE_NORMALS: &str = "surface normals";
    /// Indices of the implicit surface.
    pub const SURFACE_INDICES: &str = "surface indices";
}

impl Plan {
    /// The plan for `views` of `subject`.
    ///
    /// # Errors
    /// A setting out of range, a texture whose header cannot be read, a view whose input (bake,
    /// field, surface) is missing.
    pub fn new(subject: &Subject<'_>, settings: &RenderSettings, views: &[View]) -> Result<Self> {
        Self::with_channels(subject, settings, views, &[])
    }

    /// As [`Plan::new`], with G-buffer channels wanted for their own sake.
    ///
    /// # Errors
    /// As [`Plan::new`].
    pub fn with_channels(
        subject: &Subject<'_>,
        settings: &RenderSettings,
        views: &[View],
        channels: &[Channel],
    ) -> Result<Self> {
        settings.check()?;
        let wants = Wants::new(subject, settings, views, channels);
        let mut plan = Self {
            buffers: vec![PlannedBuffer {
                label: label::FRAME,
                bytes: size_of::<crate::abi::RenderFrame>() as u64,
            }],
            views: views.to_vec(),
            channels: wants.channels.clone(),
            ..Self::default()
        };
        plan.add_attributes(subject, settings, &wants);
        plan.add_shadow(settings, &wants, subject);
        plan.add_color(subject, settings, &wants);
        plan.add_gbuffer(settings, &wants);
        plan.add_textures(subject, settings, &wants)?;
        plan.add_overlays(subject, settings, &wants);
        plan.add_fallbacks(&wants);
        Ok(plan)
    }

    /// Bytes of everything on the device.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let images: u64 = self.images.iter().map(PlannedImage::bytes).sum();
        images + self.buffers.iter().map(|b| b.bytes).sum::<u64>()
    }

    /// Whether an image of this label is part of the plan.
    #[must_use]
    pub fn image(&self, label: &str) -> Option<&PlannedImage> {
        self.images.iter().find(|i| i.label == label)
    }

    /// The pass with this label.
    #[must_use]
    pub fn pass(&self, label: &str) -> Option<&PlannedPass> {
        self.passes.iter().find(|p| p.label == label)
    }

    /// Whether vertices carry this attribute.
    #[must_use]
    pub fn has(&self, attribute: Attribute) -> bool {
        self.attributes.contains(&attribute)
    }

    fn buffer(&mut self, label: &'static str, count: usize, bytes_each: usize) {
        self.buffers.push(PlannedBuffer {
            label,
            bytes: (count * bytes_each) as u64,
        });
    }

    fn add_attributes(&mut self, subject: &Subject<'_>, settings: &RenderSettings, w: &Wants) {
        let vertices = subject.geometry.positions.len();
        if vertices == 0 || !(w.color || w.gbuffer()) {
            return;
        }
        let shading_bytes = match settings.encoding {
            Encoding::Packed => 8,
            Encoding::Length => 12,
            Encoding::Float => 16,
        };
        let wanted = [
            (true, Attribute::Position, label::POSITIONS, 12),
            (w.shading, Attribute::Shading, label::SHADING, shading_bytes),
            (
                w.model_normal,
                Attribute::ModelNormal,
                label::MODEL_NORMALS,
                4,
            ),
            (w.texcoord, Attribute::Texcoord, label::TEXCOORDS, 8),
            (w.vertex_color, Attribute::Color, label::COLORS, 8),
        ];
        for (_, attribute, label, bytes) in wanted.into_iter().filter(|w| w.0) {
            self.attributes.push(attribute);
            self.buffer(label, vertices, bytes);
        }
        self.buffer(label::INDICES, subject.geometry.indices.len(), 4);
        if !subject.model.lights.is_empty() {
            self.buffer(
                label::LIGHTS,
                subject.model.lights.len(),
                size_of::<crate::abi::RenderLight>(),
            );
        }
    }

    fn add_shadow(&mut self, settings: &RenderSettings, w: &Wants, subject: &Subject<'_>) {
        if !w.shadow {
            return;
        }
        self.buffer(label::SHADOW_INDICES, subject.geometry.indices.len(), 4);
        self.images.push(PlannedImage::target(
            label::SHADOW_MAP,
            PixelFormat::Depth16,
            [settings.shadow_size; 2],
            1,
        ));
        self.passes.push(PlannedPass {
            label: label::SHADOW_MAP,
            views: w.views(View::is_shadowed),
            writes: vec![label::SHADOW_MAP],
        });
    }

    fn add_color(&mut self, subject: &Subject<'_>, settings: &RenderSettings, w: &Wants) {
        if !w.color {
            return;
        }
        let (size, samples) = (settings.size, settings.samples);
        let materials = super::batch::groups(subject).len().max(1);
        self.buffer(
            label::MATERIALS,
            materials,
            size_of::<crate::abi::RenderMaterial>(),
        );
        for (label, format, samples) in [
            (label::RECORD_A, PixelFormat::Rgba8, samples),
            (label::RECORD_B, PixelFormat::Rgba8, samples),
            (label::DEPTH, PixelFormat::Depth32, samples),
            (label::PICTURE, PixelFormat::Rgba8Srgb, 1),
        ] {
            self.images
                .push(PlannedImage::target(label, format, size, samples));
        }
        self.passes.push(PlannedPass {
            label: label::SURFACE_PASS,
            views: w.views(View::is_lit),
            writes: vec![label::RECORD_A, label::RECORD_B, label::DEPTH],
        });
        self.passes.push(PlannedPass {
            label: label::SHADE_PASS,
            views: w.views(View::is_lit),
            writes: vec![label::PICTURE],
        });
    }

    fn add_gbuffer(&mut self, settings: &RenderSettings, w: &Wants) {
        if !w.gbuffer() {
            return;
        }
        let mut writes = vec![label::GBUFFER_DEPTH];
        self.images.push(PlannedImage::target(
            label::GBUFFER_DEPTH,
            PixelFormat::Depth32,
            settings.size,
            1,
        ));
        for channel in &w.channels {
            writes.push(channel.label());
            self.images.push(PlannedImage::target(
                channel.label(),
                channel.format(),
                settings.size,
                1,
            ));
        }
        self.passes.push(PlannedPass {
            label: label::GBUFFER_PASS,
            views: w.views(|v| !v.is_lit()),
            writes,
        });
    }

    fn add_textures(
        &mut self,
        subject: &Subject<'_>,
        settings: &RenderSettings,
        w: &Wants,
    ) -> Result<()> {
        if !w.texcoord {
            return Ok(());
        }
        let mut keys: Vec<TextureKey> = Vec::new();
        let mut add = |key| {
            if !keys.contains(&key) {
                keys.push(key);
            }
        };
        for (material, key) in texture::used(subject) {
            // Untextured views still cut leaves out, so alpha is needed wherever it is a mask.
            let cuts = !matches!(material.alpha_mode, AlphaMode::Opaque);
            if w.albedo || (cuts && (w.color || w.gbuffer())) {
                add(TextureKey {
                    alpha_only: false,
                    ..key
                });
            }
            if w.shadow && cuts {
                add(TextureKey {
                    alpha_only: true,
                    ..key
                });
            }
        }
        for key in keys {
            let extent = textures::dimensions_of(subject.model, key.image)?;
            let (extent, levels) =
                texture::levels_within(extent, texture::edge_limit(key, settings.texture_size));
            self.images.push(PlannedImage {
                label: key.label(subject.model),
                format: if key.alpha_only {
                    PixelFormat::R8
                } else {
                    PixelFormat::Rgba8Srgb
                },
                extent,
                levels,
                samples: 1,
                texture: Some(key),
            });
        }
        Ok(())
    }

    /// Shaders name a texture and a shadow map even where a specialisation constant keeps them
    /// from reading it: one white texel stands in.
    fn add_fallbacks(&mut self, w: &Wants) {
        if w.color || w.gbuffer() {
            self.images.push(PlannedImage::target(
                label::NO_TEXTURE,
                PixelFormat::Rgba8Srgb,
                [1, 1],
                1,
            ));
        }
    }

    fn add_overlays(&mut self, subject: &Subject<'_>, settings: &RenderSettings, w: &Wants) {
        if let Some(s) = subject.surface.filter(|_| w.any(View::needs_surface)) {
            self.buffer(label::SURFACE_POSITIONS, s.positions.len(), 12);
            self.buffer(label::SURFACE_NORMALS, s.normals.len(), 4);
            self.buffer(label::SURFACE_INDICES, s.indices.len(), 4);
        }
        if subject.field.is_some() && w.any(View::needs_field) {
            self.images.push(PlannedImage::target(
                label::SLICE,
                PixelFormat::Rgba8Srgb,
                super::slice::EXTENT,
                1,
            ));
        }
        let overlaid = w.views(|v| v.needs_surface() || v.needs_field());
        if !overlaid.is_empty() {
            self.images.push(PlannedImage::target(
                label::OVERLAY_DEPTH,
                PixelFormat::Depth32,
                settings.size,
                1,
            ));
            self.passes.push(PlannedPass {
                label: label::OVERLAY_PASS,
                views: overlaid,
                writes: vec![label::PICTURE, label::OVERLAY_DEPTH],
            });
        }
    }
}

/// What the views ask for, before it is put in bytes.
struct Wants {
    views: Vec<View>,
    channels: Vec<Channel>,
    color: bool,
    shadow: bool,
    shading: bool,
    model_normal: bool,
    texcoord: bool,
    albedo: bool,
    vertex_color: bool,
}

impl Wants {
    fn new(
        subject: &Subject<'_>,
        settings: &RenderSettings,
        views: &[View],
        channels: &[Channel],
    ) -> Self {
        let any = |f: fn(View) -> bool| views.iter().any(|&v| f(v));
        let mut channels = channels.to_vec();
        if views.contains(&View::Normals) {
            channels.push(Channel::Normal);
        }
        if views.contains(&View::Depth) {
            channels.push(Channel::Depth);
        }
        channels.sort_unstable();
        channels.dedup();
        let shade = channels.contains(&Channel::Shade);
        let sun_up = settings.sun.color != [0.0; 3];
        let empty = subject.geometry.indices.is_empty();
        let albedo = any(View::is_textured) || channels.contains(&Channel::Albedo) || shade;
        let baked = subject.baked.is_some();
        let normals = any(View::needs_bake) || channels.contains(&Channel::Normal) || shade;
        Self {
            color: any(View::is_lit),
            shadow: settings.shadows && sun_up && !empty && (any(View::is_shadowed) || shade),
            shading: normals && baked,
            model_normal: views.contains(&View::Standard) || (normals && !baked),
            texcoord: settings.textures && texture::used(subject).next().is_some(),
            albedo,
            vertex_color: albedo && subject.geometry.colors.iter().any(|c| c[..3] != [1.0; 3]),
            views: views.to_vec(),
            channels,
        }
    }

    fn gbuffer(&self) -> bool {
        !self.channels.is_empty()
    }

    fn any(&self, f: fn(View) -> bool) -> bool {
        self.views.iter().any(|&v| f(v))
    }

    fn views(&self, f: fn(View) -> bool) -> Vec<View> {
        self.views.iter().copied().filter(|&v| f(v)).collect()
    }
}

/// Bytes for people: three significant digits and a unit of 1024.
#[must_use]
pub fn human_bytes(bytes: u64) -> String {
    let mut value = bytes as f64;
    for unit in ["B", "KiB", "MiB"] {
        if value < 1024.0 {
            let digits = if unit == "B" || value >= 100.0 { 0 } else { 1 };
            return format!("{value:.digits$} {unit}");
        }
        value /= 1024.0;
    }
    format!("{value:.2} GiB")
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{:<34} {:<12} {:<16} {:>10}", "pass", "", "for", "")?;
        for p in &self.passes {
            let views: Vec<_> = p.views.iter().map(|v| v.name()).collect();
            writeln!(f, "  {:<32} -> {}", p.label, p.writes.join(", "))?;
            if !views.is_empty() {
                writeln!(f, "  {:<32}    for {}", "", views.join(", "))?;
            }
        }
        writeln!(
            f,
            "{:<34} {:<12} {:<16} {:>10}",
            "image", "format", "extent", "bytes"
        )?;
        for i in &self.images {
            let [w, h] = i.extent;
            let mut extent = format!("{w}x{h}");
            if i.samples > 1 {
                extent += &format!(" x{}", i.samples);
            }
            if i.levels > 1 {
                extent += &format!(" {} levels", i.levels);
            }
            let (name, bytes) = (i.format.name(), human_bytes(i.bytes()));
            writeln!(f, "  {:<32} {name:<12} {extent:<16} {bytes:>10}", i.label)?;
        }
        writeln!(f, "{:<34} {:<12} {:<16} {:>10}", "buffer", "", "", "bytes")?;
        for b in &self.buffers {
            writeln!(
                f,
                "  {:<32} {:<29} {:>10}",
                b.label,
                "",
                human_bytes(b.bytes)
            )?;
        }
        write!(f, "{:<64} {:>10}", "total", human_bytes(self.bytes()))
    }
}
