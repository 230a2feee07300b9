#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"

// Writes the generators of a random subset in their order; each stands for `scale` as many.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Centres { vec4 centres[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Areas { float areas[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Firsts { uint firsts[]; };
layout(set = 0, binding = 3, scalar) restrict writeonly buffer KeptCentres { vec4 kept_centres[]; };
layout(set = 0, binding = 4, scalar) restrict writeonly buffer KeptAreas { float kept_areas[]; };
layout(push_constant, scalar) uniform Push { SubsetEmit push; };

void main() {
    uint i = flat_invocation();
    if (i >= push.count || firsts[i + 1u] == firsts[i]) {
        return;
    }
    uint to = firsts[i];
    kept_centres[to] = vec4(centres[i].xyz, centres[i].w * push.scale);
    kept_areas[to] = areas[i] * push.scale;
}
