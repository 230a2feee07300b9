#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "lamp.glsl"

// What of a lamp's light arrives at a receiver, what would if nothing hid it, and how many of its
// points are seen.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Receivers { Receiver receivers[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Points { vec3 points[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Items { uint items[]; };
layout(set = 0, binding = 3, scalar) restrict readonly buffer Hits { uint hits[]; };
layout(set = 0, binding = 4, scalar) restrict writeonly buffer Sums { vec3 sums[]; };
layout(push_constant, scalar) uniform Push { LampBatch push; };

void main() {
    uint item = flat_invocation();
    if (item >= push.items) {
        return;
    }
    Receiver receiver = receivers[items[item]];
    vec3 sum = vec3(0.0);
    for (uint s = 0u; s < push.points; ++s) {
        uint ray = s * push.items + item;
        bool open = (hits[ray % push.invocations] >> (ray / push.invocations) & 1u) == 0u;
        vec3 to = points[push.first_point + s] - receiver.position;
        float cosine = abs(dot(to, receiver.normal)) * inversesqrt(max(dot(to, to), 1e-30));
        float weight = cosine * lamp_falloff(to, push.normal, push.least);
        sum += vec3(open ? weight : 0.0, weight, open ? 1.0 : 0.0);
    }
    sums[item] = sum;
}
