#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "random.glsl"

// First rays of the paths of a batch: from every side of every receiver, reflected to its own
// side or through the leaf to the other.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Receivers { Receiver receivers[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Materials { LeafSides materials[]; };
layout(set = 0, binding = 2, rgba32f) uniform restrict writeonly image2D rays;
layout(set = 0, binding = 3, scalar) restrict writeonly buffer Paths { vec4 paths[]; };
layout(push_constant, scalar) uniform Push { PrtBatch push; };

void main() {
    uint path = flat_invocation();
    if (path >= push.sides * push.samples) {
        return;
    }
    uint side = path % push.sides;
    uint number = push.first_sample + path / push.sides;
    uint global = push.first_side + side;
    Receiver receiver = receivers[global >> 1u];
    bool front = (side & 1u) == 0u;
    LeafSides material = materials[receiver.material];
    vec3 rho_d = front ? material.rho_d_front : material.rho_d_back;
    float reflects = (rho_d.x + rho_d.y + rho_d.z) / 3.0;
    float transmits = (material.rho_t.x + material.rho_t.y + material.rho_t.z) / 3.0;
    float total = reflects + transmits;
    vec3 u = even_numbers(global, number, push.seed);
    bool is_reflected = u.z * total < reflects;
    vec3 weight = is_reflected ? rho_d * (total / reflects) : material.rho_t * (total / transmits);
    vec3 normal = front == is_reflected ? receiver.normal : -receiver.normal;
    vec3 direction = cosine_direction(normal, u.xy);
    float leaves = dot(direction, receiver.facing) < 0.0 ? -push.offset : push.offset;
    bool alive = total > 0.0;
    ivec2 texel = ivec2((2u * path) & ((1u << RAY_COLUMN_BITS) - 1u), (2u * path) >> RAY_COLUMN_BITS);
    imageStore(rays, texel, vec4(receiver.position + leaves * receiver.facing, alive ? RAY_FAR : -1.0));
    imageStore(rays, texel + ivec2(1, 0), vec4(direction, 0.0));
    paths[path] = vec4(alive ? weight : vec3(0.0), alive ? PATH_ALIVE : PATH_ENDED);
}
