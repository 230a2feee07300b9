#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"

// Depth and number of a particle within its (deformed) ellipse.

layout(push_constant, scalar) uniform Push { PaperEllipse push; };
layout(location = 0) flat in vec2 in_depth_number;
// Cosines and sines of the phases of both waves.
layout(location = 1) flat in vec4 in_phase;
layout(location = 2) in vec2 in_local;
layout(location = 0) out float out_depth;
layout(location = 1) out float out_number;

void main() {
    vec2 p = in_local / vec2(1.0, push.aspect);
    // Waves of twice and three times the angle from below, without the angle.
    float reach = length(p);
    vec2 way = vec2(-p.y, p.x) / max(reach, 1e-6);
    vec2 cosine = vec2(2.0 * way.x * way.x - 1.0, way.x * (4.0 * way.x * way.x - 3.0));
    vec2 sine = vec2(2.0 * way.x * way.y, way.y * (3.0 - 4.0 * way.y * way.y));
    vec2 wave = cosine * in_phase.xy - sine * in_phase.zw;
    if (reach > 1.0 + push.deformation * (0.6 * wave.x + 0.4 * wave.y)) {
        discard;
    }
    out_depth = in_depth_number.x;
    out_number = in_depth_number.y;
}
