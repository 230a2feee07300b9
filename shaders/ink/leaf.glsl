// The fragment of a leaf: cut to its shape, then its attributes.

#include "stage1.glsl"
#include "tone.glsl"
#include "ink_style.glsl"

layout(set = 0, binding = 0, scalar) restrict readonly buffer Frame { InkFrame frame; };
layout(set = 0, binding = 3) uniform sampler2D shapes;
layout(set = 0, binding = 4, scalar) restrict readonly buffer Styles { InkStyle styles[]; };
layout(set = 1, binding = 0) uniform sampler2D base_color_map;
layout(push_constant, scalar) uniform Push { InkLeafDraw push; };

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec2 in_local;
layout(location = 2) in vec2 in_texcoord;
layout(location = 3) flat in vec4 in_normal;
layout(location = 4) flat in uvec4 in_ids;
layout(location = 5) flat in vec2 in_direction;

layout(location = 6) flat in vec4 in_colour;
layout(location = 7) flat in vec3 in_tint;
layout(location = 8) flat in vec4 in_crown;
layout(location = 9) flat in vec4 in_hatch_linear;
layout(location = 10) flat in vec4 in_hatch_middle;
layout(location = 11) flat in vec4 in_hatch_depth;
layout(location = 12) flat in vec3 in_centre;

// Leaves have styles; otherwise all have the first.
layout(constant_id = 6) const bool MIXED = false;

#include "ink_hatch.glsl"
#include "ink_noise.glsl"
#include "ink_shape.glsl"

// The texture's colour, or the leaf's mean; the mean too where the shape is larger than the leaf
// and a texture has nothing to show. Bristles of a brush leave streaks along the leaf.
vec3 leaf_colour(InkStyle style, float alpha) {
    vec3 texel = texture(base_color_map, in_texcoord).rgb;
    float within = smoothstep(0.97, 1.0, alpha);
    vec3 colour = mix(in_colour.rgb, texel, within * (1.0 - style.flatness));
    float streak = value_noise(vec2(in_local.x * 9.0, in_local.y * 0.7) + in_colour.a * 4096.0, 3u);
    return push.base_color.rgb * colour * in_tint * (1.0 + style.bristles * (1.4 * streak - 0.7));
}

vec3 unit_or(vec3 v, vec3 otherwise) {
    return dot(v, v) > 1e-12 ? normalize(v) : otherwise;
}

// Normal to be lit with. The cluster's is that of the place on its sphere: smooth over leaves, so
// that tone has no borders where they end.
vec3 lit_normal(InkStyle style, vec3 centre) {
    vec3 own = in_normal.xyz;
    vec3 outward = unit_or(in_position - centre, own);
    vec3 smooth_normal = unit_or(mix(outward, in_crown.xyz, style.crown), outward);
    return unit_or(mix(own, smooth_normal, max(style.orientation, style.crown)), outward);
}

Attributes leaf_attributes() {
    InkStyle style = styles[MIXED ? in_ids.w : 0u];
    float alpha = leaf_alpha(shapes, in_local, in_ids.z);
    if (alpha < style.shape) {
        discard;
    }
    Attributes a;
    a.albedo = leaf_colour(style, alpha);
    vec3 normal = lit_normal(style, in_centre);
    a.normal = normal * in_crown.w;
    a.tone = ink_tone(normal, frame.to_sun, style, in_normal.w);
    a.depth = dot(in_position - frame.eye, frame.forward);
    a.ids = vec2(style_and_object(in_ids.w, in_ids.x), float(in_ids.y) + 1.0);
    a.direction = in_direction;
    HatchMap map = HatchMap(in_hatch_linear, in_hatch_middle, in_hatch_depth, style.packing_steps);
    a.hatch = hatch_coordinates(map, gl_FragCoord.xy, a.depth, in_position);
    return a;
}
