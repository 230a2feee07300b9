#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"

// A vertex with the light that leaves its two sides.

layout(set = 0, binding = 0, scalar) restrict readonly buffer Frame { LitFrame frame; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Positions { vec3 positions[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Normals { vec3 normals[]; };
layout(set = 0, binding = 3, scalar) restrict readonly buffer Texcoords { vec2 texcoords[]; };
layout(set = 0, binding = 4, scalar) restrict readonly buffer Radiance { vec3 radiance[]; };
layout(set = 0, binding = 5, scalar) restrict readonly buffer Visibility { float visibility[]; };
layout(push_constant, scalar) uniform Push { LitDraw push; };

layout(location = 0) out vec3 out_front;
layout(location = 1) out vec3 out_back;
layout(location = 2) out vec4 out_normal;
layout(location = 3) out vec2 out_texcoord;
layout(location = 4) out vec3 out_from_eye;

void main() {
    uint vertex = uint(gl_VertexIndex);
    out_front = radiance[2u * vertex];
    out_back = radiance[2u * vertex + 1u];
    out_normal = vec4(normals[vertex], visibility[vertex]);
    vec3 uv = vec3(texcoords[vertex], 1.0);
    out_texcoord = vec2(dot(push.texcoord_u, uv), dot(push.texcoord_v, uv));
    out_from_eye = positions[vertex] - frame.eye;
    gl_Position = frame.relative_to_clip * vec4(positions[vertex], 1.0);
}
