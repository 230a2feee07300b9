#ifndef SUBSET_GLSL
#define SUBSET_GLSL

#include "random.glsl"

// Steps of a lattice of 2^SUBSET_LATTICE_BITS over the frame's -1/2 .. 1/2. A product with a power
// of two is exact, so that device and twin agree about every voxel.
uvec3 lattice(vec3 p) {
    float steps = float(1u << SUBSET_LATTICE_BITS);
    ivec3 half_steps = ivec3(1 << (SUBSET_LATTICE_BITS - 1u));
    return uvec3(clamp(ivec3(floor(p * steps)) + half_steps, ivec3(0), 2 * half_steps));
}

// n / edge, rounded down, for n below 2^24. Drivers for CPUs divide whole numbers one by one; the
// quotient of floats is off by one at most.
uvec3 divided(uvec3 n, uint edge) {
    uvec3 quotient = uvec3(vec3(n) / float(edge));
    ivec3 rest = ivec3(n - quotient * edge);
    return quotient + uvec3(greaterThanEqual(rest, ivec3(edge))) - uvec3(lessThan(rest, ivec3(0)));
}

// Voxel of a generator; `edge` in steps, `shift` in 1/2048 of it and below 1024.
uvec3 voxel(vec3 p, uint edge, uvec3 shift) {
    return divided(lattice(p) + ((shift * edge) >> 11u), edge);
}

uint voxel_hash(uvec3 v) {
    return pcg(v.x + pcg(v.y + pcg(v.z)));
}

#endif
