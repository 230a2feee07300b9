#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"

// Colour and tone spread over wet paper, along one direction; weighted by what is covered. The first
// pass reads the attributes, the second what the first wrote.

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) uniform sampler2D depth_map;
layout(set = 0, binding = 1) uniform sampler2D colour_map;
layout(set = 0, binding = 2) uniform sampler2D tone_map;
layout(set = 0, binding = 3, rgba16f) uniform restrict writeonly image2D colour;
layout(set = 0, binding = 4, rgba16f) uniform restrict writeonly image2D tone;
layout(push_constant, scalar) uniform Push { InkSoften push; };

layout(constant_id = 0) const bool FIRST = false;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = ivec2(push.width, push.height);
    if (any(greaterThanEqual(pixel, size))) {
        return;
    }
    int reach = min(int(ceil(2.5 * push.deviation)), int(INK_SOFTEN_REACH));
    vec4 colours = vec4(0.0);
    float tones = 0.0;
    float total = 0.0;
    for (int k = -reach; k <= reach; k++) {
        ivec2 at = pixel + (FIRST ? ivec2(k, 0) : ivec2(0, k));
        if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, size))) {
            continue;
        }
        float distance = float(k) / push.deviation;
        float weight = exp(-0.5 * distance * distance);
        if (FIRST) {
            float covered = texelFetch(depth_map, at, 0).r > 0.0 ? weight : 0.0;
            colours += covered * vec4(texelFetch(colour_map, at, 0).rgb, 1.0);
            tones += covered * texelFetch(tone_map, at, 0).w;
        } else {
            colours += weight * texelFetch(colour_map, at, 0);
            tones += weight * texelFetch(tone_map, at, 0).x;
        }
        total += weight;
    }
    imageStore(colour, pixel, colours / total);
    imageStore(tone, pixel, vec4(tones / total));
}
