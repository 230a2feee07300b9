#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "ink_body.glsl"
#include "ink_raster.glsl"

// A vertex of whatever is no leaf: wood, or a smooth body.

layout(set = 0, binding = 0, scalar) restrict readonly buffer Frame { InkFrame frame; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Positions { vec3 positions[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Normals { vec3 normals[]; };
layout(set = 0, binding = 3, scalar) restrict readonly buffer Texcoords { vec2 texcoords[]; };
layout(set = 0, binding = 4, scalar) restrict readonly buffer Hatches { vec4 hatches[]; };
layout(set = 0, binding = 5, scalar) restrict readonly buffer Clusters { InkCluster clusters[]; };
layout(push_constant, scalar) uniform Push { InkWoodDraw push; };

layout(location = 0) out vec3 out_position;
layout(location = 1) out vec3 out_normal;
layout(location = 2) out vec2 out_texcoord;
layout(location = 3) out vec4 out_hatch;
layout(location = 4) flat out uint out_cluster;

void main() {
    uint vertex = uint(gl_VertexIndex);
    // Thicker by a part of a pixel where plants are small: what is thinner stays a line. By more
    // than half of it on each side, since sections of three and four sides are narrower than their circle.
    float depth = max(dot(positions[vertex] - frame.eye, frame.forward), 0.0);
    out_position = positions[vertex] + 0.6 * frame.wood * depth / frame.focal * normals[vertex];
    out_normal = normals[vertex];
    vec3 uv = vec3(texcoords[vertex], 1.0);
    out_texcoord = vec2(dot(push.texcoord_u, uv), dot(push.texcoord_v, uv));
    out_hatch = hatches[vertex];
    out_cluster = 0u;
    if (push.strokes == INK_STROKES_BODY) {
        // The cluster, exact as a float up to 2^24; coordinates follow from the view.
        uint number = uint(hatches[vertex].x);
        InkCluster cluster = clusters[number];
        out_cluster = number + 1u;
        out_hatch = vec4(body_hatch(cluster, out_position, frame.eye, frame.right, frame.up), 0.0, 0.0);
    }
    gl_Position = on_raster(to_clip(frame.relative_to_clip, vec4(out_position, 1.0)), vec2(frame.width, frame.height));
}
