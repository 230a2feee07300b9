#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"

// A vertex as the sun sees it.

layout(constant_id = 1) const bool HAS_TEXTURE = false;

layout(set = 0, binding = 0, scalar) uniform Frame { RenderFrame frame; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Positions { vec3 positions[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Texcoords { vec2 texcoords[]; };
layout(push_constant, scalar) uniform Push { RenderMaterial material; };

layout(location = 0) out vec2 out_texcoord;

void main() {
    uint vertex = uint(gl_VertexIndex);
    out_texcoord = vec2(0.0);
    if (HAS_TEXTURE) {
        vec3 uv = vec3(texcoords[vertex], 1.0);
        out_texcoord = vec2(dot(material.texcoord_u, uv), dot(material.texcoord_v, uv));
    }
    gl_Position = frame.relative_to_sun * vec4(positions[vertex], 1.0);
}
