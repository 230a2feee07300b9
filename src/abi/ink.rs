//! What the shaders of `ink` share with Rust.

use bytemuck::{Pod, Zeroable};

use super::StructLayout;
use super::glsl_text::{GlslLiteral, GlslType};

abi! {
    constants {
        /// Attribute of stage 1: base colour, and 1 in w.
        INK_ALBEDO: u32 = 0;
        /// Shading normal (world), and tone: 0 black to 1 white.
        INK_NORMAL: u32 = 1;
        /// Linear eye depth; 0 where nothing is.
        INK_DEPTH: u32 = 2;
        /// Style and object in one (style times `INK_OBJECTS` plus object), and cluster; each plus 1.
        /// Exact as floats up to 2^24.
        INK_IDS: u32 = 3;
        /// Projection of the cluster's normal into the picture (x right, y down), not normalised.
        INK_DIRECTION: u32 = 4;
        /// Hatch coordinates within their tile, texels of the finest level a pixel spans (log2).
        INK_HATCH: u32 = 5;
        /// Styles of one picture at most.
        INK_STYLES: u32 = 8;
        /// Objects of one picture at most; the upper half are wood.
        INK_OBJECTS: u32 = 2097152;
        /// Part of the order of leaves over which one shrinks before it is dropped.
        INK_FADE: f32 = 0.04;
        /// Texels along an edge of the shape of a leaf.
        INK_SHAPE_SIZE: u32 = 160;
        /// Steps of the silhouette search at most.
        INK_WALK: u32 = 96;
        /// Half width at most to which lines are widened, pixels.
        INK_WIDEN: i32 = 6;
        /// Texels along a tile of hatching at its finest level.
        INK_TILE: u32 = 512;
        /// Levels of hatching, from the finest.
        INK_LEVELS: u32 = 5;
        /// Texels along and across a band of silhouette strokes.
        INK_BAND_LENGTH: u32 = 256;
        /// Texels across a band.
        INK_BAND_WIDTH: u32 = 32;
        /// Strokes run round branches.
        INK_STROKES_ROUND: u32 = 0;
        /// Along branches.
        INK_STROKES_ALONG: u32 = 1;
        /// On a smooth body, by its clusters.
        INK_STROKES_BODY: u32 = 2;
        /// Hatching on the clusters' fronts.
        INK_HATCH_CLUSTER: u32 = 0;
        /// Hatching on the screen.
        INK_HATCH_SCREEN: u32 = 1;
        /// Hatching on the clusters' spheres.
        INK_HATCH_OBJECT: u32 = 2;
        /// Depths as they are, over the range of the scene.
        INK_DEPTH_LINEAR: u32 = 0;
        /// Depths by equation 1 of Deussen and Strothotte 2000.
        INK_DEPTH_MAPPED: u32 = 1;
    }
    structs {
        /// A leaf, flat.
        InkLeaf {
            /// Middle, in the geometry's frame.
            centre: [f32; 3],
            /// Radius of the disc around its outline, metres.
            radius: f32,
            /// Unit normal.
            normal: [f32; 3],
            /// Object.
            object: u32,
            /// Unit direction from base to tip, in its plane.
            axis: [f32; 3],
            /// Row of its shape.
            shape: u32,
            /// Unit normal of the crown about the leaf.
            crown_normal: [f32; 3],
            /// Ambient coefficient of the crown there.
            ambient: f32,
            /// Texture coordinates of the middle.
            texcoord: [f32; 2],
            /// Their change per radius across.
            texcoord_across: [f32; 2],
            /// Their change per radius along.
            texcoord_along: [f32; 2],
            /// Mean linear colour of the texture over the leaf.
            colour: [f32; 3],
        }

        /// What the style of a leaf makes of it.
        InkPlacement {
            /// Style.
            style: u32,
            /// Cluster, of those of the style.
            cluster: u32,
            /// Place in the fixed random order in which leaves are dropped, 0 to 1.
            rank: f32,
        }

        /// What stage 1 and lines need of a style.
        InkStyle {
            /// Towards the cluster's sphere, 0 to 1 (beta).
            displacement: f32,
            /// From the leaf's own normal to the cluster's, 0 to 1 (sigma).
            orientation: f32,
            /// From there to facing the viewer, 0 to 1.
            facing: f32,
            /// Factor on the size.
            size: f32,
            /// Threshold of the shape: 1 leaf, 0 disc (tau).
            shape: f32,
            /// Share of the leaves that is drawn.
            kept: f32,
            /// From the cluster's normal to the crown's in shading, 0 to 1.
            crown: f32,
            /// Packing of strokes towards the limb (c of equation 8).
            packing: f32,
            /// Its steps; 0: smooth.
            packing_steps: f32,
            /// `INK_HATCH_*`.
            hatch_space: u32,
            /// Pixels for a texel of hatching where it has the style's size.
            hatch_texel: f32,
            /// 1 where strokes are chosen from levels, 0 where they are painted on.
            hatch_levels: u32,
            /// Light from all around, 0 to 1.
            ambient: f32,
            /// How far crowns darken leaves within, 0 to 1.
            depth_of_crown: f32,
            /// Tiles of hatching per metre of wood.
            wood_tiles: f32,
            /// How strokes run on wood: `INK_STROKES_*`.
            wood_strokes: u32,
            /// Strength of contours, 0 to 1.
            contour: f32,
            /// Half width of contours, pixels.
            half_width: f32,
            /// How far sunlight reaches round a surface, 0 (Lambert) to 1.
            wrap: f32,
            /// Share of the sun that shadows take, 0 to 1.
            shadow: f32,
            /// How far the ambient coefficient shortens normals, 0 to 1.
            shorten: f32,
            /// Length over width, against what the leaf has.
            elongation: f32,
            /// From the leaf's own axis to round the cluster, 0 to 1.
            swirl: f32,
            /// From the texture to one colour a leaf, 0 to 1.
            flatness: f32,
            /// Differences between the colours of leaves, 0 to 1.
            variation: f32,
            /// Streaks of a brush along leaves, 0 to 1.
            bristles: f32,
        }

        /// Where a part of a mix is, besides its objects, materials and mask.
        InkPart {
            /// Least eye depth that is part of it, metres.
            nearest: f32,
            /// First eye depth that is not.
            farthest: f32,
            /// Its style.
            style: u32,
        }

        /// A cluster in one view.
        InkCluster {
            /// Centre, in the geometry's frame.
            centre: [f32; 3],
            /// Radius, at least that of a leaf.
            radius: f32,
            /// Centre in the picture, pixels (y down).
            pixel: [f32; 2],
            /// Radius of its outline, pixels; 0 where the camera is in it or before it.
            pixel_radius: f32,
            /// Eye depth of its front point.
            front: f32,
            /// Angles on the sphere about the front point for a pixel to the right and for one
            /// upwards: to the right (x, y) and upwards (z, w) as the eye sees the sphere.
            to_angles: [f32; 4],
            /// Texture coordinates of its centre.
            reference: [f32; 2],
            /// The picture's direction along which v grows, unit, x right, y up.
            texture_up: [f32; 2],
            /// Tiles of hatching per half turn, along u and v (m, n).
            tiles: [f32; 2],
        }

        /// What is the same for a whole view.
        InkFrame {
            /// Relative position to clip, depth reversed.
            relative_to_clip: [[f32; 4]; 4],
            /// Camera, relative.
            eye: [f32; 3],
            /// Focal length, pixels.
            focal: f32,
            /// Unit direction of view.
            forward: [f32; 3],
            /// Pixels across.
            width: u32,
            /// Unit vector to the right of the picture.
            right: [f32; 3],
            /// Pixels down.
            height: u32,
            /// Unit vector upwards in the picture.
            up: [f32; 3],
            /// Nearest eye depth of the plants.
            nearest: f32,
            /// Unit vector to the sun.
            to_sun: [f32; 3],
            /// Farthest eye depth of the plants.
            farthest: f32,
            /// Parts of a mix of styles; 0: one style.
            parts: u32,
            /// 1 where parts have masks, a word of a bit for each part per pixel.
            masked: u32,
            /// By how much wood is thickened, pixels.
            wood: f32,
        }

        /// Push constants of leaves of one material.
        InkLeafDraw {
            /// Linear RGBA factor.
            base_color: [f32; 4],
            /// First row of the texture transform.
            texcoord_u: [f32; 3],
            /// Second row of the texture transform.
            texcoord_v: [f32; 3],
        }

        /// Push constants of wood of one material.
        InkWoodDraw {
            /// Linear RGBA factor.
            base_color: [f32; 4],
            /// First row of the texture transform.
            texcoord_u: [f32; 3],
            /// Alpha below it is cut away.
            cutoff: f32,
            /// Second row of the texture transform.
            texcoord_v: [f32; 3],
            /// Object.
            object: u32,
            /// `INK_STROKES_BODY` for smooth bodies; of wood the style says how strokes run.
            strokes: u32,
            /// Bits of the parts of a mix that it may be, by its object and material.
            parts: u32,
        }

        /// Push constants of the hatch coordinates of many places.
        InkPlaces {
            /// Places.
            count: u32,
            /// Clusters, taken in turn.
            clusters: u32,
            /// Tiles of hatching per metre.
            tiles: f32,
            /// Whether strokes run along branches instead of round them.
            along: u32,
        }

        /// Push constants of the contour.
        InkContour {
            /// Pixels across.
            width: u32,
            /// Pixels down.
            height: u32,
            /// Least difference of depth that is a contour of leaves, in shares of the range.
            threshold: f32,
            /// The same for wood.
            threshold_wood: f32,
            /// `INK_DEPTH_*`.
            mapping: u32,
            /// z0 of the mapping.
            nearest: f32,
            /// z1 of the mapping.
            farthest: f32,
            /// How much the threshold grows where clusters face the viewer (k).
            detail: f32,
            /// Power of the cosine in it (q).
            detail_power: f32,
            /// Style whose pixels are worked on, in a mix.
            style: u32,
            /// Whether pixels of other styles are set to nothing, instead of left as they are.
            clears: u32,
        }

        /// Push constants of the removal of isolated pixels.
        InkClean {
            /// Pixels across.
            width: u32,
            /// Pixels down.
            height: u32,
            /// Neighbours that a contour pixel needs to stay.
            neighbours: u32,
            /// Style whose pixels are worked on, in a mix.
            style: u32,
            /// Whether pixels of other styles are set to nothing, instead of left as they are.
            clears: u32,
        }

        /// Push constants of the silhouette.
        InkSilhouette {
            /// Pixels across.
            width: u32,
            /// Pixels down.
            height: u32,
            /// Pixels that are searched for the contour (p).
            reach: f32,
            /// Length of the strokes' image, pixels (L).
            band_length: f32,
            /// Aspect of the strokes (c').
            aspect: f32,
            /// Whether two channels are blended instead of one chosen.
            blend: u32,
            /// Style whose pixels are worked on, in a mix.
            style: u32,
            /// Whether pixels of other styles are set to nothing, instead of left as they are.
            clears: u32,
        }

        /// Push constants of the composition.
        InkCompose {
            /// Linear colour of the paper.
            paper: [f32; 3],
            /// Pixels across.
            width: u32,
            /// Linear colour of the ink.
            ink: [f32; 3],
            /// Pixels down.
            height: u32,
            /// Strength of silhouette strokes, 0 to 1.
            silhouette: f32,
            /// Strength of hatching.
            hatching: f32,
            /// Share of the model's colours over the paper's.
            colour: f32,
            /// Share of shading in what is under the lines.
            shading: f32,
            /// Half width of the widest contours, pixels.
            half_width: f32,
            /// Style whose pixels are composed.
            style: u32,
            /// Steps of shading; 0: smooth.
            steps: f32,
            /// Tone from which on nothing is hatched.
            white: f32,
            /// Exponent on the darkness that hatching gives.
            gamma: f32,
            /// Share of the steps in shading, 0 to 1.
            hardness: f32,
            /// Linear colour of sunlight.
            sun: [f32; 3],
            /// Factor on the light.
            exposure: f32,
            /// Linear colour of the light from all around.
            sky: [f32; 3],
            /// Strength of edges in the normals.
            edges: f32,
            /// Share of the wash in what is under the lines.
            wash: f32,
        }
    }
}
