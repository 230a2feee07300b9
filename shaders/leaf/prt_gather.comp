#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "sh.glsl"

// Adds the escapes of a batch to the transfer vectors: an invocation takes one side of one
// receiver and either the paths that escaped at once or the others.

// Bands of the vectors.
layout(constant_id = 0) const uint ORDER = 5u;
const uint COEFFICIENTS = ORDER * ORDER;

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0) uniform sampler2D rays;
layout(set = 0, binding = 1, scalar) restrict readonly buffer Paths { vec4 paths[]; };
layout(set = 0, binding = 2, scalar) restrict buffer Sums { vec3 sums[]; };
layout(push_constant, scalar) uniform Push { PrtBatch push; };

void main() {
    uint id = flat_invocation();
    if (id >= 2u * push.sides) {
        return;
    }
    uint side = id >> 1u;
    bool indirect = (id & 1u) == 1u;
    vec3 sum[SH_MAX_COEFFICIENTS];
    [[unroll]] for (uint k = 0u; k < COEFFICIENTS; ++k) {
        sum[k] = push.first_sample == 0u ? vec3(0.0) : sums[id * COEFFICIENTS + k];
    }
    for (uint s = 0u; s < push.samples; ++s) {
        uint path = s * push.sides + side;
        vec4 state = paths[path];
        bool counts = state.w >= 0.0 && (state.w > 0.0) == indirect;
        vec3 weight = counts ? state.xyz : vec3(0.0);
        uint texel = 2u * path + 1u;
        vec3 direction = texelFetch(
            rays, ivec2(texel & ((1u << RAY_COLUMN_BITS) - 1u), texel >> RAY_COLUMN_BITS), 0).xyz;
        float sh[SH_MAX_COEFFICIENTS];
        spherical_harmonics(direction, ORDER, sh);
        [[unroll]] for (uint k = 0u; k < COEFFICIENTS; ++k) {
            sum[k] += sh[k] * weight;
        }
    }
    [[unroll]] for (uint k = 0u; k < COEFFICIENTS; ++k) {
        sums[id * COEFFICIENTS + k] = sum[k];
    }
}
