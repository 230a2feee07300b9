#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"

// A rectangle through the density field.

layout(set = 0, binding = 0, scalar) uniform Frame { RenderFrame frame; };
layout(push_constant, scalar) uniform Push { RenderOverlay overlay; };

layout(location = 0) out vec2 out_texcoord;

// Corners of two triangles.
const int CORNERS[6] = int[6](0, 1, 2, 2, 1, 3);

void main() {
    int vertex = CORNERS[gl_VertexIndex];
    out_texcoord = vec2(vertex & 1, vertex >> 1);
    vec3 position = overlay.corner + out_texcoord.x * overlay.edge_u + out_texcoord.y * overlay.edge_v;
    gl_Position = frame.relative_to_clip * vec4(position, 1.0);
}
