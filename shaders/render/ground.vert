#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"

// Two triangles of the ground plane around the subject.

layout(set = 0, binding = 0, scalar) uniform Frame { RenderFrame frame; };

layout(location = 0) out vec3 out_position;

// Corners of two triangles.
const int CORNERS[6] = int[6](0, 1, 2, 2, 1, 3);

void main() {
    int vertex = CORNERS[gl_VertexIndex];
    vec2 corner = vec2(vertex & 1, vertex >> 1) * 2.0 - 1.0;
    out_position = vec3(frame.crown_centre.x, frame.ground_height, frame.crown_centre.z);
    out_position.xz += corner * frame.ground_radius;
    gl_Position = frame.relative_to_clip * vec4(out_position, 1.0);
}
