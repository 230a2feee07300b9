#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "scan.glsl"

// Exclusive prefix sum of every chunk, on top of the scanned sums of the chunks before it. The
// total closes the result: it has one entry more than there are values.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Values { uint values[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Bases { uint bases[]; };
layout(set = 0, binding = 2, scalar) restrict writeonly buffer Firsts { uint firsts[]; };
layout(push_constant, scalar) uniform Push { Scan push; };

void main() {
    uint chunk = flat_invocation();
    uint first = scan_first(chunk);
    if (first >= push.count) {
        return;
    }
    uint running = push.has_bases != 0u ? bases[chunk] : 0u;
    uint last = scan_last(chunk, push.count);
    for (uint i = first; i < last; ++i) {
        firsts[i] = running;
        running += values[i];
    }
    if (last == push.count) {
        firsts[last] = running;
    }
}
