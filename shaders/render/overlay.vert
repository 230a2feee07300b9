#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "packing.glsl"

// A vertex of the implicit surface.

layout(set = 0, binding = 0, scalar) uniform Frame { RenderFrame frame; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Positions { vec3 positions[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Normals { uint normals[]; };

layout(location = 0) out vec3 out_position;
layout(location = 1) out vec3 out_normal;

void main() {
    uint vertex = uint(gl_VertexIndex);
    out_position = positions[vertex];
    out_normal = unpack_normal16(normals[vertex]);
    gl_Position = frame.relative_to_clip * vec4(out_position, 1.0);
}
