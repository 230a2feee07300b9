#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "material.glsl"

layout(location = 0) out vec4 out_color;

void main() {
    Fragment f = fragment(true);
    out_color = vec4(f.light * frame.exposure, f.coverage);
}
