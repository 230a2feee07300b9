#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"

layout(push_constant, scalar) uniform Push { Square push; };
layout(location = 0) out vec4 color;

void main() {
    color = push.color;
}
