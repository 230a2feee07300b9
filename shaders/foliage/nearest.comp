#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "boxes.glsl"

// Nearest vertex (or point of a triangle) of the surface, exactly: of equals the lowest number.
//
// An invocation takes NEAREST_QUERIES neighbours in Morton order one after the other. What was
// nearest to the last one bounds the search of the next, so most boxes are never opened. The
// hierarchy is walked in order without a stack: after a box comes its first child if it may hold
// something nearer, else the next box that has not been passed.

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

struct Best {
    float squared;
    uint number;
    // Place in the order of the items, to start the next search from.
    uint place;
    vec3 weights;
};

vec3 corner(uint triangle, uint k) {
    return vertices[indices[3u * triangle + k]].xyz;
}

void consider(inout Best best, vec3 q, uint place) {
    vec4 item = items[place];
    uint number = floatBitsToUint(item.w);
    vec3 weights = vec3(1.0, 0.0, 0.0);
    vec3 p = item.xyz;
    if (FACES != 0u) {
        vec3 a = corner(number, 0u);
        vec3 b = corner(number, 1u);
        vec3 c = corner(number, 2u);
        weights = closest_on_triangle(q, a, b, c);
        p = weights.x * a + weights.y * b + weights.z * c;
    }
    vec3 d = q - p;
    float squared = dot(d, d);
    if (squared < best.squared || (squared == best.squared && number < best.number)) {
        best = Best(squared, number, place, weights);
    }
}

void search(inout Best best, vec3 q) {
    // The top level has at most BOX_CHILDREN boxes.
    uint level = push.levels;
    uint box = 0u;
    while (true) {
        uvec2 here = levels[level - 1u];
        bool open = false;
        if (box < here.y) {
            uint at = 2u * (here.x + box);
            open = box_distance_squared(q, boxes[at], boxes[at + 1u]) <= best.squared;
        }
        if (open && level > 1u) {
            level -= 1u;
            box *= BOX_CHILDREN;
            continue;
        }
        if (open) {
            uint last = min(BOX_CHILDREN * (box + 1u), push.items);
            for (uint place = BOX_CHILDREN * box; place < last; ++place) {
                consider(best, q, place);
            }
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
    uint last = min(first + NEAREST_QUERIES, push.count);
    uint place = 0u;
    for (uint i = first; i < last; ++i) {
        vec4 query = queries[i];
        Best best = Best(3.0e38, 0xffffffffu, 0u, vec3(1.0, 0.0, 0.0));
        if (i == first) {
            // A start: down the boxes, each time to the nearest child.
            uint box = 0u;
            uint begin = 0u;
            uint end = levels[push.levels - 1u].y;
            for (uint level = push.levels; level > 0u; --level) {
                uvec2 here = levels[level - 1u];
                float least = 3.0e38;
                for (uint b = begin; b < min(end, here.y); ++b) {
                    uint at = 2u * (here.x + b);
                    float d = box_distance_squared(query.xyz, boxes[at], boxes[at + 1u]);
                    if (d < least) {
                        least = d;
                        box = b;
                    }
                }
                begin = BOX_CHILDREN * box;
                end = begin + BOX_CHILDREN;
            }
            place = min(begin, push.items - 1u);
        }
        consider(best, query.xyz, place);
        search(best, query.xyz);
        place = best.place;
        result[floatBitsToUint(query.w)] = vec4(uintBitsToFloat(best.number), best.weights);
    }
}
