#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "ink_style.glsl"

// Strokes along silhouettes (Coconu, Deussen, Hege 2006, section 5): from a pixel outwards along
// the cluster's normal to the contour gives v, the angle about the cluster gives u.

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) uniform sampler2D ids_map;
layout(set = 0, binding = 1) uniform sampler2D direction_map;
layout(set = 0, binding = 2) uniform sampler2D tone_map;
layout(set = 0, binding = 3) uniform sampler2D contour_map;
layout(set = 0, binding = 4) uniform sampler2D strokes;
layout(set = 0, binding = 5, scalar) restrict readonly buffer Clusters { InkCluster clusters[]; };
layout(set = 0, binding = 6, r32f) uniform restrict writeonly image2D silhouette;
layout(push_constant, scalar) uniform Push { InkSilhouette push; };

// Pixels have styles, and this pass is about one of them.
layout(constant_id = 0) const bool MIXED = false;

// Pixels from here to the contour of the same object; as many as can be where there is none.
uint steps_to_contour(ivec2 pixel, vec2 outward, float object) {
    ivec2 size = ivec2(push.width, push.height);
    uint found = INK_WALK;
    for (uint step = 0u; step < INK_WALK && float(step) + 0.5 < push.reach; step++) {
        ivec2 at = ivec2(floor(vec2(pixel) + 0.5 + float(step) * outward));
        if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, size))) {
            break;
        }
        bool line = texelFetch(contour_map, at, 0).r > 0.0;
        if (line && texelFetch(ids_map, at, 0).x == object) {
            found = step;
            break;
        }
    }
    return found;
}

// The strokes, repeated along and clamped across, between texels by exact weights: those of a
// sampler have a few bits, and not the same on every device.
vec4 strokes_at(vec2 at) {
    ivec2 size = textureSize(strokes, 0);
    vec2 place = vec2(fract(at.x), at.y) * vec2(size) - 0.5;
    vec2 low = floor(place);
    vec2 f = place - low;
    ivec2 first = ivec2(low);
    ivec2 x = ivec2(first.x < 0 ? size.x - 1 : first.x, first.x + 1 < size.x ? first.x + 1 : 0);
    ivec2 y = clamp(ivec2(first.y, first.y + 1), ivec2(0), ivec2(size.y - 1));
    vec4 top = mix(texelFetch(strokes, ivec2(x.x, y.x), 0), texelFetch(strokes, ivec2(x.y, y.x), 0), f.x);
    vec4 bottom = mix(texelFetch(strokes, ivec2(x.x, y.y), 0), texelFetch(strokes, ivec2(x.y, y.y), 0), f.x);
    return mix(top, bottom, f.y);
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (pixel.x >= int(push.width) || pixel.y >= int(push.height)) {
        return;
    }
    if (MIXED && style_of(texelFetch(ids_map, pixel, 0).x) != push.style) {
        if (push.clears != 0u) {
            imageStore(silhouette, pixel, vec4(0.0));
        }
        return;
    }
    vec2 ids = texelFetch(ids_map, pixel, 0).xy;
    vec2 e = texelFetch(direction_map, pixel, 0).xy;
    float size = length(e);
    float ink = 0.0;
    if (ids.y > 0.0 && size >= 0.1) {
        vec2 outward = e / size;
        uint steps = steps_to_contour(pixel, outward, ids.x);
        InkCluster cluster = clusters[uint(ids.y) - 1u];
        if (steps < INK_WALK && cluster.pixel_radius > 0.0) {
            vec2 up = cluster.texture_up;
            // Angle from the texture's direction to the outward one, in a picture whose y goes up.
            vec2 o = vec2(outward.x, -outward.y);
            float angle = atan(up.x * o.y - up.y * o.x, dot(up, o));
            // A whole number of repeats, so that no seam shows.
            float around = 6.28318531 * push.aspect * cluster.pixel_radius / push.band_length;
            float repeats = max(1.0, floor(around + 0.5));
            vec2 at = vec2(repeats * angle / 6.28318531, (float(steps) + 0.5) / push.reach);
            vec4 channels = strokes_at(at);
            float shade = 3.0 * clamp(texelFetch(tone_map, pixel, 0).w, 0.0, 1.0);
            uint first = uint(floor(shade + (push.blend != 0u ? 0.0 : 0.5)));
            float next = channels[min(first + 1u, 3u)];
            ink = push.blend != 0u ? mix(channels[min(first, 3u)], next, fract(shade)) : channels[min(first, 3u)];
        }
    }
    imageStore(silhouette, pixel, vec4(ink));
}
