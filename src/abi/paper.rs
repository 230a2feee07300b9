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
        /// Number of a primitive's middle among the corners of its triangles.
        PAPER_MIDDLE: u32 = 0xffff_ffff;
        /// Steps of a program at most.
        PAPER_OPS: u32 = 64;
        /// Values on a program's stack at most.
        PAPER_STACK: u32 = 16;
        /// Variables of programs, of which the last four are masks.
        PAPER_VARIABLES: u32 = 14;
        /// Largest magnitude of a program's values.
        PAPER_LARGEST: f32 = 1e9;
        /// Largest factor on thresholds, for 16-bit floats.
        PAPER_FACTOR: f32 = 60000.0;
        /// Largest factor on widths.
        PAPER_WIDER: f32 = 10.0;
        /// Step of a program: the step's value.
        PAPER_NUMBER: u32 = 0;
        /// Step of a program: the variable of that number.
        PAPER_VARIABLE: u32 = 1;
        /// Step of a program: minus.
        PAPER_NEG: u32 = 2;
        /// Step of a program: 1 where 0.
        PAPER_NOT: u32 = 3;
        /// Step of a program: without sign.
        PAPER_ABS: u32 = 4;
        /// Step of a program: root; of negatives 0.
        PAPER_SQRT: u32 = 5;
        /// Step of a program: sine, radians.
        PAPER_SIN: u32 = 6;
        /// Step of a program: cosine, radians.
        PAPER_COS: u32 = 7;
        /// Step of a program: power of e.
        PAPER_EXP: u32 = 8;
        /// Step of a program: natural logarithm; 0 where there is none.
        PAPER_LOG: u32 = 9;
        /// Step of a program: next whole number below.
        PAPER_FLOOR: u32 = 10;
        /// Step of a program: what is above it.
        PAPER_FRACT: u32 = 11;
        /// Step of a program: sum.
        PAPER_ADD: u32 = 12;
        /// Step of a program: difference.
        PAPER_SUB: u32 = 13;
        /// Step of a program: product.
        PAPER_MUL: u32 = 14;
        /// Step of a program: quotient; by 0: 0.
        PAPER_DIV: u32 = 15;
        /// Step of a program: rest of a division, of the divisor's sign; by 0: 0.
        PAPER_MOD: u32 = 16;
        /// Step of a program: power; 0 where there is none.
        PAPER_POW: u32 = 17;
        /// Step of a program: smaller.
        PAPER_MIN: u32 = 18;
        /// Step of a program: larger.
        PAPER_MAX: u32 = 19;
        /// Step of a program: 1 where the first is less.
        PAPER_LESS: u32 = 20;
        /// Step of a program: 1 where the first is greater.
        PAPER_GREATER: u32 = 21;
        /// Step of a program: between the second and the third.
        PAPER_CLAMP: u32 = 22;
        /// Step of a program: from the first to the second by the third.
        PAPER_MIX: u32 = 23;
        /// Step of a program: smooth step of the third from the first to the second.
        PAPER_SMOOTH: u32 = 24;
        /// Step of a program: second where the first is not 0, otherwise the third.
        PAPER_IF: u32 = 25;
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
            /// Cosines of the phases of both waves of the deformation, then their sines.
            waves: [f32; 4],
            /// Row of the middle in the picture, pixels.
            row: f32,
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
            /// Pixels below which branches are not drawn; 0: all are.
            thin: f32,
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
            /// Particles of foliage; those after them are ground.
            leaves: u32,
            /// The ways for ground, metres.
            ground_bias: f32,
            /// To deepest shadow on ground, metres.
            ground_softness: f32,
        }

        /// Push constants of the bitmap.
        PaperBitmap {
            /// Linear colour of the paper.
            paper: [f32; 3],
            /// Pixels across.
            width: u32,
            /// Linear colour of foliage's lines.
            ink: [f32; 3],
            /// Pixels down.
            height: u32,
            /// Linear colour of stems' lines.
            stem_ink: [f32; 3],
            /// Linear colour of shadow's areas.
            shadow_ink: [f32; 3],
            /// The same on the ground.
            ground_ink: [f32; 3],
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
            /// Shadow from which areas are inked, lines on them; above 1: nowhere.
            black: f32,
            /// Growth of lines' width in shadow.
            pressure: f32,
            /// Largest factor on widths.
            widest: f32,
        }

        /// A step of a program.
        PaperOp {
            /// What is done.
            code: u32,
            /// A number, or the number of a variable.
            value: f32,
        }

        /// What programs read of a particle beside its place.
        PaperTrait {
            /// Unit normal.
            normal: [f32; 3],
            /// Number of its object.
            object: f32,
        }

        /// Push constants of factors on thresholds and widths.
        PaperModulate {
            /// Where the programs of foliage's threshold and width and of stems' end among the
            /// steps; one without steps is 1.
            ends: [u32; 4],
            /// Pixels across.
            width: u32,
            /// Pixels down.
            height: u32,
            /// Depth that becomes `near`, metres.
            nearest: f32,
            /// Depth that becomes `far`, metres.
            farthest: f32,
            /// z0.
            near: f32,
            /// z1.
            far: f32,
            /// Light from all around, 0 to 1.
            ambient: f32,
        }
    }
}
