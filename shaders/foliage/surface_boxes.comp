#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"

// One level of the hierarchy of boxes over the surface's items in Morton order: every box holds
// BOX_CHILDREN items (the lowest level) or boxes of the level below.

layout(local_size_x = GROUP_1D) in;
layout(constant_id = 0) const uint FACES = 0;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Items { vec4 items[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Vertices { vec4 vertices[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Indices { uint indices[]; };
layout(set = 0, binding = 3, scalar) restrict buffer Boxes { vec3 boxes[]; };
layout(push_constant, scalar) uniform Push { BoxLevel push; };

void main() {
    uint box = flat_invocation();
    if (box >= push.count) {
        return;
    }
    vec3 low = vec3(1e30);
    vec3 high = vec3(-1e30);
    uint last = min(BOX_CHILDREN * (box + 1u), push.children);
    for (uint i = BOX_CHILDREN * box; i < last; ++i) {
        if (push.level > 0u) {
            uint child = push.child_first + i;
            low = min(low, boxes[2u * child]);
            high = max(high, boxes[2u * child + 1u]);
        } else if (FACES == 0u) {
            low = min(low, items[i].xyz);
            high = max(high, items[i].xyz);
        } else {
            uint triangle = floatBitsToUint(items[i].w);
            for (uint k = 0u; k < 3u; ++k) {
                vec3 p = vertices[indices[3u * triangle + k]].xyz;
                low = min(low, p);
                high = max(high, p);
            }
        }
    }
    uint target = push.first + box;
    boxes[2u * target] = low;
    boxes[2u * target + 1u] = high;
}
