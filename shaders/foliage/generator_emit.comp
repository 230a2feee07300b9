#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"

// Writes the generators bin by bin into an image: position and the square root of the weight.
// Field kernels fetch them as texels, which software rasterisers do several times faster than
// loads from a storage buffer.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Sorted { uint sorted[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Centres { vec4 centres[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Areas { float areas[]; };
layout(set = 0, binding = 3, rgba32f) restrict writeonly uniform image2D generators;
layout(push_constant, scalar) uniform Push { BinPoints push; };

void main() {
    uint i = flat_invocation();
    if (i >= push.count) {
        return;
    }
    uint g = sorted[i];
    vec4 centre = centres[g];
    float weight = push.area_scale != 0.0 ? areas[g] * push.area_scale : centre.w;
    uint column = i & ((1u << GENERATOR_COLUMN_BITS) - 1u);
    imageStore(generators, ivec2(column, i >> GENERATOR_COLUMN_BITS), vec4(centre.xyz, sqrt(weight)));
}
