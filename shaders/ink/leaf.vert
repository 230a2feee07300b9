#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "ink_hatch.glsl"
#include "ink_leaf.glsl"
#include "ink_raster.glsl"
#include "random.glsl"

// A leaf: moved towards its cluster's sphere, turned, enlarged, on a square that its shape fits in.

layout(set = 0, binding = 0, scalar) restrict readonly buffer Frame { InkFrame frame; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Leaves { InkLeaf leaves[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Clusters { InkCluster clusters[]; };
layout(set = 0, binding = 4, scalar) restrict readonly buffer Styles { InkStyle styles[]; };
layout(set = 0, binding = 5, scalar) restrict readonly buffer Placements { InkPlacement placements[]; };
layout(push_constant, scalar) uniform Push { InkLeafDraw push; };

// Leaves have styles; otherwise all have the first.
layout(constant_id = 6) const bool MIXED = false;
// Attributes that the picture has, a bit for each: what none of them takes is not worked out.
layout(constant_id = 7) const uint ATTRIBUTES = 63;

layout(location = 0) out vec3 out_position;
layout(location = 1) out vec2 out_local;
layout(location = 2) out vec2 out_texcoord;
layout(location = 3) flat out vec4 out_normal;
layout(location = 4) flat out uvec4 out_ids;
layout(location = 5) flat out vec2 out_direction;
layout(location = 6) flat out vec4 out_colour;
layout(location = 7) flat out vec3 out_tint;
layout(location = 8) flat out vec4 out_crown;
layout(location = 9) flat out vec4 out_hatch_linear;
layout(location = 10) flat out vec4 out_hatch_middle;
layout(location = 11) flat out vec4 out_hatch_depth;
layout(location = 12) flat out vec3 out_centre;

const vec2 CORNERS[6] = vec2[](vec2(-1.0, -1.0), vec2(1.0, -1.0), vec2(1.0, 1.0),
                               vec2(-1.0, -1.0), vec2(1.0, 1.0), vec2(-1.0, 1.0));

// A leaf's own shade: brightness and hue, both the wider the more they vary.
vec3 leaf_tint(float rank, float variation) {
    uint key = pcg(uint(rank * 16777216.0));
    float bright = exp2(2.0 * variation * (random(key, 0u) - 0.5));
    float warm = random(key, 1u) - 0.5;
    float cold = random(key, 2u) - 0.5;
    return bright * exp2(1.6 * variation * vec3(warm, 0.3 * cold, -warm + cold));
}

bool wanted(uint number) {
    return (ATTRIBUTES >> number & 1u) != 0u;
}

void main() {
    uint vertex = uint(gl_VertexIndex);
    InkLeaf leaf = leaves[vertex / 6u];
    vec2 local = CORNERS[vertex % 6u];
    InkPlacement placement = placements[vertex / 6u];
    InkStyle style = styles[MIXED ? placement.style : 0u];
    InkCluster cluster = clusters[placement.cluster];
    vec3 outward = cluster_normal(leaf, cluster);
    vec3 position = leaf_corner(leaf, cluster, style, placement.rank, outward, frame.forward, local);

    out_position = position;
    out_local = local;
    out_ids = uvec4(leaf.object, placement.cluster, leaf.shape, placement.style);
    out_texcoord = vec2(0.0);
    out_colour = vec4(0.0);
    out_tint = vec3(0.0);
    if (wanted(INK_ALBEDO)) {
        vec2 uv = leaf.texcoord + local.x * leaf.texcoord_across + local.y * leaf.texcoord_along;
        out_texcoord = vec2(dot(push.texcoord_u, vec3(uv, 1.0)), dot(push.texcoord_v, vec3(uv, 1.0)));
        out_colour = vec4(leaf.colour, placement.rank);
        out_tint = leaf_tint(placement.rank, style.variation);
    }
    out_normal = vec4(0.0);
    out_crown = vec4(0.0);
    out_centre = cluster.centre;
    if (wanted(INK_NORMAL)) {
        // A leaf that faces the viewer is lit as it was.
        vec3 lit = turned_normal(leaf, outward, -frame.forward, style.orientation, 0.0);
        float open = 1.0 - style.depth_of_crown * (1.0 - leaf.ambient);
        out_normal = vec4(lit, open);
        out_crown = vec4(leaf.crown_normal, mix(1.0, leaf.ambient, style.shorten));
    }
    out_direction = wanted(INK_DIRECTION)
        ? vec2(dot(outward, frame.right), -dot(outward, frame.up)) : vec2(0.0);
    HatchMap map = HatchMap(vec4(0.0), vec4(0.0), vec4(0.0), 0.0);
    if (wanted(INK_HATCH)) {
        map = hatch_map(cluster, style);
    }
    out_hatch_linear = map.linear;
    out_hatch_middle = map.middle;
    out_hatch_depth = map.depth;
    gl_Position = on_raster(to_clip(frame.relative_to_clip, vec4(position, 1.0)), vec2(frame.width, frame.height));
}
