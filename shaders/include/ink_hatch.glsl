#ifndef INK_HATCH_GLSL
#define INK_HATCH_GLSL

// The square of equation 8, smooth or in steps (figure 9c: 3).
float packed(float square, float steps) {
    return steps > 0.0 ? min(floor(steps * square), steps) / steps : square;
}

// Hatch coordinates on a cluster's sphere (Coconu, Deussen, Hege 2006, equations 5 to 8, as the
// spec reads them), made ready once for a cluster: a linear map of the picture, and what of it
// depends on depth.
struct HatchMap {
    // Tiles for a pixel to the right and upwards: of u (xy) and of v (zw).
    vec4 linear;
    // The cluster's middle in the picture, pixels; its place in the tile.
    vec4 middle;
    // Eye depth of the front point, 1 / radius, packing, log2 of texels a pixel spans.
    vec4 depth;
    // Steps of the packing; 0: smooth.
    float steps;
};

HatchMap hatch_map(InkCluster cluster, InkStyle style) {
    // Texels a pixel spans where strokes have the style's size.
    float painted = max(-log2(style.hatch_texel), 0.0);
    if (style.hatch_space == INK_HATCH_SCREEN) {
        float s = 1.0 / (float(INK_TILE) * style.hatch_texel);
        return HatchMap(vec4(s, 0.0, 0.0, s), vec4(0.0), vec4(0.0, 0.0, 0.0, painted), 0.0);
    }
    if (cluster.pixel_radius <= 0.0) {
        return HatchMap(vec4(0.0), vec4(0.0), vec4(0.0), 0.0);
    }
    vec4 m = cluster.to_angles;
    vec2 v = cluster.texture_up;
    vec2 tiles = cluster.tiles * (1.0 / 3.14159265);
    vec4 linear = vec4(tiles.x * (v.y * m.xy - v.x * m.zw), tiles.y * (v.x * m.xy + v.y * m.zw));
    float texels = tiles.y * sqrt(abs(m.x * m.w - m.y * m.z)) * float(INK_TILE);
    float level = style.hatch_levels != 0u ? log2(max(texels, 1e-6)) : painted;
    if (style.hatch_space == INK_HATCH_OBJECT) {
        // On the sphere itself, which is told by a radius below 0.
        return HatchMap(vec4(cluster.centre, 0.0), vec4(tiles, 0.0, 0.0),
                        vec4(0.0, -1.0, 0.0, level), 0.0);
    }
    return HatchMap(linear, vec4(cluster.pixel, cluster.reference),
                    vec4(cluster.front, 1.0 / cluster.radius, style.packing, level),
                    style.packing_steps);
}

// Tiles are repeated twice as often whenever their finest level would be seen more than twice as
// large as it is: strokes keep their size however near the eye comes. -1 is the least level then;
// from 0 down to it the next octave fades in.
vec3 hatch_octave(vec2 at, float level) {
    float octave = clamp(ceil(-1.0 - level), 0.0, 12.0);
    return vec3(fract(at * exp2(octave)), level + octave);
}

// Place in the tile (0 to 1), and the binary logarithm of the texels of the finest level that a
// pixel spans.
vec3 hatch_coordinates(HatchMap map, vec2 pixel, float depth, vec3 position) {
    if (map.depth.y < 0.0) {
        vec3 d = normalize(position - map.linear.xyz);
        return hatch_octave(map.middle.xy * vec2(atan(d.x, d.z), asin(d.y)), map.depth.w);
    }
    vec2 away = (pixel - map.middle.xy) * vec2(1.0, -1.0);
    // How far behind the front point, in radii.
    float behind = clamp((depth - map.depth.x) * map.depth.y, 0.0, 1.0);
    float f = 1.0 + map.depth.z * packed(behind * behind, map.steps);
    vec2 at = map.middle.zw + f * vec2(dot(map.linear.xy, away), dot(map.linear.zw, away));
    return hatch_octave(at, map.depth.w + log2(f));
}

#endif
