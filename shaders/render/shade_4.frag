#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "interface.glsl"

layout(set = 1, binding = 0) uniform sampler2DMS record_a_map;
layout(set = 1, binding = 1) uniform sampler2DMS record_b_map;
layout(set = 1, binding = 2) uniform sampler2DMS depth_map;

const int SAMPLES = 4;
// Where the samples lie, in pixels from the centre (the standard pattern).
const vec2 PLACES[SAMPLES] = vec2[SAMPLES](vec2(-0.125, -0.375), vec2(0.375, -0.125),
                                            vec2(-0.375, 0.125), vec2(0.125, 0.375));

float fetch_depth(int i) {
    return texelFetch(depth_map, ivec2(gl_FragCoord.xy), i).r;
}

void fetch(int i, out vec4 a, out vec4 b) {
    a = texelFetch(record_a_map, ivec2(gl_FragCoord.xy), i);
    b = texelFetch(record_b_map, ivec2(gl_FragCoord.xy), i);
}

#include "shade_stage.glsl"
