#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "leaf.glsl"

layout(location = 0) out vec4 out_0;

void main() {
    Attributes a = leaf_attributes();
    out_0 = attribute_of(TARGET_0, a);
}
