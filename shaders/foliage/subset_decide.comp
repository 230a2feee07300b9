#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"

// One halving in the search for the smallest voxels that are few enough.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict buffer Search { SubsetSearch search; };
layout(push_constant, scalar) uniform Push { Count push; };

void main() {
    if (flat_invocation() != 0u) {
        return;
    }
    uint middle = (search.low + search.high) / 2u;
    if (search.low < search.high) {
        if (search.voxels <= push.count) {
            search.high = middle;
        } else {
            search.low = middle + 1u;
        }
    }
    search.voxels = 0u;
}
