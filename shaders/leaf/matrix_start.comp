#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "random.glsl"

// First rays of the paths of transfer matrices: from every receiver evenly into all directions of
// the sphere, whatever its sides make of them.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Receivers { Receiver receivers[]; };
layout(set = 0, binding = 1, rgba32f) uniform restrict writeonly image2D rays;
layout(set = 0, binding = 2, scalar) restrict writeonly buffer Paths { vec4 paths[]; };
layout(push_constant, scalar) uniform Push { PrtBatch push; };

void main() {
    uint path = flat_invocation();
    if (path >= push.sides * push.samples) {
        return;
    }
    uint number = push.first_sample + path / push.sides;
    uint global = push.first_side + path % push.sides;
    Receiver receiver = receivers[global];
    vec3 direction = sphere_direction(even_numbers(global, number, push.seed).xy);
    float leaves = dot(direction, receiver.facing) < 0.0 ? -push.offset : push.offset;
    ivec2 texel = ivec2((2u * path) & ((1u << RAY_COLUMN_BITS) - 1u), (2u * path) >> RAY_COLUMN_BITS);
    imageStore(rays, texel, vec4(receiver.position + leaves * receiver.facing, RAY_FAR));
    imageStore(rays, texel + ivec2(1, 0), vec4(direction, 0.0));
    paths[path] = vec4(1.0, 1.0, 1.0, PATH_ALIVE);
}
