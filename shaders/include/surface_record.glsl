#ifndef SURFACE_RECORD_GLSL
#define SURFACE_RECORD_GLSL

// What stage 1 leaves of the nearest surface in every sample, in two times four bytes:
//     a: base colour (square roots, so that dark tones keep their steps), ambient coefficient
//     b: 11 + 11 bit octahedral normal, 8 bit material, 2 bit steepness towards the sun
// Errors: normal 0.12 degrees, coefficient 1/510, square root of the base colour 1/510.
// `src/reference/shade.rs` has the same functions.

#include "packing.glsl"

struct Surface {
    vec3 albedo;
    float ambient;
    vec3 normal;
    uint material;
    float steepness;    // sine of the sun's angle of incidence on the triangle, rounded up to 1/3
};

const float OCTAHEDRAL_STEPS = 2047.0;

vec4 record_a(Surface s) {
    return vec4(sqrt(s.albedo), s.ambient);
}

vec4 record_b(Surface s) {
    uvec2 e = uvec2(round((octahedral_encode(s.normal) * 0.5 + 0.5) * OCTAHEDRAL_STEPS));
    uint steep = uint(ceil(clamp(s.steepness, 0.0, 1.0) * 3.0 - 1e-3));
    return unpackUnorm4x8(e.x | (e.y << 11) | (s.material << 22) | (steep << 30));
}

Surface from_record(vec4 a, vec4 b) {
    uint word = packUnorm4x8(b);
    vec2 e = vec2(word & 0x7ffu, (word >> 11) & 0x7ffu) / OCTAHEDRAL_STEPS;
    Surface s;
    s.albedo = a.rgb * a.rgb;
    s.ambient = a.a;
    s.normal = octahedral_decode(e * 2.0 - 1.0);
    s.material = (word >> 22) & 0xffu;
    s.steepness = float(word >> 30) / 3.0;
    return s;
}

#endif
