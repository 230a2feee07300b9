#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "leaf_glossy.glsl"

// The glossy term at listed directions: the conformance of `leaf_glossy.glsl`, which the drawing
// shaders include.

layout(local_size_x = GROUP_1D) in;
// Cosines of incidence, reflection and half vector; roughness.
layout(set = 0, binding = 0, scalar) restrict readonly buffer Queries { vec4 queries[]; };
layout(set = 0, binding = 1, scalar) restrict writeonly buffer Found { float found[]; };
layout(push_constant, scalar) uniform Push { GlossyQueries push; };

void main() {
    uint i = flat_invocation();
    if (i >= push.count) {
        return;
    }
    vec4 q = queries[i];
    found[i] = glossy(q.x, q.y, q.z, q.w, push.safe != 0u);
}
