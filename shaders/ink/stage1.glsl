#ifndef INK_STAGE1_GLSL
#define INK_STAGE1_GLSL

// Stage 1 (Coconu, Deussen, Hege 2006, section 4): attributes per pixel, as many as the style needs.
// Which of them a render target holds is a specialisation constant.

#include "abi.glsl"

layout(constant_id = 0) const uint TARGET_0 = 0;
layout(constant_id = 1) const uint TARGET_1 = 0;
layout(constant_id = 2) const uint TARGET_2 = 0;
layout(constant_id = 3) const uint TARGET_3 = 0;
layout(constant_id = 4) const uint TARGET_4 = 0;
layout(constant_id = 5) const uint TARGET_5 = 0;

struct Attributes {
    vec3 albedo;
    vec3 normal;
    float tone;
    float depth;
    vec2 ids;
    vec2 direction;
    vec3 hatch;
};

vec4 attribute_of(uint which, Attributes a) {
    if (which == INK_ALBEDO) {
        return vec4(a.albedo, 1.0);
    }
    if (which == INK_NORMAL) {
        return vec4(a.normal, a.tone);
    }
    if (which == INK_DEPTH) {
        return vec4(a.depth);
    }
    if (which == INK_IDS) {
        return vec4(a.ids, 0.0, 0.0);
    }
    if (which == INK_DIRECTION) {
        return vec4(a.direction, 0.0, 0.0);
    }
    return vec4(a.hatch, 0.0);
}

#endif
