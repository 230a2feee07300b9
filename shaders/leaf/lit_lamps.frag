#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"

// What the surface of a pixel sees of up to four lamps.

layout(set = 1, binding = 0) uniform sampler2D base_color_map;
layout(push_constant, scalar) uniform Push { LitDraw push; };

layout(location = 0) in vec4 in_visibility;
layout(location = 1) in vec2 in_texcoord;

layout(location = 0) out vec4 out_visibility;

void main() {
    if (texture(base_color_map, in_texcoord).a * push.alpha < push.cutoff) {
        discard;
    }
    out_visibility = in_visibility;
}
