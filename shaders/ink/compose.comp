#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "ink_style.glsl"
#include "ink_tile.glsl"

// Lines, strokes and washes on paper.

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const bool CONTOUR = false;
layout(constant_id = 1) const bool SILHOUETTE = false;
layout(constant_id = 2) const bool HATCHING = false;
layout(constant_id = 3) const bool SHADING = false;
layout(constant_id = 4) const bool COLOUR = false;
// Pixels have styles, and this pass is about one of them.
layout(constant_id = 5) const bool MIXED = false;
layout(constant_id = 6) const bool LIGHT = false;
layout(constant_id = 7) const bool EDGES = false;
layout(constant_id = 8) const bool WASH = false;
layout(set = 0, binding = 0) uniform sampler2D depth_map;
layout(set = 0, binding = 1) uniform sampler2D albedo_map;
layout(set = 0, binding = 2) uniform sampler2D normal_map;
layout(set = 0, binding = 3) uniform sampler2D hatch_map;
layout(set = 0, binding = 4) uniform sampler2D contour_map;
layout(set = 0, binding = 5) uniform sampler2D silhouette_map;
layout(set = 0, binding = 6) uniform sampler2D tiles;
layout(set = 0, binding = 7, rgba16f) uniform restrict writeonly image2D picture;
layout(set = 0, binding = 8) uniform sampler2D ids_map;
layout(set = 0, binding = 9, scalar) restrict readonly buffer Styles { InkStyle styles[]; };
layout(set = 0, binding = 10) uniform sampler2D light_map;
layout(set = 0, binding = 11) uniform sampler2D edges_map;
layout(set = 0, binding = 12) uniform sampler2D wash_map;
layout(push_constant, scalar) uniform Push { InkCompose push; };

// Contours are one pixel wide: widened to the width of the style that they are of.
float line(ivec2 pixel) {
    int reach = min(int(ceil(push.half_width)), INK_WIDEN);
    ivec2 last = ivec2(push.width, push.height) - 1;
    float most = 0.0;
    float half_width = styles[push.style].half_width;
    float strength = styles[push.style].contour;
    for (int y = -reach; y <= reach; y++) {
        for (int x = -reach; x <= reach; x++) {
            ivec2 at = clamp(pixel + ivec2(x, y), ivec2(0), last);
            float found = texelFetch(contour_map, at, 0).r;
            if (found > 0.0) {
                if (MIXED) {
                    uint style = style_of(texelFetch(ids_map, at, 0).x);
                    half_width = styles[style].half_width;
                    strength = styles[style].contour;
                }
                float edge = clamp(half_width + 0.5 - length(vec2(x, y)), 0.0, 1.0);
                most = max(most, strength * (edge * found));
            }
        }
    }
    return most;
}

// What shading multiplies colours by: the light of sun and sky, in steps where the style has them.
vec3 shade(float tone, vec2 light) {
    float top = push.steps > 0.0 ? min((floor(tone * push.steps) + 0.5) / push.steps, 1.0) : tone;
    float stepped = mix(tone, top, push.hardness) / max(tone, 1e-4);
    vec3 both = LIGHT ? light.x * push.sun + light.y * push.sky : vec3(tone);
    return mix(vec3(1.0), push.exposure * stepped * both, push.shading);
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (pixel.x >= int(push.width) || pixel.y >= int(push.height)) {
        return;
    }
    if (MIXED && style_of(texelFetch(ids_map, pixel, 0).x) != push.style) {
        return;
    }
    vec3 under = push.paper;
    float dry = 1.0;
    if (CONTOUR) {
        dry *= 1.0 - line(pixel);
    }
    if (texelFetch(depth_map, pixel, 0).r > 0.0) {
        vec4 light = LIGHT ? texelFetch(light_map, pixel, 0) : texelFetch(normal_map, pixel, 0);
        float tone = SHADING || HATCHING ? light.w : 1.0;
        if (COLOUR) {
            // Between square roots, nearer to how the eye counts: a little paper does not bleach.
            vec3 between = mix(sqrt(under), sqrt(texelFetch(albedo_map, pixel, 0).rgb), push.colour);
            under = between * between;
        }
        if (SHADING) {
            under = min(under * shade(tone, light.xy), vec3(1.0));
        }
        if (SILHOUETTE) {
            dry *= 1.0 - push.silhouette * texelFetch(silhouette_map, pixel, 0).r;
        }
        if (HATCHING) {
            float darkness = pow(clamp(1.0 - tone / max(push.white, 1e-3), 0.0, 1.0), push.gamma);
            vec3 hatch = texelFetch(hatch_map, pixel, 0).xyz;
            dry *= 1.0 - push.hatching * ink_of_octaves(tiles, hatch, darkness);
        }
    }
    if (EDGES) {
        dry *= 1.0 - push.edges * texelFetch(edges_map, pixel, 0).r;
    }
    if (WASH) {
        under = mix(under, texelFetch(wash_map, pixel, 0).rgb, push.wash);
    }
    imageStore(picture, pixel, vec4(mix(push.ink, under, dry), 1.0));
}
