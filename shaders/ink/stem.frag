#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"

// Depth of trunk and branches; normal in the camera's frame and light.

layout(set = 0, binding = 0, scalar) restrict readonly buffer Frame { InkFrame frame; };
layout(push_constant, scalar) uniform Push { PaperStem push; };

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in float in_width;
layout(location = 0) out float out_depth;
layout(location = 1) out vec4 out_normal;

void main() {
    if (in_width < push.thin) {
        discard;
    }
    precise vec3 n = in_normal / sqrt(in_normal.x * in_normal.x + in_normal.y * in_normal.y + in_normal.z * in_normal.z);
    n = gl_FrontFacing ? n : -n;
    out_depth = dot(in_position - frame.eye, frame.forward);
    float light = push.ambient + (1.0 - push.ambient) * max(dot(n, frame.to_sun), 0.0);
    vec4 normal = vec4(dot(n, frame.right), dot(n, frame.up), -dot(n, frame.forward), light);
    // On steps that 16-bit floats have: devices round to those in ways of their own.
    out_normal = floor(normal * 1024.0 + 0.5) / 1024.0;
}
