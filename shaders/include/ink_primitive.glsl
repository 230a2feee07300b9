#ifndef INK_PRIMITIVE_GLSL
#define INK_PRIMITIVE_GLSL

// Point `k` of a primitive's outline (Deussen and Strothotte 2000, section 3.2): between the nine
// views about the leaf's tilt, deformed, turned in the picture. `polygon.rs` does the same.

vec2 primitive_view(uint view, uint k, uint points) {
    return outlines[view * points + k];
}

vec2 primitive_point(PaperParticle particle, uint k, uint points, uint views, float deformation) {
    vec2 p;
    if (views == 9u) {
        vec2 at = particle.tilt + 1.0;
        vec2 cell = clamp(floor(at), vec2(0.0), vec2(1.0));
        vec2 t = at - cell;
        uint first = 3u * uint(cell.y) + uint(cell.x);
        vec2 low = mix(primitive_view(first, k, points), primitive_view(first + 1u, k, points), t.x);
        vec2 high = mix(primitive_view(first + 3u, k, points), primitive_view(first + 4u, k, points), t.x);
        p = mix(low, high, t.y);
    } else {
        p = primitive_view(0u, k, points);
    }
    float angle = 6.28318531 * float(k) / float(points);
    vec2 turns = vec2(2.0, 3.0) * angle;
    vec2 wave = cos(turns) * particle.waves.xy - sin(turns) * particle.waves.zw;
    p *= 1.0 + deformation * (0.6 * wave.x + 0.4 * wave.y);
    return vec2(particle.turn.x * p.x - particle.turn.y * p.y, particle.turn.y * p.x + particle.turn.x * p.y);
}

#endif
