#ifndef TRACE_GLSL
#define TRACE_GLSL
#include "abi.glsl"
#include "dispatch.glsl"
#include "rays.glsl"

// The kernel of any_hit.comp and nearest_hit.comp, which define ANY_HIT.
//
// An invocation traces several rays, one after the other in one loop: a ray that is done gives
// its place to the next, so that neighbours in a subgroup wait for each other only at the end. One
// round takes a triangle or two and opens a node, because on devices that run all lanes in step
// both are paid for whenever either is taken.
//
// The loop has a budget of rounds (Mesa's software driver ends the loops of an invocation, all
// together, after 65,535 rounds). What is under way when it is spent is written to `states`, and
// another dispatch goes on from there.

layout(local_size_x = GROUP_1D) in;
layout(constant_id = 0) const uint MASKED = 0;
layout(set = 0, binding = 0) uniform usampler2D nodes;
layout(set = 0, binding = 1) uniform usampler2D triangles;
layout(set = 0, binding = 2) uniform usampler2D cutouts;
layout(set = 0, binding = 3) uniform sampler2D rays;
layout(set = 0, binding = 4, scalar) restrict buffer Hits { uint hits[]; };
layout(set = 0, binding = 5, scalar) restrict buffer States { uint states[]; };
layout(set = 0, binding = 6, scalar) restrict buffer Unfinished { uint unfinished; };
layout(push_constant, scalar) uniform Push { TraceRays push; };

// What is left to do for a ray.
struct Walk {
    // First child of the group, and which of its children wait (high 8 bits, in the ray's order;
    // low 8 bits: which of the node's places hold nodes).
    uvec2 group;
    // First triangle, and which wait.
    uvec2 leaves;
    // Groups on the stack.
    uint top;
    // Nearest hit: distance and triangle.
    float t_max;
    uint nearest;
};

void store_state(uint id, Walk walk, uvec2 stack[RAY_STACK], uint place, uint found) {
    uint at = id * RAY_STATE;
    states[at] = walk.group.x;
    states[at + 1u] = walk.group.y;
    states[at + 2u] = walk.leaves.x;
    states[at + 3u] = walk.leaves.y;
    states[at + 4u] = walk.top;
    states[at + 5u] = floatBitsToUint(walk.t_max);
    states[at + 6u] = walk.nearest;
    states[at + 7u] = place;
    states[at + 8u] = found;
    for (uint i = 0u; i < walk.top; ++i) {
        states[at + 9u + 2u * i] = stack[i].x;
        states[at + 10u + 2u * i] = stack[i].y;
    }
}

// Takes one triangle from those that wait.
void take_triangle(Ray ray, inout Walk walk) {
    uint bit = lowest_bit(walk.leaves.y);
    bool waits = walk.leaves.y != 0u;
    walk.leaves.y &= walk.leaves.y - 1u;
    uint place = RAY_TRIANGLE_TEXELS * (walk.leaves.x + bit);
    if (MASKED != 0u) {
        place = RAY_MASKED_TEXELS * (walk.leaves.x + bit);
    }
    uvec4 a = ray_texel(triangles, place);
    uvec4 b = ray_texel(triangles, place + 1u);
    uvec4 c = ray_texel(triangles, place + 2u);
    vec4 hit = intersect(ray, uintBitsToFloat(a.xyz), uintBitsToFloat(b.xyz), uintBitsToFloat(c.xyz));
    bool nearer = hit.x < walk.t_max || (hit.x == walk.t_max && a.w < walk.nearest);
    bool taken = waits && hit.x > 0.0 && nearer;
    if (MASKED != 0u) {
        uvec4 uv = ray_texel(triangles, place + 3u);
        uvec4 uw = ray_texel(triangles, place + 4u);
        vec2 at = hit.y * uintBitsToFloat(uv.xy) + hit.z * uintBitsToFloat(uv.zw) + hit.w * uintBitsToFloat(uw.xy);
        uvec4 cutout = ray_texel(cutouts, uw.z);
        uvec2 texel = cutout_texel(at, cutout);
        uint bit_at = texel.y * cutout.y + texel.x;
        uvec4 bits = ray_texel(cutouts, cutout.x + (bit_at >> 7u));
        uint word = (bit_at & 64u) != 0u ? ((bit_at & 32u) != 0u ? bits.w : bits.z)
                                         : ((bit_at & 32u) != 0u ? bits.y : bits.x);
        taken = taken && ((word >> (bit_at & 31u)) & 1u) != 0u;
    }
    walk.t_max = taken ? hit.x : walk.t_max;
    walk.nearest = taken ? a.w : walk.nearest;
}

// Opens the node: its children and triangles that the ray may meet become what waits.
void open_node(Ray ray, uint node, inout Walk walk) {
    uint place = RAY_NODE_TEXELS * node;
    uvec4 head = ray_texel(nodes, place);
    uvec4 meta = ray_texel(nodes, place + 1u);
    uvec4 xy = ray_texel(nodes, place + 2u);
    uvec4 zx = ray_texel(nodes, place + 3u);
    uvec4 yz = ray_texel(nodes, place + 4u);
    vec3 scale = uintBitsToFloat(uvec3(head.w & 0xffu, (head.w >> 8u) & 0xffu, (head.w >> 16u) & 0xffu) << 23u);
    vec3 slope = scale * ray.inverse;
    vec3 start = (uintBitsToFloat(head.xyz) - ray.origin) * ray.inverse;
    bvec3 back = lessThan(ray.inverse, vec3(0.0));
    // Bytes of the near and the far planes of the eight children.
    uvec2 near_x = back.x ? zx.zw : xy.xy;
    uvec2 far_x = back.x ? xy.xy : zx.zw;
    uvec2 near_y = back.y ? yz.xy : xy.zw;
    uvec2 far_y = back.y ? xy.zw : yz.xy;
    uvec2 near_z = back.z ? yz.zw : zx.xy;
    uvec2 far_z = back.z ? zx.xy : yz.zw;
    uint waits = 0u;
    [[unroll]] for (uint half_of = 0u; half_of < 2u; ++half_of) {
        [[unroll]] for (uint k = 0u; k < 4u; ++k) {
            uint shift = 8u * k;
            vec3 near = slope * vec3(uvec3(near_x[half_of], near_y[half_of], near_z[half_of]) >> shift & 0xffu) + start;
            vec3 far = slope * vec3(uvec3(far_x[half_of], far_y[half_of], far_z[half_of]) >> shift & 0xffu) + start;
            float enter = max(max(near.x, near.y), max(near.z, 0.0));
            float leave = min(min(far.x, far.y), min(far.z, walk.t_max));
            uint about = meta[2u + half_of] >> shift & 0xffu;
            waits |= enter <= leave ? (about >> 5u) << (about & 31u) : 0u;
        }
    }
    walk.group = uvec2(meta.x, in_ray_order(waits >> 24u, ray.order) << 24u | head.w >> 24u);
    walk.leaves = uvec2(meta.y, waits & 0xffffffu);
}

void main() {
    uint id = flat_invocation();
    if (id >= push.invocations) {
        return;
    }
    uvec2 stack[RAY_STACK];
    Walk walk;
    uint place = 0u;
    uint found = 0u;
    walk.group = uvec2(0u);
    walk.leaves = uvec2(0u);
    walk.top = 0u;
    walk.t_max = 0.0;
    walk.nearest = RAY_NOTHING;
    bool idle = true;
    Ray ray;
    if (push.continues != 0u) {
        uint at = id * RAY_STATE;
        walk.group = uvec2(states[at], states[at + 1u]);
        walk.leaves = uvec2(states[at + 2u], states[at + 3u]);
        walk.top = states[at + 4u];
        walk.t_max = uintBitsToFloat(states[at + 5u]);
        walk.nearest = states[at + 6u];
        place = states[at + 7u];
        found = states[at + 8u];
        for (uint i = 0u; i < walk.top; ++i) {
            stack[i] = uvec2(states[at + 9u + 2u * i], states[at + 10u + 2u * i]);
        }
        idle = walk.leaves.y == 0u && walk.group.y < 0x1000000u && walk.top == 0u;
        if (!idle) {
            uint texel = 2u * (place * push.invocations + id);
            ray = make_ray(ray_texel(rays, texel).xyz, ray_texel(rays, texel + 1u).xyz);
        }
    }
    // One less, so that the first ray has number 0.
    place = push.continues != 0u ? place : 0xffffffffu;
    uint round = 0u;
    while (round < push.rounds) {
        round += 1u;
        if (idle) {
            // Rays without length (paths that have ended) are passed over at little cost.
            vec4 origin = vec4(0.0);
            uint index = 0u;
            bool all_done = false;
            do {
                place += 1u;
                index = place * push.invocations + id;
                all_done = place >= push.places || index >= push.count;
                if (!all_done) {
                    origin = ray_texel(rays, 2u * index);
                    if (!ANY_HIT) {
                        hits[2u * index + 1u] = RAY_NOTHING;
                    }
                }
            } while (!all_done && !(origin.w > 0.0));
            if (all_done) {
                break;
            }
            ray = make_ray(origin.xyz, ray_texel(rays, 2u * index + 1u).xyz);
            walk.group = uvec2(0u, 0x80000000u);
            walk.leaves = uvec2(0u);
            walk.top = 0u;
            walk.t_max = origin.w;
            walk.nearest = RAY_NOTHING;
        }
        take_triangle(ray, walk);
        if (RAY_TRIANGLES_PER_ROUND > 1u) {
            take_triangle(ray, walk);
        }
        bool stop = ANY_HIT && walk.nearest != RAY_NOTHING;
        if (walk.leaves.y == 0u && !stop) {
            if (walk.group.y < 0x1000000u && walk.top > 0u) {
                walk.top -= 1u;
                walk.group = stack[walk.top];
            }
            if (walk.group.y >= 0x1000000u) {
                uint bit = highest_bit(walk.group.y);
                uint child = (bit - 24u) ^ ray.order;
                uint before = bitCount(walk.group.y & 0xffu & ((1u << child) - 1u));
                uint node = walk.group.x + before;
                walk.group.y &= ~(1u << bit);
                if (walk.group.y >= 0x1000000u) {
                    stack[walk.top] = walk.group;
                    walk.top += 1u;
                }
                open_node(ray, node, walk);
            }
        }
        idle = stop || (walk.leaves.y == 0u && walk.group.y < 0x1000000u && walk.top == 0u);
        if (idle) {
            if (ANY_HIT) {
                found |= stop ? 1u << place : 0u;
            } else {
                uint index = 2u * (place * push.invocations + id);
                hits[index] = floatBitsToUint(walk.t_max);
                hits[index + 1u] = walk.nearest;
            }
        }
    }
    if (ANY_HIT) {
        hits[id] = found;
    }
    if (idle) {
        walk.leaves.y = 0u;
        walk.group.y = 0u;
        walk.top = 0u;
    }
    bool more = !idle || (place + 1u < push.places && (place + 1u) * push.invocations + id < push.count);
    if (more) {
        atomicOr(unfinished, 1u);
    }
    // All write: when any has to go on, all are read.
    store_state(id, walk, stack, place, found);
}

#endif
