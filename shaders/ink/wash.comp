#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "ink_bilinear.glsl"
#include "ink_noise.glsl"

// A wash: up to three transparent layers by tone, each with pigment gathered at its edge, settled
// unevenly and in the grain of the paper.

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) uniform sampler2D colour_map;
layout(set = 0, binding = 1) uniform sampler2D tone_map;
layout(set = 0, binding = 2, rgba16f) uniform restrict writeonly image2D wash;
layout(push_constant, scalar) uniform Push { InkWash push; };

// How much is covered, and the tone of that.
vec2 cover(vec2 at) {
    ivec2 size = ivec2(push.width, push.height);
    float covered = bilinear(colour_map, at, size).a;
    return vec2(covered, bilinear(tone_map, at, size).x / max(covered, 1e-3));
}

// Density of a layer `inside` pixels from its edge.
float layer(float inside) {
    float lies = clamp(inside / push.feather + 0.5, 0.0, 1.0);
    return lies * (1.0 + push.darkening * exp(-max(inside, 0.0) / push.edge_width));
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = ivec2(push.width, push.height);
    if (any(greaterThanEqual(pixel, size))) {
        return;
    }
    vec2 at = vec2(pixel) + 0.5;
    vec2 on_paper = at / push.factor;
    vec2 wander = vec2(cloudy_noise(on_paper / INK_WOBBLE_LENGTH, push.seed),
                       cloudy_noise(on_paper / INK_WOBBLE_LENGTH, push.seed + 17u)) - 0.5;
    at += 2.0 * push.wobble * wander;
    vec2 here = cover(at);
    vec2 x = cover(at + vec2(1.0, 0.0)) - cover(at - vec2(1.0, 0.0));
    vec2 y = cover(at + vec2(0.0, 1.0)) - cover(at - vec2(0.0, 1.0));
    // Change per pixel; where nothing changes an edge is far.
    vec2 slope = max(0.5 * vec2(length(vec2(x.x, y.x)), length(vec2(x.y, y.y))), vec2(2e-3));
    float shape = (here.x - 0.5) / slope.x;
    float density = layer(shape);
    // Later layers end where the first one does.
    float settled = cloudy_noise(on_paper / INK_PIGMENT_LENGTH, push.seed + 31u) - 0.5;
    // An even tone is not painted over at once.
    float tone = here.y + 0.06 * settled;
    density += layer(min((push.middle - tone) / slope.y, shape));
    density += layer(min((push.dark - tone) / slope.y, shape));
    float grain = cloudy_noise(on_paper / INK_GRAIN_LENGTH, push.seed + 47u) - 0.5;
    density *= push.density * max(1.0 + 2.0 * push.pigment * settled + 2.0 * push.grain * grain, 0.0);
    vec4 paint = bilinear(colour_map, at, size);
    // What a layer of density 1 lets through: two such layers have the colour of the leaf.
    vec3 through = sqrt(clamp(paint.rgb / max(paint.a, 1e-3), vec3(2e-3), vec3(0.9)));
    imageStore(wash, pixel, vec4(push.paper * pow(through, vec3(density)), 1.0));
}
