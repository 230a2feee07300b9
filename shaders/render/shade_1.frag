#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "interface.glsl"

layout(set = 1, binding = 0) uniform sampler2D record_a_map;
layout(set = 1, binding = 1) uniform sampler2D record_b_map;
layout(set = 1, binding = 2) uniform sampler2D depth_map;

const int SAMPLES = 1;
// Where the samples lie, in pixels from the centre.
const vec2 PLACES[SAMPLES] = vec2[SAMPLES](vec2(0.0));

float fetch_depth(int i) {
    return texelFetch(depth_map, ivec2(gl_FragCoord.xy), 0).r;
}

void fetch(int i, out vec4 a, out vec4 b) {
    a = texelFetch(record_a_map, ivec2(gl_FragCoord.xy), 0);
    b = texelFetch(record_b_map, ivec2(gl_FragCoord.xy), 0);
}

#include "shade_stage.glsl"
