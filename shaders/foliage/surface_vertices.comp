#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "surface.glsl"

// Marching cubes, second pass: the vertices of every row of nodes, in the order of nodes and
// axes, and the first vertex of every node.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Density { float density[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer RowFirst { uint row_first[]; };
layout(set = 0, binding = 2, scalar) restrict writeonly buffer NodeFirst { uint node_first[]; };
layout(set = 0, binding = 3, scalar) restrict writeonly buffer Vertices { vec4 vertices[]; };
layout(push_constant, scalar) uniform Push { SurfaceGrid push; };

void main() {
    uint row = flat_invocation();
    uvec3 nodes = push.nodes;
    if (row >= nodes.y * nodes.z) {
        return;
    }
    uvec3 node = uvec3(0u, row % nodes.y, row / nodes.y);
    uvec3 steps = uvec3(1u, nodes.x, nodes.x * nodes.y);
    uint next = row_first[row];
    for (; node.x < nodes.x; ++node.x) {
        uint i = row * nodes.x + node.x;
        float low = density[i];
        bool inside = low > push.tau;
        uint crossed = 0u;
        uint first = next;
        for (uint axis = 0u; axis < 3u; ++axis) {
            if (node[axis] + 1u < nodes[axis]) {
                float high = density[i + steps[axis]];
                if ((high > push.tau) != inside) {
                    vec3 p = fma(vec3(node), vec3(push.cell), push.origin);
                    p[axis] += push.cell * ((push.tau - low) / (high - low));
                    vertices[next] = vec4(p, pack_owner(i, axis));
                    crossed |= 1u << axis;
                    ++next;
                }
            }
        }
        node_first[i] = pack_first(first, crossed);
    }
}
