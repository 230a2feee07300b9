#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "interface.glsl"

// The ground: lit by eq. 1, under the crown's ambient shade, fading into the background.

layout(location = 0) in vec3 in_position;
layout(location = 0) out vec4 out_color;

const float FADE_START = 0.25;    // share of the ground's radius up to which it is itself

void main() {
    vec3 up = vec3(0.0, 1.0, 0.0);
    float ambient = ground_ambient(frame.crown_centre - in_position, frame.crown_radius,
                                   frame.crown_opacity);
    float sun = SHADOWED ? sun_visibility(in_position, up) : 1.0;
    vec3 light = illuminate(in_position, up, frame.ground_albedo, ambient, sun, 0.0, 1.0, vec3(0.0));
    vec3 behind = backdrop(in_position - frame.eye);
    float away = distance(in_position.xz, frame.crown_centre.xz) / frame.ground_radius;
    float fade = smoothstep(FADE_START, 1.0, away);
    out_color = vec4(mix(light * frame.exposure, behind, fade), 1.0);
}
