#ifndef LEAF_SKY_GLSL
#define LEAF_SKY_GLSL

// Radiance of the sky from the unit direction `d`: an image of rows from +y to -y and columns from
// +x to +z (`leaf/film.rs`).
vec3 sky_radiance(sampler2D sky, vec3 d) {
    float turn = atan(d.z, d.x) / 6.28318530717958648;
    return textureLod(sky, vec2(turn - floor(turn), acos(clamp(d.y, -1.0, 1.0)) / 3.14159265358979), 0.0).xyz;
}

// Weights of the corners a, b, c (relative to a point) of a triangle with normal `face` at that point,
// times twice its area.
vec3 corner_weights(vec3 a, vec3 b, vec3 c, vec3 face) {
    return vec3(dot(cross(b, c), face), dot(cross(c, a), face), dot(cross(a, b), face));
}

#endif
