#ifndef BOXES_GLSL
#define BOXES_GLSL

// Squared distance from a point to a box, rounded down so that nothing nearest is ever skipped.
float box_distance_squared(vec3 p, vec3 low, vec3 high) {
    vec3 d = max(max(low - p, p - high), vec3(0.0));
    return dot(d, d) * (1.0 - 1e-5);
}

// Barycentric coordinates of the point of triangle abc nearest to p (Ericson 2005, Real-Time
// Collision Detection, 5.1.5: the Voronoi region decides).
vec3 closest_on_triangle(vec3 p, vec3 a, vec3 b, vec3 c) {
    vec3 ab = b - a;
    vec3 ac = c - a;
    float d1 = dot(ab, p - a);
    float d2 = dot(ac, p - a);
    if (d1 <= 0.0 && d2 <= 0.0) {
        return vec3(1.0, 0.0, 0.0);
    }
    float d3 = dot(ab, p - b);
    float d4 = dot(ac, p - b);
    if (d3 >= 0.0 && d4 <= d3) {
        return vec3(0.0, 1.0, 0.0);
    }
    float vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
        float t = d1 / (d1 - d3);
        return vec3(1.0 - t, t, 0.0);
    }
    float d5 = dot(ab, p - c);
    float d6 = dot(ac, p - c);
    if (d6 >= 0.0 && d5 <= d6) {
        return vec3(0.0, 0.0, 1.0);
    }
    float vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
        float t = d2 / (d2 - d6);
        return vec3(1.0 - t, 0.0, t);
    }
    float va = d3 * d6 - d5 * d4;
    if (va <= 0.0 && d4 >= d3 && d5 >= d6) {
        float t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return vec3(0.0, 1.0 - t, t);
    }
    // Cancellation on slivers must not lead to a point outside, which would seem nearer than it is.
    vec3 weights = max(vec3(va, vb, vc), vec3(0.0));
    float sum = weights.x + weights.y + weights.z;
    return sum > 0.0 ? weights / sum : vec3(1.0, 0.0, 0.0);
}

#endif
