#ifndef INK_TONE_GLSL
#define INK_TONE_GLSL

#include "ink_light.glsl"

// Tone of a surface: light from all around, and what of the sun falls on it.
float ink_tone(vec3 normal, vec3 to_sun, InkStyle style, float open) {
    float sun = sun_share(normal, to_sun, style.wrap);
    return clamp((style.ambient + (1.0 - style.ambient) * sun) * open, 0.0, 1.0);
}

#endif
