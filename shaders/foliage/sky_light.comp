#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"

// Light at every node: mean over the directions of transmittance times direction (xyz) and of
// transmittance (w), by the Beer-Lambert law. Batches of directions add up in order.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Directions { vec4 directions[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Depth { float depth[]; };
layout(set = 0, binding = 2, scalar) restrict buffer Light { vec4 light[]; };
layout(push_constant, scalar) uniform Push { SkyLight push; };

void main() {
    uint node = flat_invocation();
    if (node >= push.node_count) {
        return;
    }
    vec4 sum = push.first == 0u ? vec4(0.0) : light[node];
    for (uint i = 0u; i < push.count; ++i) {
        float transmittance = push.share * exp(-push.extinction * depth[i * push.node_count + node]);
        sum += transmittance * vec4(directions[push.first + i].xyz, 1.0);
    }
    light[node] = sum;
}
