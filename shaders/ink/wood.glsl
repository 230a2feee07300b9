// The fragment of whatever is no leaf.

#include "stage1.glsl"
#include "tone.glsl"
#include "ink_wood.glsl"

layout(set = 0, binding = 0, scalar) restrict readonly buffer Frame { InkFrame frame; };
layout(set = 1, binding = 0) uniform sampler2D base_color_map;
layout(push_constant, scalar) uniform Push { InkWoodDraw push; };

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec2 in_texcoord;
layout(location = 3) in vec4 in_hatch;
layout(location = 4) flat in uint in_cluster;

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
    a.tone = ink_tone(n, frame.to_sun, frame.ambient, 0.85);
    a.depth = dot(in_position - frame.eye, frame.forward);
    a.ids = vec2(float(push.object) + 1.0, float(in_cluster));
    a.direction = in_cluster > 0u ? vec2(dot(n, frame.right), -dot(n, frame.up)) : vec2(0.0);
    vec4 dx = dFdx(in_hatch);
    vec4 dy = dFdy(in_hatch);
    if (push.strokes == INK_STROKES_BODY) {
        // The mean of a pixel's two extents in the tile.
        float texels = sqrt(abs(dx.x * dy.y - dx.y * dy.x)) * float(INK_TILE);
        a.hatch = vec3(fract(in_hatch.xy), log2(max(texels, 1e-6)));
    } else {
        a.hatch = wood_hatch(in_hatch, dx, dy, push.tiles, push.strokes == INK_STROKES_ALONG);
    }
    return a;
}
