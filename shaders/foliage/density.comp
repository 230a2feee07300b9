#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "bins.glsl"
#include "influence.glsl"

// Density at the nodes of a grid (Luft, Balzer, Deussen 2007, equation 3 before the threshold).
//
// A tile of 4x4x4 nodes is shared by FIELD_SLOTS invocations. Each takes every FIELD_SLOTS-th
// generator of the rows of bins that meet the tile's support and adds it to all 64 nodes, so that
// one load serves 64 distances. Generators beyond the support add exact zeros; the order of the
// sums is fixed by the slots, not by the subgroup.

layout(local_size_x = GROUP_1D) in;
layout(constant_id = 0) const uint NORM = NORM_EUCLIDEAN;
layout(set = 0, binding = 0) uniform sampler2D generators;
layout(set = 0, binding = 1, scalar) restrict readonly buffer BinFirst { uint bin_first[]; };
layout(set = 0, binding = 2, scalar) restrict writeonly buffer Density { float density[]; };
layout(push_constant, scalar) uniform Push { DensityGrid push; };

shared float partial[GROUP_1D * TILE_NODES];

vec4 generator(uint i) {
    uint column = i & ((1u << GENERATOR_COLUMN_BITS) - 1u);
    return texelFetch(generators, ivec2(column, i >> GENERATOR_COLUMN_BITS), 0);
}

// Adds one generator to the tile whose first node has the offset `d` from it (in radii).
void add(inout float sum[TILE_NODES], vec3 d, float root, float step) {
    if (NORM != NORM_EUCLIDEAN) {
        [[unroll]] for (uint n = 0u; n < TILE_NODES; ++n) {
            vec3 q = d + step * vec3(n & 3u, (n >> 2u) & 3u, n >> 4u);
            float t = max(root - root * squared_length(q, NORM), 0.0);
            sum[n] = fma(t, t, sum[n]);
        }
        return;
    }
    vec3 square[TILE_SIDE];
    [[unroll]] for (uint k = 0u; k < TILE_SIDE; ++k) {
        vec3 q = d + step * float(k);
        square[k] = root * q * q;
    }
    [[unroll]] for (uint n = 0u; n < TILE_NODES; ++n) {
        float rest = root - square[n >> 4u].z - square[(n >> 2u) & 3u].y;
        float t = max(rest - square[n & 3u].x, 0.0);
        sum[n] = fma(t, t, sum[n]);
    }
}

void main() {
    uvec3 tiles = (push.nodes + (TILE_SIDE - 1u)) / TILE_SIDE;
    uint index = flat_invocation() / FIELD_SLOTS;
    uint slot = gl_LocalInvocationID.x % FIELD_SLOTS;
    uvec3 tile = uvec3(index % tiles.x, index / tiles.x % tiles.y, index / (tiles.x * tiles.y));
    uvec3 first_node = tile * TILE_SIDE;
    vec3 low = fma(vec3(first_node), vec3(push.cell), push.origin);
    vec3 high = low + float(TILE_SIDE - 1u) * push.cell;
    float support = push.radius * enclosing_radius(NORM) * (1.0 + CULL_MARGIN) + CULL_MARGIN * push.bin_edge;
    float inverse_edge = 1.0 / push.bin_edge;
    float inverse_radius = 1.0 / push.radius;
    float step = push.cell * inverse_radius;

    float sum[TILE_NODES];
    [[unroll]] for (uint n = 0u; n < TILE_NODES; ++n) {
        sum[n] = 0.0;
    }
    ivec2 zs = bin_range(low.z, high.z, support, push.bin_origin.z, inverse_edge, push.bins.z);
    ivec2 ys = bin_range(low.y, high.y, support, push.bin_origin.y, inverse_edge, push.bins.y);
    if (tile.z >= tiles.z) {
        zs.y = -1;
    }
    for (int z = zs.x; z <= zs.y; ++z) {
        float gap_z = bin_gap(low.z, high.z, push.bin_origin.z, push.bin_edge, z);
        for (int y = ys.x; y <= ys.y; ++y) {
            float gap_y = bin_gap(low.y, high.y, push.bin_origin.y, push.bin_edge, y);
            float rest = support * support - gap_z * gap_z - gap_y * gap_y;
            if (rest > 0.0) {
                ivec2 xs = bin_range(low.x, high.x, sqrt(rest), push.bin_origin.x, inverse_edge, push.bins.x);
                uint row = push.bins.x * (uint(y) + push.bins.y * uint(z));
                uint last = bin_first[row + uint(xs.y) + 1u];
                uint begin = bin_first[row + uint(xs.x)];
                // A generator belongs to the slot of its number, whatever the range, so that sums do not
                // depend on which points share a block.
                for (uint i = begin + ((slot - begin) & (FIELD_SLOTS - 1u)); i < last; i += FIELD_SLOTS) {
                    vec4 g = generator(i);
                    add(sum, (low - g.xyz) * inverse_radius, g.w, step);
                }
            }
        }
    }
    [[unroll]] for (uint n = 0u; n < TILE_NODES; ++n) {
        partial[n * GROUP_1D + gl_LocalInvocationID.x] = sum[n];
    }
    barrier();
    // Slot s adds up the nodes s * 8 .. s * 8 + 7 of its tile.
    uint column = gl_LocalInvocationID.x - slot;
    [[unroll]] for (uint k = 0u; k < TILE_NODES / FIELD_SLOTS; ++k) {
        uint n = slot * (TILE_NODES / FIELD_SLOTS) + k;
        float total = 0.0;
        [[unroll]] for (uint s = 0u; s < FIELD_SLOTS; ++s) {
            total += partial[n * GROUP_1D + column + s];
        }
        uvec3 node = first_node + uvec3(n & 3u, (n >> 2u) & 3u, n >> 4u);
        if (all(lessThan(node, push.nodes))) {
            density[node.x + push.nodes.x * (node.y + push.nodes.y * node.z)] = total;
        }
    }
}
