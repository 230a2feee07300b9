#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"

layout(set = 1, binding = 0) uniform sampler2D slice_map;
layout(push_constant, scalar) uniform Push { RenderOverlay overlay; };

layout(location = 0) in vec2 in_texcoord;
layout(location = 0) out vec4 out_color;

void main() {
    vec4 texel = texture(slice_map, in_texcoord);
    out_color = vec4(texel.rgb, texel.a * overlay.opacity);
}
