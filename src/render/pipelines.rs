//! Pipelines of the frame, made when first needed.

use std::collections::BTreeMap;

use super::plan::{Channel, label};
use super::settings::Encoding;
use super::upload::format;
use crate::Result;
use crate::abi;
use crate::gpu::{Format, Gpu, GraphicsPipeline, GraphicsPipelineInfo, Shader, shaders};
use crate::render::plan::PixelFormat;

/// Depth bias of casters, constant (steps of the map) and by slope: away from the sun, which is
/// down with reversed depth. The larger part of the bias is the receiver's, along its normal.
const SHADOW_BIAS: (f32, f32) = (-2.0, -1.0);

/// What distinguishes the pipelines that draw the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct SurfaceKey {
    /// `NORMALS_*`.
    pub(super) normals: u32,
    /// The draw has a texture.
    pub(super) texture: bool,
    /// Vertices have colours.
    pub(super) color: bool,
    /// Base colour shows.
    pub(super) textured: bool,
    /// S comes from the shadow map.
    pub(super) shadowed: bool,
    /// Alpha cuts.
    pub(super) cuts: bool,
    /// Into the G-buffer instead of colour.
    pub(super) gbuffer: bool,
}

/// Pipelines besides those of the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Fixed {
    Shadow {
        cuts: bool,
    },
    Shade {
        textured: bool,
        shadowed: bool,
    },
    /// Ground and sky alone.
    Backdrop {
        shadowed: bool,
    },
    Surface,
    Slice,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Key {
    Model(SurfaceKey),
    Fixed(Fixed),
}

/// Pipelines made so far.
#[derive(Debug)]
pub(super) struct Pipelines {
    gpu: Gpu,
    samples: u32,
    channels: Vec<Channel>,
    made: BTreeMap<Key, GraphicsPipeline>,
}

/// `NORMALS_*` of an encoding.
pub(super) fn normals_form(encoding: Encoding) -> u32 {
    match encoding {
        Encoding::Packed => abi::NORMALS_PACKED,
        Encoding::Length => abi::NORMALS_LENGTH,
        Encoding::Float => abi::NORMALS_FLOAT,
    }
}

impl Pipelines {
    pub(super) fn new(gpu: &Gpu, samples: u32, channels: &[Channel]) -> Self {
        Self {
            gpu: gpu.clone(),
            samples,
            channels: channels.to_vec(),
            made: BTreeMap::new(),
        }
    }

    /// The pipeline that draws the model.
    pub(super) fn model(&mut self, key: SurfaceKey) -> Result<GraphicsPipeline> {
        if let Some(p) = self.made.get(&Key::Model(key)) {
            return Ok(p.clone());
        }
        let coverage = key.cuts && !key.gbuffer && self.samples > 1;
        let mut specialization = vec![
            (0, key.normals),
            (1, u32::from(key.texture)),
            (2, u32::from(key.color)),
            (3, u32::from(key.textured)),
            (4, u32::from(key.shadowed)),
            (5, u32::from(coverage)),
        ];
        let record = [format(PixelFormat::Rgba8); 2];
        let channels: Vec<Format> = self.channels.iter().map(|c| format(c.format())).collect();
        if key.gbuffer {
            // Slots without a target name no channel.
            let ids = self
                .channels
                .iter()
                .map(|c| channel_id(*c))
                .chain([u32::MAX; 4]);
            specialization.extend((6..10).zip(ids));
        }
        let made = self.gpu.graphics_pipeline(&GraphicsPipelineInfo {
            name: if key.gbuffer {
                label::GBUFFER_PASS
            } else {
                label::SURFACE_PASS
            },
            vertex: shaders::render::SURFACE_VERT,
            fragment: Some(if key.gbuffer {
                gbuffer_shader(self.channels.len())
            } else {
                shaders::render::SURFACE_FRAG
            }),
            color_formats: if key.gbuffer { &channels } else { &record },
            depth_format: Some(format(PixelFormat::Depth32)),
            samples: if key.gbuffer { 1 } else { self.samples },
            specialization: &specialization,
            ..GraphicsPipelineInfo::default()
        })?;
        self.made.insert(Key::Model(key), made.clone());
        Ok(made)
    }

    /// One of the others.
    pub(super) fn fixed(&mut self, which: Fixed) -> Result<GraphicsPipeline> {
        if let Some(p) = self.made.get(&Key::Fixed(which)) {
            return Ok(p.clone());
        }
        let made = self.make_fixed(which)?;
        self.made.insert(Key::Fixed(which), made.clone());
        Ok(made)
    }

    fn make_fixed(&self, which: Fixed) -> Result<GraphicsPipeline> {
        use shaders::render as s;
        let over_picture = GraphicsPipelineInfo {
            color_formats: &[Format::Rgba8Srgb],
            depth_format: Some(format(PixelFormat::Depth32)),
            ..GraphicsPipelineInfo::default()
        };
        let specialization;
        let info = match which {
            Fixed::Shadow { cuts } => {
                specialization = [(1, u32::from(cuts)), (3, 1)];
                GraphicsPipelineInfo {
                    name: label::SHADOW_MAP,
                    vertex: s::SHADOW_VERT,
                    fragment: cuts.then_some(s::SHADOW_FRAG),
                    depth_format: Some(format(PixelFormat::Depth16)),
                    depth_bias: Some(SHADOW_BIAS),
                    specialization: &specialization,
                    ..GraphicsPipelineInfo::default()
                }
            }
            Fixed::Shade { textured, shadowed } => {
                specialization = [(3, u32::from(textured)), (4, u32::from(shadowed))];
                GraphicsPipelineInfo {
                    name: label::SHADE_PASS,
                    vertex: s::SHADE_VERT,
                    fragment: Some(if self.samples > 1 {
                        s::SHADE_4_FRAG
                    } else {
                        s::SHADE_1_FRAG
                    }),
                    color_formats: &[Format::Rgba8Srgb],
                    depth_test: false,
                    depth_write: false,
                    specialization: &specialization,
                    ..GraphicsPipelineInfo::default()
                }
            }
            Fixed::Backdrop { shadowed } => {
                specialization = [(3, 1), (4, u32::from(shadowed))];
                GraphicsPipelineInfo {
                    name: "backdrop",
                    vertex: s::SHADE_VERT,
                    fragment: Some(s::BACKDROP_FRAG),
                    color_formats: &[Format::Rgba8Srgb],
                    depth_test: false,
                    depth_write: false,
                    specialization: &specialization,
                    ..GraphicsPipelineInfo::default()
                }
            }
            Fixed::Surface => GraphicsPipelineInfo {
                name: "implicit surface",
                vertex: s::OVERLAY_VERT,
                fragment: Some(s::OVERLAY_FRAG),
                blend: true,
                ..over_picture
            },
            Fixed::Slice => GraphicsPipelineInfo {
                name: "field slice",
                vertex: s::SLICE_VERT,
                fragment: Some(s::SLICE_FRAG),
                depth_test: false,
                depth_write: false,
                blend: true,
                ..over_picture
            },
        };
        self.gpu.graphics_pipeline(&info)
    }
}

fn channel_id(channel: Channel) -> u32 {
    match channel {
        Channel::Normal => abi::CHANNEL_NORMAL,
        Channel::Depth => abi::CHANNEL_DEPTH,
        Channel::Albedo => abi::CHANNEL_ALBEDO,
        Channel::Shade => abi::CHANNEL_SHADE,
    }
}

fn gbuffer_shader(targets: usize) -> Shader {
    use shaders::render as s;
    match targets {
        1 => s::GBUFFER_1_FRAG,
        2 => s::GBUFFER_2_FRAG,
        3 => s::GBUFFER_3_FRAG,
        _ => s::GBUFFER_4_FRAG,
    }
}
