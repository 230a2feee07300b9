#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "interface.glsl"
#include "backdrop.glsl"

// Stage 2 where nothing of the model can be seen: no sample needs to be read.

void main() {
    vec3 centre = ray(in_corner);
    out_color = vec4(light_behind(centre, ground_distance(centre)), 1.0);
}
