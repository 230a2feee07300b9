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
//
// What is stored is the depth plus the node's own half of the trapezoid, so that a neighbour reads
// four values instead of eight; sky_light.comp takes that half off again.

layout(local_size_x = SKY_GROUP) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer LeafArea { float leaf_area[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Directions { vec4 directions[]; };
layout(set = 0, binding = 2, scalar) restrict coherent buffer Depth { float depth[]; };
layout(push_constant, scalar) uniform Push { SkyDepth push; };

void main() {
    uint direction = flat_invocation() / SKY_GROUP;
    vec3 w = directions[push.first + min(direction, push.count - 1u)].xyz;
    vec3 a = abs(w);
    uint axis = a.x >= a.y && a.x >= a.z ? 0u : (a.y >= a.z ? 1u : 2u);
    // Rotated so that x is the largest axis.
    vec3 v = axis == 0u ? w : (axis == 1u ? w.yzx : w.zxy);
    uvec3 stride = uvec3(1u, push.nodes.x, push.nodes.x * push.nodes.y);
    stride = axis == 0u ? stride : (axis == 1u ? stride.yzx : stride.zxy);
    uvec3 size = axis == 0u ? push.nodes : (axis == 1u ? push.nodes.yzx : push.nodes.zxy);

    uint slabs = direction < push.count ? size.x : 0u;
    vec2 shift = v.yz / abs(v.x);
    ivec2 low = ivec2(floor(shift));
    vec2 t = shift - vec2(low);
    float half_way = 0.5 * push.cell / abs(v.x);
    uint first = direction * size.x * size.y * size.z;
    int row = int(stride.z);
    int column = int(stride.y);

    for (uint step = 0u; step < slabs; ++step) {
        uint slab = v.x > 0.0 ? slabs - 1u - step : step;
        uint base = first + slab * stride.x;
        uint next = v.x > 0.0 ? base + stride.x : base - stride.x;
        for (uint i = gl_LocalInvocationID.x; i < size.y * size.z; i += SKY_GROUP) {
            ivec2 node = ivec2(i % size.y, i / size.y);
            int at = node.x * column + node.y * row;
            float sum = 0.0;
            if (step > 0u) {
                // Nodes outside of the grid see all light.
                ivec2 p = node + low;
                bvec2 there = bvec2(p.x >= 0 && p.x < int(size.y), p.y >= 0 && p.y < int(size.z));
                bvec2 beyond = bvec2(p.x >= -1 && p.x + 1 < int(size.y), p.y >= -1 && p.y + 1 < int(size.z));
                int q = int(next) + p.x * column + p.y * row;
                vec2 wx = vec2(there.x ? 1.0 - t.x : 0.0, beyond.x ? t.x : 0.0);
                vec2 wy = vec2(there.y ? 1.0 - t.y : 0.0, beyond.y ? t.y : 0.0);
                int px = there.x ? 0 : column;
                int nx = beyond.x ? column : 0;
                int py = there.y ? 0 : row;
                int ny = beyond.y ? row : 0;
                // An offset whose weight is zero points at a neighbour inside instead.
                bool any_inside = (there.x || beyond.x) && (there.y || beyond.y);
                if (any_inside) {
                    sum = wy.x * (wx.x * depth[q + px + py] + wx.y * depth[q + nx + py])
                        + wy.y * (wx.x * depth[q + px + ny] + wx.y * depth[q + nx + ny]);
                }
                sum += 2.0 * half_way * leaf_area[slab * stride.x + uint(at)];
            }
            depth[base + uint(at)] = sum;
        }
        memoryBarrierBuffer();
        barrier();
    }
}
