#ifndef INK_LIGHT_GLSL
#define INK_LIGHT_GLSL

// Light of drawings. Share of the sun that a surface throws back: Lambert's cosine at a wrap of 0,
// half round the surface at 1, as crowns scatter what they get.
float sun_share(vec3 normal, vec3 to_sun, float wrap) {
    float c = clamp((dot(normal, to_sun) + wrap) / (1.0 + wrap), 0.0, 1.0);
    return pow(c, 1.0 + wrap);
}

// How far the sun is hidden from a place `at` (texels) and `depth` of its map: a tent filter over
// comparisons that are themselves ramps, so that shadows move without leaps.
float sun_hidden(sampler2D map, vec2 at, float depth, float reach, float bias, uint texels) {
    vec2 first = ceil(at - reach - 0.5);
    int count = min(int(floor(2.0 * reach)) + 1, 2 * int(INK_SHADOW_REACH) + 1);
    // What lies behind all of the map is lit like its end.
    depth = max(depth, 0.0);
    float sum = 0.0;
    float total = 0.0;
    for (int y = 0; y < count; y++) {
        for (int x = 0; x < count; x++) {
            vec2 texel = first + vec2(x, y);
            vec2 tent = max(1.0 - abs(texel + 0.5 - at) / reach, vec2(0.0));
            bool inside = all(greaterThanEqual(texel, vec2(0.0))) && all(lessThan(texel, vec2(texels)));
            // Depth is reversed: 0 is farthest from the sun, where nothing casts.
            float caster = inside ? texelFetch(map, ivec2(texel), 0).r : 0.0;
            float weight = tent.x * tent.y;
            sum += weight * clamp((caster - depth) / bias - 1.0, 0.0, 1.0);
            total += weight;
        }
    }
    return total > 0.0 ? sum / total : 0.0;
}

#endif
