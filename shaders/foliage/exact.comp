#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "bins.glsl"
#include "influence.glsl"

// Normal of the implicit surface itself at its point nearest to the query: Newton steps along
// the gradient alternate with descent of the distance in the tangent plane, from the nearest
// point of the triangles. A reference mode: every step sums over all generators in reach.
//
// Mesa's software driver ends the loops of an invocation, all together, after 65,535 rounds, so
// one dispatch takes `EXACT_TURNS` turns of `EXACT_ROUNDS` rounds at most and leaves where it
// stands, even in the middle of a sum; the next one goes on there, until `finished` counts all.

layout(local_size_x = GROUP_1D) in;
layout(constant_id = 0) const uint NORM = NORM_EUCLIDEAN;
layout(set = 0, binding = 0) uniform sampler2D generators;
layout(set = 0, binding = 1, scalar) restrict readonly buffer BinFirst { uint bin_first[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Queries { vec4 queries[]; };
layout(set = 0, binding = 3, scalar) restrict readonly buffer Nearest { vec4 nearest[]; };
layout(set = 0, binding = 4, scalar) restrict readonly buffer Vertices { vec4 vertices[]; };
layout(set = 0, binding = 5, scalar) restrict readonly buffer Indices { uint indices[]; };
layout(set = 0, binding = 6, scalar) restrict buffer States { ExactState states[]; };
layout(set = 0, binding = 7, scalar) restrict buffer Found { vec4 found[]; };
layout(set = 0, binding = 8, scalar) restrict buffer Counters { uint finished; uint unsettled; };
layout(push_constant, scalar) uniform Push { ExactQueries push; };

vec4 generator(uint i) {
    uint column = i & ((1u << GENERATOR_COLUMN_BITS) - 1u);
    return texelFetch(generators, ivec2(column, i >> GENERATOR_COLUMN_BITS), 0);
}

// Adds generators to the sum of s.point, `EXACT_BATCH` per round; true when there are no more.
bool add_generators(inout ExactState s) {
    vec3 q = s.point;
    float inverse_radius = 1.0 / push.radius;
    float inverse_edge = 1.0 / push.bin_edge;
    float support = push.radius * enclosing_radius(NORM) * (1.0 + CULL_MARGIN) + CULL_MARGIN * push.bin_edge;
    ivec2 xs = bin_range(q.x, q.x, support, push.bin_origin.x, inverse_edge, push.bins.x);
    ivec2 ys = bin_range(q.y, q.y, support, push.bin_origin.y, inverse_edge, push.bins.y);
    ivec2 zs = bin_range(q.z, q.z, support, push.bin_origin.z, inverse_edge, push.bins.z);
    uint height = uint(ys.y - ys.x) + 1u;
    uint rows = height * (uint(zs.y - zs.x) + 1u);
    vec4 sum = s.sum;
    uint row = s.row;
    uint next = s.next;
    // One loop over rows and generators: neighbours whose rows differ in length stay together.
    for (uint round = 0u; round < EXACT_ROUNDS && row < rows; ++round) {
        uint y = uint(ys.x) + row % height;
        uint z = uint(zs.x) + row / height;
        uint bin = push.bins.x * (y + push.bins.y * z);
        uint first = max(next, bin_first[bin + uint(xs.x)]);
        uint last = bin_first[bin + uint(xs.y) + 1u];
        [[unroll]] for (uint k = 0u; k < EXACT_BATCH; ++k) {
            vec4 g = generator(min(first + k, max(last, 1u) - 1u));
            vec3 d = (q - g.xyz) * inverse_radius;
            float t = max(1.0 - squared_length(d, NORM), 0.0);
            float wt = first + k < last ? g.w * g.w * t : 0.0;
            sum = vec4(fma(wt, t, sum.x), fma(vec3(wt), outward(d, NORM), sum.yzw));
        }
        next = first + EXACT_BATCH;
        if (next >= last) {
            ++row;
            next = 0u;
        }
    }
    s.sum = sum;
    s.row = row;
    s.next = next;
    return row >= rows;
}

// What of the way to the query lies along the surface.
vec3 tangential_offset(vec3 offset, vec3 gradient) {
    vec3 n = gradient / max(length(gradient), 1e-30);
    return offset - dot(offset, n) * n;
}

// One step along the gradient towards D = tau. On the surface the field is wanted once more;
// `lost` where the step leads nowhere.
void newton(inout ExactState s, vec4 f, out bool lost) {
    float slope = length(f.yzw);
    lost = !(slope * push.radius >= EXACT_SLOPE_FLOOR);
    if (lost) {
        return;
    }
    float distance = (push.tau - f.x) / slope;
    float limit = 0.25 * push.radius;
    s.point += clamp(distance, -limit, limit) * f.yzw / slope;
    s.newton_steps += 1u;
    if (abs(distance) < EXACT_TOLERANCE * push.radius) {
        s.phase += 1u;
    } else {
        lost = s.newton_steps >= EXACT_NEWTON_STEPS;
    }
}

// Whether the new point on the surface is nearer to the query than the best so far.
bool nearer(ExactState s, vec3 q, vec3 gradient) {
    float now = dot(q - s.best, q - s.best);
    float then = dot(q - s.point, q - s.point);
    // Near the end the distance no longer changes in f32; what is left along the surface does.
    float left = length(tangential_offset(q - s.best, s.gradient));
    float new_left = length(tangential_offset(q - s.point, gradient));
    return then < now * (1.0 - 1e-6) || (then < now * (1.0 + 1e-6) && new_left < left);
}

// Tries the next point along the surface, or is done.
void descend(inout ExactState s, vec3 q, uint target) {
    vec3 tangential = tangential_offset(q - s.best, s.gradient);
    bool arrived = length(tangential) < EXACT_TOLERANCE * push.radius || s.step <= 1e-3;
    if (!arrived && s.descent_steps < EXACT_DESCENT_STEPS) {
        s.point = s.best + s.step * tangential;
        s.newton_steps = 0u;
        s.descent_steps += 1u;
        s.phase = EXACT_SEEK;
        return;
    }
    s.phase = EXACT_DONE;
    if (!arrived) {
        atomicAdd(unsettled, 1u);
    }
    float size = length(s.gradient);
    if (size * push.radius > GRADIENT_FLOOR) {
        found[target] = vec4(-s.gradient / size, 1.0);
    }
}

// What follows from the field at s.point.
void advance(inout ExactState s, vec3 q, uint target) {
    vec4 f = vec4(s.sum.x, -4.0 / push.radius * s.sum.yzw);
    s.sum = vec4(0.0);
    s.row = 0u;
    s.next = 0u;
    bool lost = false;
    if (s.phase == EXACT_START || s.phase == EXACT_SEEK) {
        newton(s, f, lost);
        if (!lost) {
            return;
        }
        if (s.phase == EXACT_START) {
            // The direction found on the triangles stays.
            s.phase = EXACT_DONE;
            return;
        }
    }
    if (s.phase == EXACT_START_FOUND || (!lost && nearer(s, q, f.yzw))) {
        s.step = s.phase == EXACT_START_FOUND ? 1.0 : min(1.0, 1.5 * s.step);
        s.best = s.point;
        s.gradient = f.yzw;
    } else {
        s.step *= 0.5;
    }
    descend(s, q, target);
}

ExactState start(uint target) {
    vec4 near = nearest[target];
    uint triangle = floatBitsToUint(near.x);
    vec3 point = near.y * vertices[indices[3u * triangle]].xyz
        + near.z * vertices[indices[3u * triangle + 1u]].xyz
        + near.w * vertices[indices[3u * triangle + 2u]].xyz;
    return ExactState(vec4(0.0), point, 1.0, point, vec3(0.0), EXACT_START, 0u, 0u, 0u, 0u);
}

void main() {
    uint i = flat_invocation();
    if (i >= push.count) {
        return;
    }
    vec3 q = queries[i].xyz;
    uint target = floatBitsToUint(queries[i].w);
    ExactState s;
    if (push.continues == 0u) {
        s = start(target);
    } else {
        s = states[i];
        if (s.phase == EXACT_DONE) {
            return;
        }
    }
    for (uint turn = 0u; turn < EXACT_TURNS && s.phase != EXACT_DONE; ++turn) {
        if (add_generators(s)) {
            advance(s, q, target);
        }
    }
    states[i] = s;
    if (s.phase == EXACT_DONE) {
        atomicAdd(finished, 1u);
    }
}
