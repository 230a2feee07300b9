#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"

// Normal and ambient coefficient in one word, two words or three floats.

layout(local_size_x = GROUP_1D) in;
layout(constant_id = 0) const uint ENCODING = ENCODING_PACKED16;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Normals { vec3 normals[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Ambient { float ambient[]; };
layout(set = 0, binding = 2, scalar) restrict writeonly buffer Encoded { uint encoded[]; };
layout(push_constant, scalar) uniform Push { Count push; };

// Unit vector to the square [-1,1]^2 (Meyer et al. 2010, On Floating-Point Normal Vectors).
vec2 encode_octahedral(vec3 n) {
    vec2 p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
    if (n.z >= 0.0) {
        return p;
    }
    vec2 side = vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
    return (1.0 - abs(p.yx)) * side;
}

// Signed normalised integer in two's complement, rounded half away from zero.
uint snorm(float value, uint bits) {
    float limit = float((1u << (bits - 1u)) - 1u);
    float scaled = clamp(value, -1.0, 1.0) * limit;
    int rounded = int(scaled < 0.0 ? scaled - 0.5 : scaled + 0.5);
    return uint(rounded) & ((1u << bits) - 1u);
}

uint unorm(float value, uint bits) {
    return uint(clamp(value, 0.0, 1.0) * float((1u << bits) - 1u) + 0.5);
}

void main() {
    uint i = flat_invocation();
    if (i >= push.count) {
        return;
    }
    vec3 n = normals[i];
    float k = ambient[i];
    if (ENCODING == ENCODING_LENGTH) {
        // A zero vector has no direction, so the coefficient stays above zero.
        vec3 scaled = n * clamp(k, SMALLEST_AMBIENT, 1.0);
        for (uint c = 0u; c < 3u; ++c) {
            encoded[3u * i + c] = floatBitsToUint(scaled[c]);
        }
        return;
    }
    vec2 p = encode_octahedral(n);
    if (ENCODING == ENCODING_PACKED16) {
        encoded[2u * i] = snorm(p.x, 16u) | snorm(p.y, 16u) << 16u;
        encoded[2u * i + 1u] = unorm(k, 16u);
    } else {
        encoded[i] = snorm(p.x, 8u) | snorm(p.y, 8u) << 8u | unorm(k, 8u) << 16u;
    }
}
