//! Every struct and constant shared with shaders, once.
//!
//! `build.rs` includes this file and serves [`glsl`] to the shader compiler as
//! `#include "abi.glsl"`; the tests compare the offsets in the SPIR-V with `offset_of!`. The
//! device uses scalar block layout, so `#[repr(C)]` of these field types is the same layout.

use bytemuck::{Pod, Zeroable};

// The path is written out because build.rs includes this file from another folder's module tree.
#[path = "abi/glsl.rs"]
mod glsl_text;

use glsl_text::GlslLiteral;
pub use glsl_text::GlslType;

/// A struct's layout as the host sees it, for the comparison with SPIR-V.
#[derive(Debug, Clone)]
pub struct StructLayout {
    /// Name in both languages.
    pub name: &'static str,
    /// `size_of`.
    pub size: usize,
    /// (field, offset) in order.
    pub fields: Vec<(&'static str, usize)>,
}

/// Declares structs and constants for Rust and GLSL at once.
///
/// Constants are `u32`, `i32` or `f32`; structs hold [`GlslType`] fields only.
macro_rules! abi {
    (
        constants { $( $(#[$cdoc:meta])* $cname:ident: $cty:ident = $cval:expr; )* }
        structs { $( $(#[$sdoc:meta])* $sname:ident { $( $(#[$fdoc:meta])* $field:ident: $fty:ty ),* $(,)? } )* }
    ) => {
        $( $(#[$cdoc])* pub const $cname: $cty = $cval; )*
        $(
            $(#[$sdoc])*
            #[repr(C)]
            #[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
            pub struct $sname { $( $(#[$fdoc])* pub $field: $fty ),* }
        )*

        /// The GLSL text of every constant and struct above.
        #[must_use]
        pub fn glsl() -> String {
            let mut out = String::from("#ifndef ABI_GLSL\n#define ABI_GLSL\n");
            $( out.push_str(&format!("const {} {} = {};\n",
                <$cty as GlslType>::GLSL, stringify!($cname), GlslLiteral::literal(&$cname))); )*
            $(
                out.push_str(concat!("struct ", stringify!($sname), " {\n"));
                $( out.push_str(&format!("    {} {};\n", <$fty as GlslType>::GLSL, stringify!($field))); )*
                out.push_str("};\n");
            )*
            out.push_str("#endif\n");
            out
        }

        /// Host layouts of every struct above.
        #[must_use]
        pub fn layouts() -> Vec<StructLayout> {
            vec![$( StructLayout {
                name: stringify!($sname),
                size: size_of::<$sname>(),
                fields: vec![$( (stringify!($field), std::mem::offset_of!($sname, $field)) ),*],
            } ),*]
        }
    };
}

abi! {
    constants {
        /// Invocations per group of one-dimensional kernels.
        GROUP_1D: u32 = 64;

        // ---- foliage ----

        /// Values that one invocation of the scan adds up.
        SCAN_CHUNK: u32 = 256;
        /// Invocations that share one tile of nodes or block of queries; each takes every
        /// `FIELD_SLOTS`-th generator.
        FIELD_SLOTS: u32 = 8;
        /// Nodes of a tile along each axis of the density grid.
        TILE_SIDE: u32 = 4;
        /// Nodes of a tile.
        TILE_NODES: u32 = 64;
        /// Queries of a block of the field kernel.
        BLOCK_QUERIES: u32 = 32;
        /// Invocations of a group of the field kernel: as many as 16 KiB of shared memory hold.
        FIELD_GROUP: u32 = 32;
        /// What the field kernel adds up: the density.
        FIELD_DENSITY: u32 = 0;
        /// The gradient, without the density.
        FIELD_GRADIENT: u32 = 1;
        /// Both.
        FIELD_BOTH: u32 = 2;
        /// Bits of a generator's index that select its column in the generator image.
        GENERATOR_COLUMN_BITS: u32 = 10;
        /// Culling is this much wider than the support, against rounding of bins.
        CULL_MARGIN: f32 = 1e-5;
        /// Vector norms of equation 2, in the order of `foliage::Norm`.
        NORM_EUCLIDEAN: u32 = 0;
        /// L1.
        NORM_MANHATTAN: u32 = 1;
        /// L-infinity.
        NORM_MAXIMUM: u32 = 2;
        /// Invocations that sweep one direction of the skylight.
        SKY_GROUP: u32 = 256;
        /// `directions.comp`: direction of one gradient.
        DIRECTIONS_SINGLE: u32 = 0;
        /// `directions.comp`: mean of the directions of two gradients.
        DIRECTIONS_MEAN: u32 = 1;
        /// `directions.comp`: keeps the directions there are and fills the gaps.
        DIRECTIONS_FILL: u32 = 2;
        /// Smallest ambient coefficient of the length encoding, 1 / 255.
        SMALLEST_AMBIENT: f32 = 0.003921569;
        /// Encodings, in the order of `foliage::Encoding`.
        ENCODING_LENGTH: u32 = 0;
        /// Octahedral 2 x snorm16 + unorm16.
        ENCODING_PACKED16: u32 = 1;
        /// Octahedral 2 x snorm8 + unorm8.
        ENCODING_PACKED8: u32 = 2;
        /// Items or boxes in one box of the hierarchy over the implicit surface.
        BOX_CHILDREN: u32 = 8;
        /// Neighbouring queries that one invocation of `nearest.comp` takes at once, of triangles:
        /// their code is long, and drivers take seconds to compile it for more.
        NEAREST_FACE_QUERIES: u32 = 8;
        /// Neighbouring queries that one invocation of `nearest.comp` takes at once, of vertices.
        NEAREST_QUERIES: u32 = 32;
        /// Generators that `exact.comp` adds in one round of its loop.
        EXACT_BATCH: u32 = 8;
        /// Newton steps onto the surface at most (`exact.comp`).
        EXACT_NEWTON_STEPS: u32 = 20;
        /// Descent steps along the surface at most (`exact.comp`).
        EXACT_DESCENT_STEPS: u32 = 200;
        /// Steps shorter than this share of the radius have arrived (`exact.comp`).
        EXACT_TOLERANCE: f32 = 1e-5;
        /// Below this |grad D| times the radius a Newton step leads nowhere (`exact.comp`).
        EXACT_SLOPE_FLOOR: f32 = 1e-6;
        /// Below this |grad D| times the radius the gradient has no direction.
        GRADIENT_FLOOR: f32 = 1e-3;
        /// Below this length a mean of unit vectors has no direction.
        OPPOSITE_FLOOR: f32 = 1e-3;

        // ---- render ----

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
        // ---- foliage: the implicit surface ----

        /// Push constants of the kernels that walk the grid (`foliage/surface_*.comp`,
        /// `foliage/sample.comp`).
        SurfaceGrid {
            /// Position of node (0,0,0).
            origin: [f32; 3],
            /// Cell size.
            cell: f32,
            /// Nodes per axis.
            nodes: [u32; 3],
            /// Threshold; inside is strictly above.
            tau: f32,
            /// Vertices of the surface (`surface_normals.comp`) or points (`sample.comp`).
            count: u32,
            /// Radius of influence (`surface_normals.comp`).
            radius: f32,
        }

        /// Push constants of kernels that need to know only how many there are.
        Count {
            /// Items.
            count: u32,
        }

        /// Push constants of `foliage/surface_boxes.comp`.
        BoxLevel {
            /// Boxes of this level.
            count: u32,
            /// Items or boxes of the level below.
            children: u32,
            /// 0: over items.
            level: u32,
            /// First box of this level.
            first: u32,
            /// First box of the level below.
            child_first: u32,
        }

        /// Push constants of `foliage/nearest.comp`.
        NearestQueries {
            /// Queries.
            count: u32,
            /// Items in the hierarchy.
            items: u32,
            /// Levels of boxes.
            levels: u32,
            /// Level whose boxes this dispatch walks, counted from 1.
            root_level: u32,
            /// First of these boxes.
            root_first: u32,
            /// The box after the last.
            root_last: u32,
            /// Whether an earlier dispatch has left something in the result.
            continues: u32,
        }

        /// Push constants of `foliage/exact.comp`.
        ExactQueries {
            /// Corner of bin (0,0,0).
            bin_origin: [f32; 3],
            /// Edge of a bin.
            bin_edge: f32,
            /// Bins per axis.
            bins: [u32; 3],
            /// Radius of influence.
            radius: f32,
            /// Queries.
            count: u32,
            /// Threshold.
            tau: f32,
        }

        // ---- gpu ----

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

        // ---- foliage ----

        /// Push constants of `foliage/generators.comp`.
        LeafCentres {
            /// Leaves.
            count: u32,
        }

        /// Push constants of `foliage/scan_sums.comp` and `foliage/scan_apply.comp`.
        Scan {
            /// Values to add up.
            count: u32,
            /// Whether `scan_apply` adds the scanned chunk sums of `bases`.
            has_bases: u32,
        }

        /// Push constants of the kernels that sort points into bins.
        BinPoints {
            /// Corner of bin (0,0,0).
            origin: [f32; 3],
            /// 1 / edge of a bin.
            inverse_edge: f32,
            /// Bins per axis.
            bins: [u32; 3],
            /// Points.
            count: u32,
            /// 0: bins in rows, x fastest; 1: bins in Morton order.
            morton: u32,
            /// 0: generators weigh what they stand for; otherwise their area times this.
            area_scale: f32,
        }

        /// Push constants of `foliage/density.comp`.
        DensityGrid {
            /// Position of node (0,0,0).
            origin: [f32; 3],
            /// Cell size.
            cell: f32,
            /// Nodes per axis.
            nodes: [u32; 3],
            /// Radius of influence.
            radius: f32,
            /// Corner of bin (0,0,0).
            bin_origin: [f32; 3],
            /// Edge of a bin.
            bin_edge: f32,
            /// Bins per axis.
            bins: [u32; 3],
        }

        /// Push constants of `foliage/leaf_share.comp`.
        LeafShare {
            /// Triangles.
            count: u32,
        }

        /// Push constants of `foliage/sky_depth.comp`.
        SkyDepth {
            /// Nodes per axis of the leaf-area grid.
            nodes: [u32; 3],
            /// Cell size.
            cell: f32,
            /// First direction of the batch.
            first: u32,
            /// Directions of the batch: groups of `SKY_GROUP` invocations.
            count: u32,
        }

        /// Push constants of `foliage/sky_light.comp`.
        SkyLight {
            /// Nodes.
            node_count: u32,
            /// First direction of the batch; 0 starts the sum.
            first: u32,
            /// Directions of the batch.
            count: u32,
            /// 1 / all directions.
            share: f32,
            /// Extinction per leaf area: 0.5 for leaves at random angles.
            extinction: f32,
            /// Cell size.
            cell: f32,
        }

        /// Push constants of `foliage/sky_gather.comp`.
        SkyGather {
            /// Position of node (0,0,0).
            origin: [f32; 3],
            /// Cell size.
            cell: f32,
            /// Nodes per axis.
            nodes: [u32; 3],
            /// Points.
            count: u32,
        }

        /// Push constants of `foliage/field.comp`.
        FieldQueries {
            /// Corner of bin (0,0,0).
            bin_origin: [f32; 3],
            /// Edge of a bin.
            bin_edge: f32,
            /// Bins per axis.
            bins: [u32; 3],
            /// Radius of influence.
            radius: f32,
            /// Queries.
            count: u32,
        }

        // ---- render ----

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
        /// Push constants of `foliage/directions.comp`.
        GradientDirections {
            /// Queries.
            count: u32,
            /// Radius of the first field.
            radius: f32,
            /// Radius of the second field.
            wide_radius: f32,
        }

        /// Push constants of `foliage/realign.comp`.
        Realign {
            /// Vertices.
            count: u32,
            /// Share of the realigned normal.
            blend: f32,
        }

        /// Push constants of `foliage/ambient.comp` (Luft, Balzer, Deussen 2007, equation 4).
        AmbientTransfer {
            /// Vertices.
            count: u32,
            /// Threshold, subtracted from the density.
            tau: f32,
            /// Smallest coefficient.
            k_min: f32,
            /// Density (beyond the threshold) from which on it is `k_min`.
            d_min: f32,
            /// Exponent n.
            exponent: f32,
        }

        /// Push constants of `foliage/encode.comp`.
        Encode {
            /// Vertices.
            count: u32,
        }
    }
}
