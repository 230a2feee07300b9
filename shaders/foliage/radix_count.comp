#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "radix.glsl"

// First half of one digit of a stable radix sort (Knuth, The Art of Computer Programming 5.2.5):
// how often each digit occurs in each block. One invocation has a block, so its column of counts
// is its own and needs no atomics.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Keys { uvec2 keys[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Order { uint order[]; };
layout(set = 0, binding = 2, scalar) restrict buffer Counts { uint counts[]; };
layout(push_constant, scalar) uniform Push { Radix push; };

void main() {
    uint block = flat_invocation();
    if (block >= push.blocks) {
        return;
    }
    for (uint i = radix_first(block); i < radix_last(block, push.count); ++i) {
        uint number = push.shift == 0u ? i : order[i];
        counts[radix_column(keys[number].x, push.shift, block, push.blocks)] += 1u;
    }
}
