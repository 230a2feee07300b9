#ifndef PACKING_GLSL
#define PACKING_GLSL

// Octahedral map of unit vectors (Cigolle et al. 2014); the other half is src/math/packing.rs.

vec2 sign_not_zero(vec2 v) {
    return vec2(v.x < 0.0 ? -1.0 : 1.0, v.y < 0.0 ? -1.0 : 1.0);
}

// Unit vector to the square [-1,1]^2; the zero vector maps to the pole +y.
vec2 octahedral_encode(vec3 v) {
    float sum = abs(v.x) + abs(v.y) + abs(v.z);
    if (!(sum > 0.0)) {
        return vec2(0.0, 1.0);
    }
    vec2 p = v.xy / sum;
    return v.z < 0.0 ? (1.0 - abs(p.yx)) * sign_not_zero(p) : p;
}

vec3 octahedral_decode(vec2 e) {
    float z = 1.0 - abs(e.x) - abs(e.y);
    return normalize(vec3(e - sign_not_zero(e) * max(-z, 0.0), z));
}

// 2 x 16-bit signed normalised.
uint pack_normal16(vec3 v) {
    return packSnorm2x16(octahedral_encode(v));
}

vec3 unpack_normal16(uint bits) {
    return octahedral_decode(unpackSnorm2x16(bits));
}

// 2 x 8-bit signed normalised in the low 16 bits.
uint pack_normal8(vec3 v) {
    return packSnorm4x8(vec4(octahedral_encode(v), 0.0, 0.0)) & 0xffffu;
}

vec3 unpack_normal8(uint bits) {
    return octahedral_decode(unpackSnorm4x8(bits).xy);
}

#endif
