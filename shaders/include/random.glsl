#ifndef RANDOM_GLSL
#define RANDOM_GLSL

// Integer hash (Jarzynski and Olano 2020, Hash Functions for GPU Rendering, `pcg`); the same
// function as in `src/math/sampling.rs`.
uint pcg(uint value) {
    uint state = value * 747796405u + 2891336453u;
    uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

#endif
