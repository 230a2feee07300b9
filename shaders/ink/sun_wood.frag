#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"

// Whatever is no leaf as the sun sees it.

layout(set = 1, binding = 0) uniform sampler2D base_color_map;
layout(push_constant, scalar) uniform Push { InkWoodDraw push; };

layout(location = 2) in vec2 in_texcoord;

void main() {
    if (push.base_color.a * texture(base_color_map, in_texcoord).a < push.cutoff) {
        discard;
    }
}
