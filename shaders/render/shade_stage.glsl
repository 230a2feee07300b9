#ifndef SHADE_STAGE_GLSL
#define SHADE_STAGE_GLSL

// Stage 2 of lit pictures: one evaluation of eq. 1 per surface that a pixel shows, the ground and
// the background where it shows none. The including file says how a sample is read (`fetch`,
// `fetch_depth`) and where in the pixel it lies (`SAMPLES`, `PLACES`).

#include "backdrop.glsl"
#include "surface_record.glsl"

layout(set = 1, binding = 3, scalar) restrict readonly buffer Materials { RenderMaterial materials[]; };

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

// Samples that differ in no bit of their record show one surface and share its light: the loop
// below runs once per surface, and ends when all pixels of a group are through.
void main() {
    vec3 centre = ray(in_corner);
    float to_ground = ground_distance(centre);
    // The ground hides what lies below it; a little less than all, or feet would flicker.
    float hidden = to_ground > 0.0 ? frame.near / (to_ground * 1.0005) : 0.0;

    float depths[SAMPLES];
    vec4 a[SAMPLES], b[SAMPLES];
    uint left = 0u;
    for (int i = 0; i < SAMPLES; i++) {
        depths[i] = fetch_depth(i);
        fetch(i, a[i], b[i]);
        left |= depths[i] > hidden ? 1u << i : 0u;
    }
    float rest = float(SAMPLES - bitCount(left));
    vec3 sum = vec3(0.0);
    while (left != 0u) {
        // The first sample that is left; selected, since indexing would go through memory.
        int first = findLSB(left);
        float z = depths[0];
        vec4 record_a = a[0], record_b = b[0];
        vec2 place = PLACES[0];
        for (int i = 1; i < SAMPLES; i++) {
            bool chosen = i == first;
            z = chosen ? depths[i] : z;
            record_a = chosen ? a[i] : record_a;
            record_b = chosen ? b[i] : record_b;
            place = chosen ? PLACES[i] : place;
        }
        uint same = 0u;
        for (int i = 0; i < SAMPLES; i++) {
            same |= a[i] == record_a && b[i] == record_b ? 1u << i : 0u;
        }
        same &= left;
        vec3 direction = centre + place.x * frame.right * frame.pixel.x
            - place.y * frame.up * frame.pixel.y;
        vec3 position = frame.eye + direction * (frame.near / z);
        vec3 light = shade_surface(from_record(record_a, record_b), position);
        sum += float(bitCount(same)) * min(light, vec3(1.0));
        left &= ~same;
    }
    vec3 behind = light_behind(centre, rest > 0.0 ? to_ground : 0.0);
    out_color = vec4((sum + rest * behind) / float(SAMPLES), 1.0);
}

#endif
