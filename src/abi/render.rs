//! What the shaders of `render` share with Rust.

use bytemuck::{Pod, Zeroable};

use super::StructLayout;
use super::glsl_text::{GlslLiteral, GlslType};

abi! {
    constants {
        /// Vertex form of normals: octahedral 2 x snorm16 and unorm16 ambient, 2 words.
        NORMALS_PACKED: u32 = 0;
        /// The ambient coefficient is the vector's length, 3 words.
        NORMALS_LENGTH: u32 = 1;
        /// Unit vector and coefficient, 4 words.
        NORMALS_FLOAT: u32 = 2;
        /// Octahedral 2 x snorm16, ambient 1: the model's own normals, 1 word.
        NORMALS_OWN: u32 = 3;
        /// `RenderMaterial::flags`: the normal turns round on back faces.
        MATERIAL_FLIP: u32 = 1;
        /// `RenderMaterial::flags`: the base colour is shown as it is.
        MATERIAL_UNLIT: u32 = 2;
        /// `RenderLight::kind`.
        LIGHT_DIRECTIONAL: u32 = 0;
        /// `RenderLight::kind`.
        LIGHT_POINT: u32 = 1;
        /// `RenderLight::kind`.
        LIGHT_SPOT: u32 = 2;
        /// Channel of the G-buffer: shading normal and ambient coefficient.
        CHANNEL_NORMAL: u32 = 0;
        /// Linear eye depth.
        CHANNEL_DEPTH: u32 = 1;
        /// Base colour.
        CHANNEL_ALBEDO: u32 = 2;
        /// Light by eq. 1, and S.
        CHANNEL_SHADE: u32 = 3;
        /// Places of the shadow filter on the model, four texels each.
        SURFACE_TAPS: i32 = 4;
        /// Places of the shadow filter on the ground.
        GROUND_TAPS: i32 = 16;
        /// The ground's filter is so much wider: it lies farther from its casters.
        GROUND_SPREAD: f32 = 3.0;
        /// `RenderFrame::background`: a neutral gradient.
        BACKGROUND_NEUTRAL: u32 = 0;
        /// `RenderFrame::background`: a clear sky.
        BACKGROUND_SKY: u32 = 1;
        /// Smallest ambient coefficient of the length encoding: a vector of length 0 would have no
        /// direction.
        LENGTH_MIN_AMBIENT: f32 = 0.00390625;
    }
    structs {
        /// Everything that is the same for a whole view. Positions and directions are in the
        /// geometry's frame (world axes, relative to its origin); colours are linear.
        RenderFrame {
            /// Relative position to clip, depth reversed.
            relative_to_clip: [[f32; 4]; 4],
            /// Relative position to the sun's clip, depth reversed.
            relative_to_sun: [[f32; 4]; 4],
            /// Camera, relative.
            eye: [f32; 3],
            /// Factor on the light before it is encoded.
            exposure: f32,
            /// Unit direction of view.
            forward: [f32; 3],
            /// Bits: which of ambient (1) and direct (2) light is added.
            terms: u32,
            /// Half the picture's width at distance 1, along the right vector.
            right: [f32; 3],
            /// Edge of a shadow texel, metres.
            shadow_texel: f32,
            /// Half the picture's height at distance 1, along the up vector.
            up: [f32; 3],
            /// Radius of the shadow filter over the map's edge.
            shadow_radius: f32,
            /// Unit vector to the sun.
            sun_direction: [f32; 3],
            /// Depth of the shadow map's whole range, metres.
            shadow_range: f32,
            /// Intensity of the sun.
            sun_color: [f32; 3],
            /// Number of punctual lights.
            light_count: u32,
            /// Ambient intensity from above.
            sky_zenith: [f32; 3],
            /// Which background.
            background: u32,
            /// Ambient intensity from below.
            sky_ground: [f32; 3],
            /// Height of the ground plane.
            ground_height: f32,
            /// Base colour of the ground.
            ground_albedo: [f32; 3],
            /// Distance from the subject at which the ground has faded, metres; 0 = no ground.
            ground_radius: f32,
            /// Background at the horizon and below.
            horizon_color: [f32; 3],
            /// Radius of the sphere that stands for the crown over the ground, metres.
            crown_radius: f32,
            /// Background high up.
            zenith_color: [f32; 3],
            /// Share of the sky that the crown hides.
            crown_opacity: f32,
            /// Centre of that sphere, relative.
            crown_centre: [f32; 3],
            /// Distance that counts as far in drawn depths, metres.
            depth_scale: f32,
            /// Base colour of untextured views.
            clay: [f32; 3],
            /// Distance of the near plane, metres: eye depth is near / depth.
            near: f32,
            /// A pixel's edges over half the picture's.
            pixel: [f32; 2],
            /// Reach of the shadow filter, texels.
            shadow_reach: f32,
        }

        /// Push constants of one draw: a material.
        RenderMaterial {
            /// Linear RGBA factor.
            base_color: [f32; 4],
            /// First row of the texture transform.
            texcoord_u: [f32; 3],
            /// Alpha below it is cut away; 0 = nothing is.
            cutoff: f32,
            /// Second row of the texture transform.
            texcoord_v: [f32; 3],
            /// Specular coefficient k_s.
            specular: f32,
            /// Emitted light.
            emissive: [f32; 3],
            /// Exponent n of the specular term.
            shininess: f32,
            /// Colour of transmitted light times its share.
            transmission: [f32; 3],
            /// `MATERIAL_*` bits.
            flags: u32,
            /// Place in the table of materials.
            id: u32,
        }

        /// A punctual light, relative to the geometry's origin.
        RenderLight {
            /// Position, metres.
            position: [f32; 3],
            /// `LIGHT_*`.
            kind: u32,
            /// Unit direction of travel.
            direction: [f32; 3],
            /// Range, metres; 0 = unlimited.
            range: f32,
            /// Linear intensity over pi: what a white surface reflects at distance 1.
            color: [f32; 3],
            /// Cosine of the outer half-angle of a spot.
            cos_outer: f32,
            /// 1 / (cos inner - cos outer).
            cone_scale: f32,
        }

        /// Push constants of the draws of overlays (implicit surface, slice).
        RenderOverlay {
            /// Corner of the slice, relative, or nothing.
            corner: [f32; 3],
            /// Opacity.
            opacity: f32,
            /// First edge of the slice.
            edge_u: [f32; 3],
            /// Unused, keeps the layout plain.
            reserved: u32,
            /// Second edge of the slice.
            edge_v: [f32; 3],
            /// Linear base colour of the surface.
            color: [f32; 3],
        }

        /// One evaluation of eq. 1 by `render/shade.comp`.
        ShadeProbe {
            /// Octahedral normal, 2 x snorm16.
            normal: u32,
            /// Ambient coefficient.
            ambient: f32,
            /// Base colour.
            albedo: [f32; 3],
            /// k_s.
            specular: f32,
            /// n.
            shininess: f32,
            /// Shadow term S.
            shadow: f32,
            /// Unit vector to the light.
            to_light: [f32; 3],
            /// Unit vector to the eye.
            to_eye: [f32; 3],
            /// Intensity of the light.
            light: [f32; 3],
            /// Transmitted share.
            transmission: [f32; 3],
        }

        /// Push constants of `render/shade.comp`.
        ShadeProbes {
            /// Ambient intensity from above.
            sky_zenith: [f32; 3],
            /// Ambient intensity from below.
            sky_ground: [f32; 3],
            /// Number of probes.
            count: u32,
        }
    }
}
