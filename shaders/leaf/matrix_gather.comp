#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "random.glsl"
#include "sh.glsl"

// Adds the escapes of a batch to the transfer matrices: an invocation takes one row (a harmonic of
// the direction in which paths began) of one receiver. The direct part has no colour.

// Bands of the matrices.
layout(constant_id = 0) const uint ORDER = 5u;
const uint COEFFICIENTS = ORDER * ORDER;

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0) uniform sampler2D rays;
layout(set = 0, binding = 1, scalar) restrict readonly buffer Paths { vec4 paths[]; };
// Of every receiver: rows of the direct part, then rows of the indirect one, RGB each.
layout(set = 0, binding = 2, scalar) restrict buffer Sums { float sums[]; };
layout(push_constant, scalar) uniform Push { PrtBatch push; };

void main() {
    uint id = flat_invocation();
    if (id >= push.sides * COEFFICIENTS) {
        return;
    }
    uint side = id / COEFFICIENTS;
    uint row = id % COEFFICIENTS;
    uint direct_at = (4u * side * COEFFICIENTS + row) * COEFFICIENTS;
    uint indirect_at = ((4u * side + 1u) * COEFFICIENTS + 3u * row) * COEFFICIENTS;
    float direct[SH_MAX_COEFFICIENTS];
    vec3 indirect[SH_MAX_COEFFICIENTS];
    bool fresh = push.first_sample == 0u;
    [[unroll]] for (uint k = 0u; k < COEFFICIENTS; ++k) {
        uint at = indirect_at + 3u * k;
        direct[k] = fresh ? 0.0 : sums[direct_at + k];
        indirect[k] = fresh ? vec3(0.0) : vec3(sums[at], sums[at + 1u], sums[at + 2u]);
    }
    for (uint s = 0u; s < push.samples; ++s) {
        uint path = s * push.sides + side;
        vec4 state = paths[path];
        if (state.w < 0.0) {
            continue;
        }
        vec3 u = even_numbers(push.first_side + side, push.first_sample + s, push.seed);
        float sh[SH_MAX_COEFFICIENTS];
        spherical_harmonics(sphere_direction(u.xy), ORDER, sh);
        float own = sh[row];
        uint texel = 2u * path + 1u;
        vec3 direction = texelFetch(
            rays, ivec2(texel & ((1u << RAY_COLUMN_BITS) - 1u), texel >> RAY_COLUMN_BITS), 0).xyz;
        spherical_harmonics(direction, ORDER, sh);
        float first = state.w == 0.0 ? own : 0.0;
        vec3 later = state.w == 0.0 ? vec3(0.0) : own * state.xyz;
        [[unroll]] for (uint k = 0u; k < COEFFICIENTS; ++k) {
            direct[k] += first * sh[k];
            indirect[k] += later * sh[k];
        }
    }
    [[unroll]] for (uint k = 0u; k < COEFFICIENTS; ++k) {
        uint at = indirect_at + 3u * k;
        sums[direct_at + k] = direct[k];
        sums[at] = indirect[k].x;
        sums[at + 1u] = indirect[k].y;
        sums[at + 2u] = indirect[k].z;
    }
}
