#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "ink_contour.glsl"
#include "ink_style.glsl"

// Contour by differences of depth (Coconu, Deussen, Hege 2006, equation 1): 0, 1/2 or 1 for none,
// one or more neighbours that lie farther by the threshold. The line is on the nearer side.

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) uniform sampler2D depth_map;
layout(set = 0, binding = 1) uniform sampler2D ids_map;
layout(set = 0, binding = 2) uniform sampler2D direction_map;
layout(set = 0, binding = 3, r32f) uniform restrict writeonly image2D contour;
layout(push_constant, scalar) uniform Push { InkContour push; };

layout(constant_id = 0) const bool DETAIL = false;
// Pixels have styles, and this pass is about one of them.
layout(constant_id = 1) const bool MIXED = false;

float depth_at(ivec2 at) {
    at = clamp(at, ivec2(0), ivec2(push.width, push.height) - 1);
    return contour_depth(texelFetch(depth_map, at, 0).r, push.mapping, push.nearest, push.farthest);
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (pixel.x >= int(push.width) || pixel.y >= int(push.height)) {
        return;
    }
    if (MIXED && style_of(texelFetch(ids_map, pixel, 0).x) != push.style) {
        if (push.clears != 0u) {
            imageStore(contour, pixel, vec4(0.0));
        }
        return;
    }
    float own = depth_at(pixel);
    float strength = 0.0;
    if (own < 1e8) {
        bool leaf = texelFetch(ids_map, pixel, 0).y > 0.0;
        float threshold = leaf ? push.threshold : push.threshold_wood;
        if (DETAIL && leaf) {
            vec2 e = texelFetch(direction_map, pixel, 0).xy;
            float towards = sqrt(max(1.0 - dot(e, e), 0.0));
            threshold *= 1.0 + push.detail * pow(towards, push.detail_power);
        }
        float farther = 0.0;
        for (int k = 0; k < 9; k++) {
            ivec2 q = pixel + ivec2(k % 3 - 1, k / 3 - 1);
            farther += depth_at(q) - own - threshold > 0.0 ? 1.0 : 0.0;
        }
        strength = min(0.5 * farther, 1.0);
    }
    imageStore(contour, pixel, vec4(strength));
}
