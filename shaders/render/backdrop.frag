#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "interface.glsl"

layout(location = 0) in vec3 in_direction;
layout(location = 0) out vec4 out_color;

void main() {
    out_color = vec4(backdrop(in_direction), 1.0);
}
