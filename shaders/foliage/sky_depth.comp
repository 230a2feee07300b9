#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"

// Optical depth through the leaf-area field from every node along one direction to the edge of
// the grid (Kunasz and Auer 1988, Short characteristic integration of radiative transfer
// problems). One group sweeps one direction slab by slab along its largest axis, from the side of
// the light inwards: a node's depth is that of the next slab where the ray meets it, plus the way
// there.

layout(local_size_x = SKY_GROUP) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer LeafArea { float leaf_area[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Directions { vec4 directions[]; };
layout(set = 0, binding = 2, scalar) restrict coherent buffer Depth { float depth[]; };
layout(push_constant, scalar) uniform Push { SkyDepth push; };

// Four nodes of a slab around a point and their weights; weights outside of the grid are 0.
struct Meeting {
    uint nodes[4];
    float weights[4];
};

Meeting meeting(vec2 at, uvec2 size, uint base, uvec2 stride) {
    vec2 low = floor(at);
    vec2 t = at - low;
    Meeting m;
    for (uint corner = 0u; corner < 4u; ++corner) {
        vec2 bits = vec2(corner & 1u, corner >> 1u);
        vec2 node = low + bits;
        vec2 w = mix(1.0 - t, t, bits);
        bool inside = all(greaterThanEqual(node, vec2(0.0))) && all(lessThan(node, vec2(size)));
        uvec2 clamped = uvec2(clamp(node, vec2(0.0), vec2(size - 1u)));
        m.nodes[corner] = base + clamped.x * stride.x + clamped.y * stride.y;
        m.weights[corner] = inside ? w.x * w.y : 0.0;
    }
    return m;
}

void main() {
    uint direction = flat_invocation() / SKY_GROUP;
    bool active_group = direction < push.count;
    vec3 w = directions[push.first + min(direction, push.count - 1u)].xyz;
    vec3 a = abs(w);
    uint axis = a.x >= a.y && a.x >= a.z ? 0u : (a.y >= a.z ? 1u : 2u);
    uint b = (axis + 1u) % 3u;
    uint c = (axis + 2u) % 3u;
    uvec3 stride = uvec3(1u, push.nodes.x, push.nodes.x * push.nodes.y);
    uvec2 plane = uvec2(stride[b], stride[c]);
    uvec2 size = uvec2(push.nodes[b], push.nodes[c]);
    uint slabs = active_group ? push.nodes[axis] : 0u;
    bool forward = w[axis] > 0.0;
    vec2 shift = vec2(w[b], w[c]) / a[axis];
    float half_way = 0.5 * push.cell / a[axis];
    uint first = direction * push.nodes.x * push.nodes.y * push.nodes.z;

    for (uint step = 0u; step < slabs; ++step) {
        uint slab = forward ? slabs - 1u - step : step;
        uint next = forward ? slab + 1u : slab - 1u;
        for (uint i = gl_LocalInvocationID.x; i < size.x * size.y; i += SKY_GROUP) {
            uvec2 node = uvec2(i % size.x, i / size.x);
            uint at = slab * stride[axis] + node.x * plane.x + node.y * plane.y;
            float sum = 0.0;
            if (step > 0u) {
                Meeting m = meeting(vec2(node) + shift, size, next * stride[axis], plane);
                float there = 0.0;
                for (uint k = 0u; k < 4u; ++k) {
                    there += m.weights[k] * leaf_area[m.nodes[k]];
                    sum += m.weights[k] * depth[first + m.nodes[k]];
                }
                sum += half_way * (leaf_area[at] + there);
            }
            depth[first + at] = sum;
        }
        memoryBarrierBuffer();
        barrier();
    }
}
