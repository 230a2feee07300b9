//! What the kernels of leaf appearance share with the host.

use bytemuck::{Pod, Zeroable};

use super::StructLayout;
use super::glsl_text::{GlslLiteral, GlslType};

abi! {
    constants {
        /// Nodes of the slab table along each axis.
        SLAB_NODES: u32 = 33;
        /// Coefficients of the spline through them along each axis.
        SLAB_COEFFICIENTS: u32 = 35;
        /// Natural logarithm of the thinnest optical thickness of the table, 0.01.
        SLAB_LN_THIN: f32 = -4.6051702;
        /// Natural logarithm of the thickest, 30.
        SLAB_LN_THICK: f32 = 3.4011974;
        /// Square root of 3: slope of the discrete eigenvalue at omega = 1.
        SLAB_SQRT_3: f32 = 1.7320508;
        /// Twice the extrapolated end of a conservative slab, in optical depth.
        SLAB_TWO_ENDS: f32 = 1.420892;
        /// `LeafTissue::mode`: A and B are constants of the leaf, as in the paper.
        LEAF_PAPER: u32 = 0;
        /// A and B are read from the table for every texel.
        LEAF_EXACT: u32 = 1;
        /// Smallest cosine by which the glossy term divides.
        GLOSSY_MIN_COSINE: f32 = 1e-3;
        /// Smallest roughness m of the glossy term.
        GLOSSY_MIN_ROUGHNESS: f32 = 1e-3;
        /// Cosines at which the factors of oblique light are kept.
        LEAF_TURN_NODES: u32 = 33;
    }
    structs {
        /// Push constants of `leaf/albedo.comp`: one side of a leaf.
        LeafTissue {
            /// Absorption times thickness, per channel.
            absorption: [f32; 3],
            /// Scattering times thickness, per channel.
            scattering: [f32; 3],
            /// The paper's constants A.
            a: [f32; 3],
            /// The paper's constants B.
            b: [f32; 3],
            /// `LEAF_PAPER` or `LEAF_EXACT`.
            mode: u32,
            /// Texels.
            count: u32,
        }

        /// Factors on what a leaf makes of straight light, for light at one angle.
        LeafTurn {
            /// Reflectance of the front.
            front: [f32; 3],
            /// Reflectance of the back.
            back: [f32; 3],
            /// Transmittance of light that falls on the front.
            down: [f32; 3],
            /// Transmittance of light that falls on the back.
            up: [f32; 3],
        }

        /// Push constants of `leaf/glossy.comp`.
        GlossyQueries {
            /// Queries.
            count: u32,
            /// 1: with the energy-safe shadowing term.
            safe: u32,
        }
    }
}
