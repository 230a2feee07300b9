//! The frame: every pass of a picture in order.
//!
//! 1. `shadow map`: depth as the sun sees it, leaves cut out.
//! 2. `surface` (stage 1): the nearest surface of every sample, nearest leaves first.
//! 3. `shade` (stage 2): eq. 1 once per surface that a pixel shows; ground and background.
//! 4. `overlay`: implicit surface or slice of the field over the picture.
//!
//! `g-buffer` takes the place of 2 and 3 for pictures of attributes and for filters: one target
//! per channel in full precision, one sample per pixel.

use super::batch::Batch;
use super::pipelines::{Fixed, Pipelines, SurfaceKey, normals_form};
use super::plan::{Attribute, Channel, Plan, label};
use super::settings::RenderSettings;
use super::slice::SlicePlane;
use super::upload::Resources;
use super::view::View;
use crate::Result;
use crate::abi::{self, RenderOverlay};
use crate::gpu::{Binding, ColorTarget, DepthTarget, Draws, RenderPass, Sampler, Work};

/// What a frame is drawn with.
pub(super) struct Frame<'a> {
    pub(super) plan: &'a Plan,
    pub(super) settings: &'a RenderSettings,
    pub(super) resources: &'a Resources,
    pub(super) batches: &'a [Batch],
    /// Samplers of the batches in their order: base colour, alpha in the shadow map.
    pub(super) samplers: &'a [[Sampler; 2]],
    /// Nothing in the way outside; for the shadow map.
    pub(super) border: &'a Sampler,
    /// Clamps; for images that stand in and for the slice.
    pub(super) clamp: &'a Sampler,
    pub(super) slice: Option<SlicePlane>,
}

/// How the model is drawn.
#[derive(Clone, Copy)]
struct Draw {
    view: View,
    shadowed: bool,
    gbuffer: bool,
}

/// Opacity of the implicit surface over the tree.
const SURFACE_OPACITY: f32 = 0.62;
/// Linear base colour of the implicit surface.
const SURFACE_COLOR: [f32; 3] = [0.62, 0.40, 0.16];
/// Opacity of the slice over the tree.
const SLICE_OPACITY: f32 = 0.9;

impl Frame<'_> {
    /// Pass 1: the sun's depth.
    pub(super) fn shadow_map(&self, work: &mut Work, pipelines: &mut Pipelines) -> Result<()> {
        let map = self.resources.image(label::SHADOW_MAP);
        let set = [
            Binding::Uniform(self.resources.buffer(label::FRAME)),
            Binding::Read(self.resources.buffer(label::POSITIONS)),
            Binding::Read(self.texcoords()),
        ];
        let indices = self.resources.buffer(label::SHADOW_INDICES);
        let mut reads = set.to_vec();
        reads.push(Binding::Index(indices));
        self.declare_textures(&mut reads);
        let pass = RenderPass {
            extent: map.info().extent,
            color: &[],
            depth: Some(DepthTarget {
                image: map,
                clear: Some(0.0),
                store: true,
            }),
            reads: &reads,
        };
        work.render(label::SHADOW_MAP, &pass, |draws| {
            draws.index_buffer(indices);
            for (batch, samplers) in self.batches.iter().zip(self.samplers) {
                let cuts = batch.cuts && batch.alpha.is_some();
                draws.pipeline(&pipelines.fixed(Fixed::Shadow { cuts })?);
                draws.bind(0, &set)?;
                if let Some(alpha) = batch.alpha.as_ref().filter(|_| cuts) {
                    draws.bind(
                        1,
                        &[Binding::Sampled(self.resources.image(alpha), &samplers[1])],
                    )?;
                }
                draws.push(&batch.material)?;
                draws.draw_indexed(batch.shadow_indices.clone(), 1)?;
            }
            Ok(())
        })
    }

    /// Pass 2: the nearest surface of every sample.
    pub(super) fn surface(
        &self,
        work: &mut Work,
        pipelines: &mut Pipelines,
        view: View,
    ) -> Result<()> {
        let set = self.common_set(false, self.is_realigned(view));
        self.with_surface_pass(&set, |pass| {
            work.render(label::SURFACE_PASS, pass, |draws| {
                let draw = Draw {
                    view,
                    shadowed: false,
                    gbuffer: false,
                };
                self.draw_model(draws, pipelines, &set, draw)
            })
        })
    }

    /// Readies pass 2 before pass 1, so that nothing waits between the two: neither reads what
    /// the other writes.
    pub(super) fn declare_surface(&self, work: &mut Work, view: View) {
        let set = self.common_set(false, self.is_realigned(view));
        self.with_surface_pass(&set, |pass| work.declare(label::SURFACE_PASS, pass));
    }

    fn with_surface_pass<T>(
        &self,
        set: &[Binding<'_>],
        run: impl FnOnce(&RenderPass<'_>) -> T,
    ) -> T {
        let mut reads = set.to_vec();
        reads.extend(
            self.resources
                .find_buffer(label::INDICES)
                .map(Binding::Index),
        );
        self.declare_textures(&mut reads);
        let target = |label| ColorTarget {
            image: self.resources.image(label),
            clear: Some([0.0; 4]),
            resolve: None,
            store: true,
        };
        run(&RenderPass {
            extent: self.settings.size,
            color: &[target(label::RECORD_A), target(label::RECORD_B)],
            depth: Some(DepthTarget {
                image: self.resources.image(label::DEPTH),
                clear: Some(0.0),
                store: true,
            }),
            reads: &reads,
        })
    }

    /// Pass 3: light, ground, background.
    pub(super) fn shade(
        &self,
        work: &mut Work,
        pipelines: &mut Pipelines,
        view: View,
    ) -> Result<()> {
        let shadowed = view.is_shadowed() && self.plan.image(label::SHADOW_MAP).is_some();
        let set = self.common_set(shadowed, self.is_realigned(view));
        let record = |label| Binding::Sampled(self.resources.image(label), self.border);
        let records = [
            record(label::RECORD_A),
            record(label::RECORD_B),
            record(label::DEPTH),
            Binding::Read(self.resources.buffer(label::MATERIALS)),
        ];
        let mut reads = set.to_vec();
        reads.extend(records);
        let pass = RenderPass {
            extent: self.settings.size,
            color: &[ColorTarget {
                image: self.resources.image(label::PICTURE),
                clear: Some([0.0; 4]),
                resolve: None,
                store: true,
            }],
            depth: None,
            reads: &reads,
        };
        let textured = view.is_textured();
        let areas = &self.resources.areas;
        let parts = [
            (&areas.model, Fixed::Shade { textured, shadowed }),
            (&areas.shadowed, Fixed::Backdrop { shadowed }),
            (&areas.open, Fixed::Backdrop { shadowed: false }),
        ];
        work.render(label::SHADE_PASS, &pass, |draws| {
            for (rectangles, which) in parts.iter().filter(|p| !p.0.is_empty()) {
                draws.pipeline(&pipelines.fixed(*which)?);
                draws.bind(0, &set)?;
                if matches!(which, Fixed::Shade { .. }) {
                    draws.bind(1, &records)?;
                }
                for rectangle in *rectangles {
                    draws.scissor(*rectangle);
                    draws.draw(0..3, 1)?;
                }
            }
            Ok(())
        })
    }

    /// Pass 4: what a view draws over the picture.
    pub(super) fn overlay(
        &self,
        work: &mut Work,
        pipelines: &mut Pipelines,
        view: View,
    ) -> Result<()> {
        let set = self.common_set(false, self.is_realigned(view));
        let mut reads = set.to_vec();
        self.declare_overlays(&mut reads, view);
        let pass = RenderPass {
            extent: self.settings.size,
            color: &[ColorTarget {
                image: self.resources.image(label::PICTURE),
                clear: None,
                resolve: None,
                store: true,
            }],
            depth: Some(DepthTarget {
                image: self.resources.image(label::OVERLAY_DEPTH),
                clear: Some(0.0),
                store: false,
            }),
            reads: &reads,
        };
        work.render(label::OVERLAY_PASS, &pass, |draws| {
            self.draw_overlays(draws, pipelines, &set, view)
        })
    }

    /// The channels of the G-buffer.
    pub(super) fn gbuffer(&self, work: &mut Work, pipelines: &mut Pipelines) -> Result<()> {
        let shadowed = self.plan.channels.contains(&Channel::Shade)
            && self.plan.image(label::SHADOW_MAP).is_some();
        let view = View::Textured;
        let set = self.common_set(shadowed, self.is_realigned(view));
        let mut reads = set.to_vec();
        let indices = self.resources.find_buffer(label::INDICES);
        reads.extend(indices.map(Binding::Index));
        self.declare_textures(&mut reads);
        let color: Vec<ColorTarget<'_>> = self
            .plan
            .channels
            .iter()
            .map(|c| ColorTarget {
                image: self.resources.image(c.label()),
                clear: Some([0.0; 4]),
                resolve: None,
                store: true,
            })
            .collect();
        let pass = RenderPass {
            extent: self.settings.size,
            color: &color,
            depth: Some(DepthTarget {
                image: self.resources.image(label::GBUFFER_DEPTH),
                clear: Some(0.0),
                store: false,
            }),
            reads: &reads,
        };
        work.render(label::GBUFFER_PASS, &pass, |draws| {
            self.draw_model(
                draws,
                pipelines,
                &set,
                Draw {
                    view,
                    shadowed,
                    gbuffer: true,
                },
            )
        })
    }

    /// Whether a view shows realigned normals (else the model's own).
    fn is_realigned(&self, view: View) -> bool {
        self.plan.has(Attribute::Shading) && view != View::Standard
    }

    fn texcoords(&self) -> &crate::gpu::Buffer {
        self.or_positions(label::TEXCOORDS)
    }

    /// A buffer of the plan, or the positions where shaders name one that they will not read.
    fn or_positions(&self, label: &str) -> &crate::gpu::Buffer {
        self.resources
            .find_buffer(label)
            .or_else(|| self.resources.find_buffer(label::POSITIONS))
            .unwrap_or_else(|| self.resources.buffer(label::FRAME))
    }

    /// Set 0 of every draw of a pass.
    fn common_set(&self, shadowed: bool, realigned: bool) -> [Binding<'_>; 7] {
        let normals = if realigned {
            label::SHADING
        } else {
            label::MODEL_NORMALS
        };
        let shadow = if shadowed {
            Binding::Sampled(self.resources.image(label::SHADOW_MAP), self.border)
        } else {
            Binding::Sampled(self.resources.image(label::NO_TEXTURE), self.clamp)
        };
        [
            Binding::Uniform(self.resources.buffer(label::FRAME)),
            Binding::Read(self.or_positions(label::POSITIONS)),
            Binding::Read(self.or_positions(normals)),
            Binding::Read(self.texcoords()),
            Binding::Read(self.or_positions(label::COLORS)),
            Binding::Read(self.or_positions(label::LIGHTS)),
            shadow,
        ]
    }

    fn draw_model(
        &self,
        draws: &mut Draws<'_>,
        pipelines: &mut Pipelines,
        set: &[Binding<'_>],
        Draw {
            view,
            shadowed,
            gbuffer,
        }: Draw,
    ) -> Result<()> {
        let Some(indices) = self.resources.find_buffer(label::INDICES) else {
            return Ok(());
        };
        let realigned = self.is_realigned(view);
        draws.index_buffer(indices);
        for (batch, samplers) in self.batches.iter().zip(self.samplers) {
            let textured = view.is_textured();
            let texture = batch.texture.as_ref().filter(|_| textured || batch.cuts);
            draws.pipeline(&pipelines.model(SurfaceKey {
                normals: if realigned {
                    normals_form(self.settings.encoding)
                } else {
                    abi::NORMALS_OWN
                },
                texture: texture.is_some(),
                color: textured && self.plan.has(Attribute::Color),
                textured,
                shadowed,
                cuts: batch.cuts,
                gbuffer,
            })?);
            draws.bind(0, set)?;
            let image = texture.map_or(label::NO_TEXTURE, String::as_str);
            draws.bind(
                1,
                &[Binding::Sampled(self.resources.image(image), &samplers[0])],
            )?;
            draws.push(&batch.push(realigned, self.settings.flip_back_faces))?;
            draws.draw_indexed(batch.indices.clone(), 1)?;
        }
        Ok(())
    }

    fn draw_overlays(
        &self,
        draws: &mut Draws<'_>,
        pipelines: &mut Pipelines,
        set: &[Binding<'_>; 7],
        view: View,
    ) -> Result<()> {
        if let Some(indices) = self.surface_indices(view) {
            let mut set = *set;
            set[1] = Binding::Read(self.resources.buffer(label::SURFACE_POSITIONS));
            set[2] = Binding::Read(self.resources.buffer(label::SURFACE_NORMALS));
            draws.pipeline(&pipelines.fixed(Fixed::Surface)?);
            draws.bind(0, &set)?;
            draws.push(&RenderOverlay {
                opacity: SURFACE_OPACITY,
                color: SURFACE_COLOR,
                ..RenderOverlay::default()
            })?;
            draws.index_buffer(indices);
            let count = u32::try_from(indices.bytes() / 4).expect("fewer than 2^32 indices");
            draws.draw_indexed(0..count, 1)?;
        }
        if let (Some(plane), Some(image)) = (self.slice, self.slice_image(view)) {
            draws.pipeline(&pipelines.fixed(Fixed::Slice)?);
            draws.bind(0, set)?;
            draws.bind(1, &[Binding::Sampled(image, self.clamp)])?;
            draws.push(&RenderOverlay {
                corner: plane.corner.into(),
                edge_u: plane.edge_u.into(),
                edge_v: plane.edge_v.into(),
                opacity: SLICE_OPACITY,
                ..RenderOverlay::default()
            })?;
            draws.draw(0..6, 1)?;
        }
        Ok(())
    }

    fn surface_indices(&self, view: View) -> Option<&crate::gpu::Buffer> {
        self.resources
            .find_buffer(label::SURFACE_INDICES)
            .filter(|b| view.needs_surface() && b.bytes() > 0)
    }

    fn slice_image(&self, view: View) -> Option<&crate::gpu::Image> {
        self.resources
            .find_image(label::SLICE)
            .filter(|_| view.needs_field())
    }

    fn declare_overlays<'b>(&'b self, reads: &mut Vec<Binding<'b>>, view: View) {
        if let Some(indices) = self.surface_indices(view) {
            reads.push(Binding::Index(indices));
            for label in [label::SURFACE_POSITIONS, label::SURFACE_NORMALS] {
                reads.push(Binding::Read(self.resources.buffer(label)));
            }
        }
        reads.extend(
            self.slice_image(view)
                .map(|i| Binding::Sampled(i, self.clamp)),
        );
    }

    fn declare_textures<'b>(&'b self, reads: &mut Vec<Binding<'b>>) {
        let named = self
            .batches
            .iter()
            .flat_map(|b| b.texture.iter().chain(&b.alpha));
        let mut labels: Vec<&str> = named.map(String::as_str).collect();
        labels.push(label::NO_TEXTURE);
        labels.sort_unstable();
        labels.dedup();
        let images = labels
            .into_iter()
            .filter_map(|l| self.resources.find_image(l));
        reads.extend(images.map(|i| Binding::Sampled(i, self.clamp)));
    }
}
