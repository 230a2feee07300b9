#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "bins.glsl"

// Counts the points of every bin and gives each point a place among those of its bin. The places
// depend on the order of the atomics; what is emitted is either sorted again or does not matter.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Points { vec4 points[]; };
layout(set = 0, binding = 1, scalar) restrict buffer Counts { uint counts[]; };
layout(set = 0, binding = 2, scalar) restrict writeonly buffer Places { uvec2 places[]; };
layout(push_constant, scalar) uniform Push { BinPoints push; };

void main() {
    uint i = flat_invocation();
    if (i >= push.count) {
        return;
    }
    uvec3 b = bin_of(points[i].xyz, push.origin, push.inverse_edge, push.bins);
    uint bin = push.morton != 0u ? morton_index(b) : row_index(b, push.bins);
    places[i] = uvec2(bin, atomicAdd(counts[bin], 1u));
}
