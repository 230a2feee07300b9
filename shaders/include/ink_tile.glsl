#ifndef INK_TILE_GLSL
#define INK_TILE_GLSL

// Ink of hatching tiles (Praun et al. 2001) kept as thresholds (Webb et al. 2002): a texel is the darkness
// from which it is ink. Texels are decided first and blended after: blended thresholds would have
// more ink than was asked for wherever strokes are dark.

// Tones over which a stroke comes in, on both sides of its own.
const float INK_SOFT = 0.03;

// Levels lie below each other in one image: devices do not agree about neighbouring pixels that
// look into different levels of a texture.
float ink_of_texel(sampler2D tiles, ivec2 at, int level, float darkness) {
    int size = int(INK_TILE) >> level;
    int first = 2 * (int(INK_TILE) - size);
    ivec2 inside = at & (size - 1);
    float threshold = texelFetch(tiles, ivec2(inside.x, first + inside.y), 0).r;
    float soft = min(INK_SOFT, darkness);
    return threshold < 0.999 ? smoothstep(-soft, soft, darkness - threshold) : 0.0;
}

float ink_of_level(sampler2D tiles, vec2 place, int level, float darkness) {
    vec2 at = place * float(int(INK_TILE) >> level) - 0.5;
    ivec2 low = ivec2(floor(at));
    vec2 f = at - vec2(low);
    float top = mix(ink_of_texel(tiles, low, level, darkness),
                    ink_of_texel(tiles, low + ivec2(1, 0), level, darkness), f.x);
    float bottom = mix(ink_of_texel(tiles, low + ivec2(0, 1), level, darkness),
                       ink_of_texel(tiles, low + ivec2(1, 1), level, darkness), f.x);
    return mix(top, bottom, f.y);
}

// `hatch`: place in the tile, and log2 of the texels of the finest level that a pixel spans.
float ink_of_tile(sampler2D tiles, vec3 hatch, float darkness) {
    float level = clamp(hatch.z, 0.0, float(INK_LEVELS) - 1.0);
    int fine = int(floor(level));
    float blend = level - float(fine);
    // As many levels as are blended, and no look at the others.
    int count = blend > 0.0 ? 2 : 1;
    float ink = 0.0;
    for (int k = 0; k < count; k++) {
        float own = ink_of_level(tiles, hatch.xy, min(fine + k, int(INK_LEVELS) - 1), darkness);
        ink = k == 0 ? own : mix(ink, own, blend);
    }
    // Magnified texels keep sharp borders.
    float sharp = clamp(exp2(-hatch.z), 1.0, 8.0);
    return clamp((ink - 0.5) * sharp + 0.5, 0.0, 1.0);
}

// Below level 0 strokes would grow: the next octave, of strokes half as large, takes over.
float ink_of_octaves(sampler2D tiles, vec3 hatch, float darkness) {
    float next = clamp(-hatch.z, 0.0, 1.0);
    int count = darkness > 0.0 ? (next > 0.0 ? 2 : 1) : 0;
    float ink = 0.0;
    for (int k = 0; k < count; k++) {
        float own = ink_of_tile(tiles, hatch, darkness);
        ink = k == 0 ? own : mix(ink, own, next);
        hatch = vec3(2.0 * hatch.xy, hatch.z + 1.0);
    }
    return ink;
}

#endif
