#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "leaf_brdf.glsl"
#include "lit_pixel.glsl"

// Second pass: the sun, by what each pixel's leaf scatters towards the eye, times the share of the
// disc that it sees (Wang et al. 2005, equation 10).

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 7) const uint DIRECTIONAL = 0;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Frame { LitFrame frame; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Turns { LeafTurn turns[]; };
layout(set = 0, binding = 2) uniform sampler2D light_map;
layout(set = 0, binding = 3) uniform sampler2D surface_map;
layout(set = 0, binding = 4) uniform usampler2D leaf_map;
layout(set = 0, binding = 5) uniform sampler2D shine_map;
layout(set = 0, binding = 6, rgba32f) uniform restrict writeonly image2D picture;

#include "leaf_directional.glsl"

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (pixel.x >= frame.width || pixel.y >= frame.height) {
        return;
    }
    vec4 light = texelFetch(light_map, ivec2(pixel), 0);
    vec4 surface = texelFetch(surface_map, ivec2(pixel), 0);
    PixelLeaf leaf = unpack_leaf(texelFetch(leaf_map, ivec2(pixel), 0), texelFetch(shine_map, ivec2(pixel), 0));
    if (light.a > 0.0) {
        vec3 normal = normalize(surface.xyz);
        vec3 to_eye = to_eye_of_pixel(frame, pixel, normal, surface.w);
        LeafSides sides = leaf_for_light(LeafSides(leaf.rho_d, leaf.rho_d, leaf.rho_t), leaf.material, dot(normal, frame.sun));
        vec3 scattered = leaf_scatters(sides, leaf.shine, normal, frame.sun, to_eye);
        light.rgb += frame.irradiance * (abs(surface.w) - 1.0) * scattered;
    }
    imageStore(picture, ivec2(pixel), light);
}
