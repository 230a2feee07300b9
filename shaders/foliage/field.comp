#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "bins.glsl"
#include "influence.glsl"

// Density and its gradient at query points (Luft, Balzer, Deussen 2007, equations 2 and 3).
//
// Queries are sorted, so that a block of BLOCK_QUERIES is small. FIELD_SLOTS invocations share a
// block; each takes every FIELD_SLOTS-th generator of the rows of bins that meet the block's
// support and adds it to all queries of the block.

layout(local_size_x = FIELD_GROUP) in;
layout(constant_id = 0) const uint NORM = NORM_EUCLIDEAN;
layout(constant_id = 1) const uint TERMS = FIELD_BOTH;
layout(set = 0, binding = 0) uniform sampler2D generators;
layout(set = 0, binding = 1, scalar) restrict readonly buffer BinFirst { uint bin_first[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Queries { vec4 queries[]; };
layout(set = 0, binding = 3, scalar) restrict writeonly buffer Result { float result[]; };
layout(push_constant, scalar) uniform Push { FieldQueries push; };

const uint VALUES = 4u;
shared float partial[FIELD_GROUP * BLOCK_QUERIES * VALUES];

vec4 generator(uint i) {
    uint column = i & ((1u << GENERATOR_COLUMN_BITS) - 1u);
    return texelFetch(generators, ivec2(column, i >> GENERATOR_COLUMN_BITS), 0);
}

void main() {
    uint block = flat_invocation() / FIELD_SLOTS;
    uint slot = gl_LocalInvocationID.x % FIELD_SLOTS;
    uint first_query = block * BLOCK_QUERIES;
    // Lengths stay unscaled and absolute: nothing may depend on which points share a block.
    float radius_squared = push.radius * push.radius;
    float scale = 1.0 / (radius_squared * radius_squared);
    float inverse_edge = 1.0 / push.bin_edge;
    float support = push.radius * enclosing_radius(NORM) * (1.0 + CULL_MARGIN) + CULL_MARGIN * push.bin_edge;

    vec3 q[BLOCK_QUERIES];
    vec3 low = vec3(0.0);
    vec3 high = vec3(0.0);
    [[unroll]] for (uint k = 0u; k < BLOCK_QUERIES; ++k) {
        q[k] = queries[min(first_query + k, push.count - 1u)].xyz;
        low = k == 0u ? q[0] : min(low, q[k]);
        high = k == 0u ? q[0] : max(high, q[k]);
    }
    float density[BLOCK_QUERIES];
    vec3 gradient[BLOCK_QUERIES];
    [[unroll]] for (uint k = 0u; k < BLOCK_QUERIES; ++k) {
        density[k] = 0.0;
        gradient[k] = vec3(0.0);
    }
    ivec2 zs = bin_range(low.z, high.z, support, push.bin_origin.z, inverse_edge, push.bins.z);
    ivec2 ys = bin_range(low.y, high.y, support, push.bin_origin.y, inverse_edge, push.bins.y);
    if (first_query >= push.count) {
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
                    vec3 p = g.xyz;
                    float weight = g.w * g.w;
                    [[unroll]] for (uint k = 0u; k < BLOCK_QUERIES; ++k) {
                        vec3 d = q[k] - p;
                        float t = max(radius_squared - squared_length(d, NORM), 0.0);
                        float wt = weight * t;
                        if (TERMS != FIELD_GRADIENT) {
                            density[k] = fma(wt, t, density[k]);
                        }
                        if (TERMS != FIELD_DENSITY) {
                            gradient[k] = fma(vec3(wt), outward(d, NORM), gradient[k]);
                        }
                    }
                }
            }
        }
    }
    [[unroll]] for (uint k = 0u; k < BLOCK_QUERIES; ++k) {
        uint at = k * VALUES * FIELD_GROUP + gl_LocalInvocationID.x;
        if (TERMS != FIELD_GRADIENT) {
            partial[at] = density[k];
        }
        if (TERMS != FIELD_DENSITY) {
            [[unroll]] for (uint c = 0u; c < 3u; ++c) {
                partial[at + (c + 1u) * FIELD_GROUP] = gradient[k][c];
            }
        }
    }
    barrier();
    // Slot s adds up the queries s, s + FIELD_SLOTS ... of its block.
    uint column = gl_LocalInvocationID.x - slot;
    for (uint n = slot; n < BLOCK_QUERIES; n += FIELD_SLOTS) {
        vec4 total = vec4(0.0);
        uint first = n * VALUES * FIELD_GROUP + column;
        [[unroll]] for (uint s = 0u; s < FIELD_SLOTS; ++s) {
            if (TERMS != FIELD_GRADIENT) {
                total.x += partial[first + s];
            }
            if (TERMS != FIELD_DENSITY) {
                [[unroll]] for (uint c = 1u; c < VALUES; ++c) {
                    total[c] += partial[first + c * FIELD_GROUP + s];
                }
            }
        }
        if (first_query + n < push.count) {
            uint target = floatBitsToUint(queries[first_query + n].w);
            if (TERMS == FIELD_DENSITY) {
                result[target] = scale * total.x;
            } else {
                result[4u * target] = scale * total.x;
                [[unroll]] for (uint c = 1u; c < VALUES; ++c) {
                    result[4u * target + c] = -4.0 * scale * total[c];
                }
            }
        }
    }
}
