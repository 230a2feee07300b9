#ifndef INK_WOOD_GLSL
#define INK_WOOD_GLSL

// Hatching of branches in object space. `hatch`: across the axis in its frame (x, y), metres along
// it, log2 of its girth in metres. Place in the tile (0 to 1), and the binary logarithm of the texels
// of the finest level that a pixel spans.

// Whole tiles round a branch, twice as many with each doubling of its girth, so that strokes meet
// themselves. Strokes round it are half as long as elsewhere: it curves away under the pen. Where
// they run along, the doubling is not at the same height all round.
float tiles_round(vec4 hatch, float tiles, bool along) {
    float spread = along ? 0.35 * sin(5.0 * atan(hatch.y, hatch.x)) : 1.0;
    return exp2(max(0.0, floor(hatch.w + log2(tiles) + spread + 0.5)));
}

vec3 wood_hatch(vec4 hatch, vec4 dx, vec4 dy, float tiles, bool along) {
    float round_tiles = tiles_round(hatch, tiles, along) * (1.0 / 6.28318531);
    // The derivative of the angle has no leap where the angle has.
    float square = max(dot(hatch.xy, hatch.xy), 1e-12);
    vec2 turned = vec2(hatch.x * dx.y - hatch.y * dx.x, hatch.x * dy.y - hatch.y * dy.x) / square;
    vec2 way = vec2(round_tiles * atan(hatch.y, hatch.x), tiles * hatch.z);
    float across = tiles * length(vec2(dx.z, dy.z));
    float lengthwise = round_tiles * length(turned);
    if (along) {
        way = way.yx;
        float swap = across;
        across = lengthwise;
        lengthwise = swap;
    }
    // Strokes shorten at the limb and keep their width: eight times shorter before they coarsen.
    float texels = max(across, 0.125 * lengthwise) * float(INK_TILE);
    return vec3(fract(way), log2(max(texels, 1e-6)));
}

#endif
