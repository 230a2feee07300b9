#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "abi.glsl"
#include "dispatch.glsl"

// How many of an item's rays met nothing: four items in a word.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Hits { uint hits[]; };
layout(set = 0, binding = 1, scalar) restrict writeonly buffer Counts { uint counts[]; };
layout(push_constant, scalar) uniform Push { LvcBatch push; };

void main() {
    uint word = flat_invocation();
    if (4u * word >= push.items) {
        return;
    }
    uint packed = 0u;
    for (uint k = 0u; k < 4u; ++k) {
        uint item = 4u * word + k;
        uint open = 0u;
        for (uint s = 0u; s < push.samples && item < push.items; ++s) {
            uint ray = s * push.items + item;
            open += 1u - (hits[ray % push.invocations] >> (ray / push.invocations) & 1u);
        }
        packed |= open << (8u * k);
    }
    counts[word] = packed;
}
