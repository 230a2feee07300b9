#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"

// N' = normalize((1-b) N + b N_s) (Luft, Balzer, Deussen 2007, section 3.3). Opposite vectors
// fall back to N_s, a missing N_s to N.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Found { vec4 found[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Original { vec3 original[]; };
layout(set = 0, binding = 2, scalar) restrict writeonly buffer Normals { vec3 normals[]; };
layout(push_constant, scalar) uniform Push { Realign push; };

void main() {
    uint i = flat_invocation();
    if (i >= push.count) {
        return;
    }
    vec4 realigned = found[i];
    vec3 n = original[i];
    if (realigned.w != 0.0) {
        vec3 sum = (1.0 - push.blend) * n + push.blend * realigned.xyz;
        float size = length(sum);
        n = size > OPPOSITE_FLOOR ? sum / size : realigned.xyz;
    }
    normals[i] = n;
}
