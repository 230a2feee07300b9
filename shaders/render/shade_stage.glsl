#ifndef SHADE_STAGE_GLSL
#define SHADE_STAGE_GLSL

// Stage 2 of lit pictures: one evaluation of eq. 1 per surface that a pixel shows, the ground and
// the background where it shows none. The including file says how a sample is read (`fetch`,
// `fetch_depth`) and where in the pixel it lies (`SAMPLES`, `PLACES`).

#include "surface_record.glsl"

layout(set = 1, binding = 3, scalar) restrict readonly buffer Materials { RenderMaterial materials[]; };

layout(location = 0) in vec2 in_corner;    // -1..1 over the picture
layout(location = 0) out vec4 out_color;

const float FADE_START = 0.25;    // share of the ground's radius up to which it is itself

// Ray through a place in the picture, with unit component along the direction of view.
vec3 ray(vec2 corner) {
    return frame.forward + corner.x * frame.right - corner.y * frame.up;
}

// The ground, lit by eq. 1 and under the crown's ambient shade, fading into the background.
vec3 ground(vec3 position, vec3 behind) {
    vec3 up = vec3(0.0, 1.0, 0.0);
    float ambient = ground_ambient(frame.crown_centre - position, frame.crown_radius,
                                   frame.crown_opacity);
    float steepness = sqrt(max(1.0 - frame.sun_direction.y * frame.sun_direction.y, 0.0));
    float sun = SHADOWED ? sun_visibility(position, steepness, GROUND_SPREAD, GROUND_TAPS) : 1.0;
    vec3 light = illuminate(position, up, frame.ground_albedo, ambient, sun, 0.0, 1.0, vec3(0.0));
    float away = distance(position.xz, frame.crown_centre.xz) / frame.ground_radius;
    return mix(light * frame.exposure, behind, smoothstep(FADE_START, 1.0, away));
}

// The surface of one sample, `depth` metres along the ray.
vec3 shade_surface(Surface s, vec3 position) {
    RenderMaterial m = materials[s.material];
    if ((m.flags & MATERIAL_UNLIT) != 0u && TEXTURED) {
        return s.albedo;
    }
    float sun = SHADOWED ? sun_visibility(position, s.steepness, 1.0, SURFACE_TAPS) : 1.0;
    vec3 light = illuminate(position, s.normal, s.albedo, s.ambient, sun, m.specular, m.shininess,
                            m.transmission);
    return (light + (TEXTURED ? m.emissive : vec3(0.0))) * frame.exposure;
}

// Distance along a ray at which it meets the ground; 0 where it does not.
float ground_distance(vec3 direction) {
    float t = (frame.ground_height - frame.eye.y) / min(direction.y, -1e-6);
    return frame.ground_radius > 0.0 && direction.y < -1e-6 && t > 0.0 ? t : 0.0;
}

void main() {
    vec3 centre = ray(in_corner);
    float to_ground = ground_distance(centre);
    // The ground hides what lies below it; a little less than all, or feet would flicker.
    float hidden = to_ground > 0.0 ? frame.near / (to_ground * 1.0005) : 0.0;

    vec3 sum = vec3(0.0);
    float shown = 0.0;
    uvec2 last = uvec2(0u);
    bool any = false;
    for (int i = 0; i < SAMPLES; i++) {
        any = any || fetch_depth(i) > hidden;
    }
    // Neighbouring samples that show the same surface share its light.
    vec3 light = vec3(0.0);
    for (int i = 0; any && i < SAMPLES; i++) {
        float z = fetch_depth(i);
        if (z <= hidden) {
            continue;
        }
        vec4 a, b;
        fetch(i, a, b);
        uvec2 words = uvec2(packUnorm4x8(a), packUnorm4x8(b));
        if (shown == 0.0 || words != last) {
            vec3 direction = centre + PLACES[i].x * frame.right * frame.pixel.x
                - PLACES[i].y * frame.up * frame.pixel.y;
            light = min(shade_surface(from_record(a, b), frame.eye + direction * (frame.near / z)), vec3(1.0));
            last = words;
        }
        sum += light;
        shown += 1.0;
    }
    float rest = float(SAMPLES) - shown;
    vec3 behind = backdrop(centre);
    for (int i = 0; i < 1 && rest > 0.0 && to_ground > 0.0; i++) {
        behind = ground(frame.eye + centre * to_ground, behind);
    }
    out_color = vec4((sum + rest * min(behind, vec3(1.0))) / float(SAMPLES), 1.0);
}

#endif
