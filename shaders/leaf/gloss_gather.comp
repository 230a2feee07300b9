#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "dispatch.glsl"
#include "leaf_sky.glsl"
#include "lit_pixel.glsl"

// Adds what the rays of gloss bring to their pixels: the sky where they are free, otherwise the light
// that leaves the leaf they meet, from its vertices. The rays of the cosine are taken away.

layout(local_size_x = GROUP_1D) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Frame { LitFrame frame; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Counted { LeafSides counted[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Materials { LeafSides materials[]; };
layout(set = 0, binding = 3) uniform sampler2D surface_map;
layout(set = 0, binding = 4) uniform usampler2D leaf_map;
layout(set = 0, binding = 5) uniform sampler2D shine_map;
layout(set = 0, binding = 6) uniform sampler2D sky;
layout(set = 0, binding = 7, rgba32f) uniform restrict readonly image2D rays;
layout(set = 0, binding = 8, scalar) restrict readonly buffer Hits { uvec2 hits[]; };
layout(set = 0, binding = 9, scalar) restrict readonly buffer Faces { vec4 faces[]; };
layout(set = 0, binding = 10, scalar) restrict readonly buffer Positions { vec3 positions[]; };
layout(set = 0, binding = 11, scalar) restrict readonly buffer Indices { uint indices[]; };
// What leaves the front and the back of every vertex.
layout(set = 0, binding = 12, scalar) restrict readonly buffer Leaving { vec3 leaving[]; };
layout(set = 0, binding = 13, rgba32f) uniform restrict image2D picture;
layout(push_constant, scalar) uniform Push { GlossBatch push; };

// Light against the direction of a ray from the triangle that it meets at `at`.
vec3 light_of_leaf(uint triangle, vec3 at, vec3 direction) {
    vec3 face = faces[triangle].xyz;
    uint side = dot(face, direction) < 0.0 ? 0u : 1u;
    uvec3 corner = uvec3(indices[3u * triangle], indices[3u * triangle + 1u], indices[3u * triangle + 2u]);
    vec3 weights = corner_weights(positions[corner.x] - at, positions[corner.y] - at, positions[corner.z] - at, face);
    weights = max(weights, vec3(0.0));
    weights /= max(weights.x + weights.y + weights.z, 1e-30);
    return weights.x * leaving[2u * corner.x + side] + weights.y * leaving[2u * corner.y + side]
         + weights.z * leaving[2u * corner.z + side];
}

void main() {
    uint place = flat_invocation();
    if (place >= push.pixels) {
        return;
    }
    // Of the lobe, and of the cosine.
    vec3 sums[2] = vec3[2](vec3(0.0), vec3(0.0));
    for (uint row = 0u; row < 2u * push.samples; ++row) {
        uint ray = row * push.pixels + place;
        ivec2 texel = ivec2((2u * ray) & ((1u << RAY_COLUMN_BITS) - 1u), (2u * ray) >> RAY_COLUMN_BITS);
        vec4 direction = imageLoad(rays, texel + ivec2(1, 0));
        if (!(direction.w > 0.0)) {
            continue;
        }
        uvec2 hit = hits[ray];
        vec3 light;
        if (hit.y == RAY_NOTHING) {
            light = sky_radiance(sky, direction.xyz);
        } else {
            vec3 at = imageLoad(rays, texel).xyz + uintBitsToFloat(hit.x) * direction.xyz;
            light = light_of_leaf(hit.y, at, direction.xyz);
        }
        sums[row < push.samples ? 0 : 1] += direction.w * light;
    }
    uint index = push.first_pixel + place;
    ivec2 pixel = ivec2(index % frame.width, index / frame.width);
    vec4 before = imageLoad(picture, pixel);
    if (!(before.a > 0.0)) {
        return;
    }
    bool front = texelFetch(surface_map, pixel, 0).w > 0.0;
    PixelLeaf leaf = unpack_leaf(texelFetch(leaf_map, pixel, 0), texelFetch(shine_map, pixel, 0));
    LeafSides known = counted[leaf.material];
    LeafSides means = materials[leaf.material];
    // Light of the vertices follows the leaf at the pixel by this share, and with it what of gloss it holds.
    vec3 mean = means.rho_t + (front ? means.rho_d_front : means.rho_d_back);
    vec3 share = mix(vec3(1.0), (leaf.rho_d + leaf.rho_t) / max(mean, vec3(1e-6)), greaterThan(mean, vec3(1e-6)));
    vec3 diffuse = share * (front ? known.rho_d_front : known.rho_d_back);
    vec3 more = (leaf.shine.rgb * sums[0] - diffuse * sums[1]) / float(push.all_samples);
    imageStore(picture, pixel, vec4(before.rgb + more, before.a));
}
