#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"

// Writes the numbers of the points bin by bin.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Places { uvec2 places[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer BinFirst { uint bin_first[]; };
layout(set = 0, binding = 2, scalar) restrict writeonly buffer Sorted { uint sorted[]; };
layout(push_constant, scalar) uniform Push { BinPoints push; };

void main() {
    uint i = flat_invocation();
    if (i >= push.count) {
        return;
    }
    uvec2 place = places[i];
    sorted[bin_first[place.x] + place.y] = i;
}
