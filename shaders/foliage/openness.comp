#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"

// Beer-Lambert transmittance through the leaf-area field along a set of directions: its mean is
// the ambient coefficient of the mode transmittance, the mean of the directions weighted with it
// the normal of the mode open. Midpoint rule with steps of one cell.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Queries { vec4 queries[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer LeafArea { float leaf_area[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Rays { vec4 rays[]; };
layout(set = 0, binding = 3, scalar) restrict writeonly buffer Found { vec4 found[]; };
layout(set = 0, binding = 4, scalar) restrict writeonly buffer Ambient { float ambient[]; };
layout(set = 0, binding = 5, scalar) restrict buffer Counters { uint missing; };
layout(push_constant, scalar) uniform Push { Openness push; };

// Trilinear value at the grid coordinates `u`, clamped to the grid.
float leaf_area_at(vec3 u) {
    vec3 c = clamp(u, vec3(0.0), vec3(push.nodes - 1u));
    uvec3 low = min(uvec3(c), push.nodes - 2u);
    vec3 t = c - vec3(low);
    uint y_stride = push.nodes.x;
    uint z_stride = push.nodes.x * push.nodes.y;
    uint i = low.x + y_stride * low.y + z_stride * low.z;
    float a = mix(leaf_area[i], leaf_area[i + 1u], t.x);
    float b = mix(leaf_area[i + y_stride], leaf_area[i + y_stride + 1u], t.x);
    i += z_stride;
    float c0 = mix(leaf_area[i], leaf_area[i + 1u], t.x);
    float d = mix(leaf_area[i + y_stride], leaf_area[i + y_stride + 1u], t.x);
    return mix(mix(a, b, t.y), mix(c0, d, t.y), t.z);
}

// Distance in cells from `u` to where the ray along `w` leaves the grid; 0 outside.
float exit_distance(vec3 u, vec3 w) {
    float end = 1e30;
    for (uint axis = 0u; axis < 3u; ++axis) {
        if (w[axis] != 0.0) {
            float side = w[axis] > 0.0 ? float(push.nodes[axis] - 1u) : 0.0;
            end = min(end, (side - u[axis]) / w[axis]);
        }
    }
    return max(end, 0.0);
}

void main() {
    uint i = flat_invocation();
    if (i >= push.count) {
        return;
    }
    vec4 query = queries[i];
    vec3 u = (query.xyz - push.origin) / push.cell;
    vec3 open = vec3(0.0);
    float mean = 0.0;
    for (uint k = 0u; k < push.directions; ++k) {
        vec3 w = rays[k].xyz;
        uint steps = uint(ceil(exit_distance(u, w)));
        float depth = 0.0;
        for (uint s = 0u; s < steps; ++s) {
            depth += leaf_area_at(u + (float(s) + 0.5) * w);
        }
        float transmittance = exp(-push.extinction * push.cell * depth);
        open += transmittance * w;
        mean += transmittance;
    }
    float share = 1.0 / float(push.directions);
    float size = length(open) * share;
    uint target = floatBitsToUint(query.w);
    found[target] = size > OPPOSITE_FLOOR ? vec4(open * share / size, 1.0) : vec4(0.0);
    ambient[target] = mean * share;
    if (size <= OPPOSITE_FLOOR) {
        atomicAdd(missing, 1u);
    }
}
