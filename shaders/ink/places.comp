#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "ink_body.glsl"
#include "ink_wood.glsl"

// Hatch coordinates of many places on bodies and branches: what stage 1 computes for vertices and
// pixels, for conformance.

layout(local_size_x = 64) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Frame { InkFrame frame; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Places { vec4 places[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Clusters { InkCluster clusters[]; };
layout(set = 0, binding = 3, scalar) restrict writeonly buffer Out { vec4 coordinates[]; };
layout(push_constant, scalar) uniform Push { InkPlaces push; };

void main() {
    uint i = flat_invocation();
    if (i >= push.count) {
        return;
    }
    vec4 place = places[i];
    InkCluster cluster = clusters[i % push.clusters];
    vec2 body = body_hatch(cluster, place.xyz, frame.eye, frame.right, frame.up);
    vec3 wood = wood_hatch(place, vec4(0.0), vec4(0.0), push.tiles, push.along != 0u);
    coordinates[i] = vec4(body, wood.xy);
}
