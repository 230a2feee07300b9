#ifndef TRACE_GLSL
#define TRACE_GLSL
#include "abi.glsl"
#include "dispatch.glsl"
#include "rays.glsl"

// The kernel of any_hit.comp and nearest_hit.comp, which define ANY_HIT.
//
// An invocation traces several rays, one after the other in one loop: a ray that is done gives
// its place to the next, so that neighbours in a subgroup wait for each other only at the end. One
// round takes a pair of triangles and opens a node, neither waiting for the other, because on
// devices that run all lanes in step both are paid for whenever either is taken. What is
// needed seldom (the next ray, masks) stands outside of the rounds: only loops are
// skipped on such devices.
//
// The loop has a budget of rounds (Mesa's software driver ends the loops of an invocation, all
// together, after 65,535 rounds). What is under way when it is spent is written to `states`, and
// another dispatch goes on from there.

layout(local_size_x = GROUP_1D) in;
layout(constant_id = 0) const uint MASKED = 0;
// Groups that may wait, at most RAY_STACK.
layout(constant_id = 1) const uint STACK = 24;
layout(set = 0, binding = 0, rgba32ui) uniform restrict readonly uimage2D nodes;
layout(set = 0, binding = 1, rgba32ui) uniform restrict readonly uimage2D quads;
layout(set = 0, binding = 2, rgba32ui) uniform restrict readonly uimage2D cutouts;
layout(set = 0, binding = 3, rgba32f) uniform restrict readonly image2D rays;
layout(set = 0, binding = 4, scalar) restrict buffer Hits { uint hits[]; };
layout(set = 0, binding = 5, scalar) restrict buffer States { uint states[]; };
layout(set = 0, binding = 6, scalar) restrict buffer Unfinished { uint unfinished; };
layout(push_constant, scalar) uniform Push { TraceRays push; };

const uint GROUP_WAITS = 0x1000000u;

// What is left to do for a ray.
struct Walk {
    // First child of the group, and which of its children wait (high 8 bits, in the ray's order;
    // low 8 bits: which of the node's places hold nodes).
    uvec2 group;
    // First pair of a node, and which wait; then the same of the node opened after it.
    uvec2 leaves;
    uvec2 later;
    // Distance and twice the pair plus the triangle of what was met.
    float t_max;
    uint nearest;
    // The triangle whose mask is to be read, its distance and weights, and whether the pair's
    // other triangle was met too.
    uint candidate;
    float t;
    vec3 weights;
    bool both;
    // The triangle that is tested once more, because the pair's nearer one was transparent.
    uint again;
};

// Groups that wait, the next to be taken first. Moved as a whole: kept in registers, that costs
// software drivers less than an index of each lane's own.
uvec2 stack[RAY_STACK];

void pop_stack(bool moves) {
    [[unroll]] for (uint i = 0u; i + 1u < RAY_STACK; ++i) {
        if (i + 1u < STACK) {
            stack[i] = moves ? stack[i + 1u] : stack[i];
        } else if (i < STACK) {
            stack[i] = moves ? uvec2(0u) : stack[i];
        }
    }
    if (STACK == RAY_STACK) {
        stack[RAY_STACK - 1u] = moves ? uvec2(0u) : stack[RAY_STACK - 1u];
    }
}

void push_stack(bool moves) {
    [[unroll]] for (uint i = RAY_STACK - 1u; i > 0u; --i) {
        if (i < STACK) {
            stack[i] = moves ? stack[i - 1u] : stack[i];
        }
    }
}

bool nothing_left(Walk walk) {
    bool left = walk.leaves.y != 0u || walk.group.y >= GROUP_WAITS || stack[0].y != 0u;
    return MASKED != 0u ? !left && walk.candidate == RAY_NOTHING && walk.again == RAY_NOTHING : !left;
}

void clear(inout Walk walk) {
    walk.group = uvec2(0u);
    walk.leaves = uvec2(0u);
    walk.later = uvec2(0u);
    walk.candidate = RAY_NOTHING;
    walk.again = RAY_NOTHING;
    [[unroll]] for (uint i = 0u; i < RAY_STACK; ++i) {
        stack[i] = uvec2(0u);
    }
}

// Takes a pair of triangles from those that wait and opens a node.
void take_round(Ray ray, inout Walk walk) {
    bool again = MASKED != 0u && walk.again != RAY_NOTHING;
    bool waits = walk.leaves.y != 0u || again;
    if (MASKED != 0u) {
        waits = waits && walk.candidate == RAY_NOTHING;
    }
    uint quad = walk.leaves.x + lowest_bit(walk.leaves.y);
    uint wanted = waits ? 3u : 0u;
    walk.leaves.y &= waits && !again ? walk.leaves.y - 1u : 0xffffffffu;
    if (MASKED != 0u) {
        quad = again ? walk.again >> 1u : quad;
        wanted &= again ? 1u << (walk.again & 1u) : 3u;
        walk.again = waits ? RAY_NOTHING : walk.again;
    }
    // A node is opened where there is room for its pairs.
    bool pops = walk.group.y < GROUP_WAITS;
    bool opens = walk.later.y == 0u && (!pops || stack[0].y != 0u);
    pops = pops && opens;
    uvec2 group = pops ? stack[0] : walk.group;
    uint bit = highest_bit(group.y);
    uint child = (bit - 24u) ^ ray.order;
    uint before = bitCount(group.y & 0xffu & ((1u << child) - 1u));
    uint node_at = opens ? RAY_NODE_TEXELS * (group.x + before) : 0u;
    uint quad_at = waits ? (MASKED != 0u ? RAY_MASKED_TEXELS : RAY_QUAD_TEXELS) * quad : 0u;
    // All is fetched before anything is computed: the fetches take the time of each other.
    uvec4 head = ray_texel(nodes, node_at);
    uvec4 about = ray_texel(nodes, node_at + 1u);
    uvec4 xy = ray_texel(nodes, node_at + 2u);
    uvec4 zx = ray_texel(nodes, node_at + 3u);
    uvec4 yz = ray_texel(nodes, node_at + 4u);
    vec4 a = uintBitsToFloat(ray_texel(quads, quad_at));
    vec4 b = uintBitsToFloat(ray_texel(quads, quad_at + 1u));
    vec4 c = uintBitsToFloat(ray_texel(quads, quad_at + 2u));
    // A group that is taken and put back keeps its place.
    uvec2 rest = uvec2(group.x, group.y & ~(1u << bit));
    bool pushes = opens && rest.y >= GROUP_WAITS;
    pop_stack(pops && !pushes);
    push_stack(pushes && !pops);
    stack[0] = pushes ? rest : stack[0];
    uint open = open_boxes(ray, walk.t_max, head, about.zw, xy, zx, yz);
    uvec2 children = uvec2(about.x, in_ray_order(open >> 24u, ray.order) << 24u | head.w >> 24u);
    walk.group = opens ? children : walk.group;
    uvec2 pairs = opens ? uvec2(about.y, open & 0xffffffu) : uvec2(0u);
    pairs = walk.later.y != 0u ? walk.later : pairs;
    bool free = walk.leaves.y == 0u;
    walk.leaves = free ? pairs : walk.leaves;
    walk.later = free ? uvec2(0u) : pairs;
    Meeting meeting = intersect(ray, a.xyz, b.xyz, c.xyz, vec3(a.w, b.w, c.w), walk.t_max, wanted);
    uint met = 2u * quad + meeting.which;
    if (MASKED != 0u) {
        walk.candidate = meeting.any ? met : walk.candidate;
        walk.t = meeting.any ? meeting.t : walk.t;
        walk.weights = meeting.any ? meeting.weights : walk.weights;
        walk.both = meeting.any ? meeting.both : walk.both;
    } else {
        walk.nearest = meeting.any ? met : walk.nearest;
        walk.t_max = meeting.any ? meeting.t : walk.t_max;
    }
}

// Reads the mask of what was met.
void read_mask(inout Walk walk) {
    bool asks = walk.candidate != RAY_NOTHING;
    uint quad_at = asks ? RAY_MASKED_TEXELS * (walk.candidate >> 1u) : 0u;
    uvec4 about = ray_texel(quads, quad_at + 3u);
    vec4 ab = uintBitsToFloat(ray_texel(quads, quad_at + 4u));
    vec4 cd = uintBitsToFloat(ray_texel(quads, quad_at + 5u));
    vec2 first = (walk.candidate & 1u) != 0u ? cd.zw : ab.xy;
    vec2 at = walk.weights.x * first + walk.weights.y * ab.zw + walk.weights.z * cd.xy;
    uvec4 cutout = ray_texel(cutouts, about.z);
    uvec2 texel = cutout_texel(at, cutout);
    uint bit_at = texel.y * cutout.y + texel.x;
    uvec4 bits = ray_texel(cutouts, cutout.x + (bit_at >> 7u));
    uint word = (bit_at & 64u) != 0u ? ((bit_at & 32u) != 0u ? bits.w : bits.z)
                                     : ((bit_at & 32u) != 0u ? bits.y : bits.x);
    bool stops = asks && ((word >> (bit_at & 31u)) & 1u) != 0u;
    walk.t_max = stops ? walk.t : walk.t_max;
    walk.nearest = stops ? walk.candidate : walk.nearest;
    walk.again = asks && !stops && walk.both ? walk.candidate ^ 1u : walk.again;
    walk.candidate = RAY_NOTHING;
}

void store_state(uint id, Walk walk, uint place, uint found) {
    uint at = id * RAY_STATE;
    states[at] = walk.group.x;
    states[at + 1u] = walk.group.y;
    states[at + 2u] = walk.leaves.x;
    states[at + 3u] = walk.leaves.y;
    states[at + 4u] = walk.later.x;
    states[at + 5u] = walk.later.y;
    states[at + 6u] = floatBitsToUint(walk.t_max);
    states[at + 7u] = walk.nearest;
    states[at + 8u] = walk.again;
    states[at + 9u] = place;
    states[at + 10u] = found;
    [[unroll]] for (uint i = 0u; i < RAY_STACK; ++i) {
        if (i < STACK) {
            states[at + 11u + 2u * i] = stack[i].x;
            states[at + 12u + 2u * i] = stack[i].y;
        }
    }
}

void load_state(uint id, inout Walk walk, out uint place, out uint found) {
    uint at = id * RAY_STATE;
    walk.group = uvec2(states[at], states[at + 1u]);
    walk.leaves = uvec2(states[at + 2u], states[at + 3u]);
    walk.later = uvec2(states[at + 4u], states[at + 5u]);
    walk.t_max = uintBitsToFloat(states[at + 6u]);
    walk.nearest = states[at + 7u];
    walk.again = states[at + 8u];
    place = states[at + 9u];
    found = states[at + 10u];
    [[unroll]] for (uint i = 0u; i < RAY_STACK; ++i) {
        if (i < STACK) {
            stack[i] = uvec2(states[at + 11u + 2u * i], states[at + 12u + 2u * i]);
        }
    }
}

void main() {
    uint id = flat_invocation();
    if (id >= push.invocations) {
        return;
    }
    Walk walk;
    clear(walk);
    walk.t_max = 0.0;
    walk.nearest = RAY_NOTHING;
    // One less than the first ray.
    uint place = 0xffffffffu;
    uint found = 0u;
    Ray ray = make_ray(vec3(0.0), vec3(1.0));
    if (push.continues != 0u) {
        load_state(id, walk, place, found);
    }
    bool idle = nothing_left(walk);
    if (!idle) {
        uint texel = 2u * (place * push.invocations + id);
        ray = make_ray(ray_texel(rays, texel).xyz, ray_texel(rays, texel + 1u).xyz);
    }
    uint round = 0u;
    while (round < push.rounds) {
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
                    if (!ANY_HIT && !(origin.w > 0.0)) {
                        hits[2u * index + 1u] = RAY_NOTHING;
                    }
                }
            } while (!all_done && !(origin.w > 0.0));
            if (all_done) {
                break;
            }
            ray = make_ray(origin.xyz, ray_texel(rays, 2u * index + 1u).xyz);
            clear(walk);
            walk.group = uvec2(0u, 0x80000000u);
            walk.t_max = origin.w;
            walk.nearest = RAY_NOTHING;
        }
        for (uint k = 0u; k < RAY_ROUNDS; ++k) {
            take_round(ray, walk);
        }
        round += RAY_ROUNDS;
        if (MASKED != 0u) {
            read_mask(walk);
        }
        bool stop = ANY_HIT && walk.nearest != RAY_NOTHING;
        idle = stop || nothing_left(walk);
        if (idle) {
            if (ANY_HIT) {
                found |= stop ? 1u << place : 0u;
            } else {
                bool meets = walk.nearest != RAY_NOTHING;
                uint stride = MASKED != 0u ? RAY_MASKED_TEXELS : RAY_QUAD_TEXELS;
                uvec4 about = ray_texel(quads, stride * (walk.nearest >> 1u) + 3u);
                uint index = 2u * (place * push.invocations + id);
                hits[index] = floatBitsToUint(walk.t_max);
                hits[index + 1u] = meets ? ((walk.nearest & 1u) != 0u ? about.y : about.x) : RAY_NOTHING;
            }
        }
    }
    if (ANY_HIT) {
        hits[id] = found;
    }
    if (idle) {
        clear(walk);
    }
    bool more = !idle || (place + 1u < push.places && (place + 1u) * push.invocations + id < push.count);
    if (more) {
        atomicOr(unfinished, 1u);
    }
    // All write: when any has to go on, all are read.
    store_state(id, walk, place, found);
}

#endif
