#ifndef RANDOM_GLSL
#define RANDOM_GLSL

// Counter-based random numbers: equal keys give equal numbers, whatever ran before. The other
// half is src/math/sampling.rs.

uint pcg(uint value) {
    uint state = value * 747796405u + 2891336453u;
    uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// 24 bits in [0,1): the same number in f32 and f64.
float unit_interval(uint bits) {
    return float(bits >> 8u) * (1.0 / 16777216.0);
}

// Key of a path: what is sampled, the number of the sample, the seed.
uint path_key(uint receiver, uint path_sample, uint seed) {
    return pcg(path_sample ^ pcg(receiver ^ pcg(seed)));
}

float random(uint key, uint counter) {
    return unit_interval(pcg(key ^ pcg(counter)));
}

// Number `path_sample` of a sequence that fills the unit cube evenly (Roberts 2018, R3), shifted
// by what is sampled. The steps are 2^32 / g, / g^2, / g^3 with g = 1.2207440846.
vec3 even_numbers(uint receiver, uint path_sample, uint seed) {
    uint shift = pcg(receiver ^ pcg(seed));
    return vec3(
        unit_interval(path_sample * 3518319155u + shift),
        unit_interval(path_sample * 2882110345u + pcg(shift)),
        unit_interval(path_sample * 2360945575u + pcg(shift + 1u)));
}

// Two unit vectors that complete z to a right-handed frame (Duff et al. 2017, Building an
// Orthonormal Basis, Revisited), applied to a local vector.
vec3 to_frame(vec3 z, vec3 local) {
    float s = z.z < 0.0 ? -1.0 : 1.0;
    float a = -1.0 / (s + z.z);
    float b = z.x * z.y * a;
    vec3 x = vec3(1.0 + s * z.x * z.x * a, s * b, -s * z.x);
    vec3 y = vec3(b, s + z.y * z.y * a, -z.y);
    return local.x * x + local.y * y + local.z * z;
}

// Uniform on the sphere, pole z.
vec3 sphere_direction(vec2 u) {
    float z = 1.0 - 2.0 * u.x;
    float r = sqrt(max(1.0 - z * z, 0.0));
    float phi = 6.28318530717958648 * u.y;
    return vec3(r * cos(phi), r * sin(phi), z);
}

// Cosine-distributed about z.
vec3 cosine_direction(vec3 z, vec2 u) {
    float r = sqrt(u.x);
    float phi = 6.28318530717958648 * u.y;
    return to_frame(z, vec3(r * cos(phi), r * sin(phi), sqrt(max(1.0 - u.x, 0.0))));
}

#endif
