#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"

// Cuts leaves out of their cards.

layout(set = 1, binding = 0) uniform sampler2D base_color_map;
layout(push_constant, scalar) uniform Push { LitDraw push; };

layout(location = 0) in vec2 in_texcoord;

void main() {
    if (texture(base_color_map, in_texcoord).a * push.alpha < push.cutoff) {
        discard;
    }
}
