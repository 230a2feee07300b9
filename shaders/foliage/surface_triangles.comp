#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "surface.glsl"

// Marching cubes, third pass: the triangles of every row of cells, as indices of the vertices on
// their edges.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Density { float density[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Cases { uint cases[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer RowFirst { uint row_first[]; };
layout(set = 0, binding = 3, scalar) restrict readonly buffer NodeFirst { uint node_first[]; };
layout(set = 0, binding = 4, scalar) restrict writeonly buffer Indices { uint indices[]; };
layout(push_constant, scalar) uniform Push { SurfaceGrid push; };

void main() {
    uint row = flat_invocation();
    uvec3 nodes = push.nodes;
    if (row >= nodes.y * nodes.z || row % nodes.y + 1u >= nodes.y || row / nodes.y + 1u >= nodes.z) {
        return;
    }
    uint next = 3u * row_first[row];
    if (next == 3u * row_first[row + 1u]) {
        return;
    }
    uint start = row * nodes.x;
    uint step_z = nodes.x * nodes.y;
    uint before = 0u;
    for (uint x = 0u; x < nodes.x; ++x) {
        uint i = start + x;
        uint now = uint(density[i] > push.tau)
            | (uint(density[i + nodes.x] > push.tau) << 2u)
            | (uint(density[i + step_z] > push.tau) << 4u)
            | (uint(density[i + nodes.x + step_z] > push.tau) << 6u);
        uint state = before | (now << 1u);
        before = now;
        if (x == 0u || state == 0u || state == 255u) {
            continue;
        }
        uint last = CASE_OFFSETS + cases[state + 1u];
        for (uint c = CASE_OFFSETS + cases[state]; c < last; ++c) {
            uint edge = cases[c];
            uvec3 offset = corner_offset(edge_corner(edge));
            uint node = i - 1u + offset.x + nodes.x * offset.y + step_z * offset.z;
            indices[next] = vertex_number(node_first[node], edge >> 2u);
            ++next;
        }
    }
}
