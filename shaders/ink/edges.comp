#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "ink_bilinear.glsl"

// Lines where normals turn: Sobel's filter on all three components (Saito and Takahashi 1990, as
// Luft, Balzer, Deussen 2007 use it in figure 7). Where nothing is, the normal is 0.

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) uniform sampler2D normal_map;
layout(set = 0, binding = 1, r32f) uniform restrict writeonly image2D edges;
layout(push_constant, scalar) uniform Push { InkEdges push; };

vec3 normal_at(ivec2 pixel, vec2 step) {
    vec2 at = vec2(pixel) + 0.5 + push.reach * step;
    return bilinear(normal_map, at, ivec2(push.width, push.height)).xyz;
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (pixel.x >= int(push.width) || pixel.y >= int(push.height)) {
        return;
    }
    vec3 x = vec3(0.0);
    vec3 y = vec3(0.0);
    for (int k = -1; k <= 1; k++) {
        float weight = 2.0 - abs(float(k));
        x += weight * (normal_at(pixel, vec2(1.0, k)) - normal_at(pixel, vec2(-1.0, k)));
        y += weight * (normal_at(pixel, vec2(k, 1.0)) - normal_at(pixel, vec2(k, -1.0)));
    }
    // 1 where opposite normals meet.
    float gradient = sqrt(dot(x, x) + dot(y, y)) / 8.0;
    float ink = clamp((gradient - push.threshold) / push.softness, 0.0, 1.0);
    imageStore(edges, pixel, vec4(ink));
}
