#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"

// Depth and number of a particle within its (deformed) ellipse, which is found from the pixel's own
// place: what devices interpolate differs with how they round a triangle's corners.

layout(push_constant, scalar) uniform Push { PaperEllipse push; };
layout(location = 0) flat in vec2 in_depth_number;
// Cosines of the phases of both waves, and their sines.
layout(location = 1) flat in vec4 in_waves;
layout(location = 2) flat in vec4 in_to_circle;
layout(location = 3) flat in vec2 in_middle;
layout(location = 0) out float out_depth;
layout(location = 1) out float out_number;

void main() {
    vec2 away = gl_FragCoord.xy - in_middle;
    precise vec2 p = in_to_circle.xy * away.x + in_to_circle.zw * away.y;
    precise float square = p.x * p.x + p.y * p.y;
    if (push.deformation == 0.0) {
        if (!(square <= 1.0)) {
            discard;
        }
    } else {
        // Waves of twice and three times the angle from below, without the angle.
        float reach = sqrt(square);
        precise vec2 way = vec2(-p.y, p.x) / max(reach, 1e-6);
        precise vec2 cosine = vec2(2.0 * way.x * way.x - 1.0, way.x * (4.0 * way.x * way.x - 3.0));
        precise vec2 sine = vec2(2.0 * way.x * way.y, way.y * (3.0 - 4.0 * way.y * way.y));
        precise vec2 wave = cosine * in_waves.xy - sine * in_waves.zw;
        precise float edge = 1.0 + push.deformation * (0.6 * wave.x + 0.4 * wave.y);
        if (!(reach <= edge)) {
            discard;
        }
    }
    out_depth = in_depth_number.x;
    out_number = in_depth_number.y;
}
