#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"

// A vertex with what it sees of up to four lamps.

layout(set = 0, binding = 0, scalar) restrict readonly buffer Frame { LitFrame frame; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Positions { vec3 positions[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Texcoords { vec2 texcoords[]; };
layout(set = 0, binding = 3, scalar) restrict readonly buffer Visibility { vec4 visibility[]; };
layout(push_constant, scalar) uniform Push { LitDraw push; };

layout(location = 0) out vec4 out_visibility;
layout(location = 1) out vec2 out_texcoord;

void main() {
    uint vertex = uint(gl_VertexIndex);
    out_visibility = visibility[vertex];
    vec3 uv = vec3(texcoords[vertex], 1.0);
    out_texcoord = vec2(dot(push.texcoord_u, uv), dot(push.texcoord_v, uv));
    gl_Position = frame.relative_to_clip * vec4(positions[vertex], 1.0);
}
