#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"

// Mean, weight and area of the generators of every voxel from their sums.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Sums { uint sums[]; };
layout(set = 0, binding = 1, scalar) restrict writeonly buffer Centres { vec4 centres[]; };
layout(set = 0, binding = 2, scalar) restrict writeonly buffer Areas { float areas[]; };
layout(push_constant, scalar) uniform Push { Count push; };

// A position from a sum of `count` (below 2^24) lattice steps: long division, a byte at a time.
float mean(uint low, uint high, uint count) {
    uint quotient = 0u;
    uint rest = 0u;
    for (uint k = 0u; k < 8u; ++k) {
        uint word = k < 4u ? high : low;
        rest = (rest << 8u) | ((word >> (24u - 8u * (k & 3u))) & 255u);
        quotient = (quotient << 8u) | (rest / count);
        rest = rest % count;
    }
    float steps = float(int(quotient) - (1 << SUBSET_POSITION_BITS)) + float(rest) / float(count);
    return steps / float(1u << SUBSET_POSITION_BITS);
}

void main() {
    uint i = flat_invocation();
    if (i >= push.count) {
        return;
    }
    uint first = SUBSET_SUM_WORDS * i;
    uint count = max(sums[first + 8u], 1u);
    vec3 position = vec3(
        mean(sums[first], sums[first + 1u], count),
        mean(sums[first + 2u], sums[first + 3u], count),
        mean(sums[first + 4u], sums[first + 5u], count));
    centres[i] = vec4(position, float(count));
    areas[i] = (float(sums[first + 7u]) + float(sums[first + 6u]) / 4294967296.0) / SUBSET_AREA_HIGH;
}
