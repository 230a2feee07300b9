#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "gbuffer.glsl"

layout(location = 0) out vec4 out_0;

void main() {
    Surface s = kept_surface();
    out_0 = channel_value(CHANNEL_0, s);
}
