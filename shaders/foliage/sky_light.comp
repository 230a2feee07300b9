#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"

// Light at every node: mean over the directions of transmittance times direction (xyz) and of
// transmittance (w), by the Beer-Lambert law; the depths come from sky_depth.comp. Batches of directions add up in order.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Directions { vec4 directions[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Depth { float depth[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer LeafArea { float leaf_area[]; };
layout(set = 0, binding = 3, scalar) restrict buffer Light { vec4 light[]; };
layout(push_constant, scalar) uniform Push { SkyLight push; };

void main() {
    uint node = flat_invocation();
    if (node >= push.node_count) {
        return;
    }
    vec4 sum = push.first == 0u ? vec4(0.0) : light[node];
    float own = 0.5 * push.cell * leaf_area[node];
    for (uint i = 0u; i < push.count; ++i) {
        vec3 w = directions[push.first + i].xyz;
        float largest = max(max(abs(w.x), abs(w.y)), abs(w.z));
        float way = max(depth[i * push.node_count + node] - own / largest, 0.0);
        sum += push.share * exp(-push.extinction * way) * vec4(w, 1.0);
    }
    light[node] = sum;
}
