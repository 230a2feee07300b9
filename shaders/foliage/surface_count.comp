#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "surface.glsl"

// Marching cubes, first pass (Lorensen and Cline 1987): vertices and triangles of every row of
// nodes along x, so that scans of the rows give every vertex and triangle its place.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Density { float density[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Cases { uint cases[]; };
layout(set = 0, binding = 2, scalar) restrict writeonly buffer VertexCounts { uint vertex_counts[]; };
layout(set = 0, binding = 3, scalar) restrict writeonly buffer TriangleCounts { uint triangle_counts[]; };
layout(push_constant, scalar) uniform Push { SurfaceGrid push; };

void main() {
    uint row = flat_invocation();
    uvec3 nodes = push.nodes;
    if (row >= nodes.y * nodes.z) {
        return;
    }
    uint y = row % nodes.y;
    uint z = row / nodes.y;
    bool more_y = y + 1u < nodes.y;
    bool more_z = z + 1u < nodes.z;
    uint start = row * nodes.x;
    // Beyond the last row the row itself stands in: it crosses nothing.
    uint step_y = more_y ? nodes.x : 0u;
    uint step_z = more_z ? nodes.x * nodes.y : 0u;
    uint vertices = 0u;
    uint triangles = 0u;
    uint before = 0u;
    for (uint x = 0u; x < nodes.x; ++x) {
        uint i = start + x;
        // Inside bits of the four nodes of this x: corners 0, 2, 4, 6 of the cell ahead.
        uint now = uint(density[i] > push.tau)
            | (uint(density[i + step_y] > push.tau) << 2u)
            | (uint(density[i + step_z] > push.tau) << 4u)
            | (uint(density[i + step_y + step_z] > push.tau) << 6u);
        vertices += ((now >> 2u) ^ now) & 1u;
        vertices += ((now >> 4u) ^ now) & 1u;
        if (x > 0u) {
            vertices += (before ^ now) & 1u;
            if (more_y && more_z) {
                uint state = before | (now << 1u);
                triangles += cases[state + 1u] - cases[state];
            }
        }
        before = now;
    }
    vertex_counts[row] = vertices;
    triangle_counts[row] = triangles / 3u;
}
