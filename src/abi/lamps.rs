//! What the kernels of lamps near the scene share with the host.

use bytemuck::{Pod, Zeroable};

use super::StructLayout;
use super::glsl_text::{GlslLiteral, GlslType};

abi! {
    constants {
        /// Lamps that a pass adds at most.
        LAMPS_PER_PASS: u32 = 4;
        /// A ray to a point of a lamp ends this share of its length before it.
        LAMP_REACH: f32 = 0.9999;
    }
    structs {
        /// A flat lamp as points of equal power; what light they send falls off with the cosine at
        /// the lamp.
        LampRecord {
            /// Unit vector that its face looks along.
            normal: [f32; 3],
            /// First of its points.
            first_point: u32,
            /// Irradiance that one point gives at distance 1 along the normal.
            intensity: [f32; 3],
            /// Its points.
            points: u32,
            /// Least squared distance: nearer, a point would send more than its share of the
            /// lamp's area does.
            least: f32,
        }

        /// Push constants of `leaf/lamp_rays.comp` and `leaf/lamp_count.comp`. In units of the
        /// diagonal.
        LampBatch {
            /// Unit vector that the lamp's face looks along.
            normal: [f32; 3],
            /// Receivers.
            items: u32,
            /// First point of this batch.
            first_point: u32,
            /// Points of this batch.
            points: u32,
            /// Invocations of the trace.
            invocations: u32,
            /// A ray starts so far from its surface.
            offset: f32,
            /// Least squared distance of a point.
            least: f32,
        }

        /// Push constants of `leaf/lit_lamps.comp`.
        LampPass {
            /// First lamp.
            first: u32,
            /// Lamps of this pass.
            count: u32,
        }
    }
}
