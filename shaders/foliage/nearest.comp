#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "boxes.glsl"

// Nearest vertex (or point of a triangle) of the surface, exactly: of equals the lowest number.
//
// An invocation takes a block of NEAREST_QUERIES neighbours in Morton order at once: one load of
// an item serves them all. What lies in the leaf nearest to the block bounds the search. The
// hierarchy is walked in order without a stack: after a box comes its first child if it may hold
// something nearer to any of the queries, else the next box that has not been passed.

layout(local_size_x = GROUP_1D) in;
layout(constant_id = 0) const uint FACES = 0;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Queries { vec4 queries[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Items { vec4 items[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Vertices { vec4 vertices[]; };
layout(set = 0, binding = 3, scalar) restrict readonly buffer Indices { uint indices[]; };
layout(set = 0, binding = 4, scalar) restrict readonly buffer Boxes { vec3 boxes[]; };
layout(set = 0, binding = 5, scalar) restrict readonly buffer Levels { uvec2 levels[]; };
layout(set = 0, binding = 6, scalar) restrict writeonly buffer Result { vec4 result[]; };
layout(push_constant, scalar) uniform Push { NearestQueries push; };

// The block with what is nearest so far. Globals: as an argument it would be copied.
vec3 query[NEAREST_QUERIES];
float squared[NEAREST_QUERIES];
uint number[NEAREST_QUERIES];
vec3 block_low;
vec3 block_high;
// Largest of `squared`: nothing farther than this from the block can matter.
float reach;

vec3 corner(uint triangle, uint k) {
    return vertices[indices[3u * triangle + k]].xyz;
}

// Takes the items of a leaf.
void consider(uint leaf) {
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
        for (uint k = 0u; k < NEAREST_QUERIES; ++k) {
            vec3 p = a;
            if (FACES != 0u) {
                vec3 weights = closest_on_triangle(query[k], a, b, c);
                p = weights.x * a + weights.y * b + weights.z * c;
            }
            vec3 d = query[k] - p;
            float distance = dot(d, d);
            bool better = distance < squared[k] || (distance == squared[k] && candidate < number[k]);
            squared[k] = better ? distance : squared[k];
            number[k] = better ? candidate : number[k];
        }
    }
    reach = 0.0;
    for (uint k = 0u; k < NEAREST_QUERIES; ++k) {
        reach = max(reach, squared[k]);
    }
}

// Squared distance between the block and a box, rounded down.
float gap_squared(uint box) {
    vec3 d = max(max(boxes[2u * box] - block_high, block_low - boxes[2u * box + 1u]), vec3(0.0));
    return dot(d, d) * (1.0 - 1e-5);
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

void search(uint visited) {
    // The top level has at most BOX_CHILDREN boxes.
    uint level = push.levels;
    uint box = 0u;
    while (true) {
        uvec2 here = levels[level - 1u];
        bool open = box < here.y && gap_squared(here.x + box) <= reach;
        if (open && level > 1u) {
            level -= 1u;
            box *= BOX_CHILDREN;
            continue;
        }
        if (open && box != visited) {
            consider(box);
        }
        box += 1u;
        // The last sibling, or past the end of the level: go on beside the parent.
        while (level < push.levels && (box % BOX_CHILDREN == 0u || box >= levels[level - 1u].y)) {
            box = (box - 1u) / BOX_CHILDREN + 1u;
            level += 1u;
        }
        if (level == push.levels && box >= levels[level - 1u].y) {
            return;
        }
    }
}

void main() {
    uint first = flat_invocation() * NEAREST_QUERIES;
    if (first >= push.count) {
        return;
    }
    for (uint k = 0u; k < NEAREST_QUERIES; ++k) {
        // The last block repeats its last query.
        query[k] = queries[min(first + k, push.count - 1u)].xyz;
        squared[k] = 3.0e38;
        number[k] = 0xffffffffu;
        block_low = k == 0u ? query[k] : min(block_low, query[k]);
        block_high = k == 0u ? query[k] : max(block_high, query[k]);
    }
    uint leaf = first_leaf(0.5 * (block_low + block_high));
    consider(leaf);
    search(leaf);
    for (uint k = 0u; k < NEAREST_QUERIES && first + k < push.count; ++k) {
        vec3 weights = vec3(1.0, 0.0, 0.0);
        if (FACES != 0u) {
            weights = closest_on_triangle(query[k], corner(number[k], 0u), corner(number[k], 1u),
                corner(number[k], 2u));
        }
        result[floatBitsToUint(queries[first + k].w)] = vec4(uintBitsToFloat(number[k]), weights);
    }
}
