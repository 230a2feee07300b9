#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "random.glsl"
#include "leaf_brdf.glsl"
#include "lit_pixel.glsl"

// Rays from the glossy leaves of a lit picture into their surroundings: of each sample one by the
// glossy lobe and one by the cosine, which takes out what the light of the vertices holds of the
// gloss as diffuse. What a ray's light counts stands beside its direction; 0: there is no ray.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Frame { LitFrame frame; };
// Of every material, what of its gloss the light of the vertices takes for diffuse reflection.
layout(set = 0, binding = 1, scalar) restrict readonly buffer Counted { LeafSides counted[]; };
layout(set = 0, binding = 2) uniform sampler2D surface_map;
layout(set = 0, binding = 3) uniform usampler2D leaf_map;
layout(set = 0, binding = 4) uniform sampler2D shine_map;
layout(set = 0, binding = 5) uniform sampler2D depth_map;
layout(set = 0, binding = 6, rgba32f) uniform restrict writeonly image2D rays;
layout(push_constant, scalar) uniform Push { GlossBatch push; };

// A direction of the lobe about `outward` that sends light to the eye, and its weight: the
// reflection times cosine for intensity 1, over the density of Beckmann's half vectors, in which the
// distribution cancels.
vec4 lobe_direction(vec3 outward, vec3 to_eye, float roughness, vec2 u) {
    float m = max(abs(roughness), GLOSSY_MIN_ROUGHNESS);
    float tan2 = -m * m * log(max(1.0 - u.x, 1e-12));
    float z = inversesqrt(1.0 + tan2);
    float r = sqrt(max(1.0 - z * z, 0.0));
    float turn = 2.0 * LEAF_PI * u.y;
    vec3 middle = to_frame(outward, vec3(r * cos(turn), r * sin(turn), z));
    float along = dot(middle, to_eye);
    vec3 direction = 2.0 * along * middle - to_eye;
    float light = dot(outward, direction);
    float eye = dot(outward, to_eye);
    if (!(along > 0.0 && light > 0.0 && eye > 0.0)) {
        return vec4(0.0);
    }
    float kept = roughness < 0.0 ? 1.0 / (1.0 + glossy_smith(light, m) + glossy_smith(eye, m)) : 1.0;
    return vec4(direction, kept * along / (z * max(eye, GLOSSY_MIN_COSINE)));
}

void main() {
    uint ray = flat_invocation();
    if (ray >= 2u * push.pixels * push.samples) {
        return;
    }
    uint row = ray / push.pixels;
    bool mirrored = row < push.samples;
    uint number = push.first_sample + (mirrored ? row : row - push.samples);
    uint index = push.first_pixel + ray % push.pixels;
    uvec2 pixel = uvec2(index % frame.width, index / frame.width);
    float depth = texelFetch(depth_map, ivec2(pixel), 0).r;
    vec4 start = vec4(0.0, 0.0, 0.0, -1.0);
    vec4 direction = vec4(0.0);
    if (depth > 0.0) {
        vec4 surface = texelFetch(surface_map, ivec2(pixel), 0);
        PixelLeaf leaf = unpack_leaf(texelFetch(leaf_map, ivec2(pixel), 0), texelFetch(shine_map, ivec2(pixel), 0));
        LeafSides known = counted[leaf.material];
        vec3 diffuse = surface.w > 0.0 ? known.rho_d_front : known.rho_d_back;
        vec3 normal = normalize(surface.xyz);
        vec3 view = normalize(view_of_pixel(frame, pixel));
        vec2 u = even_numbers(index, number, push.seed + uint(mirrored)).xy;
        if (mirrored && any(greaterThan(leaf.shine.rgb, vec3(0.0)))) {
            // Where the shading normal turns from the eye, at a rim, gloss is that of the other side.
            vec3 outward = dot(normal, view) < 0.0 ? normal : -normal;
            direction = lobe_direction(outward, -view, leaf.shine.w, u);
        } else if (!mirrored && any(greaterThan(diffuse, vec3(0.0)))) {
            direction = vec4(cosine_direction(surface.w > 0.0 ? normal : -normal, u), 1.0);
        }
        // Before the surface or, for rays through it, behind.
        float extent = 2.0 * max(length(frame.right) / float(frame.width), length(frame.up) / float(frame.height));
        float away = max(GLOSS_RAY_OFFSET, GLOSS_RAY_PIXELS * push.scale * extent * frame.near / depth);
        float side = dot(leaf.face, direction.xyz) < 0.0 ? away : -away;
        vec3 place = push.scale * position_of_pixel(frame, pixel, depth) + side * view;
        start = vec4(place, direction.w > 0.0 ? RAY_FAR : -1.0);
    }
    ivec2 texel = ivec2((2u * ray) & ((1u << RAY_COLUMN_BITS) - 1u), (2u * ray) >> RAY_COLUMN_BITS);
    imageStore(rays, texel, start);
    imageStore(rays, texel + ivec2(1, 0), direction);
}
