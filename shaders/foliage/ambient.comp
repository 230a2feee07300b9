#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"

// Ambient coefficient of a density (Luft, Balzer, Deussen 2007, equation 4).

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Density { float density[]; };
layout(set = 0, binding = 1, scalar) restrict writeonly buffer Ambient { float ambient[]; };
layout(push_constant, scalar) uniform Push { AmbientTransfer push; };

// With d_min <= 0 it is a step.
float transfer(float d) {
    if (d <= 0.0) {
        return 1.0;
    }
    if (d >= push.d_min) {
        return push.k_min;
    }
    // The difference of neighbours is exact; 1 - d / d_min would leave a root of rounding errors.
    float rest = (push.d_min - d) / push.d_min;
    return push.k_min + (1.0 - push.k_min) * (push.exponent == 1.0 ? rest : pow(rest, push.exponent));
}

void main() {
    uint i = flat_invocation();
    if (i >= push.count) {
        return;
    }
    ambient[i] = transfer(density[i] - push.tau);
}
