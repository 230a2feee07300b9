//! What the shaders of `ink` that make looks share with Rust: sun, edges, washes.

use bytemuck::{Pod, Zeroable};

use super::StructLayout;
use super::glsl_text::{GlslLiteral, GlslType};

abi! {
    constants {
        /// Radius at most of the filter of the sun's shadow, texels.
        INK_SHADOW_REACH: u32 = 9;
        /// Pixels to each side at most that a wash is softened over.
        INK_SOFTEN_REACH: u32 = 96;
        /// Octaves of the noise of pigment and paper.
        INK_NOISE_OCTAVES: u32 = 3;
        /// Wavelength of what displaces the edges of washes, pixels of the final picture.
        INK_WOBBLE_LENGTH: f32 = 13.0;
        /// Wavelength of pigment that settles, pixels of the final picture.
        INK_PIGMENT_LENGTH: f32 = 46.0;
        /// Wavelength of the paper's grain, pixels of the final picture.
        INK_GRAIN_LENGTH: f32 = 2.6;
    }
    structs {
        /// Push constants of the light.
        InkLight {
            /// Relative position to the sun's clip space, depth reversed.
            relative_to_sun: [[f32; 4]; 4],
            /// Pixels across.
            width: u32,
            /// Pixels down.
            height: u32,
            /// Radius of the filter, texels, 1 to `INK_SHADOW_REACH`.
            reach: f32,
            /// Depth, in shares of the map's range, by which a caster lies nearer to the sun before
            /// its shadow begins; twice that and it is full.
            bias: f32,
            /// Texels along an edge of the map.
            texels: u32,
        }

        /// Push constants of edges in the normals.
        InkEdges {
            /// Pixels across.
            width: u32,
            /// Pixels down.
            height: u32,
            /// Distance at which normals are compared, pixels.
            reach: f32,
            /// Size of the gradient at which lines begin.
            threshold: f32,
            /// Over which they become full.
            softness: f32,
        }

        /// Push constants of the softening of a wash.
        InkSoften {
            /// Pixels across.
            width: u32,
            /// Pixels down.
            height: u32,
            /// Standard deviation, pixels.
            deviation: f32,
        }

        /// Push constants of a wash.
        InkWash {
            /// Linear colour of the paper.
            paper: [f32; 3],
            /// Pixels across.
            width: u32,
            /// Pixels down.
            height: u32,
            /// Pixels of this picture for one of the final one.
            factor: f32,
            /// How far edges wander, pixels.
            wobble: f32,
            /// Width of the border of a layer, pixels.
            feather: f32,
            /// Pigment that gathers at edges, in densities of its layer.
            darkening: f32,
            /// How far in, pixels.
            edge_width: f32,
            /// Optical density of one layer.
            density: f32,
            /// Unevenness of the pigment, 0 to 1.
            pigment: f32,
            /// Share that the paper's grain has in it, 0 to 1.
            grain: f32,
            /// Tone below which a second layer lies.
            middle: f32,
            /// Tone below which a third one lies.
            dark: f32,
            /// Of the noise.
            seed: u32,
        }
    }
}
