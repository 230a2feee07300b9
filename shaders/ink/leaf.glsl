// The fragment of a leaf: cut to its shape, then its attributes.

#include "stage1.glsl"
#include "ink_style.glsl"

layout(set = 0, binding = 0, scalar) restrict readonly buffer Frame { InkFrame frame; };
layout(set = 0, binding = 2, scalar) restrict readonly buffer Clusters { InkCluster clusters[]; };
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

// Whether the shape of the threshold covers the place: 128 of 255 is the leaf's outline.
bool covered(vec2 local) {
    float size = float(INK_SHAPE_SIZE);
    vec2 inside = clamp((vec2(local.x, -local.y) * 0.5 + 0.5) * size, vec2(0.5), vec2(size - 0.5));
    vec2 at = vec2(inside.x, inside.y + size * float(in_ids.z)) / vec2(textureSize(shapes, 0));
    float alpha = textureLod(shapes, at, 0.0).r * (255.0 / 128.0);
    return dot(local, local) <= 1.0 && alpha >= styles[in_ids.w].shape;
}

#include "ink_hatch.glsl"

Attributes leaf_attributes() {
    if (!covered(in_local)) {
        discard;
    }
    Attributes a;
    a.albedo = push.base_color.rgb * texture(base_color_map, in_texcoord).rgb;
    a.normal = in_normal.xyz;
    a.tone = in_normal.w;
    a.depth = dot(in_position - frame.eye, frame.forward);
    a.ids = vec2(style_and_object(in_ids.w, in_ids.x), float(in_ids.y) + 1.0);
    a.direction = in_direction;
    InkCluster cluster = clusters[in_ids.y];
    vec2 packing = vec2(styles[in_ids.w].packing, styles[in_ids.w].packing_steps);
    a.hatch = hatch_coordinates(cluster, gl_FragCoord.xy, a.depth, packing);
    return a;
}
