#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "ink_leaf.glsl"
#include "ink_raster.glsl"

// A leaf as the sun sees it: placed as in the picture, with its shape and nothing else.

layout(set = 0, binding = 0, scalar) restrict readonly buffer Frame { InkFrame frame; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Leaves { InkLeaf leaves[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Clusters { InkCluster clusters[]; };
layout(set = 0, binding = 4, scalar) restrict readonly buffer Styles { InkStyle styles[]; };
layout(set = 0, binding = 5, scalar) restrict readonly buffer Placements { InkPlacement placements[]; };

// Leaves have styles; otherwise all have the first.
layout(constant_id = 6) const bool MIXED = false;

layout(location = 0) out vec2 out_local;
layout(location = 1) flat out uint out_shape;
layout(location = 2) flat out float out_threshold;

const vec2 CORNERS[6] = vec2[](vec2(-1.0, -1.0), vec2(1.0, -1.0), vec2(1.0, 1.0),
                               vec2(-1.0, -1.0), vec2(1.0, 1.0), vec2(-1.0, 1.0));

void main() {
    uint vertex = uint(gl_VertexIndex);
    InkLeaf leaf = leaves[vertex / 6u];
    vec2 local = CORNERS[vertex % 6u];
    InkPlacement placement = placements[vertex / 6u];
    InkStyle style = styles[MIXED ? placement.style : 0u];
    InkCluster cluster = clusters[placement.cluster];
    vec3 outward = cluster_normal(leaf, cluster);
    vec3 position = leaf_corner(leaf, cluster, style, placement.rank, outward, frame.forward, local);
    out_local = local;
    out_shape = leaf.shape;
    out_threshold = style.shape;
    gl_Position = on_raster(to_clip(frame.relative_to_clip, vec4(position, 1.0)), vec2(frame.width, frame.height));
}
