#ifndef GBUFFER_GLSL
#define GBUFFER_GLSL

// Stage 1 of pictures that need more than colour: each render target holds one channel.

#include "material.glsl"

layout(constant_id = 6) const uint CHANNEL_0 = 0;
layout(constant_id = 7) const uint CHANNEL_1 = 1;
layout(constant_id = 8) const uint CHANNEL_2 = 2;
layout(constant_id = 9) const uint CHANNEL_3 = 3;

vec4 channel_value(uint channel, Surface s) {
    if (channel == CHANNEL_NORMAL) {
        return vec4(normalize(s.normal), s.ambient);
    }
    if (channel == CHANNEL_DEPTH) {
        return vec4(dot(in_position - frame.eye, frame.forward));
    }
    if (channel == CHANNEL_ALBEDO) {
        return vec4(s.albedo, 1.0);
    }
    float sun = SHADOWED ? sun_visibility(in_position, s.steepness, 1.0, SURFACE_TAPS) : 1.0;
    vec3 light = illuminate(in_position, normalize(s.normal), s.albedo, s.ambient, sun,
                            material.specular, material.shininess, material.transmission);
    return vec4(light, sun);
}

// The fragment's surface; cut leaves end here.
Surface kept_surface() {
    float coverage;
    Surface s = surface(coverage);
    if (coverage == 0.0) {
        discard;
    }
    return s;
}

#endif
