#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "radix.glsl"

// Second half of one digit of a stable radix sort: every number goes to the next free place of its
// digit and block. The places are counted up where the scan left them.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Keys { uvec2 keys[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Order { uint order[]; };
layout(set = 0, binding = 2, scalar) restrict buffer Offsets { uint offsets[]; };
layout(set = 0, binding = 3, scalar) restrict writeonly buffer Sorted { uint sorted[]; };
layout(push_constant, scalar) uniform Push { Radix push; };

void main() {
    uint block = flat_invocation();
    if (block >= push.blocks) {
        return;
    }
    for (uint i = radix_first(block); i < radix_last(block, push.count); ++i) {
        uint number = push.shift == 0u ? i : order[i];
        uint column = radix_column(keys[number].x, push.shift, block, push.blocks);
        uint place = offsets[column];
        offsets[column] = place + 1u;
        sorted[place] = number;
    }
}
