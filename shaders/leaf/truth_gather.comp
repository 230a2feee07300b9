#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "abi.glsl"
#include "dispatch.glsl"

// Adds the paths of a batch to their pixels: direct sun and coverage, indirect sun, sky.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Paths { TruthPath paths[]; };
layout(set = 0, binding = 1, scalar) restrict buffer Sums { vec4 sums[]; };
layout(push_constant, scalar) uniform Push { TruthBatch push; };

void main() {
    uint pixel = flat_invocation();
    if (pixel >= push.pixels) {
        return;
    }
    uint at = 3u * (push.first_pixel + pixel);
    bool first = push.first_sample == 0u;
    vec4 direct = first ? vec4(0.0) : sums[at];
    vec4 indirect = first ? vec4(0.0) : sums[at + 1u];
    vec4 from_sky = first ? vec4(0.0) : sums[at + 2u];
    for (uint s = 0u; s < push.samples; ++s) {
        TruthPath path = paths[s * push.pixels + pixel];
        direct += vec4(path.direct, path.covered);
        indirect += vec4(path.indirect, 0.0);
        from_sky += vec4(path.sky, 0.0);
    }
    sums[at] = direct;
    sums[at + 1u] = indirect;
    sums[at + 2u] = from_sky;
}
