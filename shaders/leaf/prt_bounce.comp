#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "random.glsl"

// What becomes of the paths after their rays were traced: those that met nothing have escaped,
// those that met a leaf are reflected, go through it or end there.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Hits { uvec2 hits[]; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Faces { vec4 faces[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Materials { LeafSides materials[]; };
layout(set = 0, binding = 3, rgba32f) uniform restrict image2D rays;
layout(set = 0, binding = 4, scalar) restrict buffer Paths { vec4 paths[]; };
// How many go on: tells the host whether another bounce is needed, nothing else.
layout(set = 0, binding = 5, scalar) restrict buffer Alive { uint alive_count; };
layout(push_constant, scalar) uniform Push { PrtBounce push; };

void main() {
    uint path = flat_invocation();
    if (path >= push.batch.sides * push.batch.samples) {
        return;
    }
    vec4 state = paths[path];
    if (state.w != PATH_ALIVE) {
        return;
    }
    ivec2 texel = ivec2((2u * path) & ((1u << RAY_COLUMN_BITS) - 1u), (2u * path) >> RAY_COLUMN_BITS);
    vec3 origin = imageLoad(rays, texel).xyz;
    uvec2 hit = hits[path];
    if (hit.y == RAY_NOTHING) {
        paths[path].w = float(push.bounce);
        imageStore(rays, texel, vec4(origin, -1.0));
        return;
    }
    vec3 direction = imageLoad(rays, texel + ivec2(1, 0)).xyz;
    vec4 face = faces[hit.y];
    bool front = dot(face.xyz, direction) < 0.0;
    vec3 normal = front ? face.xyz : -face.xyz;
    LeafSides material = materials[floatBitsToUint(face.w)];
    vec3 rho_d = front ? material.rho_d_front : material.rho_d_back;
    float reflects = (rho_d.x + rho_d.y + rho_d.z) / 3.0;
    float transmits = (material.rho_t.x + material.rho_t.y + material.rho_t.z) / 3.0;
    float total = reflects + transmits;
    uint side = path % push.batch.sides;
    uint number = push.batch.first_sample + path / push.batch.sides;
    uint key = path_key(push.batch.first_side + side, number, push.batch.seed);
    uint counter = 4u * push.bounce;
    // Russian roulette from the second bounce on.
    float survives = push.bounce > 0u ? min(push.survival * total, 1.0) : 1.0;
    bool ends = push.last != 0u || !(total > 0.0) || random(key, counter) >= survives;
    if (ends) {
        paths[path] = vec4(0.0, 0.0, 0.0, PATH_ENDED);
        imageStore(rays, texel, vec4(origin, -1.0));
        return;
    }
    bool is_reflected = random(key, counter + 1u) * total < reflects;
    vec3 weight = is_reflected ? rho_d * (total / reflects) : material.rho_t * (total / transmits);
    vec3 outward = is_reflected ? normal : -normal;
    vec3 next = cosine_direction(outward, vec2(random(key, counter + 2u), random(key, counter + 3u)));
    vec3 place = origin + uintBitsToFloat(hit.x) * direction + push.batch.offset * outward;
    paths[path] = vec4(state.xyz * weight / survives, PATH_ALIVE);
    imageStore(rays, texel, vec4(place, RAY_FAR));
    imageStore(rays, texel + ivec2(1, 0), vec4(next, 0.0));
    atomicAdd(alive_count, 1u);
}
