#ifndef SURFACE_GLSL
#define SURFACE_GLSL

// Numbering of cubes and edges as in marching_cubes_table.rs: corner i of a cell has the offsets
// (i & 1, i >> 1 & 1, i >> 2 & 1); edge 4 * axis + k starts at the k-th corner that is low in
// `axis`. A surface vertex belongs to the low node of its edge.

const uint CASE_OFFSETS = 257u;

uvec3 corner_offset(uint corner) {
    return uvec3(corner & 1u, (corner >> 1u) & 1u, (corner >> 2u) & 1u);
}

// Low corner of an edge.
uint edge_corner(uint edge) {
    uint k = edge & 3u;
    uint axis = edge >> 2u;
    return axis == 0u ? k << 1u : (axis == 1u ? (k & 1u) | ((k & 2u) << 1u) : k);
}

// Edge that starts at `corner` along `axis`.
uint edge_number(uint corner, uint axis) {
    uint k = axis == 0u ? corner >> 1u : (axis == 1u ? (corner & 1u) | ((corner >> 1u) & 2u) : corner);
    return 4u * axis + k;
}

// Owner of a vertex, kept in its fourth component: node number and axis.
float pack_owner(uint node, uint axis) {
    return uintBitsToFloat(node * 4u + axis);
}

// First vertex of a node and which of its three edges are crossed.
uint pack_first(uint first, uint crossed) {
    return first * 8u + crossed;
}

// Number of the vertex on the edge along `axis`.
uint vertex_number(uint packed_first, uint axis) {
    return (packed_first >> 3u) + bitCount(packed_first & ((1u << axis) - 1u));
}

#endif
