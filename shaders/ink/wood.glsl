// The fragment of whatever is no leaf.

#include "stage1.glsl"
#include "tone.glsl"
#include "ink_hatch.glsl"
#include "ink_wood.glsl"
#include "ink_style.glsl"

layout(set = 0, binding = 0, scalar) restrict readonly buffer Frame { InkFrame frame; };
layout(set = 0, binding = 6, scalar) restrict readonly buffer Styles { InkStyle styles[]; };
layout(set = 0, binding = 7, scalar) restrict readonly buffer Parts { InkPart parts[]; };
layout(set = 0, binding = 8, scalar) restrict readonly buffer Masks { uint masks[]; };
layout(set = 1, binding = 0) uniform sampler2D base_color_map;
layout(push_constant, scalar) uniform Push { InkWoodDraw push; };

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec2 in_texcoord;
layout(location = 3) in vec4 in_hatch;
layout(location = 4) flat in uint in_cluster;

// The style of the first part that the pixel is in; the first style where there is none.
uint wood_style(float depth) {
    uint open = push.parts;
    if (frame.masked != 0u) {
        uvec2 pixel = min(uvec2(gl_FragCoord.xy), uvec2(frame.width, frame.height) - 1u);
        open &= masks[pixel.y * frame.width + pixel.x];
    }
    for (uint i = 0u; i < min(frame.parts, 32u); i++) {
        bool within = depth >= parts[i].nearest && depth < parts[i].farthest;
        if ((open >> i & 1u) != 0u && within) {
            return parts[i].style;
        }
    }
    return 0u;
}

Attributes wood_attributes() {
    vec4 base = push.base_color * texture(base_color_map, in_texcoord);
    if (base.a < push.cutoff) {
        discard;
    }
    Attributes a;
    vec3 n = normalize(in_normal);
    n = gl_FrontFacing ? n : -n;
    a.albedo = base.rgb;
    a.normal = n;
    a.depth = dot(in_position - frame.eye, frame.forward);
    uint number = wood_style(a.depth);
    InkStyle style = styles[number];
    a.tone = ink_tone(n, frame.to_sun, style, 0.85);
    a.ids = vec2(style_and_object(number, push.object), float(in_cluster));
    a.direction = in_cluster > 0u ? vec2(dot(n, frame.right), -dot(n, frame.up)) : vec2(0.0);
    vec4 dx = dFdx(in_hatch);
    vec4 dy = dFdy(in_hatch);
    if (push.strokes == INK_STROKES_BODY) {
        // By a pixel's area in the tile; by its extents where the map folds and that is nothing.
        float size = sqrt(0.5 * (dot(dx.xy, dx.xy) + dot(dy.xy, dy.xy)));
        float texels = max(sqrt(abs(dx.x * dy.y - dx.y * dy.x)), 0.5 * size) * float(INK_TILE);
        a.hatch = hatch_octave(in_hatch.xy, log2(max(texels, 1e-6)));
    } else {
        bool along = style.wood_strokes == INK_STROKES_ALONG;
        a.hatch = wood_hatch(in_hatch, dx, dy, style.wood_tiles, along);
    }
    return a;
}
