#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"

// Depth and number of a particle within its (deformed) ellipse.

layout(push_constant, scalar) uniform Push { PaperEllipse push; };
layout(location = 0) flat in vec2 in_depth_number;
layout(location = 1) flat in vec2 in_phase;
layout(location = 2) in vec2 in_local;
layout(location = 0) out float out_depth;
layout(location = 1) out float out_number;

void main() {
    vec2 p = in_local / vec2(1.0, push.aspect);
    float angle = atan(p.y, p.x) + 1.57079633;
    vec2 wave = cos(vec2(2.0, 3.0) * angle + in_phase);
    if (length(p) > 1.0 + push.deformation * (0.6 * wave.x + 0.4 * wave.y)) {
        discard;
    }
    out_depth = in_depth_number.x;
    out_number = in_depth_number.y;
}
