#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "boxes.glsl"

// Nearest vertex (or point of a triangle) of the surface, exactly: of equals the lowest number.
//
// An invocation takes a block of BLOCK_SIZE neighbours in Morton order at once: one load of
// an item serves them all. What lies in the leaf nearest to the block bounds the search. The
// hierarchy is walked in order without a stack: after a box comes its first child if it may hold
// something nearer to any of the queries, else the next box that has not been passed.
//
// One dispatch walks the boxes [root_first, root_last) of one level, and goes on from what the
// dispatches before it found: Mesa's software driver ends the loops of an invocation, all
// together, after 65,535 rounds.

layout(local_size_x = GROUP_1D) in;
layout(constant_id = 0) const uint FACES = 0;
layout(constant_id = 1) const uint BLOCK_SIZE = NEAREST_QUERIES;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Queries { vec4 queries[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Items { vec4 items[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Vertices { vec4 vertices[]; };
layout(set = 0, binding = 3, scalar) restrict readonly buffer Indices { uint indices[]; };
layout(set = 0, binding = 4, scalar) restrict readonly buffer Boxes { vec3 boxes[]; };
layout(set = 0, binding = 5, scalar) restrict readonly buffer Levels { uvec2 levels[]; };
layout(set = 0, binding = 6, scalar) restrict buffer Result { vec4 result[]; };
layout(push_constant, scalar) uniform Push { NearestQueries push; };

// The block with what is nearest so far.
struct Block {
    vec3 query[BLOCK_SIZE];
    float squared[BLOCK_SIZE];
    uint number[BLOCK_SIZE];
};

vec3 corner(uint triangle, uint k) {
    return vertices[indices[3u * triangle + k]].xyz;
}

// Takes the items of a leaf.
void consider(inout Block block, uint leaf) {
    uint last = min(BOX_CHILDREN * (leaf + 1u), push.items);
    for (uint place = BOX_CHILDREN * leaf; place < last; ++place) {
        vec4 item = items[place];
        uint candidate = floatBitsToUint(item.w);
        vec3 a = item.xyz;
        vec3 b = vec3(0.0);
        vec3 c = vec3(0.0);
        if (FACES != 0u) {
            a = corner(candidate, 0u);
            b = corner(candidate, 1u);
            c = corner(candidate, 2u);
        }
        [[unroll]] for (uint k = 0u; k < BLOCK_SIZE; ++k) {
            vec3 p = a;
            if (FACES != 0u) {
                vec3 weights = closest_on_triangle(block.query[k], a, b, c);
                p = weights.x * a + weights.y * b + weights.z * c;
            }
            vec3 d = block.query[k] - p;
            float distance = dot(d, d);
            bool better = distance < block.squared[k] || (distance == block.squared[k] && candidate < block.number[k]);
            block.squared[k] = better ? distance : block.squared[k];
            block.number[k] = better ? candidate : block.number[k];
        }
    }
}

// Whether a box may hold something nearer to any of the queries.
bool matters(Block block, uint box) {
    vec3 low = boxes[2u * box];
    vec3 high = boxes[2u * box + 1u];
    bool any_nearer = false;
    [[unroll]] for (uint k = 0u; k < BLOCK_SIZE; ++k) {
        any_nearer = any_nearer || box_distance_squared(block.query[k], low, high) <= block.squared[k];
    }
    return any_nearer;
}

// The leaf that is nearest to the block's centre at every level on the way down.
uint first_leaf(vec3 centre) {
    uint box = 0u;
    uint begin = 0u;
    uint end = BOX_CHILDREN;
    for (uint level = push.levels; level > 0u; --level) {
        uvec2 here = levels[level - 1u];
        float least = 3.0e38;
        for (uint b = begin; b < min(end, here.y); ++b) {
            uint at = 2u * (here.x + b);
            float d = box_distance_squared(centre, boxes[at], boxes[at + 1u]);
            if (d < least) {
                least = d;
                box = b;
            }
        }
        begin = BOX_CHILDREN * box;
        end = begin + BOX_CHILDREN;
    }
    return box;
}

void search(inout Block block) {
    uint level = push.root_level;
    uint box = push.root_first;
    while (true) {
        uvec2 here = levels[level - 1u];
        uint end = level == push.root_level ? push.root_last : here.y;
        bool open = box < end && matters(block, here.x + box);
        if (open && level > 1u) {
            level -= 1u;
            box *= BOX_CHILDREN;
            continue;
        }
        if (open) {
            consider(block, box);
        }
        box += 1u;
        // The last sibling, or past the end of the level: go on beside the parent.
        while (level < push.root_level && (box % BOX_CHILDREN == 0u || box >= levels[level - 1u].y)) {
            box = (box - 1u) / BOX_CHILDREN + 1u;
            level += 1u;
        }
        if (level == push.root_level && box >= push.root_last) {
            return;
        }
    }
}

// Squared distance to what an earlier dispatch found.
float known_squared(vec3 q, uint number, vec3 weights) {
    vec3 p = FACES == 0u
        ? vertices[number].xyz
        : weights.x * corner(number, 0u) + weights.y * corner(number, 1u) + weights.z * corner(number, 2u);
    vec3 d = q - p;
    return dot(d, d);
}

void main() {
    uint first = flat_invocation() * BLOCK_SIZE;
    if (first >= push.count) {
        return;
    }
    Block block;
    vec3 low = queries[first].xyz;
    vec3 high = low;
    [[unroll]] for (uint k = 0u; k < BLOCK_SIZE; ++k) {
        // The last block repeats its last query.
        vec4 query = queries[min(first + k, push.count - 1u)];
        block.query[k] = query.xyz;
        block.squared[k] = 3.0e38;
        block.number[k] = 0xffffffffu;
        if (push.continues != 0u) {
            vec4 known = result[floatBitsToUint(query.w)];
            block.number[k] = floatBitsToUint(known.x);
            block.squared[k] = known_squared(query.xyz, block.number[k], known.yzw);
        }
        low = min(low, query.xyz);
        high = max(high, query.xyz);
    }
    if (push.continues == 0u) {
        consider(block, first_leaf(0.5 * (low + high)));
    }
    search(block);
    for (uint k = 0u; k < BLOCK_SIZE && first + k < push.count; ++k) {
        uint number = block.number[k];
        vec3 weights = vec3(1.0, 0.0, 0.0);
        if (FACES != 0u) {
            weights = closest_on_triangle(
                block.query[k], corner(number, 0u), corner(number, 1u), corner(number, 2u));
        }
        result[floatBitsToUint(queries[first + k].w)] = vec4(uintBitsToFloat(number), weights);
    }
}
