#ifndef INK_BILINEAR_GLSL
#define INK_BILINEAR_GLSL

// Exact weights, unlike a sampler's: edges are made from small differences.
vec4 bilinear(sampler2D map, vec2 at, ivec2 size) {
    vec2 low = floor(at - 0.5);
    vec2 f = at - 0.5 - low;
    ivec2 last = size - 1;
    ivec2 a = clamp(ivec2(low), ivec2(0), last);
    ivec2 b = clamp(ivec2(low) + 1, ivec2(0), last);
    vec4 top = mix(texelFetch(map, a, 0), texelFetch(map, ivec2(b.x, a.y), 0), f.x);
    vec4 bottom = mix(texelFetch(map, ivec2(a.x, b.y), 0), texelFetch(map, b, 0), f.x);
    return mix(top, bottom, f.y);
}

#endif
