#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "scan.glsl"

// Sum of every chunk: the first half of an exclusive prefix sum. One invocation adds one chunk
// in order, so that neither barriers nor the width of a subgroup matter.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Values { uint values[]; };
layout(set = 0, binding = 1, scalar) restrict writeonly buffer Sums { uint sums[]; };
layout(push_constant, scalar) uniform Push { Scan push; };

void main() {
    uint chunk = flat_invocation();
    uint first = scan_first(chunk);
    if (first >= push.count) {
        return;
    }
    uint sum = 0u;
    for (uint i = first; i < scan_last(chunk, push.count); ++i) {
        sum += values[i];
    }
    sums[chunk] = sum;
}
