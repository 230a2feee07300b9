#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"

// Cuts leaves out of their cards; opaque casters have no fragment shader.

layout(set = 1, binding = 0) uniform sampler2D alpha_map;
layout(push_constant, scalar) uniform Push { RenderMaterial material; };

layout(location = 0) in vec2 in_texcoord;

void main() {
    if (texture(alpha_map, in_texcoord).r * material.base_color.a < material.cutoff) {
        discard;
    }
}
