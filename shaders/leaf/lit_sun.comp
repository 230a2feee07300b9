#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "leaf_brdf.glsl"

// Second pass: the sun, by what each pixel's leaf scatters towards the eye, times the share of the
// disc that it sees (Wang et al. 2005, equation 10).

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Frame { LitFrame frame; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer Materials { LeafSides materials[]; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Gloss { vec4 gloss[]; };
layout(set = 0, binding = 3) uniform sampler2D light_map;
layout(set = 0, binding = 4) uniform sampler2D surface_map;
layout(set = 0, binding = 5) uniform sampler2D material_map;
layout(set = 0, binding = 6, rgba32f) uniform restrict writeonly image2D picture;

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (pixel.x >= frame.width || pixel.y >= frame.height) {
        return;
    }
    vec4 light = texelFetch(light_map, ivec2(pixel), 0);
    vec4 surface = texelFetch(surface_map, ivec2(pixel), 0);
    vec4 material = texelFetch(material_map, ivec2(pixel), 0);
    if (light.a > 0.0) {
        vec3 normal = normalize(surface.xyz);
        vec3 to_eye = to_eye_of_pixel(frame, pixel, normal, surface.w);
        uint id = uint(material.w + 0.5);
        vec3 scattered = leaf_scatters(materials[id], gloss[id], normal, frame.sun, to_eye);
        light.rgb += material.rgb * frame.irradiance * (abs(surface.w) - 1.0) * scattered;
    }
    imageStore(picture, ivec2(pixel), light);
}
