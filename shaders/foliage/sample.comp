#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"

// Trilinear interpolation of node values at points, clamped to the grid.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Values { float values[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Points { vec4 points[]; };
layout(set = 0, binding = 2, scalar) restrict writeonly buffer Result { float result[]; };
layout(push_constant, scalar) uniform Push { SurfaceGrid push; };

void main() {
    uint i = flat_invocation();
    if (i >= push.count) {
        return;
    }
    vec3 c = clamp((points[i].xyz - push.origin) / push.cell, vec3(0.0), vec3(push.nodes - 1u));
    uvec3 low = min(uvec3(c), push.nodes - 2u);
    vec3 t = c - vec3(low);
    uint step_y = push.nodes.x;
    uint step_z = push.nodes.x * push.nodes.y;
    uint at = low.x + low.y * step_y + low.z * step_z;
    vec4 low_x = vec4(values[at], values[at + step_y], values[at + step_z], values[at + step_y + step_z]);
    vec4 high_x = vec4(values[at + 1u], values[at + step_y + 1u], values[at + step_z + 1u],
        values[at + step_y + step_z + 1u]);
    vec4 x = mix(low_x, high_x, t.x);
    vec2 y = mix(x.xz, x.yw, t.y);
    result[i] = mix(y.x, y.y, t.z);
}
