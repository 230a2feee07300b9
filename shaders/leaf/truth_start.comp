#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "random.glsl"

// Rays of the camera through every pixel.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Frame { TruthFrame frame; };
layout(set = 0, binding = 1, rgba32f) uniform restrict writeonly image2D rays;
layout(set = 0, binding = 2, scalar) restrict writeonly buffer Paths { TruthPath paths[]; };
layout(push_constant, scalar) uniform Push { TruthBatch push; };

void main() {
    uint path = flat_invocation();
    if (path >= push.pixels * push.samples) {
        return;
    }
    uint pixel = push.first_pixel + path % push.pixels;
    uint number = push.first_sample + path / push.pixels;
    vec3 u = even_numbers(pixel, number, frame.seed);
    vec2 place = vec2(pixel % frame.width, pixel / frame.width) + u.xy;
    vec2 on_film = 2.0 * place / vec2(frame.width, frame.height) - 1.0;
    vec3 direction = normalize(frame.forward + on_film.x * frame.right - on_film.y * frame.up);
    ivec2 texel = ivec2((2u * path) & ((1u << RAY_COLUMN_BITS) - 1u), (2u * path) >> RAY_COLUMN_BITS);
    // From the ball about the model: far cameras would lose digits.
    float skip = max(dot(-frame.eye, direction) - 1.0, 0.0);
    imageStore(rays, texel, vec4(frame.eye + skip * direction, RAY_FAR));
    imageStore(rays, texel + ivec2(1, 0), vec4(direction, 0.0));
    paths[path] = TruthPath(vec3(1.0), PATH_ALIVE, vec3(0.0), 0.0, vec3(0.0), vec3(0.0), vec3(0.0));
}
