#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"

// Centres of the surface's triangles, for sorting them.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Vertices { vec4 vertices[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Indices { uint indices[]; };
layout(set = 0, binding = 2, scalar) restrict writeonly buffer Centres { vec4 centres[]; };
layout(push_constant, scalar) uniform Push { Count push; };

void main() {
    uint i = flat_invocation();
    if (i >= push.count) {
        return;
    }
    vec3 sum = vec3(0.0);
    for (uint k = 0u; k < 3u; ++k) {
        sum += vertices[indices[3u * i + k]].xyz;
    }
    centres[i] = vec4(sum / 3.0, 0.0);
}
