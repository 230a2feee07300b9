#ifndef LEAF_BRDF_GLSL
#define LEAF_BRDF_GLSL

#include "leaf_glossy.glsl"

const float LEAF_PI = 3.14159265358979;

// Beckmann's distribution of slopes over cos^4: cos_h to the normal, m the root mean square
// slope times the square root of 2.
float slope_distribution(float cos_h, float m) {
    float c2 = max(cos_h * cos_h, 1e-8);
    return exp((1.0 - 1.0 / c2) / (m * m)) / (LEAF_PI * m * m * c2 * c2);
}

// Light scattered towards `to_eye` from `to_light`, times the cosine of the light (Wang et al. 2005,
// equations 1 and 7): reflection where both are on one side of the leaf, transmission otherwise.
// `normal` is that of the front; 1 / cos of the glossy term cancels that of the light.
vec3 leaf_scatters(LeafSides leaf, vec4 gloss, vec3 normal, vec3 to_light, vec3 to_eye) {
    float light = dot(normal, to_light);
    float eye = dot(normal, to_eye);
    vec3 through = leaf.rho_t * (abs(light) / LEAF_PI);
    vec3 rho_d = eye > 0.0 ? leaf.rho_d_front : leaf.rho_d_back;
    vec3 middle = to_light + to_eye;
    float cos_h = abs(dot(normal, middle)) * inversesqrt(max(dot(middle, middle), 1e-12));
    // A roughness below 0 asks for masking and shadowing, which keep the energy.
    float m = abs(gloss.w);
    float kept = gloss.w < 0.0 ? 1.0 / (1.0 + glossy_smith(abs(light), m) + glossy_smith(abs(eye), m)) : 1.0;
    vec3 shine = gloss.xyz * (kept * slope_distribution(cos_h, m) / (4.0 * max(abs(eye), 1e-3)));
    return light * eye > 0.0 ? rho_d * (abs(light) / LEAF_PI) + shine : through;
}

// From the eye through the middle of a pixel, of length 1 along the direction of view.
vec3 view_of_pixel(LitFrame frame, uvec2 pixel) {
    vec2 on_film = 2.0 * (vec2(pixel) + 0.5) / vec2(frame.width, frame.height) - 1.0;
    return frame.forward + on_film.x * frame.right - on_film.y * frame.up;
}

// Where the surface of a pixel lies; `depth` is reversed, infinitely far at 0.
vec3 position_of_pixel(LitFrame frame, uvec2 pixel, float depth) {
    return frame.eye + (frame.near / depth) * view_of_pixel(frame, pixel);
}

// Unit vector from the surface of a pixel to the eye. Which side is seen (the sign of `side`) follows
// from the triangle; where the shading normal disagrees, at a rim, it is turned to that side.
vec3 to_eye_of_pixel(LitFrame frame, uvec2 pixel, vec3 normal, float side) {
    vec3 to_eye = -normalize(view_of_pixel(frame, pixel));
    float facing = dot(normal, to_eye);
    return facing * side < 0.0 ? normalize(to_eye - (1.0 + 1e-3) * facing * normal) : to_eye;
}

#endif
