#ifndef BACKDROP_GLSL
#define BACKDROP_GLSL

// What stands behind the model: the ground, else the background.

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

// Distance along a ray at which it meets the ground; 0 where it does not.
float ground_distance(vec3 direction) {
    float t = (frame.ground_height - frame.eye.y) / min(direction.y, -1e-6);
    return frame.ground_radius > 0.0 && direction.y < -1e-6 && t > 0.0 ? t : 0.0;
}

// Light from behind the model along a ray that meets the ground at `to_ground` (0: not at all).
vec3 light_behind(vec3 direction, float to_ground) {
    vec3 behind = backdrop(direction);
    if (to_ground > 0.0) {
        behind = ground(frame.eye + direction * to_ground, behind);
    }
    return min(behind, vec3(1.0));
}

#endif
