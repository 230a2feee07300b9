#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"

// One triangle over the whole picture, infinitely far away.

layout(set = 0, binding = 0, scalar) uniform Frame { RenderFrame frame; };

layout(location = 0) out vec3 out_direction;

void main() {
    vec2 corner = vec2((gl_VertexIndex << 1) & 2, gl_VertexIndex & 2) * 2.0 - 1.0;
    out_direction = frame.forward + corner.x * frame.right - corner.y * frame.up;
    gl_Position = vec4(corner, 0.0, 1.0);
}
