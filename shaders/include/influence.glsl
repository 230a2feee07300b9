#ifndef INFLUENCE_GLSL
#define INFLUENCE_GLSL

// Luft, Balzer, Deussen 2007, equation 2, in units of the radius.

// Squared length of d in a norm.
float squared_length(vec3 d, uint norm) {
    if (norm == NORM_EUCLIDEAN) {
        return dot(d, d);
    }
    vec3 a = abs(d);
    float length = norm == NORM_MANHATTAN ? a.x + a.y + a.z : max(a.x, max(a.y, a.z));
    return length * length;
}

// Length of d times the gradient of the length: d itself in the Euclidean norm.
vec3 outward(vec3 d, uint norm) {
    if (norm == NORM_EUCLIDEAN) {
        return d;
    }
    vec3 a = abs(d);
    if (norm == NORM_MANHATTAN) {
        return (a.x + a.y + a.z) * sign(d);
    }
    if (a.x >= a.y && a.x >= a.z) {
        return vec3(d.x, 0.0, 0.0);
    }
    return a.y >= a.z ? vec3(0.0, d.y, 0.0) : vec3(0.0, 0.0, d.z);
}

// Euclidean radius of a ball that contains the norm's unit ball.
float enclosing_radius(uint norm) {
    return norm == NORM_MAXIMUM ? 1.7320509 : 1.0;
}

#endif
