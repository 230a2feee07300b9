#ifndef INK_HATCH_GLSL
#define INK_HATCH_GLSL

// The square of equation 8, smooth or in steps (figure 9c: 3).
float packed(float square, float steps) {
    return steps > 0.0 ? min(floor(steps * square), steps) / steps : square;
}

// Hatch coordinates on a cluster's sphere (Coconu, Deussen, Hege 2006, equations 5 to 8, as the
// spec reads them): place in the tile (0 to 1), and the binary logarithm of the texels of the
// finest level that a pixel spans.
vec3 hatch_coordinates(InkCluster cluster, vec2 pixel, float depth, vec2 packing) {
    if (cluster.pixel_radius <= 0.0) {
        return vec3(0.0);
    }
    vec2 away = (pixel - cluster.pixel) * vec2(1.0, -1.0);
    vec4 m = cluster.to_angles;
    vec2 offset = vec2(dot(m.xy, away), dot(m.zw, away));
    float angle_per_pixel = sqrt(abs(m.x * m.w - m.y * m.z));
    // How far behind the front point, in radii.
    float behind = clamp((depth - cluster.front) / cluster.radius, 0.0, 1.0);
    float f = 1.0 + packing.x * packed(behind * behind, packing.y);
    vec2 v = cluster.texture_up;
    vec2 turned = vec2(v.y * offset.x - v.x * offset.y, v.x * offset.x + v.y * offset.y);
    vec2 at = cluster.reference + f * cluster.tiles * (1.0 / 3.14159265) * turned;
    float texels = f * cluster.tiles.y * (1.0 / 3.14159265) * angle_per_pixel * float(INK_TILE);
    return vec3(fract(at), log2(max(texels, 1e-6)));
}

#endif
