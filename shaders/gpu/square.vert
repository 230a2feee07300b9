#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"

layout(push_constant, scalar) uniform Push { Square push; };

// Two triangles, counter-clockwise on a screen whose y points down.
const vec2 CORNERS[6] = vec2[](vec2(0, 0), vec2(0, 1), vec2(1, 1), vec2(0, 0), vec2(1, 1), vec2(1, 0));

void main() {
    gl_Position = vec4(mix(push.min, push.max, CORNERS[gl_VertexIndex]), push.depth, 1.0);
}
