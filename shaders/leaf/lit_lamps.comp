#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "leaf_brdf.glsl"
#include "lit_pixel.glsl"
#include "lamp.glsl"

// Adds up to four lamps: what each point of a lamp would send to the eye if nothing hid it, times
// the share of the lamp that is seen. One point is the constant BRDF of Wang et al. 2005.

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 7) const uint DIRECTIONAL = 0;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Frame { LitFrame frame; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Turns { LeafTurn turns[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Lamps { LampRecord lamps[]; };
layout(set = 0, binding = 3, scalar) restrict readonly buffer Points { vec3 points[]; };
layout(set = 0, binding = 4) uniform sampler2D surface_map;
layout(set = 0, binding = 5) uniform usampler2D leaf_map;
layout(set = 0, binding = 6) uniform sampler2D shine_map;
layout(set = 0, binding = 7) uniform sampler2D depth_map;
layout(set = 0, binding = 8) uniform sampler2D visibility_map;
layout(set = 0, binding = 9, rgba32f) uniform restrict image2D picture;
layout(push_constant, scalar) uniform Push { LampPass push; };

#include "leaf_directional.glsl"

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (pixel.x >= frame.width || pixel.y >= frame.height) {
        return;
    }
    float depth = texelFetch(depth_map, ivec2(pixel), 0).r;
    if (depth <= 0.0) {
        return;
    }
    vec3 position = position_of_pixel(frame, pixel, depth);
    vec4 surface = texelFetch(surface_map, ivec2(pixel), 0);
    PixelLeaf leaf = unpack_leaf(texelFetch(leaf_map, ivec2(pixel), 0), texelFetch(shine_map, ivec2(pixel), 0));
    vec4 visibility = texelFetch(visibility_map, ivec2(pixel), 0);
    vec3 normal = normalize(surface.xyz);
    vec3 to_eye = to_eye_of_pixel(frame, pixel, normal, surface.w);
    LeafSides straight = LeafSides(leaf.rho_d, leaf.rho_d, leaf.rho_t);
    vec3 sum = vec3(0.0);
    for (uint k = 0u; k < push.count; ++k) {
        LampRecord lamp = lamps[push.first + k];
        vec3 light = vec3(0.0);
        for (uint i = 0u; i < lamp.points && visibility[k] > 0.0; ++i) {
            vec3 to = points[lamp.first_point + i] - position;
            float falloff = lamp_falloff(to, lamp.normal, lamp.least);
            vec3 towards = to * inversesqrt(max(dot(to, to), 1e-30));
            LeafSides sides = leaf_for_light(straight, leaf.material, dot(normal, towards));
            light += falloff * leaf_scatters(sides, leaf.shine, normal, towards, to_eye);
        }
        sum += visibility[k] * lamp.intensity * light;
    }
    vec4 before = imageLoad(picture, ivec2(pixel));
    imageStore(picture, ivec2(pixel), vec4(before.rgb + sum, before.a));
}
