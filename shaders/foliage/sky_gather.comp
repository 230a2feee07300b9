#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"

// Light at points, by trilinear interpolation between the nodes (points beyond the grid take the
// nearest): the unit open direction, with w = 1 or 0 where there is none, and the mean
// transmittance, which is the ambient coefficient.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Queries { vec4 queries[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Light { vec4 light[]; };
layout(set = 0, binding = 2, scalar) restrict writeonly buffer Found { vec4 found[]; };
layout(set = 0, binding = 3, scalar) restrict writeonly buffer Ambient { float ambient[]; };
layout(set = 0, binding = 4, scalar) restrict buffer Counters { uint missing; };
layout(push_constant, scalar) uniform Push { SkyGather push; };

vec4 light_at(vec3 q) {
    vec3 u = clamp((q - push.origin) / push.cell, vec3(0.0), vec3(push.nodes - 1u));
    uvec3 low = min(uvec3(u), push.nodes - 2u);
    vec3 t = u - vec3(low);
    vec4 sum = vec4(0.0);
    for (uint corner = 0u; corner < 8u; ++corner) {
        uvec3 bits = uvec3(corner & 1u, (corner >> 1u) & 1u, corner >> 2u);
        vec3 w = mix(1.0 - t, t, vec3(bits));
        uvec3 node = low + bits;
        uint at = node.x + push.nodes.x * (node.y + push.nodes.y * node.z);
        sum += w.x * w.y * w.z * light[at];
    }
    return sum;
}

void main() {
    uint i = flat_invocation();
    if (i >= push.count) {
        return;
    }
    vec4 query = queries[i];
    uint number = floatBitsToUint(query.w);
    vec4 arrived = light_at(query.xyz);
    float size = length(arrived.xyz);
    bool open = size > OPPOSITE_FLOOR;
    found[number] = open ? vec4(arrived.xyz / size, 1.0) : vec4(0.0);
    ambient[number] = clamp(arrived.w, 0.0, 1.0);
    if (!open) {
        atomicAdd(missing, 1u);
    }
}
