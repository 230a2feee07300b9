#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"

// Lines of foliage and stems on paper, each by its own threshold, hidden by what is nearer.

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) uniform sampler2D foliage_depth;
layout(set = 0, binding = 1) uniform sampler2D foliage_number;
layout(set = 0, binding = 2) uniform sampler2D foliage_difference;
layout(set = 0, binding = 3) uniform sampler2D stem_depth;
layout(set = 0, binding = 4) uniform sampler2D stem_difference;
layout(set = 0, binding = 5, scalar) restrict readonly buffer Particles { PaperParticle particles[]; };
layout(set = 0, binding = 6) uniform sampler2D shadow_map;
layout(set = 0, binding = 7) uniform sampler2D factor_map;
layout(set = 0, binding = 8, rgba16f) uniform restrict writeonly image2D picture;
layout(push_constant, scalar) uniform Push { PaperBitmap push; };

layout(constant_id = 0) const bool SHADOW = false;
layout(constant_id = 1) const bool MODULATED = false;

// Half width of the line in a pixel, 0: none; and 1 where it is a stem's.
vec2 line_at(ivec2 at) {
    float foliage = texelFetch(foliage_depth, at, 0).r;
    float stem = texelFetch(stem_depth, at, 0).r;
    float shade = SHADOW ? texelFetch(shadow_map, at, 0).r : 0.0;
    vec2 factor = MODULATED ? texelFetch(factor_map, at, 0).rg : vec2(1.0);
    float width = 0.0;
    float on_stem = 0.0;
    if (foliage > 0.0 && (stem <= 0.0 || foliage <= stem)) {
        uint number = uint(texelFetch(foliage_number, at, 0).r);
        float threshold = push.foliage * (1.0 + push.detail * shade) * factor.x;
        bool line = number <= push.leaves && texelFetch(foliage_difference, at, 0).r > threshold;
        if (line && push.lower != 0u) {
            line = float(at.y) + 0.5 >= particles[number - 1u].row;
        }
        width = line ? push.foliage_width : 0.0;
    } else {
        bool line = stem > 0.0 && texelFetch(stem_difference, at, 0).r > push.stem * factor.x;
        width = line ? push.stem_width : 0.0;
        on_stem = 1.0;
    }
    return vec2(width * (1.0 + push.pressure * shade) * factor.y, on_stem);
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (pixel.x >= int(push.width) || pixel.y >= int(push.height)) {
        return;
    }
    float widest = max(push.foliage_width, push.stem_width) * (1.0 + push.pressure) * push.widest;
    int reach = min(int(ceil(widest)), PAPER_WIDEN);
    ivec2 last = ivec2(push.width, push.height) - 1;
    vec3 below = push.paper;
    if (SHADOW && texelFetch(shadow_map, pixel, 0).r > push.black) {
        bool ground = texelFetch(foliage_depth, pixel, 0).r > 0.0
            && uint(texelFetch(foliage_number, pixel, 0).r) > push.leaves;
        below = ground ? push.ground_ink : push.shadow_ink;
    }
    // Of the lines that reach a pixel the one that covers it most is drawn.
    float most = 0.0;
    vec3 ink = push.ink;
    for (int y = -reach; y <= reach; y++) {
        for (int x = -reach; x <= reach; x++) {
            vec2 line = line_at(clamp(pixel + ivec2(x, y), ivec2(0), last));
            float cover = line.x + 0.5 - length(vec2(x, y));
            if (line.x > 0.0 && cover > most) {
                most = cover;
                ink = line.y > 0.0 ? push.stem_ink : push.ink;
            }
        }
    }
    imageStore(picture, pixel, vec4(mix(below, ink, min(most, 1.0)), 1.0));
}
