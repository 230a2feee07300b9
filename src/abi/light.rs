//! What the kernels that trace rays and gather light share with the host.

use bytemuck::{Pod, Zeroable};

use super::StructLayout;
use super::glsl_text::{GlslLiteral, GlslType};

impl GlslType for PrtBatch {
    const GLSL: &'static str = "PrtBatch";
}

abi! {
    constants {
        /// Bits of a texel's number that select its column in the images of `rays.glsl`.
        RAY_COLUMN_BITS: u32 = 10;
        /// Texels of a node of the hierarchy.
        RAY_NODE_TEXELS: u32 = 5;
        /// Texels of a pair of triangles: four corners, numbers.
        RAY_QUAD_TEXELS: u32 = 4;
        /// Texels of a pair in scenes with cutouts: texture coordinates too.
        RAY_MASKED_TEXELS: u32 = 6;
        /// Groups of nodes that wait for a ray at most; the host builds no deeper hierarchy.
        RAY_STACK: u32 = 24;
        /// Words of the state of an unfinished invocation.
        RAY_STATE: u32 = 59;
        /// Number of no triangle.
        RAY_NOTHING: u32 = 0xffff_ffff;
        /// Largest reciprocal of a component of a direction.
        RAY_STEEP: f32 = 1e18;
        /// Rounds after which an invocation looks whether its ray is done.
        RAY_ROUNDS: u32 = 3;
        /// Rays of one invocation at most: `any_hit.comp` has a bit for each.
        RAY_PLACES: u32 = 32;
        /// Wrap modes of cutouts, in the order of `scene::Wrap`.
        CUTOUT_REPEAT: u32 = 0;
        /// Clamps to the edge.
        CUTOUT_CLAMP: u32 = 1;
        /// `t_max` of a ray without end.
        RAY_FAR: f32 = 1e30;
        /// Coefficients of spherical harmonics at most: bands 0 to 5.
        SH_MAX_COEFFICIENTS: u32 = 36;
        /// Angles of view of a glossy lobe's table, even from 0 to 90 degrees.
        LOBE_NODES: u32 = 65;
        /// Coefficients of an angle: m from 0 to l in each of 6 bands.
        LOBE_COEFFICIENTS: u32 = 21;
        /// State of a path whose ray is to be traced.
        PATH_ALIVE: f32 = -1.0;
        /// State of a path that was absorbed; others hold the bounce at which they escaped.
        PATH_ENDED: f32 = -2.0;
        /// Points of the filter of the sun's shadow map.
        LIT_SHADOW_TAPS: u32 = 16;
        /// Steepest slope of a leaf against the sun that its shadow map is read at.
        LIT_SHADOW_STEEPEST: f32 = 8.0;
        /// Rays of gloss start so far before the surface of their pixel, in units of the diagonal.
        GLOSS_RAY_OFFSET: f32 = 1e-5;
        /// And no nearer than this share of the pixel's extent: where depth is steep, the place of the
        /// surface hangs on how devices round corners to parts of a pixel.
        GLOSS_RAY_PIXELS: f32 = 0.1;
    }
    structs {
        /// Push constants of `leaf/any_hit.comp` and `leaf/nearest_hit.comp`.
        TraceRays {
            /// Rays.
            count: u32,
            /// Invocations; each takes every `invocations`-th ray.
            invocations: u32,
            /// Rays of an invocation.
            places: u32,
            /// Rounds of the loop that an invocation may take in this dispatch.
            rounds: u32,
            /// Whether an earlier dispatch has left its states.
            continues: u32,
        }

        /// Where light is gathered: a vertex, drawn a little into one of its faces.
        Receiver {
            /// In units of the diagonal.
            position: [f32; 3],
            /// Its `LeafSides`.
            material: u32,
            /// Unit shading normal of the front.
            normal: [f32; 3],
            /// Unit normal of the face.
            facing: [f32; 3],
        }

        /// What the two sides of a leaf make of light, per channel.
        LeafSides {
            /// Diffuse reflectance of the front.
            rho_d_front: [f32; 3],
            /// Diffuse reflectance of the back.
            rho_d_back: [f32; 3],
            /// Diffuse transmittance, either way.
            rho_t: [f32; 3],
        }

        /// Push constants of `leaf/prt_start.comp`, `leaf/prt_gather.comp`, `leaf/matrix_start.comp` and
        /// `leaf/matrix_gather.comp`.
        PrtBatch {
            /// First side.
            first_side: u32,
            /// Sides: two for each receiver of the batch; one where matrices are gathered.
            sides: u32,
            /// Number of the first sample.
            first_sample: u32,
            /// Samples of each side.
            samples: u32,
            /// Seed of the random numbers.
            seed: u32,
            /// A ray starts so far from its surface, in units of the diagonal.
            offset: f32,
        }

        /// Push constants of `leaf/prt_bounce.comp`.
        PrtBounce {
            /// The batch.
            batch: PrtBatch,
            /// Number of the rays just traced.
            bounce: u32,
            /// Whether no path goes on.
            last: u32,
            /// Chance of going on, in albedos of what was met.
            survival: f32,
        }

        /// Push constants of `leaf/gloss_view.comp`.
        GlossView {
            /// Eye, in units of the diagonal.
            eye: [f32; 3],
            /// Receivers.
            count: u32,
        }

        /// Push constants of `leaf/lvc_rays.comp` and `leaf/lvc_count.comp`.
        LvcBatch {
            /// Pairs of a direction and a receiver.
            items: u32,
            /// Number of the first sample.
            first_sample: u32,
            /// Samples of this batch.
            samples: u32,
            /// Sine of the disc's angular radius.
            sin_radius: f32,
            /// A ray starts so far from its surface, in units of the diagonal.
            offset: f32,
            /// Invocations of the trace.
            invocations: u32,
        }

        // ---- pictures ----

        /// What is the same for a path-traced picture. Positions in units of the diagonal.
        TruthFrame {
            /// Camera.
            eye: [f32; 3],
            /// Pixels across.
            width: u32,
            /// Unit direction of view.
            forward: [f32; 3],
            /// Pixels down.
            height: u32,
            /// Half the picture's width at distance 1.
            right: [f32; 3],
            /// Seed of the random numbers.
            seed: u32,
            /// Half the picture's height at distance 1.
            up: [f32; 3],
            /// A ray starts so far from its surface.
            offset: f32,
            /// Unit vector to the sun.
            sun: [f32; 3],
            /// Sine of its angular radius.
            sin_radius: f32,
            /// Its irradiance on a surface that faces it.
            irradiance: [f32; 3],
            /// 1 where there is a sun.
            suns: u32,
            /// Points of the sun's shape, the first ones of all points; 0: an even disc.
            sun_points: u32,
            /// Lamps.
            lamps: u32,
        }

        /// A path of light, followed from the camera.
        TruthPath {
            /// What light at its end counts.
            weight: [f32; 3],
            /// `PATH_ALIVE` or `PATH_ENDED`.
            alive: f32,
            /// Light of the sun or a lamp that waits for its ray.
            pending: [f32; 3],
            /// 1 where the camera's ray met the model.
            covered: f32,
            /// Sun and lamps on what the camera sees.
            direct: [f32; 3],
            /// Sun and lamps over other leaves.
            indirect: [f32; 3],
            /// Sky.
            sky: [f32; 3],
        }

        /// Push constants of `leaf/truth_*.comp`.
        TruthBatch {
            /// First pixel.
            first_pixel: u32,
            /// Pixels.
            pixels: u32,
            /// Number of the first sample.
            first_sample: u32,
            /// Samples of each pixel.
            samples: u32,
            /// Number of the rays just traced.
            bounce: u32,
            /// Whether no path goes on.
            last: u32,
            /// Invocations of the trace of the sun's rays.
            invocations: u32,
        }

        /// What is the same for a picture in two passes. Positions relative, metres.
        LitFrame {
            /// Relative position to clip, depth reversed.
            relative_to_clip: [[f32; 4]; 4],
            /// Unit direction of view.
            forward: [f32; 3],
            /// Pixels across.
            width: u32,
            /// Half the picture's width at distance 1.
            right: [f32; 3],
            /// Pixels down.
            height: u32,
            /// Half the picture's height at distance 1.
            up: [f32; 3],
            /// Distance of depth 1, metres.
            near: f32,
            /// Camera.
            eye: [f32; 3],
            /// Unit vector to the sun.
            sun: [f32; 3],
            /// Its irradiance on a surface that faces it.
            irradiance: [f32; 3],
        }

        /// Push constants of `leaf/gloss_rays.comp` and `leaf/gloss_gather.comp`.
        GlossBatch {
            /// First pixel, row by row.
            first_pixel: u32,
            /// Pixels.
            pixels: u32,
            /// Number of the first sample.
            first_sample: u32,
            /// Samples of this batch: each a ray of the lobe, and one of what counts as diffuse.
            samples: u32,
            /// Samples of each pixel in all.
            all_samples: u32,
            /// Seed of the random numbers.
            seed: u32,
            /// Metres to units of the diagonal.
            scale: f32,
        }

        /// A map of the sun's depth, seen along its direction.
        ShadowView {
            /// Relative position to clip, depth reversed.
            relative_to_sun: [[f32; 4]; 4],
            /// Texels along an edge.
            size: u32,
            /// Extent of a texel, metres.
            texel: f32,
            /// Extent along the light, metres.
            range: f32,
            /// Radius of the filter, texels.
            radius: f32,
        }

        /// Push constants of `leaf/lit.{vert,frag}`: one part of the model.
        LitDraw {
            /// Map of the texture coordinates, first row.
            texcoord_u: [f32; 3],
            /// Second row.
            texcoord_v: [f32; 3],
            /// 1 / mean of the texture.
            tint: [f32; 3],
            /// Factor on the texture's alpha.
            alpha: f32,
            /// Fragments of less alpha are cut away.
            cutoff: f32,
            /// Number of the material.
            material: u32,
        }
    }
}
