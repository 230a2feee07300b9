#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"

// Marks the first generator of every voxel: its number decides the order of what is left.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Places { uint places[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Leaders { uint leaders[]; };
layout(set = 0, binding = 2, scalar) restrict writeonly buffer Flags { uint flags[]; };
layout(push_constant, scalar) uniform Push { Count push; };

void main() {
    uint i = flat_invocation();
    if (i < push.count) {
        flags[i] = uint(leaders[places[i]] == i);
    }
}
