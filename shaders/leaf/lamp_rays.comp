#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "abi.glsl"
#include "dispatch.glsl"

// Rays to points of a lamp, each from the side of the leaf that faces it.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Receivers { Receiver receivers[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Points { vec3 points[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Items { uint items[]; };
layout(set = 0, binding = 3, rgba32f) uniform restrict writeonly image2D rays;
layout(push_constant, scalar) uniform Push { LampBatch push; };

void main() {
    uint ray = flat_invocation();
    if (ray >= push.items * push.points) {
        return;
    }
    Receiver receiver = receivers[items[ray % push.items]];
    vec3 point = points[push.first_point + ray / push.items];
    float side = dot(point - receiver.position, receiver.facing) < 0.0 ? -push.offset : push.offset;
    vec3 origin = receiver.position + side * receiver.facing;
    vec3 direction = point - origin;
    // Nothing arrives from behind the lamp: no ray.
    float reach = dot(direction, push.normal) < 0.0 ? LAMP_REACH : -1.0;
    ivec2 texel = ivec2((2u * ray) & ((1u << RAY_COLUMN_BITS) - 1u), (2u * ray) >> RAY_COLUMN_BITS);
    imageStore(rays, texel, vec4(origin, reach));
    imageStore(rays, texel + ivec2(1, 0), vec4(direction, 0.0));
}
