#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "wood.glsl"

layout(location = 0) out vec4 out_0;
layout(location = 1) out vec4 out_1;
layout(location = 2) out vec4 out_2;

void main() {
    Attributes a = wood_attributes();
    out_0 = attribute_of(TARGET_0, a);
    out_1 = attribute_of(TARGET_1, a);
    out_2 = attribute_of(TARGET_2, a);
}
