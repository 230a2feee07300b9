#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "random.glsl"

// A seeded random subset: first the least number that is drawn, then the marks of all that draw a
// number below the threshold, or that least one.

layout(local_size_x = GROUP_1D) in;
layout(constant_id = 0) const uint FINAL = 0;
layout(set = 0, binding = 0, scalar) restrict buffer Draw { uint least; uint kept; };
layout(set = 0, binding = 1, scalar) restrict writeonly buffer Flags { uint flags[]; };
layout(push_constant, scalar) uniform Push { SubsetDraw push; };

void main() {
    uint i = flat_invocation();
    if (i >= push.count) {
        return;
    }
    uint number = pcg(i ^ push.hashed_seed);
    if (FINAL == 0u) {
        atomicMin(least, number);
        return;
    }
    bool keep = number < push.threshold || number == least;
    flags[i] = uint(keep);
    if (keep) {
        atomicAdd(kept, 1u);
    }
}
