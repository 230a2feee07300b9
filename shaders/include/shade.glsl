#ifndef SHADE_GLSL
#define SHADE_GLSL

// Eq. 1 of Luft, Balzer, Deussen 2007:
//     I = I_a k_a + sum_i I_i S_i [ k_d (N.L)+ + k_s ((V.R)+)^n ]
// with k_d the base colour and I_a the light of a sky over a ground. `src/reference/shade.rs` is
// the f64 twin, function by function.

// Irradiance of an upper and a lower half-sphere of constant radiance is linear in n.y.
vec3 ambient_intensity(vec3 normal, vec3 zenith, vec3 ground) {
    return mix(ground, zenith, 0.5 + 0.5 * normal.y);
}

// Phong's lobe (V.R)^n about the mirrored direction of the light; nil on the side away from it.
float specular_lobe(vec3 normal, vec3 to_light, vec3 to_eye, float shininess) {
    float cosine = dot(normal, to_light);
    vec3 mirrored = 2.0 * cosine * normal - to_light;
    float along = max(dot(to_eye, mirrored), 0.0);
    return cosine > 0.0 ? pow(max(along, 1e-8), shininess) : 0.0;
}

// The bracket of eq. 1 for one light. `transmission` is umbrage's addition: diffuse light from the
// far side, zero in the paper's model.
vec3 reflected(vec3 normal, vec3 to_light, vec3 to_eye, vec3 albedo, float specular,
               float shininess, vec3 transmission) {
    float cosine = dot(normal, to_light);
    vec3 diffuse = albedo * (max(cosine, 0.0) + transmission * max(-cosine, 0.0));
    return diffuse + specular * specular_lobe(normal, to_light, to_eye, shininess);
}

// Window that brings the inverse square to zero at `range` (KHR_lights_punctual); range 0 = none.
float range_window(float distance_squared, float range) {
    if (range <= 0.0) {
        return 1.0;
    }
    float ratio = distance_squared / (range * range);
    return clamp(1.0 - ratio * ratio, 0.0, 1.0);
}

// Share of a spot's light in a direction at this cosine from its axis (KHR_lights_punctual).
float cone_share(float cosine, float cos_outer, float scale) {
    float t = clamp((cosine - cos_outer) * scale, 0.0, 1.0);
    return t * t;
}

// Ambient coefficient of the ground under a crown: a sphere that hides part of the sky. The form
// factor of a sphere above a plane's horizon is (n.d/|d|) (r/|d|)^2.
float ground_ambient(vec3 to_crown, float radius, float opacity) {
    float d2 = max(dot(to_crown, to_crown), radius * radius);
    float hidden = to_crown.y * inversesqrt(d2) * radius * radius / d2;
    return 1.0 - opacity * clamp(hidden, 0.0, 1.0);
}

#endif
