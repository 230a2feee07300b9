#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"

// How deep each pixel lies in shadow (0 light to 1): foliage as a whole leaf, stems by the pixel.

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, scalar) restrict readonly buffer Frame { InkFrame frame; };
layout(set = 0, binding = 1, scalar) restrict readonly buffer SunFrame { InkFrame sun; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Particles { PaperParticle particles[]; };
layout(set = 0, binding = 3) uniform sampler2D foliage_depth;
layout(set = 0, binding = 4) uniform sampler2D foliage_number;
layout(set = 0, binding = 5) uniform sampler2D stem_depth;
layout(set = 0, binding = 6) uniform sampler2D sun_foliage;
layout(set = 0, binding = 7) uniform sampler2D sun_stems;
layout(set = 0, binding = 8, r32f) uniform restrict writeonly image2D shadow;
layout(push_constant, scalar) uniform Push { PaperSunlit push; };

// What lies in the light's way at a place of its map, how far behind it `own` is.
float behind(ivec2 at, float own) {
    at = clamp(at, ivec2(0), ivec2(push.map_size) - 1);
    float foliage = texelFetch(sun_foliage, at, 0).r;
    float stems = texelFetch(sun_stems, at, 0).r;
    float nearest = foliage > 0.0 && (stems <= 0.0 || foliage < stems) ? foliage : stems;
    return nearest > 0.0 ? own - nearest : 0.0;
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (pixel.x >= int(push.width) || pixel.y >= int(push.height)) {
        return;
    }
    float foliage = texelFetch(foliage_depth, pixel, 0).r;
    float stem = texelFetch(stem_depth, pixel, 0).r;
    float sum = 0.0;
    if (foliage > 0.0 || stem > 0.0) {
        bool leaf = foliage > 0.0 && (stem <= 0.0 || foliage <= stem);
        vec3 position;
        float bias = push.bias;
        float softness = push.softness;
        if (leaf) {
            uint number = uint(texelFetch(foliage_number, pixel, 0).r) - 1u;
            position = particles[number].centre;
            // Ground hides nothing of itself: its shadow begins at the foot of what throws it.
            if (number >= push.leaves) {
                bias = push.ground_bias;
                softness = push.ground_softness;
            }
        } else {
            vec2 at = (vec2(pixel) + 0.5 - 0.5 * vec2(push.width, push.height)) * stem / frame.focal;
            position = frame.eye + stem * frame.forward + at.x * frame.right - at.y * frame.up;
        }
        float slope = 1.0 / softness;
        vec2 clip = (sun.relative_to_clip * vec4(position, 1.0)).xy;
        ivec2 middle = ivec2(floor((0.5 * clip + 0.5) * float(push.map_size)));
        float own = dot(position - sun.eye, sun.forward);
        int reach = int(push.reach);
        for (int y = -reach; y <= reach; y++) {
            for (int x = -reach; x <= reach; x++) {
                sum += clamp((behind(middle + ivec2(x, y), own) - bias) * slope, 0.0, 1.0);
            }
        }
        sum /= float((2 * reach + 1) * (2 * reach + 1));
    }
    imageStore(shadow, pixel, vec4(sum));
}
