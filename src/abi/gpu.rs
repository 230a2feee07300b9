//! What all kernels share with Rust, and the proofs of the mechanism.

use bytemuck::{Pod, Zeroable};

use super::StructLayout;
use super::glsl_text::{GlslLiteral, GlslType};

abi! {
    constants {
        /// Invocations per group of one-dimensional kernels.
        GROUP_1D: u32 = 64;
    }
    structs {
        /// Push constants of `gpu/fill_sequence.comp`: the smallest kernel, which proves the path
        /// from Rust to the device and back.
        FillSequence {
            /// Number of elements.
            count: u32,
            /// Value of element 0.
            first: u32,
            /// Difference between neighbours.
            step: u32,
        }

        /// Push constants of `gpu/square.{vert,frag}`: the smallest picture.
        Square {
            /// Lower corner in clip space.
            min: [f32; 2],
            /// Upper corner in clip space.
            max: [f32; 2],
            /// Linear RGBA.
            color: [f32; 4],
            /// Reversed depth: 1 is nearest.
            depth: f32,
        }
    }
}
