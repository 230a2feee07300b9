#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"

// First pass: light of the sky and light between leaves, and what the second pass needs.

layout(set = 1, binding = 0) uniform sampler2D base_color_map;
layout(push_constant, scalar) uniform Push { LitDraw push; };

layout(location = 0) in vec3 in_front;
layout(location = 1) in vec3 in_back;
layout(location = 2) in vec4 in_normal;
layout(location = 3) in vec2 in_texcoord;

layout(location = 0) out vec4 out_light;
// Normal of the front; visibility of the sun plus 1, negative on the back.
layout(location = 1) out vec4 out_surface;
// Colour of the texture over its mean, and the material.
layout(location = 2) out vec4 out_material;

void main() {
    vec4 base = texture(base_color_map, in_texcoord);
    if (base.a * push.alpha < push.cutoff) {
        discard;
    }
    vec3 tint = base.rgb * push.tint;
    out_light = vec4((gl_FrontFacing ? in_front : in_back) * tint, 1.0);
    float side = gl_FrontFacing ? 1.0 : -1.0;
    out_surface = vec4(normalize(in_normal.xyz), side * (1.0 + in_normal.w));
    out_material = vec4(tint, float(push.material));
}
