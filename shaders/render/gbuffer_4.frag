#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "gbuffer.glsl"

layout(location = 0) out vec4 out_0;
layout(location = 1) out vec4 out_1;
layout(location = 2) out vec4 out_2;
layout(location = 3) out vec4 out_3;

void main() {
    Surface s = kept_surface();
    out_0 = channel_value(CHANNEL_0, s);
    out_1 = channel_value(CHANNEL_1, s);
    out_2 = channel_value(CHANNEL_2, s);
    out_3 = channel_value(CHANNEL_3, s);
}
