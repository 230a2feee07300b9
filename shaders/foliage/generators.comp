#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"

// Centre of mass and one-sided area of every leaf (Luft, Balzer, Deussen 2007, section 3.1).

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Points { vec4 points[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Indices { uvec3 triangles[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer LeafFirst { uint leaf_first[]; };
layout(set = 0, binding = 3, scalar) restrict readonly buffer LeafTriangles { uint leaf_triangles[]; };
layout(set = 0, binding = 4, scalar) restrict writeonly buffer Centres { vec4 centres[]; };
layout(set = 0, binding = 5, scalar) restrict writeonly buffer Areas { float areas[]; };
layout(push_constant, scalar) uniform Push { Count push; };

void main() {
    uint leaf = flat_invocation();
    if (leaf >= push.count) {
        return;
    }
    uint first = leaf_first[leaf];
    uint last = leaf_first[leaf + 1u];
    // Relative to the first corner, small differences keep their digits.
    vec3 origin = points[triangles[leaf_triangles[first]].x].xyz;
    vec3 moment = vec3(0.0);
    vec3 corners = vec3(0.0);
    float area = 0.0;
    for (uint i = first; i < last; ++i) {
        uvec3 t = triangles[leaf_triangles[i]];
        vec3 a = points[t.x].xyz - origin;
        vec3 b = points[t.y].xyz - origin;
        vec3 c = points[t.z].xyz - origin;
        float twice = length(cross(b - a, c - a));
        moment += twice * (a + b + c);
        corners += a + b + c;
        area += twice;
    }
    // A leaf of zero area lies at the mean of its corners.
    vec3 mean = area > 0.0 ? moment / (3.0 * area) : corners / (3.0 * float(last - first));
    centres[leaf] = vec4(origin + mean, 1.0);
    areas[leaf] = 0.5 * area;
}
