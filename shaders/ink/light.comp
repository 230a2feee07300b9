#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#include "ink_light.glsl"
#include "ink_style.glsl"

// Light on what each pixel shows: sun (x), light from all around (y), how far the sun is hidden (z)
// and the tone of both (w). Behind stage 1, so that a pixel is looked up once, whatever lies below.

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) uniform sampler2D depth_map;
layout(set = 0, binding = 1) uniform sampler2D normal_map;
layout(set = 0, binding = 2) uniform sampler2D sun_map;
layout(set = 0, binding = 3) uniform sampler2D ids_map;
layout(set = 0, binding = 4, scalar) restrict readonly buffer Frame { InkFrame frame; };
layout(set = 0, binding = 5, scalar) restrict readonly buffer Styles { InkStyle styles[]; };
layout(set = 0, binding = 6, rgba16f) uniform restrict writeonly image2D light;
layout(push_constant, scalar) uniform Push { InkLight push; };

layout(constant_id = 0) const bool SHADOW = false;
// Pixels have styles.
layout(constant_id = 1) const bool MIXED = false;

vec3 place(ivec2 pixel, float depth) {
    vec2 corner = vec2(pixel) + 0.5 - 0.5 * vec2(push.width, push.height);
    vec3 ray = frame.forward + (corner.x * frame.right - corner.y * frame.up) / frame.focal;
    return frame.eye + depth * ray;
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (pixel.x >= int(push.width) || pixel.y >= int(push.height)) {
        return;
    }
    float depth = texelFetch(depth_map, pixel, 0).r;
    vec4 found = vec4(0.0);
    if (depth > 0.0) {
        vec4 surface = texelFetch(normal_map, pixel, 0);
        vec3 n = surface.xyz;
        n = dot(n, n) > 1e-12 ? normalize(n) : frame.to_sun;
        InkStyle style = styles[MIXED ? style_of(texelFetch(ids_map, pixel, 0).x) : 0u];
        float sun = (1.0 - style.ambient) * sun_share(n, frame.to_sun, style.wrap);
        // What of both reaches the place in the crown.
        float open = min(surface.w / max(style.ambient + sun, 1e-3), 1.0);
        float hidden = 0.0;
        if (SHADOW) {
            vec4 at = push.relative_to_sun * vec4(place(pixel, depth), 1.0);
            vec2 texel = (0.5 * at.xy + 0.5) * float(push.texels);
            hidden = sun_hidden(sun_map, texel, at.z, push.reach, push.bias, push.texels);
        }
        float lit = open * sun * (1.0 - style.shadow * hidden);
        float sky = open * style.ambient;
        found = vec4(lit, sky, hidden, lit + sky);
    }
    imageStore(light, pixel, found);
}
