#ifndef LAMP_GLSL
#define LAMP_GLSL

// Share of a point's intensity that arrives per area across `to` (from the surface to the point):
// the cosine at the lamp over the squared distance. 0 behind the lamp's face.
float lamp_falloff(vec3 to, vec3 normal, float least) {
    float squared = max(dot(to, to), 1e-30);
    return max(-dot(to, normal) * inversesqrt(squared), 0.0) / max(squared, least);
}

#endif
