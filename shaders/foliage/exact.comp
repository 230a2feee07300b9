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

layout(local_size_x = GROUP_1D) in;
layout(constant_id = 0) const uint NORM = NORM_EUCLIDEAN;
layout(set = 0, binding = 0) uniform sampler2D generators;
layout(set = 0, binding = 1, scalar) restrict readonly buffer BinFirst { uint bin_first[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Queries { vec4 queries[]; };
layout(set = 0, binding = 3, scalar) restrict readonly buffer Nearest { vec4 nearest[]; };
layout(set = 0, binding = 4, scalar) restrict readonly buffer Vertices { vec4 vertices[]; };
layout(set = 0, binding = 5, scalar) restrict readonly buffer Indices { uint indices[]; };
layout(set = 0, binding = 6, scalar) restrict buffer Found { vec4 found[]; };
layout(push_constant, scalar) uniform Push { ExactQueries push; };

vec4 generator(uint i) {
    uint column = i & ((1u << GENERATOR_COLUMN_BITS) - 1u);
    return texelFetch(generators, ivec2(column, i >> GENERATOR_COLUMN_BITS), 0);
}

// Density and its gradient at one point.
vec4 field(vec3 q) {
    float inverse_radius = 1.0 / push.radius;
    float inverse_edge = 1.0 / push.bin_edge;
    float support = push.radius * enclosing_radius(NORM) * (1.0 + CULL_MARGIN) + CULL_MARGIN * push.bin_edge;
    float density = 0.0;
    vec3 gradient = vec3(0.0);
    ivec2 zs = bin_range(q.z, q.z, support, push.bin_origin.z, inverse_edge, push.bins.z);
    ivec2 ys = bin_range(q.y, q.y, support, push.bin_origin.y, inverse_edge, push.bins.y);
    for (int z = zs.x; z <= zs.y; ++z) {
        for (int y = ys.x; y <= ys.y; ++y) {
            ivec2 xs = bin_range(q.x, q.x, support, push.bin_origin.x, inverse_edge, push.bins.x);
            uint row = push.bins.x * (uint(y) + push.bins.y * uint(z));
            uint last = bin_first[row + uint(xs.y) + 1u];
            // Several at a time: Mesa's software driver ends the loops of an invocation, all
            // together, after 65,535 rounds.
            for (uint i = bin_first[row + uint(xs.x)]; i < last; i += EXACT_BATCH) {
                [[unroll]] for (uint k = 0u; k < EXACT_BATCH; ++k) {
                    vec4 g = generator(min(i + k, last - 1u));
                    vec3 d = (q - g.xyz) * inverse_radius;
                    float t = max(1.0 - squared_length(d, NORM), 0.0);
                    float wt = i + k < last ? g.w * g.w * t : 0.0;
                    density = fma(wt, t, density);
                    gradient = fma(vec3(wt), outward(d, NORM), gradient);
                }
            }
        }
    }
    return vec4(density, -4.0 * inverse_radius * gradient);
}

// Moves p along the gradient onto D = tau; w of the result is 0 where it does not arrive.
vec4 newton(vec3 p) {
    for (uint step = 0u; step < EXACT_NEWTON_STEPS; ++step) {
        vec4 f = field(p);
        float slope = length(f.yzw);
        if (slope * push.radius < EXACT_SLOPE_FLOOR) {
            return vec4(p, 0.0);
        }
        float distance = (push.tau - f.x) / slope;
        float limit = 0.25 * push.radius;
        p += clamp(distance, -limit, limit) * f.yzw / slope;
        if (abs(distance) < EXACT_TOLERANCE * push.radius) {
            return vec4(p, 1.0);
        }
    }
    return vec4(p, 0.0);
}

// What of the way to the query lies along the surface.
vec3 tangential_offset(vec3 offset, vec3 gradient) {
    vec3 n = gradient / max(length(gradient), 1e-30);
    return offset - dot(offset, n) * n;
}

void main() {
    uint i = flat_invocation();
    if (i >= push.count) {
        return;
    }
    vec3 q = queries[i].xyz;
    uint target = floatBitsToUint(queries[i].w);
    vec4 near = nearest[target];
    uint triangle = floatBitsToUint(near.x);
    vec3 start = near.y * vertices[indices[3u * triangle]].xyz
        + near.z * vertices[indices[3u * triangle + 1u]].xyz
        + near.w * vertices[indices[3u * triangle + 2u]].xyz;
    vec4 p = newton(start);
    if (p.w == 0.0) {
        // The direction found on the triangles stays.
        return;
    }
    vec3 gradient = field(p.xyz).yzw;
    vec3 tangential = tangential_offset(q - p.xyz, gradient);
    float step = 1.0;
    for (uint k = 0u; k < EXACT_DESCENT_STEPS && step > 1e-3; ++k) {
        if (length(tangential) < EXACT_TOLERANCE * push.radius) {
            break;
        }
        vec4 next = newton(p.xyz + step * tangential);
        vec3 next_gradient = field(next.xyz).yzw;
        vec3 next_tangential = tangential_offset(q - next.xyz, next_gradient);
        float now = dot(q - p.xyz, q - p.xyz);
        float then = dot(q - next.xyz, q - next.xyz);
        // Near the end the distance no longer changes in f32; what is left along the surface does.
        bool nearer = then < now * (1.0 - 1e-6)
            || (then < now * (1.0 + 1e-6) && length(next_tangential) < length(tangential));
        if (next.w != 0.0 && nearer) {
            p = next;
            gradient = next_gradient;
            tangential = next_tangential;
            step = min(1.0, 1.5 * step);
        } else {
            step *= 0.5;
        }
    }
    float size = length(gradient);
    if (size * push.radius > GRADIENT_FLOOR) {
        found[target] = vec4(-gradient / size, 1.0);
    }
}
