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
    a.ids = vec2(float(push.object) + 1.0, 0.0);
    a.direction = vec2(0.0);
    a.hatch = wood_hatch(in_hatch, dFdx(in_hatch), dFdy(in_hatch), push.tiles, push.along != 0u);
    return a;
}
