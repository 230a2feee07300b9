#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"

// Normals of the surface where it is nearest: of a vertex (the paper's way), or interpolated
// over a triangle. The fourth component says that there is one.

layout(local_size_x = GROUP_1D) in;
layout(constant_id = 0) const uint FACES = 0;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Nearest { vec4 nearest[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Indices { uint indices[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Normals { vec4 normals[]; };
layout(set = 0, binding = 3, scalar) restrict writeonly buffer Found { vec4 found[]; };
layout(push_constant, scalar) uniform Push { Count push; };

void main() {
    uint i = flat_invocation();
    if (i >= push.count) {
        return;
    }
    uint number = floatBitsToUint(nearest[i].x);
    if (FACES == 0u) {
        found[i] = vec4(normals[number].xyz, 1.0);
        return;
    }
    vec3 weights = nearest[i].yzw;
    vec3 first = normals[indices[3u * number]].xyz;
    vec3 sum = weights.x * first + weights.y * normals[indices[3u * number + 1u]].xyz
        + weights.z * normals[indices[3u * number + 2u]].xyz;
    float size = length(sum);
    found[i] = vec4(size > 0.0 ? sum / size : first, 1.0);
}
