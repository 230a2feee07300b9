#ifndef RENDER_INTERFACE_GLSL
#define RENDER_INTERFACE_GLSL

// What every fragment shader of the render room is given: the frame, the lights, the shadow map.
// Set 0 is the same for all draws of a pass, set 1 changes with the material.

#include "abi.glsl"
#include "shade.glsl"

layout(constant_id = 3) const bool TEXTURED = true;      // base colour shows (else clay)
layout(constant_id = 4) const bool SHADOWED = false;     // S from the shadow map (else 1)

layout(set = 0, binding = 0, scalar) uniform Frame { RenderFrame frame; };
layout(set = 0, binding = 5, scalar) restrict readonly buffer Lights { RenderLight lights[]; };
layout(set = 0, binding = 6) uniform sampler2D shadow_map;

// Bilinear comparison at one place of the map: a gather of four texels and their weights.
float shadow_tap(vec2 at, float depth) {
    vec2 size = vec2(textureSize(shadow_map, 0));
    vec4 lit = step(textureGather(shadow_map, at), vec4(depth));
    vec2 t = fract(at * size - 0.5);
    // Not `mix`: where all four are lit the result is 1 to the last bit.
    float above = lit.w + t.x * (lit.z - lit.w);
    float below = lit.x + t.x * (lit.y - lit.x);
    return above + t.y * (below - above);
}

// Cosine and sine of the golden angle: places of the filter follow a sunflower's spiral, evenly
// spread over the unit disc (Vogel 1979).
const vec2 GOLDEN = vec2(-0.73736888, 0.67549029);

// Share of the sun that reaches a point (S of eq. 1), filtered over a disc of `spread` times the
// radius that is set. The point first moves off its surface towards the sun, farther the steeper
// the triangle stands in the light (`steepness` is the sine of the angle of incidence on the
// geometric normal), so that no triangle shades itself within the reach of the filter; a texel or
// two is not enough to see daylight under a foot.
float sun_visibility(vec3 position, float steepness, float spread, int taps) {
    float cosine = sqrt(max(1.0 - steepness * steepness, 0.01));
    float way = frame.shadow_texel * (1.0 + frame.shadow_reach * spread * min(steepness / cosine, 4.0));
    vec3 at = (frame.relative_to_sun * vec4(position + frame.sun_direction * way, 1.0)).xyz;
    vec2 centre = 0.5 + 0.5 * at.xy;
    // Behind the farthest caster the map is as deep as it can say.
    float depth = max(at.z, 0.0);
    // Nothing stands between the sun and what lies outside the map.
    bool inside = max(abs(at.x), abs(at.y)) < 1.0;
    float count = inside ? float(taps) : 0.0;
    vec2 direction = vec2(1.0, 0.0);
    float lit = 0.0;
    for (float i = 0.5; i < count; i += 1.0) {
        float radius = frame.shadow_radius * spread * sqrt(i / float(taps));
        lit += shadow_tap(centre + direction * radius, depth);
        direction = vec2(GOLDEN.x * direction.x - GOLDEN.y * direction.y,
                         GOLDEN.y * direction.x + GOLDEN.x * direction.y);
    }
    return inside ? lit / float(taps) : 1.0;
}

// Light of one punctual source at a point: direction to it and intensity there.
vec3 punctual(RenderLight light, vec3 position, out vec3 to_light) {
    if (light.kind == LIGHT_DIRECTIONAL) {
        to_light = -light.direction;
        return light.color;
    }
    vec3 offset = light.position - position;
    float d2 = max(dot(offset, offset), 1e-12);
    to_light = offset * inversesqrt(d2);
    vec3 intensity = light.color * (range_window(d2, light.range) / d2);
    if (light.kind == LIGHT_SPOT) {
        intensity *= cone_share(-dot(to_light, light.direction), light.cos_outer, light.cone_scale);
    }
    return intensity;
}

// Eq. 1 over all lights, without exposure.
vec3 illuminate(vec3 position, vec3 normal, vec3 albedo, float ambient, float sun_share,
                float specular, float shininess, vec3 transmission) {
    vec3 light = vec3(0.0);
    if ((frame.terms & 1u) != 0u) {
        light += albedo * ambient * ambient_intensity(normal, frame.sky_zenith, frame.sky_ground);
    }
    if ((frame.terms & 2u) != 0u) {
        vec3 to_eye = normalize(frame.eye - position);
        light += frame.sun_color * sun_share
            * reflected(normal, frame.sun_direction, to_eye, albedo, specular, shininess, transmission);
        for (uint i = 0u; i < frame.light_count; i++) {
            vec3 to_light;
            vec3 intensity = punctual(lights[i], position, to_light);
            light += intensity
                * reflected(normal, to_light, to_eye, albedo, specular, shininess, transmission);
        }
    }
    return light;
}

// What stands behind: `direction` need not be of unit length.
vec3 backdrop(vec3 direction) {
    float height = max(direction.y * inversesqrt(dot(direction, direction)), 0.0);
    float rise = frame.background == BACKGROUND_SKY ? sqrt(height) : smoothstep(0.0, 0.6, height);
    return mix(frame.horizon_color, frame.zenith_color, rise);
}

#endif
