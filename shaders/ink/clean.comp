#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "ink_style.glsl"

// Removes contour pixels with too few neighbours, once: a second time would eat the ends of lines.

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) uniform sampler2D contour_map;
layout(set = 0, binding = 1) uniform sampler2D ids_map;
layout(set = 0, binding = 2, r32f) uniform restrict writeonly image2D cleaned;
layout(push_constant, scalar) uniform Push { InkClean push; };

// Pixels have styles, and this pass is about one of them.
layout(constant_id = 0) const bool MIXED = false;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = ivec2(push.width, push.height);
    if (any(greaterThanEqual(pixel, size))) {
        return;
    }
    if (MIXED && style_of(texelFetch(ids_map, pixel, 0).x) != push.style) {
        if (push.clears != 0u) {
            imageStore(cleaned, pixel, vec4(0.0));
        }
        return;
    }
    float own = texelFetch(contour_map, pixel, 0).r;
    uint neighbours = 0u;
    for (int k = 0; k < 9; k++) {
        ivec2 q = pixel + ivec2(k % 3 - 1, k / 3 - 1);
        bool inside = all(greaterThanEqual(q, ivec2(0))) && all(lessThan(q, size));
        if (k != 4 && inside && texelFetch(contour_map, clamp(q, ivec2(0), size - 1), 0).r > 0.0) {
            neighbours++;
        }
    }
    imageStore(cleaned, pixel, vec4(neighbours >= push.neighbours ? own : 0.0));
}
