#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"

// Writes the query points bin by bin, each with its number.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Places { uvec2 places[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer BinFirst { uint bin_first[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Points { vec4 points[]; };
layout(set = 0, binding = 3, scalar) restrict writeonly buffer Queries { vec4 queries[]; };
layout(push_constant, scalar) uniform Push { BinPoints push; };

void main() {
    uint i = flat_invocation();
    if (i >= push.count) {
        return;
    }
    uvec2 place = places[i];
    queries[bin_first[place.x] + place.y] = vec4(points[i].xyz, uintBitsToFloat(i));
}
