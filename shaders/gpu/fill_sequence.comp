#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict writeonly buffer Values { uint values[]; };
layout(push_constant, scalar) uniform Push { FillSequence push; };

void main() {
    uint i = flat_invocation();
    if (i >= push.count) {
        return;
    }
    values[i] = push.first + i * push.step;
}
