#ifndef INK_TONE_GLSL
#define INK_TONE_GLSL

// Tone of a surface: light from all around, and what of the sun falls on it. Wrapped half round
// the surface, as crowns scatter what they get.
float ink_tone(vec3 normal, vec3 to_sun, float ambient, float open) {
    float sun = clamp(0.5 + 0.5 * dot(normal, to_sun), 0.0, 1.0);
    return clamp((ambient + (1.0 - ambient) * sun * sun) * open, 0.0, 1.0);
}

#endif
