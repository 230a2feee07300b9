#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "abi.glsl"
#include "dispatch.glsl"

// Adds the sun where the ray to it met nothing.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Hits { uint hits[]; };
layout(set = 0, binding = 1, scalar) restrict buffer Paths { TruthPath paths[]; };
layout(push_constant, scalar) uniform Push { TruthBatch push; };

void main() {
    uint path = flat_invocation();
    if (path >= push.pixels * push.samples) {
        return;
    }
    bool hidden = (hits[path % push.invocations] >> (path / push.invocations) & 1u) != 0u;
    vec3 light = hidden ? vec3(0.0) : paths[path].pending;
    paths[path].pending = vec3(0.0);
    if (push.bounce == 0u) {
        paths[path].direct = light;
    } else {
        paths[path].indirect += light;
    }
}
