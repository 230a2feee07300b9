//! What the shaders of drawings on paper share with Rust.

use bytemuck::{Pod, Zeroable};

use super::StructLayout;
use super::glsl_text::{GlslLiteral, GlslType};

abi! {
    constants {
        /// Differences of depth where nothing is beside: farther than any threshold.
        PAPER_INFINITE: f32 = 1e9;
        /// Units of depth differences over the whole range (Deussen and Strothotte 2000).
        PAPER_DEPTHS: f32 = 65535.0;
        /// Half width at most to which lines are widened, pixels.
        PAPER_WIDEN: i32 = 6;
    }
    structs {
        /// A particle of foliage in one view.
        PaperParticle {
            /// Middle, in the geometry's frame.
            centre: [f32; 3],
            /// Radius, metres, with the size law.
            radius: f32,
            /// Turn in the picture: cosine and sine.
            turn: [f32; 2],
            /// Tilt of the leaf's normal that chooses among the nine views, -1 to 1.
            tilt: [f32; 2],
            /// Phases of the deformation, radians.
            phase: [f32; 2],
            /// Row of the middle in the picture, pixels.
            row: f32,
            /// Nothing.
            unused: f32,
        }

        /// Push constants of primitives.
        PaperPrimitive {
            /// Points of an outline.
            points: u32,
            /// Outlines: 1, or 9 for views by normal.
            views: u32,
            /// Share by which outlines are deformed.
            deformation: f32,
        }

        /// Push constants of ellipses.
        PaperEllipse {
            /// Width in shares of the length.
            aspect: f32,
            /// Share by which outlines are deformed.
            deformation: f32,
        }

        /// Push constants of stems.
        PaperStem {
            /// Light from all around, 0 to 1.
            ambient: f32,
        }

        /// Push constants of depth differences.
        PaperDifference {
            /// Pixels across.
            width: u32,
            /// Pixels down.
            height: u32,
            /// Whether depths are taken as a depth buffer has them (1) or as they are (0).
            mapped: u32,
            /// Whether what shows nothing is infinitely far (0) or at the far end (1).
            sky_at_far: u32,
            /// Depth that becomes `near`, metres.
            nearest: f32,
            /// Depth that becomes `far`, metres.
            farthest: f32,
            /// z0.
            near: f32,
            /// z1.
            far: f32,
            /// Share of the surface's own slope that is no difference.
            slope: f32,
        }

        /// Push constants of shadows.
        PaperSunlit {
            /// Pixels across.
            width: u32,
            /// Pixels down.
            height: u32,
            /// Texels along the sun's map.
            map_size: u32,
            /// Texels on each side over which shadows are averaged.
            reach: u32,
            /// Way behind what the sun sees first that is still in its light, metres.
            bias: f32,
            /// Way from there to deepest shadow, metres.
            softness: f32,
        }

        /// Push constants of the bitmap.
        PaperBitmap {
            /// Linear colour of the paper.
            paper: [f32; 3],
            /// Pixels across.
            width: u32,
            /// Linear colour of the ink.
            ink: [f32; 3],
            /// Pixels down.
            height: u32,
            /// Threshold of foliage, units of the depth range / 65535.
            foliage: f32,
            /// The same of stems.
            stem: f32,
            /// Half width of foliage's lines, pixels.
            foliage_width: f32,
            /// The same of stems.
            stem_width: f32,
            /// Whether only the lower part of outlines is drawn.
            lower: u32,
            /// Number of the last particle of foliage; those after it are ground.
            leaves: u32,
            /// Growth of foliage's threshold in shadow, -1 to 1.
            detail: f32,
            /// Shadow from which everything is ink; above 1: nowhere.
            black: f32,
            /// Growth of lines' width in shadow.
            pressure: f32,
        }
    }
}
