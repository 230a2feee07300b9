#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "random.glsl"

// Rays to points of the light's disc, from the side of the leaf that faces it.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Receivers { Receiver receivers[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Directions { vec3 directions[]; };
// Direction and receiver of each item.
layout(set = 0, binding = 2, scalar) restrict readonly buffer Items { uvec2 items[]; };
layout(set = 0, binding = 3, rgba32f) uniform restrict writeonly image2D rays;
// Of the light's shape, in units of its radius.
layout(set = 0, binding = 4, scalar) restrict readonly buffer Points { vec2 points[]; };
layout(push_constant, scalar) uniform Push { LvcBatch push; };

void main() {
    uint ray = flat_invocation();
    if (ray >= push.items * push.samples) {
        return;
    }
    uint item = ray % push.items;
    uint number = push.first_sample + ray / push.items;
    uvec2 what = items[item];
    Receiver receiver = receivers[what.y];
    vec3 centre = directions[what.x];
    vec2 place = push.sin_radius * points[number];
    vec3 direction = normalize(to_frame(centre, vec3(place, 1.0)));
    float side = dot(centre, receiver.facing) < 0.0 ? -push.offset : push.offset;
    ivec2 texel = ivec2((2u * ray) & ((1u << RAY_COLUMN_BITS) - 1u), (2u * ray) >> RAY_COLUMN_BITS);
    imageStore(rays, texel, vec4(receiver.position + side * receiver.facing, RAY_FAR));
    imageStore(rays, texel + ivec2(1, 0), vec4(direction, 0.0));
}
