#ifndef GBUFFER_GLSL
#define GBUFFER_GLSL

// Stage 1 of pictures that need more than colour: each render target holds one channel.

#include "material.glsl"

layout(constant_id = 6) const uint CHANNEL_0 = 0;
layout(constant_id = 7) const uint CHANNEL_1 = 1;
layout(constant_id = 8) const uint CHANNEL_2 = 2;
layout(constant_id = 9) const uint CHANNEL_3 = 3;

bool wants(uint channel) {
    return CHANNEL_0 == channel || CHANNEL_1 == channel || CHANNEL_2 == channel
        || CHANNEL_3 == channel;
}

vec4 channel_value(uint channel, Fragment f) {
    if (channel == CHANNEL_NORMAL) {
        return vec4(f.normal, f.ambient);
    }
    if (channel == CHANNEL_DEPTH) {
        return vec4(dot(in_position - frame.eye, frame.forward));
    }
    if (channel == CHANNEL_ALBEDO) {
        return vec4(f.albedo, 1.0);
    }
    return vec4(f.light, f.sun);
}

#endif
