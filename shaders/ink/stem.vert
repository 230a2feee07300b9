#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "ink_raster.glsl"

// A vertex of trunk and branches.

layout(set = 0, binding = 0, scalar) restrict readonly buffer Frame { InkFrame frame; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Positions { vec3 positions[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Normals { vec3 normals[]; };

layout(set = 0, binding = 3, scalar) restrict readonly buffer Radii { float radii[]; };

layout(location = 0) out vec3 out_position;
layout(location = 1) out vec3 out_normal;
// Width of the branch in the picture, pixels.
layout(location = 2) out float out_width;

void main() {
    uint vertex = uint(gl_VertexIndex);
    out_position = positions[vertex];
    out_normal = normals[vertex];
    float depth = max(dot(out_position - frame.eye, frame.forward), 1e-6);
    out_width = min(2.0 * radii[vertex] * frame.focal / depth, 1e6);
    gl_Position = on_raster(to_clip(frame.relative_to_clip, vec4(out_position, 1.0)), vec2(frame.width, frame.height));
}
