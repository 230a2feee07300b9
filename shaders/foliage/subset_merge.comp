#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "subset.glsl"

// Adds the generators of every voxel up. Sums are whole numbers of two words: the order in which
// atomics add them does not matter, and as many may coincide as there are.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Centres { vec4 centres[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Areas { float areas[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Places { uint places[]; };
layout(set = 0, binding = 3, scalar) restrict readonly buffer Leaders { uint leaders[]; };
layout(set = 0, binding = 4, scalar) restrict readonly buffer Firsts { uint firsts[]; };
layout(set = 0, binding = 5, scalar) restrict buffer Sums { uint sums[]; };
layout(push_constant, scalar) uniform Push { Count push; };

// Adds to the low word at `place` and the high word behind it.
void add(uint place, uint high, uint low) {
    uint before = atomicAdd(sums[place], low);
    uint carried = high + uint(before + low < before);
    if (carried != 0u) {
        atomicAdd(sums[place + 1u], carried);
    }
}

void main() {
    uint i = flat_invocation();
    if (i >= push.count) {
        return;
    }
    uint first = SUBSET_SUM_WORDS * firsts[leaders[places[i]]];
    float unit = float(1u << SUBSET_POSITION_BITS);
    ivec3 p = ivec3(floor(centres[i].xyz * unit + 0.5)) + ivec3(1 << SUBSET_POSITION_BITS);
    uvec3 position = uvec3(clamp(p, ivec3(0), ivec3(2 << SUBSET_POSITION_BITS)));
    add(first, 0u, position.x);
    add(first + 2u, 0u, position.y);
    add(first + 4u, 0u, position.z);
    float area = areas[i] * SUBSET_AREA_HIGH;
    add(first + 6u, uint(floor(area)), uint(fract(area) * 4294967296.0));
    atomicAdd(sums[first + 8u], 1u);
}
