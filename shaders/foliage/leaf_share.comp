#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"

// Takes the transparent margin of alpha-masked cards off the areas of their triangles.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Shares { float shares[]; };
layout(set = 0, binding = 1, scalar) restrict buffer Areas { float areas[]; };
layout(push_constant, scalar) uniform Push { Count push; };

void main() {
    uint i = flat_invocation();
    if (i < push.count) {
        areas[i] *= shares[i];
    }
}
