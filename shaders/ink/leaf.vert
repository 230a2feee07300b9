#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "ink_leaf.glsl"
#include "tone.glsl"

// A leaf: moved towards its cluster's sphere, turned, enlarged, on a square that its shape fits in.

layout(set = 0, binding = 0, scalar) restrict readonly buffer Frame { InkFrame frame; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Leaves { InkLeaf leaves[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Clusters { InkCluster clusters[]; };
layout(set = 0, binding = 4, scalar) restrict readonly buffer Styles { InkStyle styles[]; };
layout(set = 0, binding = 5, scalar) restrict readonly buffer Placements { InkPlacement placements[]; };
layout(push_constant, scalar) uniform Push { InkLeafDraw push; };

layout(location = 0) out vec3 out_position;
layout(location = 1) out vec2 out_local;
layout(location = 2) out vec2 out_texcoord;
layout(location = 3) flat out vec4 out_normal;
layout(location = 4) flat out uvec4 out_ids;
layout(location = 5) flat out vec2 out_direction;

const vec2 CORNERS[6] = vec2[](vec2(-1.0, -1.0), vec2(1.0, -1.0), vec2(1.0, 1.0),
                               vec2(-1.0, -1.0), vec2(1.0, 1.0), vec2(-1.0, 1.0));

void main() {
    uint vertex = uint(gl_VertexIndex);
    InkLeaf leaf = leaves[vertex / 6u];
    vec2 local = CORNERS[vertex % 6u];
    InkPlacement placement = placements[vertex / 6u];
    InkStyle style = styles[placement.style];
    InkCluster cluster = clusters[placement.cluster];
    vec3 outward = cluster_normal(leaf, cluster);
    vec3 place = displaced(leaf, cluster, outward, style.displacement);
    // Facing means parallel to the picture: depth is constant over the leaf, so that no threshold of
    // contours depends on the place in the picture.
    vec3 normal = turned_normal(leaf, outward, -frame.forward, style.orientation, style.facing);
    vec3 axis = turned_axis(leaf.axis, leaf.normal, normal);
    float radius = placement.rank < style.kept ? leaf.radius * style.size : 0.0;
    vec3 position = place + radius * (local.x * cross(axis, normal) + local.y * axis);

    vec3 round_normal = normalize(mix(outward, leaf.crown_normal, style.crown));
    vec3 shading = normalize(mix(normal, round_normal, max(style.orientation, style.crown)));
    float open = 1.0 - style.depth_of_crown * (1.0 - leaf.ambient);
    out_position = position;
    out_local = local;
    vec2 uv = leaf.texcoord + local.x * leaf.texcoord_across + local.y * leaf.texcoord_along;
    out_texcoord = vec2(dot(push.texcoord_u, vec3(uv, 1.0)), dot(push.texcoord_v, vec3(uv, 1.0)));
    out_normal = vec4(shading, ink_tone(shading, frame.to_sun, style.ambient, open));
    out_ids = uvec4(leaf.object, placement.cluster, leaf.shape, placement.style);
    out_direction = vec2(dot(outward, frame.right), -dot(outward, frame.up));
    gl_Position = frame.relative_to_clip * vec4(position, 1.0);
}
