#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"

// Directions of -grad D (modes gradient and multiscale). The fourth component is 1 where there
// is a direction and 0 where the gradient is too small to have one; those are counted.

layout(local_size_x = GROUP_1D) in;
layout(constant_id = 0) const uint MODE = DIRECTIONS_SINGLE;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Near { vec4 near[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Wide { vec4 wide[]; };
layout(set = 0, binding = 2, scalar) restrict buffer Found { vec4 found[]; };
layout(set = 0, binding = 3, scalar) restrict buffer Counters { uint missing; };
layout(push_constant, scalar) uniform Push { GradientDirections push; };

vec4 direction(vec3 gradient, float radius) {
    float size = length(gradient);
    return size * radius > GRADIENT_FLOOR ? vec4(-gradient / size, 1.0) : vec4(0.0);
}

vec4 mean(vec4 a, vec4 b) {
    if (a.w == 0.0 || b.w == 0.0) {
        return a.w == 0.0 ? b : a;
    }
    vec3 sum = a.xyz + b.xyz;
    float size = length(sum);
    return size > OPPOSITE_FLOOR ? vec4(sum / size, 1.0) : a;
}

void main() {
    uint i = flat_invocation();
    if (i >= push.count) {
        return;
    }
    vec4 result;
    if (MODE == DIRECTIONS_FILL) {
        result = found[i];
        if (result.w == 0.0) {
            result = direction(wide[i].yzw, push.wide_radius);
        }
    } else {
        result = direction(near[i].yzw, push.radius);
        if (MODE == DIRECTIONS_MEAN) {
            result = mean(result, direction(wide[i].yzw, push.wide_radius));
        }
    }
    found[i] = result;
    if (result.w == 0.0) {
        atomicAdd(missing, 1u);
    }
}
