#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "material.glsl"

// Stage 1 of lit pictures: the nearest surface of every sample, to be shaded once by stage 2.

layout(location = 0) out vec4 out_a;
layout(location = 1) out vec4 out_b;

// Samples covered for 0 to 4 quarters.
const int MASKS[5] = int[5](0, 1, 9, 13, 15);

void main() {
    float coverage;
    Surface s = surface(coverage);
    if (coverage < 0.125) {
        discard;
    }
    if (COVERAGE) {
        gl_SampleMask[0] = MASKS[int(coverage * 4.0 + 0.5)];
    } else {
        gl_SampleMask[0] = -1;
    }
    out_a = record_a(s);
    out_b = record_b(s);
}
