#ifndef INK_NOISE_GLSL
#define INK_NOISE_GLSL

#include "random.glsl"

// A number in [0,1) of a node of the lattice.
float lattice(ivec2 node, uint seed) {
    return unit_interval(pcg(uint(node.x) ^ pcg(uint(node.y) ^ pcg(seed))));
}

// Smooth numbers in [0,1) with a wavelength of 1.
float value_noise(vec2 at, uint seed) {
    vec2 cell = floor(at);
    vec2 f = at - cell;
    f = f * f * (3.0 - 2.0 * f);
    ivec2 i = ivec2(cell);
    float top = mix(lattice(i, seed), lattice(i + ivec2(1, 0), seed), f.x);
    float bottom = mix(lattice(i + ivec2(0, 1), seed), lattice(i + ivec2(1, 1), seed), f.x);
    return mix(top, bottom, f.y);
}

// Octaves of it, in [0,1).
float cloudy_noise(vec2 at, uint seed) {
    float sum = 0.0;
    float weight = 0.5;
    float total = 0.0;
    for (uint k = 0u; k < INK_NOISE_OCTAVES; k++) {
        sum += weight * value_noise(at, seed + k);
        total += weight;
        at *= 2.0;
        weight *= 0.5;
    }
    return sum / total;
}

#endif
