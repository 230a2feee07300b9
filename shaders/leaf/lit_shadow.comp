#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "leaf_brdf.glsl"
#include "lit_pixel.glsl"

// Adds the sun by a shadow map in place of stored visibility (Reeves, Salesin, Cook 1987, Rendering
// Antialiased Shadows with Depth Maps): the share of the points of a disc of texels that nothing
// is nearer to the sun at.

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 7) const uint DIRECTIONAL = 0;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Frame { LitFrame frame; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Turns { LeafTurn turns[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer View { ShadowView view; };
layout(set = 0, binding = 3) uniform sampler2D surface_map;
layout(set = 0, binding = 4) uniform usampler2D leaf_map;
layout(set = 0, binding = 5) uniform sampler2D shine_map;
layout(set = 0, binding = 6) uniform sampler2D depth_map;
layout(set = 0, binding = 7) uniform sampler2D shadow_map;
layout(set = 0, binding = 8, rgba32f) uniform restrict image2D picture;

#include "leaf_directional.glsl"

float shadow_visibility(vec3 position, float cosine) {
    vec4 place = view.relative_to_sun * vec4(position, 1.0);
    vec2 texel = (0.5 * place.xy + 0.5) * float(view.size);
    // Over the filter a slanted leaf rises by so much.
    float slope = sqrt(max(1.0 - cosine * cosine, 0.0)) / max(abs(cosine), 1e-3);
    float rise = view.texel * (view.radius + 1.0) * min(slope, LIT_SHADOW_STEEPEST);
    float depth = place.z + rise / view.range + 1e-5;
    float open = 0.0;
    for (uint i = 0u; i < LIT_SHADOW_TAPS; ++i) {
        float along = float(i) + 0.5;
        float radius = view.radius * sqrt(along / float(LIT_SHADOW_TAPS));
        float turn = along * 2.39996322972865332;
        ivec2 at = ivec2(floor(texel + radius * vec2(cos(turn), sin(turn))));
        at = clamp(at, ivec2(0), ivec2(view.size - 1u));
        open += texelFetch(shadow_map, at, 0).r > depth ? 0.0 : 1.0;
    }
    return open / float(LIT_SHADOW_TAPS);
}

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (pixel.x >= frame.width || pixel.y >= frame.height) {
        return;
    }
    float depth = texelFetch(depth_map, ivec2(pixel), 0).r;
    if (depth <= 0.0) {
        return;
    }
    vec4 surface = texelFetch(surface_map, ivec2(pixel), 0);
    PixelLeaf leaf = unpack_leaf(texelFetch(leaf_map, ivec2(pixel), 0), texelFetch(shine_map, ivec2(pixel), 0));
    vec3 normal = normalize(surface.xyz);
    vec3 to_eye = to_eye_of_pixel(frame, pixel, normal, surface.w);
    vec3 position = position_of_pixel(frame, pixel, depth);
    float seen = shadow_visibility(position, dot(normal, frame.sun));
    LeafSides sides = leaf_for_light(LeafSides(leaf.rho_d, leaf.rho_d, leaf.rho_t), leaf.material, dot(normal, frame.sun));
    vec3 scattered = leaf_scatters(sides, leaf.shine, normal, frame.sun, to_eye);
    vec4 before = imageLoad(picture, ivec2(pixel));
    vec3 light = frame.irradiance * seen * scattered;
    imageStore(picture, ivec2(pixel), vec4(before.rgb + light, before.a));
}
